// Who sends its synaptic vectors in which part of a tick: the sink's table (SYN-16).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "network/clock/tick_plan.hpp"

namespace rubicon::mote {

struct slot_table_counters {
  std::uint64_t refused = 0; ///< notices for which the tick had no room
  std::uint64_t moved = 0;   ///< slots that were moved to make room for another
};
RUBICON_FIELDS(slot_table_counters, refused, moved);

/// Slots do not overlap and lie within the room of a tick. A mote gets the first gap that holds
/// what it needs; if there is none, all slots are put together anew, as long as they fit. A slot is
/// free again when its mote has not said for `hold` that it needs it.
class slot_table {
public:
  slot_table() = default;
  explicit slot_table(duration hold) : hold_(hold) {}

  /// Units of a tick (network::tick_plan::units()), 0 at first.
  void set_room(std::size_t units) { room_ = units; }

  /// A mote needs so many units, 0: none, and holds `has` for its slot.
  /// @returns motes that are to be sent their slot_of(), ascending
  [[nodiscard]] std::vector<mote_id> on_notice(mote_id mote, std::uint16_t units,
                                               network::slot_run has, instant now);
  void forget(mote_id mote) { slots_.erase(mote); }
  void on_time(instant now); ///< harmless before deadline()

  [[nodiscard]] network::slot_run slot_of(mote_id mote) const;
  [[nodiscard]] std::size_t used() const; ///< units up to the end of the last slot
  [[nodiscard]] std::optional<instant> deadline() const;
  [[nodiscard]] const slot_table_counters& counters() const { return counters_; }

private:
  struct holder {
    network::slot_run slot;
    instant end;
  };

  [[nodiscard]] std::optional<std::uint16_t> gap(std::uint16_t units) const;
  void put_together(std::vector<mote_id>& changed);

  duration hold_{};
  std::size_t room_ = 0;
  std::map<mote_id, holder> slots_;
  slot_table_counters counters_;
};

} // namespace rubicon::mote
