// What is on the air and what each transceiver makes of it.
#pragma once

#include <cassert>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "radio/energy.hpp"
#include "radio/frame.hpp"
#include "radio/topology.hpp"

namespace rubicon::radio {

/// What the air has done to one copy of a frame.
enum class fate : std::uint8_t { intact, collision, half_duplex, off };

/// A frame on the air.
struct transmission {
  radio_index from;
  frame content; ///< views `psdu`
  payload psdu;  ///< empty for acks: only their DSN is ever asked for
};

/// A place in the medium's table of frames on the air.
using slot_index = std::uint32_t;

/// Transceivers without intelligence: they send when told to, lock on the first frame they hear,
/// and lose it when anything comes in between. Two frames that overlap at a receiver destroy each
/// other there, however strong one is. Costs O(hearers) for each start and end of a frame.
class medium {
public:
  /// A transceiver, listening; its states are the meter's.
  void add(const energy_meter& meter, instant now);

  /// @pre the radio is on and not sending
  slot_index start(transmission x, std::shared_ptr<const hearers> heard_by, instant now);

  /// Nobody can use what has been sent so far: its sender was switched off.
  void cut(slot_index slot);

  /// The last octet has left. Calls `on_copy(const transmission&, const hearer&, fate)` for each
  /// radio in range, in ascending order; it must not start a frame.
  template <class OnCopy>
  void end(slot_index slot, instant now, OnCopy on_copy) {
    auto& sent = on_air_[slot];
    assert(sent.heard_by != nullptr);
    stop_sending(sent.what.from, now);
    std::uint32_t place = 0;
    for (const auto& x : *sent.heard_by) {
      silence(x.radio, slot, now);
      on_copy(sent.what, x, sent.fates[place++]);
    }
    release(slot);
  }

  void switch_on(radio_index radio, instant now);

  /// @pre the radio is not sending: its frame was cut and ended before
  void switch_off(radio_index radio, instant now);

  /// Whether nothing has been audible to the radio, and it has sent nothing itself, since `since`.
  [[nodiscard]] bool clear(radio_index radio, instant since) const {
    const auto& x = transceivers_[radio.value];
    return x.audible == 0 && !x.sending && x.quiet_from <= since;
  }

  [[nodiscard]] std::optional<slot_index> sending(radio_index radio) const {
    return transceivers_[radio.value].sending;
  }

  /// Changes with every new use of a slot and at the end of each.
  [[nodiscard]] std::uint64_t stamp(slot_index slot) const { return on_air_[slot].stamp; }

  [[nodiscard]] const transmission& content(slot_index slot) const { return on_air_[slot].what; }

  /// Radios in range summed over all frames that have ended.
  [[nodiscard]] std::uint64_t copies() const { return copies_; }

  [[nodiscard]] energy_meter& meter(radio_index radio) { return transceivers_[radio.value].meter; }
  [[nodiscard]] const energy_meter& meter(radio_index radio) const {
    return transceivers_[radio.value].meter;
  }

private:
  struct transceiver {
    energy_meter meter;
    std::uint32_t audible = 0; ///< frames of others in the air here
    instant quiet_from;        ///< when the last frame ended, audible or its own
    std::optional<slot_index> sending;
    std::optional<slot_index> locked;  ///< the frame it is receiving
    std::uint32_t place_in_locked = 0; ///< where its fate stands
  };

  struct on_air {
    transmission what;
    std::shared_ptr<const hearers> heard_by; ///< nullptr: the slot is free
    std::vector<fate> fates;                 ///< one for each hearer
    std::uint64_t stamp = 0;
  };

  [[nodiscard]] slot_index free_slot();
  [[nodiscard]] fate meet(transceiver& hearing, slot_index slot, std::uint32_t place, instant now);
  void spoil_locked(transceiver& x, fate cause);
  void stop_sending(radio_index radio, instant now);
  void silence(radio_index radio, slot_index slot, instant now);
  void release(slot_index slot);

  std::vector<transceiver> transceivers_;
  std::vector<on_air> on_air_;
  std::vector<slot_index> free_;
  std::uint64_t copies_ = 0;
};

} // namespace rubicon::radio
