// What a neighbour that keeps to no rule can bring about, and what not.
#include <algorithm>
#include <limits>

#include "peis/network_clock.hpp"
#include "peis/routing_page.hpp"
#include "peis_world.hpp"
#include "support/catch.hpp"

namespace rubicon::peis {
namespace {

using test::world;

constexpr link_id hostile_link{1000};
constexpr peer_id hostile{666};

/// A package as it lies in a stream.
bytes package_of(package_header header, byte_view data) {
  static std::int32_t next_id = 1;
  header.id = next_id++;
  if (header.ack_id == 0)
    header.ack_id = header.id;
  header.length = static_cast<std::uint16_t>(data.size());
  bytes octets;
  encode(header, octets);
  octets.insert(octets.end(), data.begin(), data.end());
  return octets;
}

package_header header_of(package_type type, std::uint16_t port, peer_id source,
                         peer_id destination = any_peer) {
  package_header x;
  x.type = type;
  x.port = port;
  x.source = source;
  x.destination = destination;
  return x;
}

void say(world& w, peer_id to, const bytes& octets) {
  w.perform(to, w.at(to).on_link_octets(hostile_link, octets, w.now()));
}

/// A neighbour by whom anything may be said.
void befriend(world& w, peer_id to) {
  w.perform(to, w.at(to).on_link_open(hostile_link, link_role::acceptor, w.now()));
  say(w, to, encode(connect_request{500, hostile, connect_request::for_merge, "test"}));
}

} // namespace

TEST_CASE("what follows a clock message in its package is passed on as it is",
          "[peis][CLK-07][P2P-01]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(5s);
  befriend(w, a);
  for (const std::size_t size : {12, 13, 100, 1024}) {
    auto data = encode(clock_message{1s, false, 0s});
    data.resize(size, 0x55);
    for (const auto source : {b, peer_id{77}}) { // of a host that we know to be of our kind, or not
      w.packages.clear();
      say(w, a, package_of(header_of(package_type::broadcast, port::clock, source), data));
      w.run_for(100ms);
      const auto passed = std::ranges::find_if(w.packages, [&](const test::carried& x) {
        return x.header.port == port::clock && x.header.source == source;
      });
      REQUIRE(passed != w.packages.end());
      CHECK(passed->header.length == size);
    }
  }
}

TEST_CASE("a sequence number that nobody can have reached is not taken for ours",
          "[peis][RTE-03]") {
  routing_table table(peer_id{1}, 7, 30);
  const routing_entry incredible{peer_id{1}, std::numeric_limits<std::int32_t>::max(), 8, 1, 1};
  static_cast<void>(table.on_table(link_id{1}, 1, {&incredible, 1}, instant{}));
  CHECK_FALSE(table.take_overtaken());
  CHECK(table.next_seqno() == 1);
  const routing_entry earlier{peer_id{1}, 1'000'000, 8, 1, 1};
  static_cast<void>(table.on_table(link_id{1}, 1, {&earlier, 1}, instant{}));
  CHECK(table.take_overtaken());
  CHECK(table.next_seqno() == 1'000'001);
}

} // namespace rubicon::peis
