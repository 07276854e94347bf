// The crystal of one mote: its clock runs too fast or too slow by some parts per million (CLK-01).
#pragma once

#include <cstdint>

#include "core/time.hpp"

namespace rubicon::mote {

/// All timing of a mote is by its own crystal; only whoever feeds it knows the real time.
class crystal {
public:
  crystal() = default;
  /// @param ppb parts per billion by which it runs fast, -1'000'000..1'000'000
  explicit crystal(std::int64_t ppb) : ppb_(ppb) {}

  /// What it shows at a real time. Never goes back.
  [[nodiscard]] instant own(instant real) const;

  /// The first real time at which it shows `own`, or more.
  [[nodiscard]] instant real(instant own) const;

private:
  std::int64_t ppb_ = 0;
};

} // namespace rubicon::mote
