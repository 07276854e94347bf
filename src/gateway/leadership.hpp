// Whether this gateway leads its island, of several that are connected to it (GW-14).
#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "network/sink_event.hpp"

namespace rubicon::gateway {

struct leadership_config {
  bool alone = true;       ///< it is the only one, and always leads
  std::uint32_t life = 0;  ///< how often it was started before
  duration lease = 1500ms; ///< a word of the sink counts for so long: its patience with a silent
                           ///< gateway lasts longer (mote::gateway_lines)
};

/// Stands by until the sink says that it leads, and again when the sink says otherwise or nothing.
///
///   stands by --poll: you lead--> leads --poll: another, lease over--> stands by
///                                  | ^ a new term
///                                  `-'
class leadership {
public:
  enum class change : std::uint8_t { none, taken, lost };

  leadership() = default;
  explicit leadership(leadership_config config) : config_(config) {}

  /// The answer to a poll is answer(). A new term taken while leading is `taken` as well: who led
  /// before has forgotten all that was in flight.
  [[nodiscard]] change on_poll(const network::gateway_poll& x, instant now);
  [[nodiscard]] change on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const { return lease_until_; }

  [[nodiscard]] network::gateway_answer answer() const { return {config_.life, newest_term_}; }
  [[nodiscard]] bool alone() const { return config_.alone; }
  [[nodiscard]] bool leads() const { return config_.alone || lease_until_.has_value(); }
  [[nodiscard]] std::uint32_t term() const { return term_; } ///< in which it leads or led last

  [[nodiscard]] std::uint64_t led() const { return led_; } ///< times that it took the lead
  [[nodiscard]] duration leading(instant now) const;       ///< for how long in all

private:
  void end_lead(instant now);

  leadership_config config_;
  std::uint32_t term_ = 0;
  std::uint32_t newest_term_ = 0;
  std::optional<instant> lease_until_; ///< set while it leads
  instant since_;
  std::uint64_t led_ = 0;
  duration leading_{};
};

} // namespace rubicon::gateway
