// Routers on a grid, and the backbones of further sinks, under virtual time.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/codec.hpp"
#include "network/router.hpp"
#include "serial/cable/backbone.hpp"
#include "support/agenda.hpp"
#include "support/mote_ids.hpp"

namespace rubicon::test {

/// Routers whose radios reach the eight motes around them, with a crystal each that runs too fast
/// or too slow. A unicast is tried four times. Mote 1 is the sink; there may be further ones.
class routed_grid {
public:
  routed_grid(int width, int height, double delivery, std::uint64_t seed = 1,
              std::vector<mote_id> further_sinks = {})
      : width_(width), delivery_(delivery), rng_(seed), further_sinks_(std::move(further_sinks)) {
    for (const auto x : further_sinks_) {
      backbones_.emplace(x, serial::backbone({}, random_stream(seed, to_string(x))));
      backbone(x).set_end(serial::backbone_direction::up, true);
    }
    for (int i = 1; i <= width * height; ++i)
      start(id(i));
  }

  void start(mote_id x) {
    network::router_config config;
    config.self = x;
    config.is_sink = x == the_sink;
    config.backbone.doubt = std::chrono::microseconds(500); // half of the jitter
    if (config.is_sink)
      config.backbone.motes = further_sinks_;
    else if (backbones_.contains(x))
      config.backbone.motes = {the_sink};
    auto& here = nodes_[x];
    here.ppm = rng_.unit() * 100 - 50;
    here.ahead = duration(rng_.below(100'000'000'000));
    here.life = network::router(config, random_stream(rng_.next()), own_time(x));
    set_end(x, true);
  }

  void kill(mote_id x) {
    nodes_.erase(x);
    set_end(x, false);
  }

  network::router& at(mote_id x) { return nodes_.at(x).life; }

  /// Of this further sink.
  serial::backbone& backbone(mote_id x) { return backbones_.at(x); }

  void cut(mote_id x) { perform_backbone(x, backbone(x).cut(now_)); }

  [[nodiscard]] instant own_time(mote_id x) const { return own(nodes_.at(x), now_); }

  [[nodiscard]] std::vector<mote_id> motes() const {
    std::vector<mote_id> all;
    for (const auto& [id, x] : nodes_)
      all.push_back(id);
    return all;
  }

  void send(mote_id from, mote_id to, bytes content) {
    perform(from, at(from).send(to, std::move(content), own_time(from)));
  }

  network::channel_id connect(mote_id from, mote_id to) {
    auto [id, todo] = at(from).connect(to, {}, 5min, own_time(from));
    perform(from, std::move(todo));
    return id;
  }

  void perform(mote_id from, network::router_outputs todo) {
    for (auto& x : todo) {
      if (auto* frame = std::get_if<network::frame_out>(&x))
        put(from, std::move(*frame));
      else if (auto* content = std::get_if<network::content_in>(&x))
        arrived.emplace_back(from, std::move(*content));
      else if (const auto* open = std::get_if<network::channel_connected>(&x))
        connected.insert(open->channel);
      else if (const auto* over = std::get_if<network::channel_ended>(&x))
        ended[over->channel] = over->why;
      else if (auto* packet = std::get_if<network::channel_received>(&x))
        received[packet->channel].push_back(std::move(packet->content));
    }
  }

  void run_for(duration length) {
    const auto end = now_ + length;
    const auto next = [&] {
      auto due = end;
      for (auto& [id, x] : nodes_)
        due = std::min(due, real(x, x.life.deadline()));
      for (const auto& [id, x] : backbones_)
        due = std::min(due, x.deadline().value_or(end));
      return due;
    };
    agenda_.run(now_, end, next, [this] {
      for (auto& [id, x] : backbones_)
        perform_backbone(id, x.on_time(now_));
      for (const auto id : motes()) {
        if (at(id).deadline() <= own_time(id))
          perform(id, at(id).on_time(own_time(id)));
      }
    });
  }

  std::vector<std::pair<mote_id, network::content_in>> arrived;
  std::set<network::channel_id> connected;
  std::map<network::channel_id, network::channel_end> ended;
  std::map<network::channel_id, std::vector<bytes>> received;

private:
  struct node {
    network::router life;
    double ppm = 0;
    duration ahead{};
  };

  [[nodiscard]] static instant own(const node& x, instant real) {
    const auto since = real.time_since_epoch();
    return instant(
        since + x.ahead +
        duration(static_cast<duration::rep>(static_cast<double>(since.count()) * x.ppm * 1e-6)));
  }

  /// The first real time at which a mote's own clock shows `x`, to the microsecond.
  [[nodiscard]] static instant real(const node& x, instant shown) {
    const auto since = static_cast<double>((shown.time_since_epoch() - x.ahead).count());
    auto guess = instant(duration(static_cast<duration::rep>(since / (1 + x.ppm * 1e-6))));
    while (own(x, guess) < shown)
      guess += 1us;
    return guess;
  }

  [[nodiscard]] bool near(mote_id a, mote_id b) const {
    const int ia = a.value - 1;
    const int ib = b.value - 1;
    return a != b && std::abs(ia % width_ - ib % width_) <= 1 &&
           std::abs(ia / width_ - ib / width_) <= 1;
  }

  void set_end(mote_id x, bool on) {
    if (const auto found = backbones_.find(x); found != backbones_.end())
      found->second.set_end(serial::backbone_direction::down, on);
  }

  void put(mote_id from, network::frame_out frame) {
    if (frame.over == network::medium::radio)
      put_on_air(from, std::move(frame));
    else
      put_on_backbone(from, std::move(frame));
  }

  void put_on_backbone(mote_id from, network::frame_out frame) {
    const bool goes_down = from == the_sink;
    serial::backbone_packet x{std::nullopt, frame.am_type, std::move(frame.payload)};
    if (frame.token != network::no_token)
      x.token = frame.token;
    backbone(goes_down ? frame.next_hop : from)
        .send(goes_down ? serial::backbone_direction::down : serial::backbone_direction::up,
              std::move(x), now_);
  }

  void perform_backbone(mote_id further, const serial::backbone_outputs& todo) {
    for (const auto& output : todo) {
      if (const auto* x = std::get_if<serial::backbone_arrived>(&output)) {
        const bool goes_up = x->to == serial::backbone_direction::up;
        const auto to = goes_up ? the_sink : further;
        perform(to, at(to).on_frame(goes_up ? further : the_sink, x->am_type, x->octets.view(),
                                    own(nodes_.at(to), now_ - x->age), own_time(to),
                                    network::medium::backbone));
      } else {
        const auto& done = std::get<serial::backbone_done>(output);
        const auto sender = done.to == serial::backbone_direction::up ? further : the_sink;
        if (nodes_.contains(sender))
          perform(sender, at(sender).on_sent(done.token, done.acked, 1, own_time(sender)));
      }
    }
  }

  void put_on_air(mote_id from, network::frame_out frame) {
    const auto wait = rng_.between(1ms, 6ms);
    std::vector<mote_id> receivers;
    bool acked = false;
    unsigned tries = 0;
    for (const auto& [id, x] : nodes_) {
      if (frame.next_hop == broadcast_mote && near(from, id) && rng_.chance(delivery_))
        receivers.push_back(id);
    }
    while (frame.next_hop != broadcast_mote && tries < 4 && !acked) {
      ++tries;
      if (!nodes_.contains(frame.next_hop) || !near(from, frame.next_hop) ||
          !rng_.chance(delivery_))
        continue;
      if (receivers.empty())
        receivers.push_back(frame.next_hop);
      acked = rng_.chance(delivery_);
    }
    if (frame.age_at) {
      byte_writer age;
      age.big(static_cast<std::uint32_t>(wait / 1us));
      std::ranges::copy(age.finish(),
                        frame.payload.begin() + static_cast<std::ptrdiff_t>(*frame.age_at));
    }
    const auto when = now_ + wait;
    for (const auto to : receivers) {
      agenda_.add(when, [this, from, to, frame] {
        if (nodes_.contains(to))
          perform(to,
                  at(to).on_frame(from, frame.am_type, frame.payload, own_time(to), own_time(to)));
      });
    }
    agenda_.add(when, [this, from, acked, tries, token = frame.token] {
      if (nodes_.contains(from))
        perform(from, at(from).on_sent(token, acked, tries, own_time(from)));
    });
  }

  int width_;
  double delivery_;
  random_stream rng_;
  std::vector<mote_id> further_sinks_;
  std::map<mote_id, serial::backbone> backbones_;
  instant now_;
  std::map<mote_id, node> nodes_;
  agenda agenda_;
};

} // namespace rubicon::test
