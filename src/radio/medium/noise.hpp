// Noise that continues a recording: closest-pattern matching (docs/tinyos.md 6; Lee, Cerpa, Levis:
// Improving Wireless Simulation Through Noise Modeling, IPSN 2007).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::radio {

/// Readings of a radio, one a millisecond, and what followed each pattern of them. Immutable;
/// radios share it. A pattern is the last `history` readings, each rounded down to 5 dB and kept
/// within -115..-5 dBm. Takes 13 octets a reading at most.
class noise_trace {
public:
  static constexpr std::size_t readings_min = 100;
  static constexpr std::size_t readings_max = 1U << 22U; ///< 70 minutes
  static constexpr std::size_t history = 20;             ///< readings that make a pattern

  /// @param readings_dbm readings_min..readings_max of them
  explicit noise_trace(std::vector<std::int8_t> readings_dbm);

  [[nodiscard]] const std::vector<std::int8_t>& readings() const { return readings_; }

  /// A place in readings(), after the first pattern.
  [[nodiscard]] std::uint32_t random_place(random_stream& rng) const;
  /// A place whose reading may follow that at `place` and those before it.
  [[nodiscard]] std::uint32_t next_place(std::uint32_t place, random_stream& rng) const;

private:
  std::vector<std::int8_t> readings_;
  // A pattern is met at each place that it precedes. So the place of the last reading gives the
  // whole history: whichever follower of a pattern is drawn, what stands before it is that pattern.
  std::vector<std::uint32_t> places_; ///< places with the same pattern before them side by side
  std::vector<std::uint32_t> starts_; ///< by pattern: its first in places_; places_.size() last
  std::vector<std::uint32_t>
      patterns_; ///< by place less `history`: the pattern before it; one more
};

/// The noise at one radio. Readings are made when asked for; after a long silence (more than
/// `memory`) the chain starts again somewhere in the trace, since nothing of the past shows any
/// more: idle time costs nothing.
class noise_source {
public:
  static constexpr duration memory = 1s;

  /// @param trace not nullptr
  noise_source(std::shared_ptr<const noise_trace> trace, random_stream rng);

  /// The reading of the millisecond that `at` is in, in dBm. @pre not before the millisecond of an
  /// earlier call
  [[nodiscard]] std::int8_t at(instant at);

private:
  std::shared_ptr<const noise_trace> trace_;
  random_stream rng_;
  std::int64_t millisecond_ = 0; ///< of the last reading
  std::uint32_t place_ = 0;      ///< in the trace, of the last reading
  bool started_ = false;
};

static_assert(sizeof(noise_source) <= 80, "every mote has one");

} // namespace rubicon::radio
