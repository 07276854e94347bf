// Synaptic channels of several nodes under a common RUBICON clock, over a channel service that
// delays and loses. Nodes may die and start again.
#pragma once

#include <functional>
#include <map>
#include <utility>
#include <variant>
#include <vector>

#include "core/numbers/random.hpp"
#include "synaptic/channels.hpp"

namespace rubicon::test {

/// Each element of a vector encodes whose it is and of which tick: below 2^24, so exact.
[[nodiscard]] inline float value_of(std::size_t node, std::uint32_t tick, std::size_t k) {
  return static_cast<float>(((tick % 2048) * 16 + k) * 8 + node);
}

class synaptic_fixture {
public:
  using event =
      std::variant<synaptic::create_done, synaptic::input_update, synaptic::channel_failed>;

  struct node_event {
    std::size_t node = 0;
    unsigned life = 0;
    std::uint32_t tick = 0;
    event what;
  };

  /// A vector that was handed to the channel service.
  struct vector {
    std::size_t source = 0, destination = 0;
    std::uint32_t tick = 0;
    bool lost = false; ///< some packet of it

    friend bool operator==(const vector&, const vector&) = default;
  };

  explicit synaptic_fixture(std::size_t size, synaptic::channels_config config = {},
                            std::uint64_t seed = 1)
      : config_(config), rng_(seed, "world"), nodes_(size) {
    for (std::size_t i = 0; i < size; ++i)
      start_node(i);
  }

  [[nodiscard]] static mote_address address(std::size_t node) {
    return {island_id{1}, mote_id{static_cast<std::uint16_t>(node + 1)}};
  }

  [[nodiscard]] synaptic::channels& at(std::size_t node) { return nodes_[node].core; }
  [[nodiscard]] unsigned life(std::size_t node) const { return nodes_[node].life; }

  /// Does what a call asks for. @returns the channel that it was about
  synaptic::descriptor take(std::size_t node, const synaptic::answer& x) {
    perform(node, x.todo);
    return x.channel;
  }

  synaptic::descriptor create_out(std::size_t node, std::size_t to, std::size_t size,
                                  synaptic::parameters x = {}) {
    return take(node, at(node).create_out(address(node), address(to), size, x, now));
  }

  synaptic::descriptor create_in(std::size_t node, std::size_t from, std::size_t size,
                                 synaptic::parameters x = {}) {
    return take(node, at(node).create_in(address(node), address(from), size, x, now));
  }

  /// The node forgets all. @param notifies whether the other ends of its channels are notified
  void restart(std::size_t node, bool notifies = true) {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      for (std::size_t end = 0; end < 2; ++end) {
        if (channels_[i].nodes[end] != node || !channels_[i].is_open[end])
          continue;
        if (notifies)
          leave(i, end);
        else
          channels_[i].is_open[end] = false;
      }
    }
    ++nodes_[node].life;
    start_node(node);
  }

  /// A tick at all nodes, then half a second. Open out ends write in their clock_tick.
  void run_ticks(std::uint32_t count) {
    for (; count > 0; --count) {
      for (std::size_t i = 0; i < nodes_.size(); ++i)
        perform(i, at(i).on_tick(tick, now));
      for (std::size_t i = 0; i < nodes_.size(); ++i)
        write_all(i);
      run_until(now + 499ms);
      if (after_tick)
        after_tick();
      now += 1ms;
      ++tick;
    }
  }

  void run_until(instant end) {
    for (;;) {
      auto next = in_flight_.empty() ? std::nullopt : std::optional(in_flight_.begin()->first);
      for (const auto& x : nodes_)
        next = earliest(next, x.core.deadline());
      if (!next || *next > end)
        break;
      now = std::max(now, *next);
      while (!in_flight_.empty() && in_flight_.begin()->first <= now) {
        const auto arrival = std::move(in_flight_.begin()->second);
        in_flight_.erase(in_flight_.begin());
        arrival();
      }
      for (std::size_t i = 0; i < nodes_.size(); ++i)
        perform(i, nodes_[i].core.on_time(now));
    }
    now = end;
  }

  [[nodiscard]] bool is_quiet() const { return in_flight_.empty(); }

  /// Ends of channels that the node has not closed, nor been notified of as closed.
  [[nodiscard]] std::size_t open_ends(std::size_t node) const {
    std::size_t count = 0;
    for (const auto& x : channels_) {
      for (std::size_t end = 0; end < 2; ++end)
        count += x.nodes[end] == node && x.is_open[end] ? 1U : 0U;
    }
    return count;
  }

  /// The events of kind T at a node, in order.
  template <class T>
  [[nodiscard]] std::vector<T> all(std::size_t node) const {
    std::vector<T> found;
    for (const auto& x : events) {
      if (x.node == node && std::holds_alternative<T>(x.what))
        found.push_back(std::get<T>(x.what));
    }
    return found;
  }

  double loss = 0; ///< of packets
  double connect_loss = 0;
  duration delay_min = 5ms, delay_max = 5ms;
  bool reaches_all = true; ///< false: connects are never answered
  instant now;
  std::uint32_t tick = 1;
  std::function<void()> after_tick;
  std::vector<node_event> events;
  std::vector<vector> vectors;
  std::vector<synaptic::connect_channel> connects;
  std::size_t packets = 0;

private:
  struct inhabitant {
    synaptic::channels core;
    unsigned life = 0;
  };

  struct channel {
    std::size_t nodes[2] = {0, 0}; ///< source, destination
    bool is_open[2] = {true, true};
  };

  static synaptic::channel_handle handle(std::size_t channel, std::size_t end) {
    return synaptic::channel_handle{static_cast<std::uint32_t>(channel * 2 + end)};
  }

  void start_node(std::size_t node) {
    nodes_[node].core = synaptic::channels(config_);
    nodes_[node].core.set_slot(20ms * static_cast<int>(node + 1));
  }

  void write_all(std::size_t node) {
    for (std::uint16_t id = 1; id < 600; ++id) {
      const synaptic::descriptor x{id};
      for (std::size_t k = 0; k < config_.size_max; ++k) {
        if (at(node).write_output(x, k, value_of(node, tick, k)))
          break;
      }
    }
  }

  void later(std::function<void()> x) {
    in_flight_.emplace(now + rng_.between(delay_min, delay_max), std::move(x));
  }

  void perform(std::size_t node, const synaptic::outputs& todo) {
    for (const auto& x : todo)
      std::visit([&](const auto& y) { perform_one(node, y); }, x);
  }

  void perform_one(std::size_t source, const synaptic::connect_channel& x) {
    connects.push_back(x);
    if (!reaches_all)
      return;
    const auto life = nodes_[source].life;
    const auto fails = rng_.chance(connect_loss);
    const std::size_t destination = x.destination.mote.value - 1U;
    later([=, this] {
      if (nodes_[source].life != life)
        return;
      if (fails)
        return perform(source, at(source).on_connect_failed(x.channel));
      const auto i = channels_.size();
      channels_.push_back({{source, destination}});
      perform(destination, at(destination).on_accepted(handle(i, 1), address(source), now));
      later([=, this] {
        if (nodes_[source].life != life)
          return leave(i, 0);
        perform(source, channels_[i].is_open[0]
                            ? at(source).on_connected(x.channel, handle(i, 0), now)
                            : at(source).on_connect_failed(x.channel));
      });
    });
  }

  void perform_one(std::size_t, const synaptic::send_on_channel& x) {
    ++packets;
    const auto i = x.channel.value / 2;
    const auto other = 1 - x.channel.value % 2;
    const bool is_lost = rng_.chance(loss);
    note(channels_[i], x.octets, is_lost);
    if (is_lost)
      return;
    later([=, this] {
      if (!channels_[i].is_open[other])
        return;
      const auto to = channels_[i].nodes[other];
      perform(to, at(to).on_channel_octets(handle(i, other), x.octets));
    });
  }

  void note(const channel& over, byte_view octets, bool is_lost) {
    const auto content = synaptic::decode_message(octets);
    const auto* x = std::get_if<synaptic::vector_message>(&*content);
    if (x == nullptr)
      return;
    if (x->first == 0)
      vectors.push_back({over.nodes[0], over.nodes[1], x->tick});
    if (is_lost)
      vectors.back().lost = true;
  }

  void perform_one(std::size_t, const synaptic::disconnect& x) {
    leave(x.channel.value / 2, x.channel.value % 2);
  }

  template <class Event>
  void perform_one(std::size_t node, const Event& x) {
    events.push_back({node, nodes_[node].life, tick, x});
  }

  void leave(std::size_t i, std::size_t end) {
    channels_[i].is_open[end] = false;
    later([=, this] {
      if (!channels_[i].is_open[1 - end])
        return;
      channels_[i].is_open[1 - end] = false;
      const auto to = channels_[i].nodes[1 - end];
      perform(to, at(to).on_channel_closed(handle(i, 1 - end)));
    });
  }

  synaptic::channels_config config_;
  random_stream rng_;
  std::vector<inhabitant> nodes_;
  std::vector<channel> channels_;
  std::multimap<instant, std::function<void()>> in_flight_;
};

} // namespace rubicon::test
