// The receiving half of one mote above its address filter: receive slots, repeats.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "radio/energy.hpp"
#include "radio/frame.hpp"
#include "radio/mac_rules.hpp"

namespace rubicon::radio {

/// What becomes of a data frame that came in unharmed and is for this mote.
enum class verdict : std::uint8_t {
  accepted,
  overflow,  ///< no receive slot free; it is not acked
  duplicate, ///< a repeat: takes a slot and is acked again, but is not delivered
};

/// Sans-I/O. The address filter is the transceiver's, so frames for others take no slot. Deviation:
/// a CC2420 that overflows flushes its whole FIFO (tinyos.md 10); here only the newcomer is lost. A
/// repeat has the source and DSN of the last such frame taken from that source; DSNs come round
/// after 256 frames, so by the standard's rules one is remembered only for as long as its sender
/// can be repeating it. TinyOS remembers a few sources for ever (tinyos.md 4.2).
class receiver {
public:
  receiver() = default;
  /// @param rules not nullptr, valid as long as this
  /// @param memory how long a sender may go on repeating a frame
  receiver(const mac_rules* rules, std::size_t slots, duration memory)
      : rules_(rules), slots_(slots), memory_(memory) {}

  /// @param may_repeat whether it may be a repeat: it was sent to this mote alone, or its sender
  /// repeats broadcasts too
  /// @param service how long the MCU has a slot occupied with a frame
  [[nodiscard]] verdict on_frame(const frame& x, bool may_repeat, duration service,
                                 energy_meter& mcu, instant now);

  /// At least so long from now on.
  void remember_for(duration memory) { memory_ = std::max(memory_, memory); }

  /// Forgets what is in the slots and what has been received, as a restart does.
  void reset();

private:
  struct reception {
    std::uint16_t source = 0; ///< key_of() it
    std::uint8_t dsn = 0;
    instant at;
  };

  [[nodiscard]] std::uint16_t key_of(mote_id source) const;
  [[nodiscard]] bool repeated(const frame& x, instant now);

  const mac_rules* rules_ = nullptr;
  std::size_t slots_ = 0;
  duration memory_{};
  std::vector<instant> served_at_; ///< of the frames in the slots, ascending
  std::vector<reception> last_;    ///< ascending by source
};

} // namespace rubicon::radio
