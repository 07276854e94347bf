// Two ends of UDP sessions and a network between them that loses, repeats, delays and has a queue,
// in virtual time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/numbers/random.hpp"
#include "peis/udp/udp_port.hpp"

namespace rubicon::peis::test {

struct udp_network {
  double loss = 0;
  double twice = 0;          ///< share of datagrams that come twice
  duration delay = 5ms;      ///< one way
  duration jitter{};         ///< up to so much more: what is behind may come first
  double octets_per_s = 0;   ///< 0: unlimited
  std::size_t queue_max = 0; ///< datagrams before the bottleneck
};

class udp_pair {
public:
  static constexpr udp_address a_address{{10, 0, 0, 1}, 1000};
  static constexpr udp_address b_address{{10, 0, 0, 2}, 2000};

  struct end {
    udp_address address;
    udp_port port;
    std::map<udp_token, bytes> received;
    std::map<udp_token, std::size_t> acknowledged;
    std::vector<udp_token> opened;
    std::vector<udp_token> closed;
    std::vector<attempt_id> refused;
    instant busy_until{}; ///< of the bottleneck towards the other end
    std::size_t held_max = 0;
  };

  explicit udp_pair(udp_network x = {}, std::uint64_t seed = 1, udp_port_config config = {})
      : network(x), rng_(seed) {
    config.room = 1024;
    a.address = a_address;
    a.port = udp_port(config, {seed, 1});
    b.address = b_address;
    b.port = udp_port(config, {seed, 2});
  }

  /// A session from a to b.
  udp_token open() {
    a.port.connect(attempt_id{1}, b.address, 30s, now);
    run_until([&] { return !a.opened.empty() && !b.opened.empty(); }, 30s);
    return a.opened.empty() ? udp_token{} : a.opened.back();
  }

  void run(duration length) {
    run_until([] { return false; }, length);
  }

  template <class Done>
  bool run_until(Done done, duration length) {
    const auto end_of_it = now + length;
    settle(a);
    settle(b);
    while (!done()) {
      auto next = earliest(a.port.deadline(), b.port.deadline());
      if (!on_way.empty())
        next = earliest(next, on_way.begin()->first.first);
      if (!next || *next > end_of_it) {
        now = end_of_it;
        return done();
      }
      now = std::max(now, *next);
      deliver();
      for (auto* x : {&a, &b}) {
        if (const auto due = x->port.deadline(); due && *due <= now)
          x->port.on_time(now);
        settle(*x);
      }
    }
    return true;
  }

  void settle(end& x) {
    for (auto& event : x.port.take_events())
      std::visit([&](auto& what) { handle(x, what); }, event);
    for (auto& batch : x.port.flush(now))
      send(x, batch);
    for (const auto token : x.opened) {
      if (const auto* session = x.port.find(token))
        x.held_max = std::max(x.held_max, session->held());
    }
  }

  struct datagram {
    udp_address from;
    udp_address to;
    bytes octets;
  };

  end a;
  end b;
  udp_network network;
  instant now{};
  std::map<std::pair<instant, std::uint64_t>, datagram> on_way;
  std::vector<datagram> seen; ///< if kept
  bool keeps = false;
  std::uint64_t octets_sent = 0;
  std::uint64_t lost = 0;

private:
  void handle(end& x, udp_opened& what) { x.opened.push_back(what.session); }
  void handle(end& x, udp_refused& what) { x.refused.push_back(what.attempt); }
  void handle(end& x, udp_received& what) {
    auto& all = x.received[what.session];
    all.insert(all.end(), what.octets.begin(), what.octets.end());
  }
  void handle(end& x, udp_acknowledged& what) { x.acknowledged[what.session] += what.octets; }
  void handle(end& x, udp_closed& what) { x.closed.push_back(what.session); }

  void send(end& from, const udp_batch& x) {
    for (std::size_t at = 0; at < x.octets.size(); at += x.each) {
      const auto size = std::min(x.each, x.octets.size() - at);
      const auto piece = byte_view(x.octets).subspan(at, size);
      const datagram one{from.address, x.to, to_bytes(piece)};
      octets_sent += size;
      if (keeps)
        seen.push_back(one);
      pass(from, one);
      if (rng_.chance(network.twice))
        pass(from, one);
    }
  }

  void pass(end& from, const datagram& x) {
    auto leaves = now;
    if (network.octets_per_s > 0) {
      const auto takes = [&](double octets) {
        return duration(static_cast<std::int64_t>(octets / network.octets_per_s * 1e9));
      };
      from.busy_until = std::max(from.busy_until, now);
      if (from.busy_until - now > takes(static_cast<double>(network.queue_max) * 1400)) {
        ++lost;
        return;
      }
      from.busy_until += takes(static_cast<double>(x.octets.size()));
      leaves = from.busy_until;
    }
    if (rng_.chance(network.loss)) {
      ++lost;
      return;
    }
    const auto comes = leaves + network.delay + rng_.between(duration(0), network.jitter);
    on_way.emplace(std::pair{comes, ++number_}, x);
  }

  void deliver() {
    while (!on_way.empty() && on_way.begin()->first.first <= now) {
      const auto x = std::move(on_way.extract(on_way.begin()).mapped());
      for (auto* each : {&a, &b}) {
        if (each->address == x.to)
          each->port.on_datagram(x.from, x.octets, now);
      }
    }
  }

  random_stream rng_;
  std::uint64_t number_ = 0;
};

} // namespace rubicon::peis::test
