// A channel, its virtual time and everything it has said.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "radio/channel.hpp"

namespace rubicon::test {

struct radio_happening {
  instant at;
  radio::output what;
};

class radio_world {
public:
  explicit radio_world(const radio::channel_config& config = {}, std::uint64_t seed = 1)
      : channel(config, random_stream(seed)) {}

  /// A radio on the x axis.
  radio::radio_index add(std::uint16_t address, double x_m, std::uint16_t pan = 1,
                         const radio::platform* kind = radio::find_platform("micaz")) {
    radio::radio_config x;
    x.address = mote_id{address};
    x.pan = pan;
    x.place = {x_m, 0, 0};
    x.kind = kind;
    return channel.add(x, now);
  }

  void send(radio::radio_index from, std::uint64_t token, std::uint16_t to, std::size_t size,
            bool ack = true) {
    note(channel.send(from, {token, mote_id{to}, 6, bytes(size, 0x5a), ack}, now));
  }

  void set_power(radio::radio_index radio, radio::power state) {
    note(channel.set_power(radio, state, now));
  }

  /// Lets time pass up to `end`, stopping at each deadline.
  void run_until(instant end) {
    for (auto due = channel.deadline(); due && *due <= end; due = channel.deadline()) {
      now = *due;
      note(channel.on_time(now));
    }
    now = end;
  }

  void run_for(duration length) { run_until(now + length); }

  template <class T>
  [[nodiscard]] std::vector<T> all() const {
    std::vector<T> found;
    for (const auto& x : log)
      if (const auto* y = std::get_if<T>(&x.what))
        found.push_back(*y);
    return found;
  }

  /// When things of one kind happened.
  template <class T>
  [[nodiscard]] std::vector<instant> times_of() const {
    std::vector<instant> found;
    for (const auto& x : log)
      if (std::holds_alternative<T>(x.what))
        found.push_back(x.at);
    return found;
  }

  [[nodiscard]] std::size_t delivered_to(radio::radio_index radio) const {
    const auto list = all<radio::delivered>();
    return static_cast<std::size_t>(
        std::count_if(list.begin(), list.end(), [radio](const auto& x) { return x.to == radio; }));
  }

  void note(radio::outputs outputs) {
    for (auto& x : outputs)
      log.push_back({now, std::move(x)});
  }

  radio::channel channel;
  instant now;
  std::vector<radio_happening> log;
};

} // namespace rubicon::test
