// The sending half of one transceiver: queue, CSMA-CA, ack wait, repeats.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/bounded_queue.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "radio/frame.hpp"
#include "radio/mac_rules.hpp"
#include "radio/radio_counters.hpp"

namespace rubicon::radio {

/// How a request to send ended.
enum class send_status : std::uint8_t {
  sent,                   ///< it left the radio and, if that was asked for, was acked
  no_ack,                 ///< repeated as often as allowed, never acked
  channel_access_failure, ///< too many busy clear-channel assessments in one attempt
  queue_full,             ///< refused
  aborted,                ///< the radio was switched off meanwhile, or is off
};

/// As the report names them.
[[nodiscard]] std::string to_string(send_status x);

/// A frame in the transmit queue.
struct outgoing {
  std::uint64_t token = 0;
  payload psdu;
  frame content;                          ///< views `psdu`
  std::optional<std::size_t> age_at = {}; ///< as in radio::request; the next too
  bool in_slot = false;
  instant asked;                                  ///< for it
  unsigned transmissions = 0;                     ///< so far
  bool arrived = false;                           ///< a copy of it was accepted by its destination
  copy_outcome last = copy_outcome::out_of_reach; ///< of the copy at its destination
  provenance from = {};
};

struct finished {
  std::uint64_t token = 0;
  send_status status = send_status::sent;
  unsigned transmissions = 0; ///< a train is one
  bool arrived = false;
  copy_outcome last = copy_outcome::out_of_reach;
  provenance from = {};
  bool acked = false; ///< it was to be acknowledged, and was
};

/// What the owner has to do.
struct mac_action {
  bool transmit = false;         ///< put current() on the air now
  std::optional<finished> ended; ///< report it to the requester
};

/// Sans-I/O; the medium is its owner's.
///
///   idle --submit--> backing_off --clear--> [looking_again] --clear--> turning --> sending
///                     |  ^   |  <--busy-----------+                                  |
///                busy +--+   +-- too often: next       acked: ack_wait <-------------+--> next
///                     ^                                  |    |
///                     +--- no ack, attempts left --------+    +--- ack, or attempts used up: next
///
/// Where radios listen at low power a frame is sent in a train of copies: one follows the other
/// until it is acked, or for so long that every receiver's radio has been on. A busy channel then
/// delays copies, and ends nothing but a train that has lasted so long without a first copy.
///
/// "Next" takes the following frame from the queue; its back-off begins after the interframe space,
/// and when the transceiver receives again after its own ack if one is due.
class mac {
public:
  enum class state : std::uint8_t { idle, backing_off, looking_again, turning, sending, ack_wait };

  mac() = default;
  /// @param rules not nullptr, valid as long as this
  /// @param queue frames that may be open at a time, the one in flight included
  /// @param train how long a frame is repeated; 0: it is sent once, and again without an ack
  mac(const mac_rules* rules, std::size_t queue, unsigned retries_max, duration train = {})
      : rules_(rules), open_(queue), retries_max_(retries_max), train_(train) {}

  /// @pre !full()
  void submit(outgoing x, instant now, random_stream& rng);

  /// Whether on_time() will assess the channel.
  [[nodiscard]] bool assesses() const {
    return state_ == state::backing_off || state_ == state::looking_again;
  }

  /// @param clear whether the channel has been clear for the last timing::cca; matters only if
  /// assesses()
  [[nodiscard]] mac_action on_time(instant now, bool clear, random_stream& rng);

  /// The last octet of the frame has left. @pre state is sending
  [[nodiscard]] mac_action on_sent(instant now, random_stream& rng);

  /// The transceiver answers a frame with an ack of its own, which has left by `until`. An ack
  /// needs no CSMA and goes first (IEEE 802.15.4-2006 7.5.6.4.2): CSMA for our next frame begins
  /// when the transceiver receives again after it, anew if it was in flight, so that neither the
  /// frame received nor the ack counts as a busy channel.
  void on_own_ack(instant until, random_stream& rng);

  /// An ack has come in. @pre awaits(its DSN)
  [[nodiscard]] mac_action on_ack(instant now, random_stream& rng);

  /// Gives up everything, in the order of the queue.
  [[nodiscard]] std::vector<finished> abort();

  /// When on_time() is due; nothing while idle or sending.
  [[nodiscard]] std::optional<instant> deadline() const { return deadline_; }

  /// The earliest moment at which deadline() can lead to the end of a request or of a frame. @pre
  /// there is a deadline
  [[nodiscard]] instant earliest_output() const;

  /// The same if the next assessment finds the channel clear. @pre assesses()
  [[nodiscard]] instant earliest_output_if_clear() const;

  [[nodiscard]] bool awaits(std::uint8_t dsn) {
    return state_ == state::ack_wait && open_.front().content.dsn == dsn;
  }

  /// The frame in flight. @pre not idle
  [[nodiscard]] outgoing& current() {
    assert(!open_.empty());
    return open_.front();
  }

  /// Whether frames go in trains.
  [[nodiscard]] bool repeats() const { return train_ > 0s; }

  [[nodiscard]] const mac_rules& rules() const { return *rules_; }
  [[nodiscard]] state now_in() const { return state_; }
  [[nodiscard]] bool full() const { return open_.full(); }
  [[nodiscard]] std::size_t open() const { return open_.size(); }

private:
  [[nodiscard]] instant earliest_output_of_train() const;
  void leave_space(instant now);
  void take_up(instant now, random_stream& rng);
  void begin(instant now, random_stream& rng);
  void attempt(instant now, random_stream& rng);
  void back_off(instant from, random_stream& rng);
  [[nodiscard]] mac_action on_assessed(instant now, bool clear, random_stream& rng);
  [[nodiscard]] mac_action again(instant now, random_stream& rng);
  [[nodiscard]] bool train_is_over(instant at) const { return repeats() && at >= train_end_; }
  [[nodiscard]] unsigned counted(unsigned copies) const {
    return repeats() && copies > 1 ? 1 : copies;
  }
  [[nodiscard]] mac_action end_train(instant now, random_stream& rng);
  [[nodiscard]] mac_action finish(send_status status, instant now, random_stream& rng);

  const mac_rules* rules_ = nullptr;
  bounded_queue<outgoing> open_;
  unsigned retries_max_ = 0;
  duration train_{};
  instant train_end_;   ///< nothing more of the frame is sent from here on
  unsigned busy_ = 0;   ///< busy assessments in this round
  unsigned rounds_ = 0; ///< of this attempt that have ended
  state state_ = state::idle;
  instant free_from_;   ///< end of the interframe space, and of turning back after the own ack
  instant assess_from_; ///< no assessment may begin earlier: the receiver is off, or the ack is
                        ///< received
  std::optional<instant> deadline_;
};

} // namespace rubicon::radio
