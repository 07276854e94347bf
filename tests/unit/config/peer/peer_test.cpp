#include <string>

#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

constexpr std::string_view wall_head = "[ecology]\nname = \"t\"\nmode = \"wall\"\n";

/// The first peer of a file in wall time whose keys these are.
peer_description wall_peer(const std::string& keys) {
  return good(std::string(wall_head) + "[[peer]]\nname = \"pc\"\nid = 300\n" + keys).peers.at(0);
}

} // namespace

TEST_CASE("a peer without links finds others by itself", "[config][CM-12][LEA-01][A-78]") {
  const auto x = good(std::string(head)).peers.at(0);
  CHECK(x.discovery);
  CHECK(x.manager);
  CHECK_FALSE(x.leaf);
  CHECK_FALSE(x.lan);
  CHECK_FALSE(x.tcp);
  CHECK(x.connect.empty());
  CHECK(x.managers.empty());
}

TEST_CASE("a peer with links does not announce itself unless it is to", "[config][AUT-01]") {
  const auto with = [](const std::string& keys) {
    return good(std::string(head) + keys + "[[peer]]\nname = \"b\"\nid = 301\n").peers.at(0);
  };
  CHECK_FALSE(with("links = [\"inproc://b\"]\n").discovery);
  CHECK(with("links = [\"inproc://b\"]\ndiscovery = true\n").discovery);
  CHECK_FALSE(with("discovery = false\n").discovery);
  CHECK_FALSE(wall_peer("connect = [\"tcp://a:1\"]\n").discovery);
}

TEST_CASE("the keys of a peer arrive", "[config][AUT-01][CM-12][LEA-01][TUP-22][CLK-06]") {
  const auto x = wall_peer("connect = [\"tcp://10.0.0.7\", \"tcp://pc.lan:9000\"]\n"
                           "tcp = { port = 8100 }\nlan = true\nleaf = true\nmanager = false\n"
                           "time_master = true\nmanagers = [7, 65535]\n");
  CHECK(x.connect == std::vector<std::string>{"tcp://10.0.0.7:8000", "tcp://pc.lan:9000"});
  REQUIRE(x.tcp);
  CHECK(x.tcp->port == 8100);
  CHECK(x.lan);
  CHECK(x.leaf);
  CHECK_FALSE(x.manager);
  CHECK(x.time_master);
  CHECK_FALSE(x.udp);
  const auto over_udp = wall_peer("udp = true\nconnect = [\"udp://10.0.0.7\"]\n");
  CHECK(over_udp.udp);
  CHECK(over_udp.connect == std::vector<std::string>{"udp://10.0.0.7:8000"});
  CHECK_FALSE(wall_peer("").time_master);
  CHECK(x.managers == std::vector{peer_id{7}, peer_id{65535}});
  CHECK(wall_peer("tcp = true\n").tcp);
  CHECK_FALSE(wall_peer("tcp = true\n").tcp->port);
  CHECK_FALSE(wall_peer("tcp = false\n").tcp);
  CHECK_FALSE(wall_peer("tcp = {}\n").tcp->port);
}

TEST_CASE("a table with a count makes peers with numbers", "[config][GEN-04]") {
  const auto x =
      good("[ecology]\nname = \"t\"\nmode = \"wall\"\n"
           "[[peer]]\nname = \"m\"\nid = 1\nlinks = [\"inproc://leaf-3\"]\n"
           "[[peer]]\nname = \"leaf\"\nid = 10\ncount = 3\nlinks = [\"inproc://m\"]\n"
           "leaf = true\ntcp = { port = 9000 }\napps = [{ app = \"collector\", keys = [\"a\"] }]\n")
          .peers;
  REQUIRE(x.size() == 4);
  CHECK(x[0].links == std::vector<std::string>{"leaf-3"});
  for (std::size_t i = 1; i <= 3; ++i) {
    CHECK(x[i].id.value == static_cast<std::int32_t>(9 + i));
    CHECK(x[i].name == "leaf-" + std::to_string(i));
    CHECK(x[i].leaf);
    CHECK(x[i].links == std::vector<std::string>{"m"});
    CHECK(x[i].tcp->port == 8999 + i);
    CHECK(x[i].apps.size() == 1);
  }
  const auto one = good("[ecology]\nname = \"t\"\n[[peer]]\nname = \"m\"\nid = 1\ncount = 1\n");
  CHECK(one.peers.at(0).name == "m-1");
}

TEST_CASE("peers that cannot be are refused", "[config][GEN-06]") {
  check_mistakes(head, R"(
count = 0
#       ^ `count` must be a whole number from 1 to 1000, not 0

count = 1001
#       ^ `count` must be a whole number from 1 to 1000, not 1001

[[peer]]
name = "b"
id = 298
#    ^ PEIS id 300 is already taken (line 5, column 6)
count = 3

[[peer]]
name = "b"
id = 65000
count = 537
#       ^ PEIS ids from 65000 to 65536 are more than 65535

[[peer]]
name = "b"
id = 65000
count = 536

[[peer]]
name = "b"
id = 1
count = 2
[[peer]]
name = "B-2"
#      ^ peer or gateway name `B-2` is already taken (line 7, column 8)
id = 9

[[peer]]
name = "a2345678901234567890123456789x"
#      ^ `a2345678901234567890123456789x-10` would be longer than 32 characters
id = 1
count = 10

[[peer]]
name = "b"
id = 1
count = 2
links = ["inproc://b-2"]
#        ^ `b-2` cannot have a link to itself

[[peer]]
name = "b"
id = 1
count = 2
links = ["inproc://b"]
#        ^ no peer or gateway is named `b`: there is b-1, b-2, pc

count = 2
apps = [{ app = "proxy_manager" }]
#               ^ an island has one proxy manager, not 2

managers = [0]
#           ^ `managers` must be a whole number from 1 to 65535, not 0

leaf = 1
#      ^ `leaf` must be true or false, not 1

connect = ["tcp://a:1"]
#         ^ `connect` needs mode = "wall": in virtual time there is no real network

tcp = true
#     ^ `tcp` needs mode = "wall": in virtual time there is no real network

udp = true
#     ^ `udp` needs mode = "wall": in virtual time there is no real network

lan = true
#     ^ `lan` needs mode = "wall": in virtual time there is no real network

tcp = false
lan = false
connect = []
)");
}

TEST_CASE("real links that cannot be are refused", "[config][GEN-06][LNK-05]") {
  check_mistakes(wall_head, R"(
[[peer]]
id = 300
name = "pc"
connect = ["inproc://b"]
#          ^ `connect` must be the address of a peer, as in "tcp://192.168.1.7:8000", not
#   "inproc://b"

[[peer]]
id = 300
name = "pc"
connect = ["tcp://b:0"]
#          ^ `connect` must be the address of a peer, as in "tcp://192.168.1.7:8000", not
#   "tcp://b:0"

[[peer]]
id = 300
name = "pc"
connect = ["bt://b"]
#          ^ `connect` must be the address of a peer, as in "tcp://192.168.1.7:8000", not "bt://b"

[[peer]]
id = 300
name = "pc"
connect = ["tcp://b", "udp://b"]
#         ^ `udp://b:8000` needs `udp = true`

[[peer]]
id = 300
name = "pc"
udp = true
#     ^ `udp` needs `tcp`, `lan` or a `udp://` address in `connect`

[[peer]]
id = 300
name = "pc"
connect = [7]
#          ^ `connect` must be the address of a peer, as in "tcp://192.168.1.7:8000", not 7

[[peer]]
id = 300
name = "pc"
tcp = 8000
#     ^ `tcp` must be true, false or a table, as in { port = 8000 }, not 8000

[[peer]]
id = 300
name = "pc"
tcp = { prot = 8000 }
#       ^ unknown key `prot` in [peer.tcp]: did you mean `port`?

[[peer]]
id = 300
name = "pc"
tcp = { port = 0 }
#              ^ `port` must be a whole number from 1 to 65535, not 0

[[peer]]
id = 300
name = "pc"
count = 2
tcp = { port = 65535 }
#              ^ ports from 65535 on are too few for 2 peers

[[peer]]
id = 300
name = "pc"
tcp = { port = 9001 }
[[peer]]
name = "b"
id = 1
count = 2
tcp = { port = 9000 }
#              ^ TCP port 9001 is already taken (line 7, column 16)
)");
}

TEST_CASE("a mode given beside the file decides what may be real", "[config][GEN-06]") {
  const auto text = std::string(head) + "tcp = true\n";
  overrides wall;
  wall.mode = run_mode::wall;
  CHECK(load_text(text, "t", wall).problems.empty());
  overrides virtual_time;
  virtual_time.mode = run_mode::virtual_time;
  CHECK(load_text(std::string(wall_head) + "[[peer]]\nname = \"pc\"\nid = 1\ntcp = true\n", "t",
                  virtual_time)
            .problems.size() == 1);
}

TEST_CASE("the network between hosts arrives with its keys", "[config]") {
  const auto none = good(std::string(head)).peis;
  CHECK(none.delay == 200us);
  CHECK(none.loss == 0);
  CHECK(none.bandwidth_bps == 0);
  const auto x =
      good(std::string(head) + "[peis]\ndelay = \"2ms\"\nloss = \"5%\"\nbandwidth = \"10Mbit/s\"\n")
          .peis;
  CHECK(x.delay == 2ms);
  CHECK(x.loss == 0.05);
  CHECK(x.bandwidth_bps == 10'000'000);
  CHECK(good(std::string(head) + "[peis]\nbandwidth = 0\n").peis.bandwidth_bps == 0);
  CHECK(good(std::string(head) + "[peis]\nbandwidth = \"1.5kbit/s\"\n").peis.bandwidth_bps == 1500);
  const auto bad = GENERATE(values<row>({
      {"[peis]\ndelay = \"11s\"\n", "7:9: `delay` must be a time from 0 ns to 10 s, not \"11s\""},
      {"[peis]\nloss = 2\n",
       "7:8: `loss` must be a ratio from 0 to 1, or from \"0%\" to \"100%\", not 2"},
      {"[peis]\nbandwidth = 999\n",
       "7:13: `bandwidth` must be a rate from 1 kbit/s to 1000 Gbit/s with its unit (bit/s, "
       "kbit/s, "
       "Mbit/s or Gbit/s), as in \"10Mbit/s\", or 0 for no limit, not 999"},
      {"[peis]\nbandwidth = \"10MB/s\"\n",
       "7:13: `bandwidth` must be a rate from 1 kbit/s to 1000 Gbit/s with its unit (bit/s, "
       "kbit/s, "
       "Mbit/s or Gbit/s), as in \"10Mbit/s\", or 0 for no limit, not \"10MB/s\""},
  }));
  CHECK(problem_after(head, bad.toml) == bad.problem);
}

TEST_CASE("a summary shows how peers meet", "[config]") {
  const auto x = good("[ecology]\nname = \"t\"\nmode = \"wall\"\n"
                      "[peis]\nloss = 0.1\nbandwidth = \"10Mbit/s\"\n"
                      "[[peer]]\nname = \"a\"\nid = 1\n"
                      "[[peer]]\nname = \"b\"\nid = 2\nlinks = [\"inproc://a\"]\n"
                      "connect = [\"tcp://c\"]\ntcp = true\nlan = true\nudp = true\nleaf = true\n"
                      "manager = false\ndiscovery = true\n"
                      "[[peer]]\nname = \"c\"\nid = 3\ndiscovery = false\ntcp.port = 9000\n"
                      "time_master = true\n");
  CHECK(summary(x) == R"(t: 10 min of wall time, seed 1, network rubicon
0 islands, 0 motes, 3 peers
peers: delay 200 us; loss 10 %; 10 Mbit/s

peers and gateways
  1  a
  2  b  -> a, tcp://c:8000; tcp 8000 or above; lan; udp; leaf; no manager; discovery
  3  c  tcp 9000; no discovery; time master
)");
}
