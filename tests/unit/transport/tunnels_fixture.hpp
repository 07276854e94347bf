// Nodes with tunnels, and a packet service between them that loses, repeats and reorders, under
// virtual time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "core/codec.hpp"
#include "core/numbers/random.hpp"
#include "support/catch.hpp"
#include "transport/tunnels.hpp"

namespace rubicon::test {

inline constexpr mote_address alice{island_id{1}, mote_id{7}};
inline constexpr mote_address bob{island_id{2}, mote_id{8}};
inline constexpr mote_address pc{island_id{2}, no_mote};
inline transport::tunnels make_tunnels(mote_address self, std::uint32_t incarnation = 0,
                                       std::size_t tunnels_max = 4,
                                       transport::answer_slacks slacks = {}) {
  transport::tunnels_config config;
  config.self = self.mote;
  config.incarnation = incarnation;
  config.tunnels_max = tunnels_max;
  config.slacks = std::move(slacks);
  transport::tunnels x(config);
  x.join(self.island);
  return x;
}

/// One end of a tunnel: a node, which of its lives, and its id there.
using end_of_tunnel = std::tuple<mote_address, std::uint32_t, transport::tunnel_id>;

struct connection {
  bool opened_here = false;
  bool is_open = false;
  bool is_over = false; ///< ended, closed or refused: nothing may follow
  std::optional<transport::tunnel_end> why;
  std::vector<std::uint32_t> received;
  std::optional<end_of_tunnel> other; ///< whose contents have come
};

/// Nodes and a packet service between them that loses, repeats and reorders at seeded rates. Checks
/// at every output that it may follow the ones before.
class tunnel_fixture {
public:
  explicit tunnel_fixture(duration delay_max = 20ms, double loss = 0, std::uint64_t seed = 1,
                          std::size_t tunnels_max = 4, transport::answer_slacks slacks = {})
      : delay_max_(delay_max), loss_(loss), tunnels_max_(tunnels_max), slacks_(std::move(slacks)),
        rng_(seed) {
    for (const auto who : {alice, bob, pc})
      nodes_[who].core = make_tunnels(who, 0, tunnels_max_, slacks_);
  }

  transport::tunnels& at(mote_address who) { return nodes_.at(who).core; }
  std::map<transport::tunnel_id, connection>& ends_at(mote_address who) {
    return nodes_.at(who).ends;
  }

  transport::tunnel_id connect(mote_address from, mote_address to) {
    auto [id, out] = at(from).connect(to, now);
    REQUIRE(!ends_at(from).contains(id));
    ends_at(from)[id].opened_here = true;
    take(from, out);
    return id;
  }

  /// Its content names its sender.
  bool send(mote_address from, transport::tunnel_id id, std::uint32_t number) {
    byte_writer content;
    content.big(from.island.value).big(from.mote.value).big(nodes_[from].life).big(id.value);
    auto out = at(from).send(id, content.big(number).view(), now);
    if (out)
      take(from, *out);
    return out.has_value();
  }

  void close(mote_address who, transport::tunnel_id id) {
    ends_at(who).at(id).is_over = true;
    take(who, at(who).close(id));
  }

  void refuse(mote_address who, transport::tunnel_id id) {
    ends_at(who).at(id).is_over = true;
    take(who, at(who).refuse(id));
  }

  /// The node forgets all. What is in flight stays in flight.
  void restart(mote_address who) {
    auto& x = nodes_[who];
    x.core = make_tunnels(who, ++x.life, tunnels_max_, slacks_);
    x.ends.clear();
  }

  void run_until(instant end) {
    while (const auto next = next_event()) {
      if (*next > end)
        break;
      now = std::max(now, *next);
      while (!in_flight_.empty() && in_flight_.begin()->first <= now)
        deliver(in_flight_.extract(in_flight_.begin()).mapped());
      for (auto& [who, x] : nodes_)
        take(who, x.core.on_time(now));
    }
    now = end;
  }
  void run_for(duration length) { run_until(now + length); }

  instant now;
  std::set<mote_address> off;                             ///< nothing comes to or from them
  double copies = 0;                                      ///< chance that a packet is repeated
  std::map<transport::tunnel_message::kind, int> packets; ///< sent
  int contents = 0;                                       ///< received

private:
  struct node {
    std::uint32_t life = 0;
    transport::tunnels core;
    std::map<transport::tunnel_id, connection> ends;
  };

  struct flight {
    mote_address from;
    transport::packet_out packet;
  };

  [[nodiscard]] std::optional<instant> next_event() const {
    auto next = in_flight_.empty() ? std::nullopt : std::optional(in_flight_.begin()->first);
    for (const auto& [who, x] : nodes_)
      next = earliest(next, x.core.deadline());
    return next;
  }

  void deliver(const flight& x) {
    const auto to = x.packet.destination;
    if (!off.contains(to) && nodes_.contains(to))
      take(to, at(to).on_packet(x.from.island, x.packet.octets, now));
  }

  void take(mote_address who, const transport::tunnels_outputs& out) {
    for (const auto& x : out)
      std::visit([&](const auto& y) { take(who, y); }, x);
  }

  void take(mote_address who, const transport::packet_out& x) {
    const auto message = transport::decode_tunnel_message(x.octets);
    REQUIRE(message);
    REQUIRE(message->sender == who.mote);
    REQUIRE(message->receiver == x.destination.mote);
    ++packets[message->what];
    if (off.contains(who) || rng_.chance(loss_))
      return;
    for (int copy = rng_.chance(copies) ? 2 : 1; copy > 0; --copy)
      in_flight_.emplace(now + rng_.between(1ms, delay_max_), flight{who, x});
  }

  void take(mote_address who, const transport::tunnel_connected& x) {
    auto& y = ends_at(who).at(x.id);
    REQUIRE((y.opened_here && !y.is_open && !y.is_over));
    y.is_open = true;
  }

  void take(mote_address who, const transport::tunnel_accepted& x) {
    REQUIRE(nodes_.contains(x.source));
    REQUIRE(!ends_at(who).contains(x.id));
    ends_at(who)[x.id].is_open = true;
  }

  void take(mote_address who, const transport::tunnel_received& x) {
    auto& y = ends_at(who).at(x.id);
    REQUIRE((y.is_open && !y.is_over));
    byte_reader in(x.content);
    const island_id island{in.big<std::uint32_t>()};
    const mote_id mote{in.big<std::uint16_t>()};
    const auto life = in.big<std::uint32_t>();
    const transport::tunnel_id id{in.big<std::uint32_t>()};
    const end_of_tunnel from{{island, mote}, life, id};
    REQUIRE((!y.other || *y.other == from)); // no tunnel is taken for another
    y.other = from;
    y.received.push_back(in.big<std::uint32_t>());
    REQUIRE(in.ok());
    ++contents;
  }

  void take(mote_address who, const transport::tunnel_ended& x) {
    auto& y = ends_at(who).at(x.id);
    REQUIRE(!y.is_over);
    y.is_over = true;
    y.why = x.why;
  }

  duration delay_max_;
  double loss_;
  std::size_t tunnels_max_;
  transport::answer_slacks slacks_;
  random_stream rng_;
  std::map<mote_address, node> nodes_;
  std::multimap<instant, flight> in_flight_;
};

} // namespace rubicon::test
