#include "core/text/host_port.hpp"
#include "core/text/ipv4_network.hpp"

#include <string>

#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("networks are written as addresses with a prefix", "[core]") {
  for (const std::string text : {"192.168.1.0/24", "10.0.0.7", "0.0.0.0/0", "127.0.0.0/8",
                                 "10.1.2.128/25", "255.255.255.255"}) {
    const auto found = parse_ipv4_network(text);
    REQUIRE(found);
    CHECK(to_string(*found) == text);
  }
  CHECK(to_string(*parse_ipv4_network("10.0.0.7/32")) == "10.0.0.7");
  for (const auto* text :
       {"", "10.0.0", "10.0.0.0.0", "10.0.0.256", "10.0.0.1/24", "10.0.0.0/33", "10.0.0.0/",
        "10.0.0.0/-1", "010.0.0.1", "10.0.0.1 ", " 10.0.0.1", "a.b.c.d", "10.0.0.0/8/8", "::1"})
    CHECK_FALSE(parse_ipv4_network(text));
  CHECK_FALSE(parse_ipv4_address("10.0.0.0/8"));
}

TEST_CASE("a network contains what its prefix says", "[core]") {
  const auto contains = [](const char* network, const char* address) {
    return parse_ipv4_network(network)->contains(*parse_ipv4_address(address));
  };
  CHECK(contains("192.168.1.0/24", "192.168.1.255"));
  CHECK_FALSE(contains("192.168.1.0/24", "192.168.2.0"));
  CHECK(contains("10.1.2.128/25", "10.1.2.129"));
  CHECK_FALSE(contains("10.1.2.128/25", "10.1.2.127"));
  CHECK(contains("0.0.0.0/0", "1.2.3.4"));
  CHECK(contains("10.0.0.7", "10.0.0.7"));
  CHECK_FALSE(contains("10.0.0.7", "10.0.0.8"));
}

TEST_CASE("a host and its port are apart at the last colon", "[core]") {
  const auto x = parse_host_port("basement.local:9002");
  REQUIRE(x);
  CHECK(x->host == "basement.local");
  CHECK(x->port == 9002);
  CHECK(parse_host_port(":1")->host.empty());
  CHECK(parse_host_port("a:b:65535")->host == "a:b");
  for (const auto* bad :
       {"", "host", "host:", "host:0", "host:65536", "host:-1", "host:9002 ", "host:port"}) {
    INFO(bad);
    CHECK_FALSE(parse_host_port(bad));
  }
}
