// The sending half of one transceiver: queue, unslotted CSMA-CA, ack wait, repeats.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/bounded_queue.hpp"
#include "core/bytes.hpp"
#include "core/random.hpp"
#include "core/time.hpp"
#include "radio/frame.hpp"

namespace rubicon::radio {

/// The standard's numbers for 2.4 GHz (tinyos.md 5.3).
namespace timing {
inline constexpr duration symbol = 16us;
inline constexpr duration unit_backoff = 20 * symbol;
inline constexpr duration cca = 8 * symbol;
inline constexpr duration turnaround = 12 * symbol;
inline constexpr duration ack_wait = 54 * symbol; ///< from the end of the frame
inline constexpr duration sifs = 12 * symbol;
inline constexpr duration lifs = 40 * symbol;
inline constexpr std::size_t sifs_psdu_max = 18; ///< longer frames are followed by a LIFS
inline constexpr unsigned be_min = 3;
inline constexpr unsigned be_max = 5;
inline constexpr unsigned backoffs_max = 4; ///< macMaxCSMABackoffs

/// The most time that one attempt takes from its first back-off to the end of its ack wait.
inline constexpr duration attempt_max = (7 + 15 + 31 + 31 + 31) * unit_backoff +
                                        (backoffs_max + 1) * cca + turnaround + air_time(psdu_max) +
                                        ack_wait;
} // namespace timing

/// How a request to send ended.
enum class send_status : std::uint8_t {
  sent,                   ///< it left the radio and, if that was asked for, was acked
  no_ack,                 ///< repeated retries_max times, never acked
  channel_access_failure, ///< five busy clear-channel assessments in one attempt
  queue_full,             ///< refused
  aborted,                ///< the radio was switched off meanwhile, or is off
};

/// As the report names them.
[[nodiscard]] std::string to_string(send_status x);

/// A frame in the transmit queue.
struct outgoing {
  std::uint64_t token = 0;
  payload psdu;
  frame content;              ///< views `psdu`
  unsigned transmissions = 0; ///< so far
};

struct finished {
  std::uint64_t token = 0;
  send_status status = send_status::sent;
  unsigned transmissions = 0;
};

/// What the owner has to do.
struct mac_action {
  bool transmit = false;         ///< put current() on the air now
  std::optional<finished> ended; ///< tell the requester
};

/// Sans-I/O; the medium is its owner's.
///
///   idle --submit--> backing_off --clear--> turning --on_time--> sending --on_sent--> idle or next
///                     |  ^   |                                      |
///                busy +--+   +-- busy 5 times: next        acked: ack_wait --on_ack--> next
///                     ^                                             |
///                     +------- no ack, attempts left ---------------+-- attempts used up: next
///
/// "Next" takes the following frame from the queue; its back-off begins after the interframe space.
class mac {
public:
  enum class state : std::uint8_t { idle, backing_off, turning, sending, ack_wait };

  mac() = default;
  /// @param queue frames that may be open at a time, the one under way included
  mac(std::size_t queue, unsigned retries_max) : open_(queue), retries_max_(retries_max) {}

  /// @pre !full()
  void submit(outgoing x, instant now, random_stream& dice);

  /// @param clear whether the channel has been clear for the last timing::cca; matters only while
  /// backing off
  [[nodiscard]] mac_action on_time(instant now, bool clear, random_stream& dice);

  /// The last octet of the frame has left. @pre state is sending
  [[nodiscard]] mac_action on_sent(instant now, random_stream& dice);

  /// An ack has come in. @pre awaits(its DSN)
  [[nodiscard]] mac_action on_ack(instant now, random_stream& dice);

  /// Gives up everything, in the order of the queue.
  [[nodiscard]] std::vector<finished> abort();

  /// When on_time() is due; nothing while idle or sending.
  [[nodiscard]] std::optional<instant> deadline() const { return deadline_; }

  [[nodiscard]] bool awaits(std::uint8_t dsn) {
    return state_ == state::ack_wait && open_.front().content.dsn == dsn;
  }

  /// The frame under way. @pre not idle
  [[nodiscard]] const outgoing& current() {
    assert(!open_.empty());
    return open_.front();
  }

  [[nodiscard]] state now_in() const { return state_; }
  [[nodiscard]] bool full() const { return open_.full(); }
  [[nodiscard]] std::size_t open() const { return open_.size(); }

private:
  void leave_space(instant now);
  void attempt(instant now, random_stream& dice);
  void back_off(instant from, random_stream& dice);
  [[nodiscard]] mac_action finish(send_status status, instant now, random_stream& dice);

  bounded_queue<outgoing> open_;
  unsigned retries_max_ = 0;
  state state_ = state::idle;
  unsigned busy_ = 0; ///< clear-channel assessments that failed in this attempt
  instant free_from_; ///< end of the interframe space after the last frame
  std::optional<instant> deadline_;
};

} // namespace rubicon::radio
