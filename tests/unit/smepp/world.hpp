// Peers of SMEPP Light on a radio that loses frames, in virtual time, each by its own crystal.
#pragma once

#include <functional>
#include <memory>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include "core/numbers/random.hpp"
#include "smepp/crypto/pairwise.hpp"
#include "smepp/smepp.hpp"

namespace rubicon::smepp::test {

inline key key_of(std::uint8_t x) {
  std::array<std::uint8_t, key::size> octets{};
  octets.fill(x);
  return key(octets);
}

/// A frame as everybody in range could hear it.
struct heard_frame {
  mote_id from;
  mote_id to;
  bytes octets;
  std::string what;
  instant at;
};

struct world_config {
  std::size_t peers = 2;
  std::size_t columns = 1; ///< 1: a line; else a grid, each with its neighbours beside and above
  double loss = 0;
  double crystals_ppm = 0; ///< each crystal's error is up to this
  unsigned link_tries = 4; ///< of the radio, until it is acknowledged
  std::uint64_t seed = 1;
};

/// Has its events prove their sender, by a key with each of so many peers drawn from `root`.
inline void prove_senders(peer_config& x, std::uint16_t peers, const key& root) {
  x.events.authenticates_sender = true;
  for (std::uint16_t i = 1; i <= peers; ++i)
    if (const mote_id other{i}; other != x.self)
      x.pairwise.emplace_back(other, pairwise_key(root, x.self, other));
}

class world {
public:
  using change = std::function<void(peer_config&)>;

  explicit world(world_config config, const change& adapt = {});

  // Peers are numbered from 1, as their motes are.
  [[nodiscard]] peer& at(std::size_t i) { return *nodes_[i - 1].core; }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] instant now() const { return now_; }
  [[nodiscard]] instant local(std::size_t i) const { return local(nodes_[i - 1], now_); }
  [[nodiscard]] instant world_time(std::size_t i, instant own) const {
    return true_time(nodes_[i - 1], own);
  }

  /// Gives a peer a command: f(peer, its time, outputs).
  template <class F>
  auto with(std::size_t i, F f) {
    outputs out;
    auto& x = nodes_[i - 1];
    if constexpr (std::is_void_v<decltype(f(*x.core, now_, out))>) {
      f(*x.core, local(x, now_), out);
      perform(i - 1, out);
    } else {
      auto result = f(*x.core, local(x, now_), out);
      perform(i - 1, out);
      return result;
    }
  }

  void run_for(duration x);
  /// @returns whether it came about in time
  bool run_until(const std::function<bool()>& done, duration limit, duration step = 100ms);

  void power_off(std::size_t i) { nodes_[i - 1].is_off = true; }
  void power_on(std::size_t i); ///< with what its store holds
  /// Whether two can hear each other, besides being neighbours.
  void cut(std::function<bool(std::size_t, std::size_t)> is_cut) { is_cut_ = std::move(is_cut); }
  /// A node sends this, whatever sender it names.
  void inject(std::size_t to, mote_id from, mote_id receiver, const bytes& octets);

  // ---- what has happened

  template <class Signal>
  [[nodiscard]] std::vector<Signal> signals(std::size_t i) const {
    std::vector<Signal> all;
    for (const auto& [when, x] : nodes_[i - 1].signals)
      if (const auto* const found = std::get_if<Signal>(&x))
        all.push_back(*found);
    return all;
  }
  void forget_signals() {
    for (auto& x : nodes_)
      x.signals.clear();
  }
  [[nodiscard]] const std::vector<heard_frame>& air() const { return air_; }
  void forget_air() { air_.clear(); }
  [[nodiscard]] duration radio_time(std::size_t i) const;
  void record_air(bool x) { records_air_ = x; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] std::uint64_t octets() const { return octets_; }

  // ---- steps of many tests

  std::vector<group_id> find_groups(std::size_t i, const group_filter& filter);
  std::optional<failure> subscribe(std::size_t i, group_id group, const std::string& name,
                                   double rate = 0,
                                   std::optional<duration> expiration = std::nullopt,
                                   bool receives = true);
  std::optional<failure> raise(std::size_t i, group_id group, const std::string& name,
                               const bytes& value = {1});
  std::optional<failure> leave(std::size_t i, group_id group);

  /// Peer 1 creates a group and all others join it, one after the other.
  group_id build_group(const group_description& x);
  std::optional<failure> join(std::size_t i, group_id group, const std::optional<key>& master,
                              const group_filter& filter);
  /// Whether all in the list are members, agree on the members and have the same keys.
  [[nodiscard]] bool agree(group_id group, const std::vector<std::size_t>& who) const;

  key_pair network{key_of(1), key_of(2)};

private:
  struct node {
    std::unique_ptr<peer> core;
    peer_config config;
    persistent_state store;
    double rate = 1;
    duration offset{};
    bool is_off = false;
    bool is_on = false; ///< its radio
    instant on_since;
    duration on_for{};
    std::optional<instant> due; ///< world time
    std::vector<std::pair<instant, signal>> signals;
  };
  struct happening {
    instant at;
    std::uint64_t order = 0;
    std::function<void()> what;

    bool operator<(const happening& x) const {
      return std::pair(at, order) > std::pair(x.at, x.order);
    }
  };

  [[nodiscard]] static instant local(const node& x, instant t) {
    return instant(x.offset + duration(static_cast<std::int64_t>(
                                  static_cast<double>(t.time_since_epoch().count()) * x.rate)));
  }
  [[nodiscard]] static instant true_time(const node& x, instant own) {
    return instant(duration(static_cast<std::int64_t>(
                       static_cast<double>((own.time_since_epoch() - x.offset).count()) / x.rate)) +
                   3ns);
  }
  /// As of a timer with a 32 kHz crystal.
  [[nodiscard]] duration time_stamp_error() { return rng_.between(0us, 31us); }
  [[nodiscard]] bool reaches(std::size_t a, std::size_t b) const;
  void perform(std::size_t i, outputs& out);
  void transmit(std::size_t i, send_frame x, unsigned tries);
  void later(duration after, std::function<void()> what) {
    events_.push({now_ + after, order_++, std::move(what)});
  }

  world_config config_;
  random_stream rng_;
  std::vector<node> nodes_;
  std::priority_queue<happening> events_;
  std::uint64_t order_ = 0;
  instant now_{1h};
  std::function<bool(std::size_t, std::size_t)> is_cut_;
  std::vector<heard_frame> air_;
  bool records_air_ = false;
  std::uint64_t frames_ = 0;
  std::uint64_t octets_ = 0;
};

} // namespace rubicon::smepp::test
