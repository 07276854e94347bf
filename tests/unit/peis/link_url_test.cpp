#include "peis/wire/link_url.hpp"

#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::peis;
using scheme = link_url::scheme;

TEST_CASE("the four forms of addresses are read and written", "[peis][LNK-05]") {
  struct row {
    const char* text;
    link_url url;
    const char* again;
  };
  const row rows[] = {
      {"tcp://192.168.1.7:8001", {scheme::tcp, "192.168.1.7", 8001}, "tcp://192.168.1.7:8001"},
      {"tcp://localhost", {scheme::tcp, "localhost", 8000}, "tcp://localhost:8000"},
      {"udp://pc.lan:9000", {scheme::udp, "pc.lan", 9000}, "udp://pc.lan:9000"},
      {"bt://00:1A:7d:da:71:13",
       {scheme::bluetooth, "00:1A:7d:da:71:13", 7315},
       "bt://00:1A:7d:da:71:13;7315"},
      {"bt://00:1A:7D:DA:71:13;12",
       {scheme::bluetooth, "00:1A:7D:DA:71:13", 12},
       "bt://00:1A:7D:DA:71:13;12"},
      {"inproc://kitchen", {scheme::inproc, "kitchen", 0}, "inproc://kitchen"},
  };
  for (const auto& x : rows) {
    INFO(x.text);
    const auto url = parse_link_url(x.text);
    REQUIRE(url);
    CHECK(*url == x.url);
    CHECK(to_string(*url) == x.again);
  }
}

TEST_CASE("what is no address is refused", "[peis][LNK-05]") {
  for (const auto* text : {"", "tcp:", "tcp://", "tcp://:8000", "tcp://a:0", "tcp://a:65536",
                           "tcp://a:80x", "tcp://a b", "http://a", "bt://00:1A:7D:DA:71",
                           "inproc://", "bt://00-1A-7D-DA-71-13", "tcp://a:b:1", "inproc://a/b"}) {
    INFO(text);
    CHECK_FALSE(parse_link_url(text));
  }
}

TEST_CASE("addresses of a record say where they lead", "[peis][LNK-03]") {
  CHECK(to_string(url_of(tcp_address("eth0", false, {10, 77, 0, 3}, 8002))) ==
        "tcp://10.77.0.3:8002");
  CHECK(to_string(url_of(inproc_address(5, peer_id{70000}))) == "inproc://70000");
  low_level_address bluetooth{"hci0",
                              false,
                              low_level_address::kind::bluetooth,
                              {0, 0x1a, 0x7d, 0xda, 0x71, 0x13, 0x1c, 0x93}};
  CHECK(to_string(url_of(bluetooth)) == "bt://00:1A:7D:DA:71:13;7315");
}

TEST_CASE("links of simulated media name a peer or a device", "[peis][LNK-05]") {
  CHECK(inproc_peer(*parse_link_url("inproc://70000")) == peer_id{70000});
  CHECK(!inproc_peer(*parse_link_url("inproc://kitchen")));
  CHECK(!inproc_peer(*parse_link_url("inproc://7x")));
  CHECK(!inproc_peer(*parse_link_url("tcp://7")));
  const auto* const address = "00:1A:7D:DA:71:13";
  const auto device = bluetooth_device(*parse_link_url(std::string("bt://") + address));
  REQUIRE(device);
  CHECK(to_string(*device) == address);
  CHECK(!bluetooth_device(*parse_link_url("tcp://a")));
}
