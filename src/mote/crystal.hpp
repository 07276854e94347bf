// The crystal of one mote: its clock runs too fast or too slow by some parts per million (CLK-01).
#pragma once

#include <cstdint>

#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::mote {

/// What a crystal is like. It runs fast by `ppb` parts per billion, and beside that, as temperature
/// rises and falls, by up to `wander_ppb` more or less: from one to the other and back in a
/// straight line each, in a period.
struct crystal_config {
  std::int64_t ppb = 0;         ///< -1'000'000..1'000'000
  std::int64_t wander_ppb = 0;  ///< 0..100'000
  duration wander_period = 24h; ///< > 0
  duration phase{};             ///< into that period at real time zero; 0..wander_period
};

/// What a mote's clock shows more than real time when it starts: unknown, up to an hour.
[[nodiscard]] duration boot_time(random_stream rng);

/// All timing of a mote is by its own crystal; only whoever feeds it knows the real time.
class crystal {
public:
  crystal() = default;
  explicit crystal(const crystal_config& config);
  /// One that does not wander.
  explicit crystal(std::int64_t ppb) : crystal(crystal_config{.ppb = ppb}) {}

  /// The same crystal in another life of its mote: its clock shows so much more than it would.
  [[nodiscard]] crystal ahead_by(duration x) const;

  /// What it shows at a real time. Never goes back.
  [[nodiscard]] instant own(instant real) const;

  /// The first real time at which it shows `own`, or more.
  [[nodiscard]] instant real(instant own) const;

private:
  [[nodiscard]] duration wandered(duration since) const;

  crystal_config config_;
  duration ahead_{};
};

} // namespace rubicon::mote
