// What the radios of a channel have counted.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "radio/channel/station.hpp"
#include "radio/medium/topology.hpp"
#include "radio/radio_counters.hpp"

namespace rubicon::radio {

/// A view, valid until a radio is added. Each function but on_link() costs O(links).
class channel_counts {
public:
  /// @param copies radios in reach summed over all frames that have ended, as the medium has it
  channel_counts(std::span<const station> stations, std::uint64_t copies)
      : stations_(stations), copies_(copies) {}

  [[nodiscard]] radio_counters by(radio_index radio) const;
  [[nodiscard]] std::vector<radio_counters> by_radio() const;
  [[nodiscard]] radio_counters in_pan(std::uint16_t pan) const;
  [[nodiscard]] radio_counters by_all() const;

  /// The copies on one link while `from` has had it last: they begin anew when `from` gets another
  /// list of hearers, because a radio near it is added or moves or channel::set_loss() concerns it.
  [[nodiscard]] copy_counters on_link(radio_index from, radio_index to) const;

  /// Whether the counters of every radio and the copies of every link balance, and no copy is
  /// missing from the sum of them. Always true.
  [[nodiscard]] bool balanced() const;

private:
  std::span<const station> stations_;
  std::uint64_t copies_ = 0;
};

} // namespace rubicon::radio
