// When a mote that cannot rely on its time asks for it, and when its radio must be on for that
// (CLK-04, NRG-01).
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

#include "core/island_time.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "network/clock/time_estimate.hpp"
#include "network/duty_window.hpp"

namespace rubicon::network {

struct time_search_config {
  bool is_root = false;
  duty_window duty;

  /// A mote sends no request within this of its start, nor within `company` if it has just received
  /// a beacon: then all begin together.
  duration start_quiet = 1500ms;
  duration company = 10s;
  /// Motes that have missed the same rounds send requests spread over this.
  duration stale_spread = 10s;
  static constexpr unsigned window_asks = 2;
  static constexpr duration long_search = 2min; ///< after such a one others may have lost the time

  /// Between two searches at least; doubles each time, up to pause_max or pause_periods of the
  /// common window.
  duration pause = 8s;
  duration pause_max = 2min;
  static constexpr unsigned pause_periods = 200;

  static constexpr duration probe_gap = 45s;      ///< between two probes at most
  static constexpr duration probe_listen = 150ms; ///< after a probe's last beacon
  static constexpr unsigned probe_beacons = 3;  ///< of a probe: a beacon or its answer may be lost
  static constexpr duration probe_pause = 60ms; ///< between these
};

/// What a mote knows of the time.
enum class time_knowledge : std::uint8_t {
  none,    ///< nothing, or so little that it misses the others' windows
  doubted, ///< something shows that it may be wrong
  stale,   ///< the root is silent
  good,
};

/// In an island whose radios are always on a search is a beacon that asks; if no answer comes,
/// another, each time twice as long after.
///
/// Where they sleep, who knows the time is on in a short window that others do not know: a search
/// asks again and again for a whole period, with one beacon in each window, as X-MAC wakes
/// receivers. A mote that has only missed some rounds asks in two windows as it knows them first.
/// After one that has found nothing the mote rests: its radio is off, but for the windows as it
/// knows them, the next searches, which become rare, and probes: three beacons that ask, and a
/// moment to listen. A root that comes back is always on and answers a probe. Whoever has found the
/// time again after its island's has leapt stays on for so long that others' probes reach it, and
/// sends two beacons in the windows of the time before.
class time_search {
public:
  enum class beacon_due : std::uint8_t { none, ask, plain };

  time_search() = default;
  time_search(time_search_config config, random_stream rng, instant now);

  /// To be called whenever something has happened, and at deadline().
  /// @returns the beacon that is to be sent now, whatever the window
  [[nodiscard]] beacon_due on_time(instant now, time_knowledge knowledge,
                                   const time_estimate& clock);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// A beacon has come; others are there.
  void on_beacon(instant now) { received_ = now; }

  /// One that asks has gone out for another reason: it may be answered.
  void on_beacon_sent(instant now) {
    listen_until_ = std::max(listen_until_, now + config_.probe_listen);
  }

  /// Another asks, whose answers we receive too.
  void on_asked(instant now);

  /// A round of the root has come.
  /// @param leap by so much the island's time is ahead of what we took it for, if it is another
  /// @param clock that shows it
  void on_news(std::optional<island_clock::duration> leap, const time_estimate& clock, instant now);

  /// The root's time has begun anew: whoever sleeps near it shall know.
  void announce(instant now);

  /// There is something to be found.
  [[nodiscard]] bool is_lost() const { return lost_; }

  /// The radio must be on, whatever the windows.
  [[nodiscard]] bool listens(instant now) const { return asks_ || now < listen_until_; }

  /// When listens() ends of itself.
  [[nodiscard]] std::optional<instant> listen_end(instant now) const {
    return now < listen_until_ ? std::optional(listen_until_) : std::nullopt;
  }

  /// Else the radio is needed in the windows alone, even if they are not known.
  [[nodiscard]] bool rests() const { return rests_; }

private:
  [[nodiscard]] duration ask_gap() const { return config_.duty.length * 2 / 3; }
  [[nodiscard]] duration pause_max() const;
  void begin(time_knowledge knowledge, const time_estimate& clock, instant now);
  [[nodiscard]] instant in_next_window(const time_estimate& clock, instant now);
  [[nodiscard]] beacon_due ask(const time_estimate& clock, instant now);
  void rest(instant now);
  void await_probe(instant now);

  time_search_config config_;
  random_stream rng_;
  bool lost_ = false;  ///< there is something to be found,
  bool asks_ = false;  ///< it searches,
  bool rests_ = false; ///< or has, in vain
  bool has_started_ = false;
  unsigned window_asks_ = 0;   ///< that are to come before a search
  unsigned probe_left_ = 0;    ///< beacons of a probe
  std::optional<instant> due_; ///< the next beacon that asks
  instant search_end_;
  instant next_search_;
  instant lost_from_;
  instant listen_until_;
  duration pause_{};
  std::optional<instant> received_; ///< a beacon
  instant announce_until_;
  std::optional<instant> announce_due_;                 ///< of announce()
  std::array<std::optional<instant>, 2> old_windows_{}; ///< in which to send a beacon
};

} // namespace rubicon::network
