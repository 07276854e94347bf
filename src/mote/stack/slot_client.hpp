// The slot of each tick in which a mote's vectors leave (SYN-16), at the mote.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "communication/layer.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "mote/join/management.hpp"

namespace rubicon::mote {

/// Requests a slot of the sink for the vectors of this mote, again before the sink forgets it, and
/// decides which packet leaves when in the slot that it has granted.
class slot_client {
public:
  /// The layer's, of vectors.
  using packet = std::variant<communication::channel_packet, transport::to_network>;

  void on_joined();
  void on_lost(); ///< the island

  /// A refusal stands until the next notice.
  void on_grant(const network::slot_run& x, random_stream& rng, instant now);
  [[nodiscard]] const network::slot_run& granted() const { return granted_; }

  /// Channels of vectors come about one after the other, and are counted together.
  /// @param units that all connected ones need @param all_connected none is still to come
  void set_demand(std::uint16_t units, bool all_connected, random_stream& rng, instant now);

  /// @returns what the sink is to be sent now; nothing: no notice is due
  /// @param answer_wait what a grant takes longer, as frames wait for their turn
  [[nodiscard]] std::optional<slot_notice> take_notice(duration answer_wait, random_stream& rng,
                                                       instant now);

  /// @param length of our slot at this tick; 0: there is none
  void begin_tick(duration length) { left_ = length; }

  /// When a packet that is under way for so long may leave in our slot of this tick; nothing: what
  /// is left of it is too short, so that the packet waits as others do.
  /// @param space that every radio of the island needs after a packet
  [[nodiscard]] std::optional<instant> take(duration passage, duration space, instant now);

  /// Until its part of the slot.
  void delay(instant due, packet x) { delayed_.push_back({due, std::move(x)}); }
  /// A delayed packet whose part has begun.
  [[nodiscard]] std::optional<packet> next(instant now);

  [[nodiscard]] std::optional<instant> deadline() const;

private:
  struct delayed_packet {
    instant due;
    packet what;
  };

  [[nodiscard]] std::optional<instant> next_notice(random_stream& rng, instant now) const;

  network::slot_run granted_;
  duration left_{};                     ///< at this tick, for packets that begin
  instant at_;                          ///< at this time
  std::uint16_t units_ = 0;             ///< needed, as the sink is to know
  std::optional<instant> notice_at_;    ///< the sink is to know how long a slot the vectors need
  std::optional<instant> counts_at_;    ///< channels that are not open then are not waited for
  std::vector<delayed_packet> delayed_; ///< in the order of their times
};

} // namespace rubicon::mote
