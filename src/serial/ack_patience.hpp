// How long the PC side of a serial line waits for an ack before it writes a packet again.
#pragma once

#include <array>
#include <cstddef>

#include "core/time.hpp"

namespace rubicon::serial {

/// On a line that answers every first attempt the wait is the longest one, so that a mote busy
/// with a frame of its own causes no duplicates (motes do not suppress them, docs/tinyos.md 1.3).
/// Once a repeat was needed the line counts as noisy for the next 64 answers, and the wait is 250
/// us and an eighth more than the longest of the last 16 answers took: a fixed 100 ms would cost a
/// line with 1 % octet errors most of its throughput (GW-16). The last attempt waits four times as
/// long before the packet is given up. Never longer than the longest one.
///
/// What the packet itself takes on the line is known, and differs from packet to packet: it is not
/// measured, but added.
class ack_patience {
public:
  /// An ack came so long after the last octet of its attempt has left; `repeated` if that was not
  /// the first attempt.
  void on_answer(duration answer, bool repeated);

  /// All attempts of a packet stayed unanswered. Once is noise; twice in a row means that what was
  /// measured no longer holds, and the wait is the configured one until there is a new answer.
  void on_silence();

  /// From when an attempt is written. @param on_line what its octets take
  [[nodiscard]] duration wait(duration on_line, duration longest, bool last_attempt) const;

private:
  std::array<duration, 16> answers_{}; ///< a ring; the first measured_ are valid
  std::size_t measured_ = 0;
  std::size_t next_ = 0;
  bool silent_ = false;        ///< the last packet had no answer
  unsigned noisy_answers_ = 0; ///< answers left until the line counts as quiet again
};

} // namespace rubicon::serial
