// Stream Systems of several nodes over a channel service that delays, loses, repeats and reorders,
// under virtual time. Nodes may die and start again.
#pragma once

#include <functional>
#include <map>
#include <utility>
#include <variant>
#include <vector>

#include "core/numbers/random.hpp"
#include "stream/streams.hpp"

namespace rubicon::test {

// The nodes of a single stream.
inline constexpr std::size_t writer_node = 0;
inline constexpr std::size_t reader_node = 1;

/// How badly the channel service does its work.
struct channel_service {
  duration delay_min = 5ms;
  duration delay_max = 5ms;
  double loss = 0;         ///< of packets
  double repetition = 0;   ///< of packets
  double connect_loss = 0; ///< of connects: the source hears a failure
  bool reaches_all = true; ///< false: connects are never answered
};

/// An end of a stream: number of the node, which of its lives, descriptor.
struct end_of_stream {
  std::size_t node = 0;
  unsigned life = 0;
  stream::descriptor id;

  friend auto operator<=>(const end_of_stream&, const end_of_stream&) = default;
};

class stream_fixture {
public:
  using event = std::variant<stream::open_done, stream::read_done>;

  explicit stream_fixture(std::size_t size, channel_service quality = {}, std::uint64_t seed = 1,
                          stream::streams_config config = {})
      : service(quality), config_(config), rng_(seed, "world"), nodes_(size) {
    for (auto& x : nodes_)
      x.core = stream::streams(config_);
  }

  [[nodiscard]] static mote_address address(std::size_t node) {
    return {island_id{1}, mote_id{static_cast<std::uint16_t>(node + 1)}};
  }

  [[nodiscard]] stream::streams& at(std::size_t node) { return nodes_[node].core; }
  [[nodiscard]] unsigned life(std::size_t node) const { return nodes_[node].life; }

  /// Does what a call asks for. @returns the stream that it was about
  stream::descriptor take(std::size_t node, stream::answer x) {
    perform(node, x.todo);
    return x.stream;
  }

  stream::answer open(std::size_t node, stream::remote_request x) {
    return at(node).open_remote(address(node), x, now);
  }

  /// The node forgets all; the other ends of its channels hear of it.
  void restart(std::size_t node) {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      for (std::size_t end = 0; end < 2; ++end) {
        if (channels_[i].nodes[end] == node && channels_[i].is_open[end])
          leave(i, end);
      }
    }
    nodes_[node].core = stream::streams(config_);
    ++nodes_[node].life;
  }

  /// Packets of all open channels get lost from now on; their ends hear of it `later_on`.
  void cut(duration later_on) {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      channels_[i].is_cut = true;
      in_flight_.emplace(now + later_on, [=, this] {
        for (std::size_t end = 0; end < 2; ++end) {
          if (!std::exchange(channels_[i].is_open[end], false))
            continue;
          const auto to = channels_[i].nodes[end];
          perform(to, at(to).on_channel_closed(handle(i, end)));
        }
      });
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

  void run_for(duration x) { run_until(now + x); }

  [[nodiscard]] bool is_quiet() const { return in_flight_.empty(); }

  channel_service service;
  instant now;
  std::vector<std::pair<end_of_stream, event>> events; ///< of the applications, in order
  std::vector<stream::connect_channel> connects;
  std::vector<bytes> packets; ///< handed to the service

private:
  struct inhabitant {
    stream::streams core;
    unsigned life = 0;
  };

  struct channel {
    std::size_t nodes[2] = {0, 0}; ///< source, destination
    bool is_open[2] = {true, true};
    bool is_cut = false;
  };

  static stream::channel_handle handle(std::size_t channel, std::size_t end) {
    return stream::channel_handle{static_cast<std::uint32_t>(channel * 2 + end)};
  }

  void later(std::function<void()> x) {
    in_flight_.emplace(now + rng_.between(service.delay_min, service.delay_max), std::move(x));
  }

  void perform(std::size_t node, const stream::outputs& todo) {
    for (const auto& x : todo)
      std::visit([&](const auto& y) { perform_one(node, y); }, x);
  }

  void perform_one(std::size_t source, const stream::connect_channel& x) {
    connects.push_back(x);
    if (!service.reaches_all)
      return;
    const auto life = nodes_[source].life;
    const auto fails = rng_.chance(service.connect_loss);
    const std::size_t destination = x.destination.mote.value - 1U;
    later([=, this] {
      if (nodes_[source].life != life)
        return;
      if (fails)
        return perform(source, at(source).on_connect_failed(x.stream));
      const auto i = channels_.size();
      channels_.push_back({{source, destination}});
      perform(destination, at(destination).on_accepted(handle(i, 1), address(source), now));
      later([=, this] {
        if (channels_[i].is_open[0])
          perform(source, at(source).on_connected(x.stream, handle(i, 0), now));
      });
    });
  }

  void perform_one(std::size_t, const stream::send_on_channel& x) {
    packets.push_back(x.octets);
    const auto i = x.channel.value / 2;
    const auto other = 1 - x.channel.value % 2;
    if (rng_.chance(service.loss) || channels_[i].is_cut)
      return;
    for (int copies = rng_.chance(service.repetition) ? 2 : 1; copies > 0; --copies) {
      later([=, this] {
        if (!channels_[i].is_open[other] || channels_[i].is_cut)
          return;
        const auto to = channels_[i].nodes[other];
        perform(to, at(to).on_channel_octets(handle(i, other), x.octets, now));
      });
    }
  }

  void perform_one(std::size_t, const stream::disconnect& x) {
    leave(x.channel.value / 2, x.channel.value % 2);
  }

  void perform_one(std::size_t, const stream::sample&) {}

  void perform_one(std::size_t node, const stream::open_done& x) {
    events.emplace_back(end_of_stream{node, nodes_[node].life, x.stream}, x);
  }

  void perform_one(std::size_t node, const stream::read_done& x) {
    events.emplace_back(end_of_stream{node, nodes_[node].life, x.stream}, x);
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

  stream::streams_config config_;
  random_stream rng_;
  std::vector<inhabitant> nodes_;
  std::vector<channel> channels_;
  std::multimap<instant, std::function<void()>> in_flight_;
};

} // namespace rubicon::test
