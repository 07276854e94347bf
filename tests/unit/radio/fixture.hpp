// A channel, its virtual time and everything it has said.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "radio/channel/channel.hpp"
#include "radio/medium/tossim_files.hpp"

namespace rubicon::test {

/// The default channel with some changes.
template <class Change>
[[nodiscard]] radio::channel_config channel_with(Change change) {
  radio::channel_config x;
  change(x);
  return x;
}

/// Links between motes by their ids and no others: from, to, gain in dB.
[[nodiscard]] inline radio::propagation links_of(std::vector<radio::gain_table::gain> gains) {
  std::sort(gains.begin(), gains.end(), [](const auto& a, const auto& b) {
    return std::tie(a.from, a.to) < std::tie(b.from, b.to);
  });
  radio::gain_table table;
  table.gains = std::move(gains);
  return radio::gain_matrix{std::make_shared<const radio::gain_table>(std::move(table)), 0};
}

struct radio_happening {
  instant at;
  radio::output what;
};

class radio_fixture {
public:
  explicit radio_fixture(const radio::channel_config& config = {}, std::uint64_t seed = 1)
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

  radio::radio_index add(const radio::radio_config& x) { return channel.add(x, now); }

  void send(radio::radio_index from, std::uint64_t token, std::uint16_t to, std::size_t size,
            bool ack = true) {
    note(channel.send(from, {token, mote_id{to}, 6, bytes(size, 0x5a), ack}, now));
  }

  void set_power(radio::radio_index radio, radio::power state) {
    note(channel.set_power(radio, state, now));
  }

  /// Lets time pass up to `end`, stopping at each deadline; then everything until `end` has been
  /// done.
  void run_until(instant end) {
    for (auto due = channel.deadline(); due && *due <= end; due = channel.deadline()) {
      now = *due;
      note(channel.on_time(now));
    }
    now = end;
    note(channel.on_time(now));
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

  /// Radios in reach of this one, in ascending order.
  [[nodiscard]] std::vector<radio::radio_index> neighbours(radio::radio_index radio) const {
    std::vector<radio::radio_index> found;
    for (const auto& x : *channel.links().around(radio))
      found.push_back(x.radio);
    return found;
  }

  [[nodiscard]] std::size_t delivered_to(radio::radio_index radio) const {
    const auto list = all<radio::delivered>();
    return static_cast<std::size_t>(
        std::count_if(list.begin(), list.end(), [radio](const auto& x) { return x.to == radio; }));
  }

  /// Keeps one frame of `size` octets of payload open at each of `senders` for `length`.
  /// @returns frames sent successfully, by all of them
  std::uint64_t saturate(const std::vector<radio::radio_index>& senders, std::uint16_t to,
                         std::size_t size, bool ack, duration length) {
    std::uint64_t sent = 0;
    std::size_t seen = log.size();
    for (const auto sender : senders)
      send(sender, 0, to, size, ack);
    const auto end = now + length;
    for (auto due = channel.deadline(); due && *due <= end; due = channel.deadline()) {
      run_until(*due);
      for (; seen < log.size(); ++seen) {
        const auto* ended = std::get_if<radio::done>(&log[seen].what);
        if (ended == nullptr || ended->status == radio::send_status::queue_full)
          continue;
        const auto sender = ended->radio;
        sent += ended->status == radio::send_status::sent ? 1 : 0;
        send(sender, 0, to, size, ack);
      }
    }
    now = end;
    return sent;
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
