// When something that is no radio of ours disturbs: a microwave oven, a WLAN at work.
#pragma once

#include <optional>

#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::radio {

struct interferer_config {
  double duty = 1;       ///< share of the time that it sends, above 0 up to 1
  duration burst = 10ms; ///< of each time it does, above 0
};

/// Bursts of one length, between them gaps drawn uniformly from 0 to twice their mean, which is
/// what the duty leaves. Begins with a gap, so that many of one kind do not begin together.
///
///   silent --gap over--> sending --burst over--> silent      until its end
class interferer {
public:
  interferer() = default;
  interferer(interferer_config config, random_stream rng, instant now, instant until);

  /// Harmless before deadline(). @returns whether it sends from now on
  bool on_time(instant now);
  [[nodiscard]] bool sends() const { return sends_; }
  [[nodiscard]] std::optional<instant> deadline() const { return next_; } ///< nothing: it has ended

private:
  [[nodiscard]] duration gap();

  interferer_config config_;
  random_stream rng_;
  instant until_;
  bool sends_ = false;
  std::optional<instant> next_;
};

} // namespace rubicon::radio
