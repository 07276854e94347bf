// What must hold all the time, not only at the end: motes are received, and know the time. Whatever
// healed late is found by it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "report/report.hpp"

namespace rubicon::report {

/// How fast an island heals.
struct healing_rules {
  bool sleeps = false;      ///< its motes' radios do
  duration period{};        ///< of their windows
  duration departure = 10s; ///< a mote that is silent for so long has left
  bool judges = false;      ///< in wall time everything comes when the computer comes to it

  /// After a cause has ended, everything is as before within so long: 2 min where radios are always
  /// on; where they sleep, 4 periods and 2 min for each hop.
  [[nodiscard]] duration bound(unsigned hops) const;
};

/// A mote at one moment.
struct mote_look {
  bool runs = false;                       ///< it has power, and is not out of order
  bool has_route = false;                  ///< to its sink
  bool moves = false;                      ///< it is carried about, perhaps beyond all others
  unsigned hops = 0;                       ///< of that route
  std::optional<duration> clock_error{};   ///< nothing: it or its sink does not know the time
  duration clock_doubt{};                  ///< how far off it says that it may be
  std::optional<std::uint64_t> messages{}; ///< that its programs have sent, in this life
  std::uint64_t arrived = 0; ///< a number that changes whenever one of them has come to the gateway
};

/// Looks at motes each 10 s of a run, and is notified when one is listed or not. A silence or a
/// wrong clock is a violation when it has lasted longer than healing takes, counted from its own
/// beginning or from the end of the last cause near it, whatever is later. Causes are faults, and
/// whatever starts or ends; what a mote without power does is not judged, nor what one does that
/// nobody in reach can hear.
///
/// Time is an argument, and nothing here has any influence on the run.
class time_watch {
public:
  static constexpr duration every = 10s;

  void add_island(island_id id, std::string name, const healing_rules& rules);

  /// Something happens that an island has to recover from. @param until its end
  void on_cause(island_id island, instant until);
  void on_cause(instant until); ///< in all islands

  /// The gateway lists the mote, or does not any more. @param by_itself it has said goodbye, or its
  /// battery is flat
  void on_listed(mote_address mote, bool listed, bool by_itself, instant now);

  /// @param name `kitchen/fan`
  void look(mote_address mote, const std::string& name, const mote_look& x, instant now);

  /// What has been found, and what lasts; the watch goes on.
  void fill(run_report& x, instant now) const;

private:
  /// Something that lasts, and is to end.
  struct trouble {
    std::optional<instant> since{};
    std::optional<instant> too_long{}; ///< when it had lasted longer than it may
  };

  struct watched_island {
    std::string name;
    healing_rules rules;
    instant cause_until;  ///< the latest end of all causes so far
    std::size_t down = 0; ///< motes that do not run: others may need them
    clock_report clock;
  };

  struct watched_mote {
    std::string name;
    bool runs = false;
    bool is_known = false; ///< it has been looked at
    bool is_listed = false;
    bool is_expected = false; ///< it has joined, and not said goodbye
    unsigned hops = 1;        ///< the most that it ever had
    instant excused;          ///< until then nothing was to be asked of it
    trouble unlisted;
    trouble unheard; ///< it sends, and nothing arrives
    trouble wrong;   ///< its clock is
    std::uint64_t messages = 0;
    std::uint64_t arrived = 0;
    std::uint64_t unheard_messages = 0; ///< sent since the last that arrived
    bool was_heard = false;             ///< ever
    duration silence{};
    instant silence_from;
  };

  static void note_power(watched_island& of, watched_mote& who, const mote_look& x, instant now);
  void judge_clock(watched_island& of, watched_mote& who, const mote_look& x, instant now);
  void judge_messages(const watched_island& of, watched_mote& who, const mote_look& x, instant now);
  static void judge(trouble& x, const watched_island& of, const watched_mote& who, duration more,
                    instant now);
  void end_silence(const watched_island& of, watched_mote& who, trouble& x, instant now);
  void end_wrong(watched_island& of, watched_mote& who, instant now);
  static void note_silence(watched_mote& who, const trouble& x, instant now);
  [[nodiscard]] static violation silence_violation(const watched_island& of,
                                                   const watched_mote& who, const trouble& x,
                                                   instant now);
  [[nodiscard]] static violation clock_violation(const watched_island& of, const watched_mote& who,
                                                 instant now);
  void keep(violation x);

  std::map<island_id, watched_island> islands_;
  std::map<mote_address, watched_mote> motes_;
  std::vector<violation> found_; ///< at most violations_max
};

} // namespace rubicon::report
