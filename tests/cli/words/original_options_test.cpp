// Options of original kernels, as peisinit gives them.
#include <string>
#include <vector>

#include "cli/options/parse_command_line.hpp"
#include "cli/words/original_options.hpp"
#include "config/load.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::cli;

namespace {

original_options taken(std::vector<std::string>& words) {
  const auto file = [](const std::string& name) {
    return name == "opts" ? std::optional<std::string>("id 9 # ours\nnetwork lab\n--peis-leaf\n")
                          : std::nullopt;
  };
  auto x = take_original_options(words, file);
  REQUIRE(std::holds_alternative<original_options>(x));
  return std::get<original_options>(x);
}

std::string refusal(std::vector<std::string> words) {
  const auto x = take_original_options(words, [](const auto&) { return std::nullopt; });
  const auto* why = std::get_if<std::string>(&x);
  return why == nullptr ? "" : *why;
}

config::ecology_description ecology_of(const std::string& toml) {
  auto x = config::load_with_files("[ecology]\nname = \"e\"\nmode = \"wall\"\n" + toml, "e.toml");
  REQUIRE(x.ecology);
  return *std::move(x.ecology);
}

command parsed(std::vector<const char*> words) {
  words.insert(words.begin(), "rubicon");
  return parse_command_line(words);
}

} // namespace

TEST_CASE("what peisinit gives is taken out of the command line", "[cli]") {
  std::vector<std::string> words{"rubicon",
                                 "run",
                                 "robot.toml",
                                 "--peis-id",
                                 "7",
                                 "--peis-hostname",
                                 "robot",
                                 "--peis-network",
                                 "lab",
                                 "--peis-connect",
                                 "tcp://localhost:8001",
                                 "--for",
                                 "10s",
                                 "--peis-connect",
                                 "10.0.0.7"};
  const auto x = taken(words);
  CHECK(words == std::vector<std::string>{"rubicon", "run", "robot.toml", "--for", "10s"});
  CHECK(x.id == peer_id{7});
  CHECK(x.host_name == "robot");
  CHECK(x.network == "lab");
  CHECK(x.connect == std::vector<std::string>{"tcp://localhost:8001", "tcp://10.0.0.7:8000"});
  CHECK(x.without_effect.empty());
}

TEST_CASE("options of original kernels come from files as well, and those without effect are told",
          "[cli]") {
  std::vector<std::string> words{"--peis-load", "opts",          "--peis-net-metric", "3",
                                 "FILE",        "--peis-silent", "--peis-set-tuple",  "a.b",
                                 "5",           "--peis-new"};
  const auto x = taken(words);
  CHECK(words == std::vector<std::string>{"FILE"});
  CHECK(x.id == peer_id{9});
  CHECK(x.network == "lab");
  CHECK(x.leaf);
  CHECK(x.without_effect == std::vector<std::string>{"--peis-net-metric", "--peis-silent",
                                                     "--peis-set-tuple", "--peis-new"});
}

TEST_CASE("bad options of original kernels are refused with the reason", "[cli]") {
  CHECK(refusal({"--peis-id", "0"}) == "--peis-id: not a number from 1 to 65535: '0'");
  CHECK(refusal({"--peis-id"}) != "");
  CHECK(refusal({"--peis-port", "x"}) != "");
  CHECK(refusal({"--peis-connect", "bt://00:11:22:33:44:55;1"}) != "");
  CHECK(refusal({"--peis-network", std::string(63, 'n')}) != "");
  CHECK(refusal({"--peis-load", "none"}) == "--peis-load: none cannot be read");
  const auto other = parsed({"check", "home.toml", "--peis-id", "7"});
  CHECK(std::holds_alternative<refused_command>(other));
}

TEST_CASE("the peer of a file is who its starter says", "[cli]") {
  auto x = ecology_of("[[peer]]\nid = 700\nname = \"pc\"\ntcp = true\n");
  std::vector<std::string> words{
      "--peis-id",      "7",    "--peis-hostname", "robot",
      "--peis-network", "lab",  "--peis-connect",  "tcp://localhost:8001",
      "--peis-port",    "8100", "--peis-name",     "arm"};
  CHECK(take_over(taken(words), x) == "");
  REQUIRE(x.peers.size() == 1);
  const auto& peer = x.peers[0];
  CHECK(peer.id == peer_id{7});
  CHECK(peer.host == "robot");
  CHECK(peer.name == "arm");
  CHECK(x.network == "lab");
  CHECK(peer.connect == std::vector<std::string>{"tcp://localhost:8001"});
  REQUIRE(peer.tcp);
  CHECK(peer.tcp->port == 8100);
  CHECK_FALSE(peer.udp);
  auto over_udp = ecology_of("[[peer]]\nid = 700\nname = \"pc\"\ntcp = true\n");
  std::vector<std::string> asked{"--peis-connect", "udp://robot:8001"};
  CHECK(take_over(taken(asked), over_udp) == "");
  CHECK(over_udp.peers[0].udp);
  CHECK(over_udp.peers[0].connect == std::vector<std::string>{"udp://robot:8001"});
  auto many = ecology_of("[[peer]]\nid = 1\nname = \"a\"\n[[peer]]\nid = 2\nname = \"b\"\n");
  original_options id;
  id.id = peer_id{5};
  CHECK(take_over(id, many) != ""); // which of them?
  auto real =
      ecology_of("[[peer]]\nid = 1\nname = \"a\"\n[[peer]]\nid = 2\nname = \"b\"\ntcp = true\n");
  id.id = peer_id{1};
  CHECK(take_over(id, real) == "--peis-id: the file uses 1 for another peer");
  id.id = peer_id{5};
  CHECK(take_over(id, real) == "");
  CHECK(real.peers[1].id == peer_id{5});
}

TEST_CASE("who joins as a guest takes the options too", "[cli]") {
  const auto x = parsed({"hosts", "--peis-id", "9", "--peis-network", "lab", "--peis-connect",
                         "tcp://10.0.0.7:8001", "--peis-silent"});
  REQUIRE(std::holds_alternative<network_command>(x));
  const auto& with = std::get<network_command>(x).with;
  CHECK(with.id == peer_id{9});
  CHECK(with.network == "lab");
  CHECK(with.peer == "tcp://10.0.0.7:8001");
  CHECK(with.without_effect == std::vector<std::string>{"--peis-silent"});
}
