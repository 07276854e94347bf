// Frames that nearly all who heard them have received and filtered.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/time.hpp"
#include "radio/medium/topology.hpp"

namespace rubicon::radio {

/// What such frames add to the times of their receivers, by sender: a frame costs the same, however
/// many they are. Those to whom one was something else have it taken off their own times.
class filtered_frames {
public:
  /// Who has time to be taken out before the next add().
  [[nodiscard]] bool is_full() const { return entries_.size() >= entries_max; }

  /// One more has ended.
  /// @param place of its sender's frames here; kept by the sender, 0 at first
  void add(const std::shared_ptr<const hearers>& by, std::uint32_t& place, duration length,
           instant end) {
    if (place >= entries_.size() || entries_[place].by != by) {
      place = static_cast<std::uint32_t>(entries_.size());
      entries_.push_back({by, {}});
    }
    entries_[place].time += length;
    last_by_ = by;
    last_end_ = end;
  }

  /// Calls `add(radio_index, duration)` for all that has been added, and forgets it.
  template <class Add>
  void take_out(Add add) {
    for (const auto& each : entries_)
      for (const auto& x : *each.by)
        add(x.radio, each.time);
    entries_.clear();
  }

  /// What has not been taken out, of one radio.
  [[nodiscard]] duration received_by(radio_index radio) const {
    duration sum{};
    for (const auto& each : entries_)
      if (link_to(*each.by, radio) != nullptr)
        sum += each.time;
    return sum;
  }

  /// The last one, taken out or not.
  [[nodiscard]] instant last_end() const { return last_end_; }
  [[nodiscard]] const hearer* last_copy(radio_index radio) const {
    return last_by_ != nullptr ? link_to(*last_by_, radio) : nullptr;
  }

private:
  struct entry {
    std::shared_ptr<const hearers> by;
    duration time{};
  };
  static constexpr std::size_t entries_max = 128; ///< all radios of most airs

  std::vector<entry> entries_;
  std::shared_ptr<const hearers> last_by_;
  instant last_end_ = instant::min();
};

} // namespace rubicon::radio
