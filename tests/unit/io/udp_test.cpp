#include <chrono>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "io/udp/udp_group.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

/// On the loopback interface, away from the port of real ecologies.
io::udp_group_config local_group() {
  io::udp_group_config x;
  x.port = 20001;
  x.interfaces = {"127.0.0.1"};
  return x;
}

} // namespace

TEST_CASE("everyone of a group hears a datagram, its sender included", "[io][TCP-02][TCP-03]") {
  io::loop loop;
  std::vector<std::string> heard_a;
  std::vector<std::string> heard_b;
  auto a = std::get<io::udp_group>(
      io::udp_group::join(loop, local_group(), [&](byte_view x, const ipv4_address&) {
        heard_a.push_back(to_string(x));
      }));
  const auto b = std::get<io::udp_group>(
      io::udp_group::join(loop, local_group(), [&](byte_view x, const ipv4_address&) {
        heard_b.push_back(to_string(x));
      }));
  a.send(to_bytes("one"));
  a.send(to_bytes(""));
  a.send(bytes(616, 'x'));
  const auto end = std::chrono::steady_clock::now() + 20s;
  while ((heard_a.size() < 3 || heard_b.size() < 3) && std::chrono::steady_clock::now() < end)
    loop.wait_until(end);
  const std::vector<std::string> all{"one", "", std::string(616, 'x')};
  CHECK(heard_a == all);
  CHECK(heard_b == all);
  CHECK(a.unsent() == 0);
}

TEST_CASE("a datagram that the network does not take is counted", "[io]") {
  io::loop loop;
  auto a = std::get<io::udp_group>(
      io::udp_group::join(loop, local_group(), [](byte_view, const ipv4_address&) {}));
  a.send(bytes(70'000, 'x'));
  CHECK(a.unsent() == 1);
}

TEST_CASE("a group that can never be joined is refused with its reason", "[io]") {
  io::loop loop;
  auto config = local_group();
  SECTION("no address") {
    config.group = "everybody";
  }
  SECTION("an address of one machine") {
    config.group = "127.0.0.1";
  }
  SECTION("no address of an interface") {
    config.interfaces = {"eth0"};
  }
  const auto x = io::udp_group::join(loop, config, [](byte_view, const ipv4_address&) {});
  REQUIRE(std::holds_alternative<std::string>(x));
  CHECK(std::get<std::string>(x).starts_with(config.group + ":20001: "));
}

TEST_CASE("an interface that is not there is waited for", "[io][TCP-02]") {
  io::loop loop;
  auto config = local_group();
  config.interfaces = {"192.0.2.1"};
  auto x = std::get<io::udp_group>(
      io::udp_group::join(loop, config, [](byte_view, const ipv4_address&) {}));
  CHECK(x.trouble().starts_with("227.1.3.5:20001: "));
  x.send(to_bytes("nobody"));
  CHECK(x.unsent() == 1);
}
