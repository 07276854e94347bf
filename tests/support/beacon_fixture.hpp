// A small lossy broadcast world under virtual time: motes that do nothing but beacon.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <queue>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/numbers/random.hpp"
#include "network/beacon.hpp"
#include "network/places/coordinates.hpp"
#include "network/tree/gradient.hpp"
#include "network/tree/neighbours.hpp"
#include "network/tree/trickle.hpp"

namespace rubicon::test {

/// Neighbours, gradient, coordinates and trickle put together as a router does, with beacons up to
/// 16 s apart: there is no traffic here that would tell sooner what has become of a link.
class beacon_mote {
public:
  beacon_mote(mote_id self, bool is_sink, random_stream rng, instant now)
      : self_(self), links({.beacon_gap_max = 24s}),
        tree({.self = self, .is_root = is_sink, .root_patience = 3min}),
        place({.self = self, .is_sink = is_sink, .sequence_patience = 6min}, now),
        timer({.interval_max = 16s}, rng, now) {}

  /// @returns the beacon to send, if one is due
  std::optional<bytes> on_time(instant now) {
    links.on_time(now);
    settle(now);
    if (!timer.on_time(now))
      return {};
    network::beacon x;
    x.sequence = ++sequence_;
    x.next_quarters = network::quarters(timer.deadline() - now);
    x.gradient = tree.advertise();
    x.coordinates = place.advertise();
    x.heard = links.heard(network::beacon::heard_max(x.clock));
    ++beacons;
    return encode(x);
  }

  void on_frame(mote_id source, byte_view octets, instant now) {
    const auto x = network::decode_beacon(octets);
    const auto what = links.on_beacon(x->report(source, self_, tree.has_route()), now);
    if (what == network::admission::repeated)
      return;
    if (what == network::admission::added || what == network::admission::restarted)
      timer.reset(now);
    place.on_beacon(source, x->coordinates, links);
    if (what == network::admission::refused)
      return;
    if (tree.on_beacon(source, x->gradient, links))
      timer.reset(now);
    settle(now);
  }

  void settle(instant now) {
    links.pin(tree.parent(), false);
    const auto change = tree.update(links, now);
    links.pin(tree.parent(), true);
    if (change == network::gradient_change::lost)
      timer.reset(now);
    if (place.update(links, now))
      timer.reset(now);
  }

  [[nodiscard]] instant deadline() const {
    auto due = timer.deadline();
    if (const auto x = links.deadline())
      due = std::min(due, *x);
    if (const auto x = place.deadline())
      due = std::min(due, *x);
    return due;
  }

private:
  mote_id self_;
  std::uint16_t sequence_ = 0;

public:
  network::neighbours links;
  network::gradient tree;
  network::coordinates place;
  network::trickle timer;
  std::uint64_t beacons = 0;
};

/// Motes 1, 2, 3, ... of which mote 1 is the sink unless said otherwise. A frame arrives at once or
/// not at all.
class beacon_fixture {
public:
  explicit beacon_fixture(std::size_t size, std::uint64_t seed = 1, mote_id sink = mote_id{1})
      : sink_(sink), seed_(seed), rng_(seed, "air"), links_(size) {
    for (std::size_t i = 0; i < size; ++i) {
      motes_.emplace_back();
      start(id(i));
    }
  }

  /// Chance that a frame of `from` arrives at `to`.
  void set_delivery(mote_id from, mote_id to, double chance) {
    links_[index(from)][index(to)] = chance;
  }

  void set_both(mote_id a, mote_id b, double chance) {
    set_delivery(a, b, chance);
    set_delivery(b, a, chance);
  }

  /// Starts a mote, or starts it again having forgotten everything.
  void start(mote_id x) {
    const auto path = "mote/" + to_string(x) + "/" + std::to_string(++starts_);
    motes_[index(x)].emplace(x, x == sink_, random_stream(seed_, path), now);
    wake(index(x));
  }

  void kill(mote_id x) { motes_[index(x)].reset(); }

  [[nodiscard]] bool alive(mote_id x) const { return motes_[index(x)].has_value(); }
  [[nodiscard]] beacon_mote& at(mote_id x) { return *motes_[index(x)]; }
  [[nodiscard]] const beacon_mote& at(mote_id x) const { return *motes_[index(x)]; }
  [[nodiscard]] std::size_t size() const { return motes_.size(); }
  [[nodiscard]] mote_id sink() const { return sink_; }

  void run_until(instant end) {
    while (!wakes_.empty() && wakes_.top().first <= end) {
      const auto [at, i] = wakes_.top();
      wakes_.pop();
      if (!motes_[i] || at != motes_[i]->deadline())
        continue; // killed, or woken for something earlier
      now = at;
      if (const auto frame = motes_[i]->on_time(now))
        spread(i, *frame);
      wake(i);
    }
    now = end;
  }

  void run_for(duration x) { run_until(now + x); }

  /// Runs until `done`, looking every second. @returns whether it was within `limit`
  bool run_until_true(const std::function<bool()>& done, duration limit) {
    for (const auto end = now + limit; now < end && !done();)
      run_for(1s);
    return done();
  }

  /// A unicast with up to four transmissions, each acknowledged by the receiver.
  bool unicast(mote_id from, mote_id to) {
    unsigned transmissions = 0;
    bool acked = false;
    while (!acked && transmissions < 4) {
      ++transmissions;
      acked = alive(to) && arrives(index(from), index(to)) && arrives(index(to), index(from));
    }
    at(from).links.on_sent(to, acked, transmissions, now);
    at(from).settle(now);
    wake(index(from));
    return acked;
  }

  /// Hops to `target` over links that deliver at least `least` both ways, by breadth-first search;
  /// nothing for those out of reach.
  [[nodiscard]] std::vector<std::optional<unsigned>> true_hops(mote_id target,
                                                               double least = 0.8) const {
    std::vector<std::optional<unsigned>> hops(size());
    std::vector<std::size_t> edge{index(target)};
    if (!alive(target))
      return hops;
    hops[index(target)] = 0;
    for (unsigned distance = 1; !edge.empty(); ++distance) {
      std::vector<std::size_t> next;
      for (const auto from : edge) {
        for (const auto& [to, chance] : links_[from]) {
          if (!motes_[to] || hops[to] || chance < least || delivery(to, from) < least)
            continue;
          hops[to] = distance;
          next.push_back(to);
        }
      }
      edge = std::move(next);
    }
    return hops;
  }

  [[nodiscard]] double delivery(mote_id from, mote_id to) const {
    return delivery(index(from), index(to));
  }

  [[nodiscard]] std::vector<mote_id> all_alive() const {
    std::vector<mote_id> found;
    for (std::size_t i = 0; i < size(); ++i) {
      if (motes_[i])
        found.push_back(id(i));
    }
    return found;
  }

  [[nodiscard]] std::uint64_t beacons() const {
    std::uint64_t sum = 0;
    for (const auto x : all_alive())
      sum += at(x).beacons;
    return sum;
  }

  [[nodiscard]] static mote_id id(std::size_t i) {
    return mote_id{static_cast<std::uint16_t>(i + 1)};
  }
  [[nodiscard]] static std::size_t index(mote_id x) { return x.value - 1U; }

  instant now;

private:
  [[nodiscard]] double delivery(std::size_t from, std::size_t to) const {
    const auto found = links_[from].find(to);
    return found == links_[from].end() ? 0 : found->second;
  }

  bool arrives(std::size_t from, std::size_t to) { return rng_.chance(delivery(from, to)); }

  void wake(std::size_t i) { wakes_.emplace(motes_[i]->deadline(), i); }

  void spread(std::size_t from, const bytes& frame) {
    for (const auto& [to, chance] : links_[from]) {
      if (!motes_[to] || !rng_.chance(chance))
        continue;
      motes_[to]->on_frame(id(from), frame, now);
      wake(to);
    }
  }

  using wake_up = std::pair<instant, std::size_t>;

  mote_id sink_;
  std::uint64_t seed_;
  std::uint64_t starts_ = 0;
  random_stream rng_;
  std::vector<std::map<std::size_t, double>> links_; ///< by sender, then receiver
  std::vector<std::optional<beacon_mote>> motes_;
  std::priority_queue<wake_up, std::vector<wake_up>, std::greater<>> wakes_;
};

/// side x side motes, row by row; straight neighbours hear each other with chance `straight`,
/// diagonal ones and those two apart with chance `far`.
[[nodiscard]] inline beacon_fixture grid_fixture(std::size_t side, double straight, double far,
                                                 std::uint64_t seed = 1,
                                                 mote_id sink = mote_id{1}) {
  beacon_fixture world(side * side, seed, sink);
  const auto connect = [&](std::size_t from, std::size_t row, std::size_t column, double chance) {
    if (row < side && column < side && chance > 0)
      world.set_both(beacon_fixture::id(from), beacon_fixture::id(row * side + column), chance);
  };
  for (std::size_t i = 0; i < side * side; ++i) {
    const auto row = i / side;
    const auto column = i % side;
    connect(i, row, column + 1, straight);
    connect(i, row + 1, column, straight);
    connect(i, row + 1, column + 1, far);
    connect(i, row + 1, column - 1, far); // column 0: out of the grid
    connect(i, row, column + 2, far);
    connect(i, row + 2, column, far);
  }
  return world;
}

} // namespace rubicon::test
