// The in end of a synaptic channel: ChIn, and the vectors in flight to it (SYN-10).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "synaptic/message.hpp"

namespace rubicon::synaptic {

/// Puts vectors together from packets, and shows one at a tick only. The vector of tick T is due
/// at tick T + 1: updated if it is complete by then, else missed. A vector that is complete only
/// later is shown at the next tick if nothing newer is there; its tick stays missed.
///
/// Reports begin with the first vector that arrives and end with the one that SYN_STOP names.
class arrivals {
public:
  enum class verdict : std::uint8_t {
    taken,
    repeated,
    late,    ///< its tick has been reported missed, or a newer vector is shown
    untimely ///< of a tick that is none of the channel's, or not to come soon
  };
  enum class report : std::uint8_t { none, updated, missed };

  arrivals() = default;
  arrivals(std::uint8_t size, std::uint8_t divisor) : divisor_(divisor), shown_(size) {}

  /// @param tick this node's, nothing before the first
  /// @pre x.first + x.values.size() <= size
  [[nodiscard]] verdict put(const vector_message& x, std::optional<std::uint32_t> tick);

  /// Vectors after that of tick `last` are not to be waited for. An outdated word is ignored.
  /// @param tick as in put()
  void stop(std::uint32_t last, std::optional<std::uint32_t> tick);

  /// The tick after the last one begins.
  [[nodiscard]] report on_tick(std::uint32_t tick);

  /// Ticks have been left out or come again: vectors in flight are forgotten.
  void on_leap(std::uint32_t tick);

  /// Shows a vector now.
  void show(std::span<const float> values) { shown_.assign(values.begin(), values.end()); }

  [[nodiscard]] std::span<const float> shown() const { return shown_; }

  /// Ticks reported missed since anything has arrived.
  [[nodiscard]] unsigned silence() const { return silence_; }

private:
  struct vector {
    std::optional<std::uint32_t> tick{};
    std::vector<bool> has{};
    std::vector<float> values{};
    std::size_t missing = 0;
  };

  void note_run(std::uint32_t tick);
  [[nodiscard]] vector* place_for(std::uint32_t tick);
  [[nodiscard]] bool is_in_run(std::uint32_t tick) const;

  std::uint8_t divisor_ = 1;
  std::vector<float> shown_; ///< ChIn
  std::optional<std::uint32_t> shown_tick_;
  std::array<vector, 2> coming_;              ///< the one due next, and one that is early or late
  std::optional<std::uint32_t> first_, last_; ///< of the ticks to be reported
  std::optional<std::uint32_t> newest_;       ///< that any packet has named
  bool has_arrivals_ = false;                 ///< since the last report
  unsigned silence_ = 0;
};

} // namespace rubicon::synaptic
