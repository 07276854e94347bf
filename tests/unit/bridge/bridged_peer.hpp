// A bridge with its client, as their component joins them, at a rosbridge on loopback.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <variant>

#include "bridge/ros2/ros2_bridge.hpp"
#include "core/overloads.hpp"
#include "io/tcp/web_client.hpp"
#include "support/start.hpp"

namespace rubicon::test {

using ros2_clock = std::chrono::steady_clock;

/// Far too long a wait is a failure.
inline constexpr auto ros2_wait_max = std::chrono::seconds(30);

[[nodiscard]] inline bridge::ros2_config echoing_config() {
  bridge::ros2_config x;
  bridge::topic_publication out;
  out.key = "value";
  out.topic = "/value";
  out.type = "std_msgs/msg/Int64";
  out.queue = 100;
  x.publications.push_back(out);
  bridge::topic_subscription back;
  back.topic = "/value";
  back.key = "echo";
  back.type = "std_msgs/msg/Int64";
  x.subscriptions.push_back(back);
  return x;
}

/// Core and client, as their component joins them.
class bridged_peer {
public:
  explicit bridged_peer(std::uint16_t port)
      : bridged_peer(io::web_client_settings{"127.0.0.1", port, "/"}) {}
  explicit bridged_peer(io::web_client_settings server)
      : core_(echoing_config(), random_stream(1)), client_(std::move(server), [this] {
          const std::lock_guard lock(mutex_);
          rang_ = true;
          rings_.notify_all();
        }) {
    perform(core_.start(now()));
  }

  void set(const std::string& text) {
    perform(core_.on_tuple({1, peer_id{1}, "value", text, false}, now()));
  }

  void work() {
    for (const auto& each : client_.take())
      std::visit(
          overloads{[this](const io::web_connected&) { perform(core_.on_connected(now())); },
                    [this](const io::web_disconnected& x) {
                      cause = x.cause;
                      perform(core_.on_disconnected(now()));
                    },
                    [this](const io::web_message& x) { perform(core_.on_text(x.text, now())); },
                    [this](const io::web_sent& x) { perform(core_.on_sent(x.count, now())); }},
          each);
    if (const auto due = core_.deadline(); due && *due <= now())
      perform(core_.on_time(now()));
  }

  /// Whether `done` is so in time.
  bool within(const std::function<bool()>& done) {
    const auto end = ros2_clock::now() + ros2_wait_max;
    while (true) {
      work();
      if (done())
        return true;
      if (ros2_clock::now() >= end)
        return false;
      std::unique_lock lock(mutex_);
      rings_.wait_for(lock, std::chrono::milliseconds(10),
                      [this] { return std::exchange(rang_, false); });
    }
  }

  [[nodiscard]] const bridge::ros2_bridge& core() const { return core_; }
  [[nodiscard]] io::web_client_counters client() const { return client_.counters(); }

  std::string echo;
  std::size_t echoes = 0;
  std::string cause;

private:
  [[nodiscard]] instant now() const {
    return start + std::chrono::duration_cast<duration>(ros2_clock::now() - began_);
  }

  void perform(bridge::ros2_outputs todo) {
    for (auto& each : todo)
      std::visit(overloads{[this](bridge::open_connection&) { client_.connect(); },
                           [this](bridge::ros2_text& x) { client_.send(std::move(x.text)); },
                           [this](components::publish& x) {
                             echo = to_string(byte_view(x.value));
                             ++echoes;
                           },
                           [](components::write&) {}},
                 each);
  }

  ros2_clock::time_point began_ = ros2_clock::now();
  std::mutex mutex_;
  std::condition_variable rings_;
  bool rang_ = false;
  bridge::ros2_bridge core_;
  io::web_client client_;
};

} // namespace rubicon::test
