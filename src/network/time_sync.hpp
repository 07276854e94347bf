// How one mote takes part in the synchronisation of its island: which beacons it sends for others,
// when it asks, and what it requests from the root (CLK-01, CLK-04).
#pragma once

#include <cstdint>
#include <optional>

#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "network/clock/clock_sync.hpp"
#include "network/clock/period_requests.hpp"
#include "network/clock/round_relay.hpp"
#include "network/clock/time_answers.hpp"
#include "network/clock/time_search.hpp"
#include "network/duty_window.hpp"
#include "network/silence_watch.hpp"

namespace rubicon::network {

struct time_sync_config {
  clock_sync_config clock;
  time_search_config search;
  relay_config relay;
  answers_config answers;
  duty_window duty;
};

/// What a stamp has caused.
struct stamp_effect {
  bool is_news = false;  ///< the clock has been corrected, or is known now
  bool disputes = false; ///< it does not fit what is known
  bool is_answered = false;
};

/// Draws of random numbers are made from the owner's stream.
class time_sync {
public:
  time_sync() = default;
  time_sync(const time_sync_config& config, random_stream search_rng, instant now);

  [[nodiscard]] const clock_sync& clock() const { return clock_; }
  [[nodiscard]] clock_sync& clock() { return clock_; }
  [[nodiscard]] const time_estimate& time() const { return clock_.time(); }
  [[nodiscard]] const time_search& search() const { return search_; }
  [[nodiscard]] round_relay& relay() { return relay_; }

  /// Whether the windows of neighbours are not known.
  [[nodiscard]] bool is_lost(instant now) const {
    return duty_.enabled() && !duty_.knows_time(now, time());
  }

  // What is received.

  void on_received() { silence_.on_received(); }
  /// @param is_urgent our beacon is needed for another reason
  [[nodiscard]] stamp_effect on_stamp(const clock_stamp& x, instant sfd, bool is_urgent,
                                      instant now, random_stream& rng);
  /// The end of a unicast. @returns whether the time is distrusted from now on
  [[nodiscard]] bool on_unicast(bool acked, instant now);

  // What is sent.

  /// A beacon is to leave now. @param is_extra it takes no other one's place
  /// @returns whether it must ask for the time
  [[nodiscard]] bool on_beacon_due(bool is_extra, instant now);
  /// It leaves, and is not extra.
  void on_beacon_sent(instant now, random_stream& rng);

  /// @returns whether the root has begun a round: a beacon is due now
  [[nodiscard]] bool on_time(instant now);
  /// The beacon that the search needs now. To be called whenever something has happened.
  [[nodiscard]] time_search::beacon_due search_time(instant now);
  /// @param has_route to the sink @returns the period of rounds to request of it now
  [[nodiscard]] std::optional<duration> request_period(bool has_route, instant now,
                                                       random_stream& rng);

  [[nodiscard]] bool is_answer_due(instant now) const { return answers_.is_due(now); }
  /// @param turn when a beacon may leave that is not an answer
  [[nodiscard]] std::optional<instant> deadline(instant turn) const;

  [[nodiscard]] static std::size_t footprint() { return clock_sync::footprint(); }

private:
  [[nodiscard]] time_knowledge knowledge(instant now) const;
  [[nodiscard]] bool answer(const clock_stamp& x, instant now, random_stream& rng);

  bool is_root_ = false;
  duty_window duty_;
  clock_sync clock_;
  time_search search_;
  round_relay relay_;
  time_answers answers_;
  silence_watch silence_;
  period_requests requests_;
  std::uint64_t steps_ = 0; ///< of the clock, as far as the search knows
};

} // namespace rubicon::network
