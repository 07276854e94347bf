#include <chrono>
#include <string>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "io/tcp/host_lookup.hpp"
#include "io/tcp/tcp_connect.hpp"
#include "io/udp/udp_socket.hpp"
#include "support/catch.hpp"
#include "unit/io/run.hpp"

using namespace rubicon;
using test::run;

namespace {

struct listening {
  std::vector<bytes> datagrams;
  std::uint16_t from = 0;
  int turns = 0;

  io::udp_socket::callbacks callbacks() {
    return {[this](byte_view x, std::size_t each, const ipv4_address&, std::uint16_t port) {
              from = port;
              for (; !x.empty(); x = x.subspan(std::min(each, x.size())))
                datagrams.push_back(to_bytes(x.first(std::min(each, x.size()))));
            },
            [this] { ++turns; }};
  }
};

io::udp_socket open(io::loop& loop, io::udp_socket::callbacks x, std::uint16_t port = 0) {
  return std::get<io::udp_socket>(io::udp_socket::open(loop, "127.0.0.1", port, std::move(x)));
}

} // namespace

TEST_CASE("datagrams that are sent together come as they were", "[io][UDP-01]") {
  io::loop loop;
  listening a;
  listening b;
  auto from = open(loop, a.callbacks());
  const auto to = open(loop, b.callbacks());
  bytes many;
  for (std::uint8_t i = 0; i < 40; ++i)
    many.insert(many.end(), 1400, i);
  many.insert(many.end(), 7, 99);
  from.send(many, 1400, {127, 0, 0, 1}, to.port());
  from.send(to_bytes("alone"), 5, {127, 0, 0, 1}, to.port());
  run(loop, [&] { return b.datagrams.size() == 42; });
  for (std::uint8_t i = 0; i < 40; ++i)
    CHECK(b.datagrams[i] == bytes(1400, i));
  CHECK(b.datagrams[40] == bytes(7, 99));
  CHECK(b.datagrams[41] == to_bytes("alone"));
  CHECK(b.from == from.port());
  CHECK(b.turns > 0);
  CHECK(a.datagrams.empty());
  CHECK(from.unsent() == 0);
  CHECK(to.input_octets() > 100'000);
}

TEST_CASE("a UDP port counts up to a free one", "[io][UDP-01]") {
  io::loop loop;
  listening x;
  const auto first = open(loop, x.callbacks());
  const auto second = open(loop, x.callbacks(), first.port());
  CHECK(second.port() > first.port());
  const auto refused = io::udp_socket::open(loop, "192.0.2.1", 0, x.callbacks());
  REQUIRE(std::holds_alternative<std::string>(refused));
  CHECK(std::get<std::string>(refused).starts_with("no UDP at 192.0.2.1:0: "));
}

TEST_CASE("datagrams that the network does not take are counted one by one", "[io][UDP-01]") {
  io::loop loop;
  listening x;
  auto socket = open(loop, x.callbacks());
  socket.send(bytes(3 * 1400 + 1), 1400, {192, 0, 2, 1}, 9); // not from a loopback address
  CHECK(socket.unsent() == 4);
}

TEST_CASE("the address of a host is found, or it is said why not", "[io][LNK-07]") {
  io::loop loop;
  std::vector<std::variant<ipv4_address, std::string>> found;
  const auto take = [&](auto x) { found.push_back(std::move(x)); };
  const io::host_lookup numeric(loop, "10.1.2.3", take);
  CHECK(found.empty());
  run(loop, [&] { return found.size() == 1; });
  CHECK(std::get<ipv4_address>(found[0]) == ipv4_address{10, 1, 2, 3});
  { const io::host_lookup given_up(loop, "10.1.2.4", take); }
  const io::host_lookup named(loop, "localhost", take);
  run(loop, [&] { return found.size() == 2; });
  CHECK(std::get<ipv4_address>(found[1]) == ipv4_address{127, 0, 0, 1});
}
