// The receiving half of one mote: address filter, receive slots, repeats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "radio/energy.hpp"
#include "radio/frame.hpp"

namespace rubicon::radio {

/// What becomes of a data frame that came in unharmed.
enum class verdict : std::uint8_t {
  accepted,
  filtered,  ///< not for this mote, or of another PAN (RTG-06)
  overflow,  ///< no receive slot free; it is not acked
  duplicate, ///< a repeat: takes a slot and is acked again, but is not delivered
};

/// Sans-I/O. The filter is the transceiver's, so frames for others take no slot. Deviation: a
/// CC2420 that overflows flushes its whole FIFO (tinyos.md 10); here only the newcomer is lost. A
/// repeat has the source and DSN of the last unicast frame taken from that source; DSNs come round
/// after 256 frames, so one is remembered only for as long as its sender can be repeating it.
class receiver {
public:
  receiver() = default;
  /// @param memory how long a sender may go on repeating a frame
  receiver(mote_id address, std::uint16_t pan, bool promiscuous, std::size_t slots, duration memory)
      : address_(address), pan_(pan), promiscuous_(promiscuous), slots_(slots), memory_(memory) {}

  /// @param service how long the MCU has a slot occupied with a frame
  [[nodiscard]] verdict on_frame(const frame& x, duration service, energy_meter& mcu, instant now);

  /// Whether the frame was sent to this mote alone.
  [[nodiscard]] bool addressed(const frame& x) const {
    return x.pan == pan_ && x.destination == address_;
  }

  /// Forgets what is in the slots and what has been heard, as a restart does.
  void reset();

private:
  struct memory_entry {
    std::uint8_t dsn = 0;
    instant heard_at;
  };

  [[nodiscard]] bool wanted(const frame& x) const {
    return promiscuous_ ||
           (x.pan == pan_ && (x.destination == address_ || x.destination == broadcast_mote));
  }
  [[nodiscard]] bool repeated(const frame& x, instant now);

  mote_id address_;
  std::uint16_t pan_ = default_pan;
  bool promiscuous_ = false;
  std::size_t slots_ = 0;
  duration memory_{};
  std::vector<instant> served_at_;       ///< of the frames in the slots, ascending
  std::map<mote_id, memory_entry> last_; ///< by source; at most one for each mote in range
};

} // namespace rubicon::radio
