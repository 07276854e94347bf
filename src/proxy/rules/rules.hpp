// The smallest control program: from what a tuple says, and for how long, to other tuples.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "proxy/rules/rules_config.hpp"

namespace rubicon::proxy {

/// Write the word to the key, at the key's owner.
struct write_tuple {
  std::string key;
  std::string word;
  bool again = false; ///< since the last time it was written it has failed
  bool meta = false;  ///< as in rule_write

  friend bool operator==(const write_tuple&, const write_tuple&) = default;
};

/// The outcomes of what one rule has written. Each write has one outcome: writes = accepted +
/// refused + replaced + lost + those that wait.
struct write_counters {
  std::uint64_t writes = 0;
  std::uint64_t accepted = 0; ///< its owner has it
  std::uint64_t refused = 0;  ///< its owner, or the proxy there, does not take it
  std::uint64_t replaced = 0; ///< by another one, before its owner had it
  std::uint64_t lost = 0;     ///< its owner was away, or went away with it

  friend bool operator==(const write_counters&, const write_counters&) = default;
};
RUBICON_FIELDS(write_counters, writes, accepted, refused, replaced, lost);

struct rules_counters {
  std::uint64_t repeats = 0;       ///< writes because one before had failed
  std::uint64_t times_missed = 0;  ///< times of day at which the rules were away, and too old since
  std::uint64_t values = 0;        ///< numbers that a rule watches
  std::uint64_t unread_values = 0; ///< texts that are no number: dropped
  std::uint64_t unwatched_keys = 0; ///< keys that no rule watches: dropped
};
RUBICON_FIELDS(rules_counters, repeats, times_missed, values, unread_values, unwatched_keys);

/// What an owner's kernel has made of a write.
enum class write_end : std::uint8_t {
  accepted,
  refused,
  unreached, ///< unknown whether it has it
};

/// Each rule is a Schmitt trigger with delays and writes only on a crossing:
///
///   unknown --at or above `above`--> high (writes then)
///   unknown --below `below`--------> low  (writes otherwise)
///   high --below `below`--> low           low --at or above `above`--> high
///
/// Between `below` (inclusive) and `above` (exclusive) a rule stays what it is. A delay begins anew
/// when the value leaves the range that the rule is waiting for, or its tuple is deleted.
///
/// A rule with `after` writes its `then` so much later, whatever the value is by then; one with a
/// time of day writes on no crossing, but at that time what its level asks for. What is read `from`
/// a tuple that no component publishes is not written.
///
/// A rule whose condition does not hold, and that has no `otherwise`, changes nothing.
///
/// What a rule has written stands, one word for each key, until another is written:
///
///   waiting --owner is there--> asked --on_written(accepted)--> accepted --KEY.outcome--> done
///      ^                          | unreached                      | owner gone within `unsure`
///      +--------------------------+--------------------------------+
///
/// One that waits is written when its owner is there (again). Where no owner could be reached, or a
/// proxy reports by `KEY.outcome` that the word has failed, is unreachable or timed out, it is
/// written again after `retry`, then after twice that, up to retry_max.
class rules {
public:
  static constexpr duration retry_max = 1min;
  static constexpr duration unsure = 30s;      ///< an owner that is gone so soon may not have acted
  static constexpr duration patience = 10s;    ///< then it is reported that a word waits
  static constexpr duration lateness_max = 1h; ///< of a time of day

  /// @param retry 0: nothing is written again
  explicit rules(std::vector<rule> list = {}, duration retry = 5s,
                 std::vector<clock_change> changes = {});

  /// Keys to subscribe to with any owner, and keys whose owners must be found: each once, in order
  /// of the rules.
  [[nodiscard]] const std::vector<std::string>& watched() const { return watched_; }
  [[nodiscard]] const std::vector<std::string>& written() const { return written_; }

  /// Whether this key is that of a meta tuple, as written() and write_tuple have it.
  [[nodiscard]] bool is_meta(std::string_view key) const;

  /// Before anything else: finds the next time of each rule that has one. deadline() is good then.
  /// @param away_since when an earlier life ended: times of day since then are made up for, by
  /// on_time() or when the condition is known
  void start(instant now, std::optional<instant> away_since = {});

  /// A tuple has a new value; for thresholds a number as std::from_chars reads it, the whole text,
  /// finite.
  [[nodiscard]] std::vector<write_tuple> on_value(std::string_view key, std::string_view text,
                                                  instant now);

  /// A tuple is there no more.
  void on_gone(std::string_view key);

  [[nodiscard]] std::vector<write_tuple> on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  /// The owner of `key` has become known, or is another one: repeats the word that stands, for it
  /// may never have reached an owner. @param is_back it is the one of before, which was gone:
  /// repeats only what waits, for a word may be a command
  [[nodiscard]] std::vector<write_tuple> on_owner(std::string_view key, instant now,
                                                  bool is_back = false);

  /// The owner of `key` is there no more, or has the tuple no more.
  void on_owner_gone(std::string_view key, instant now);

  /// The word that stands could not be written: no owner of `key` is known.
  void on_unowned(std::string_view key, instant now);

  /// What has become of the newest write to `key`. @param cause of what was not accepted
  void on_written(std::string_view key, write_end end, std::string_view cause, instant now);

  /// Lines for the event log, since the last call.
  [[nodiscard]] std::vector<std::string> take_notices() { return std::exchange(notices_, {}); }

  [[nodiscard]] const rules_counters& counters() const { return counters_; }
  /// In the order of the rules.
  [[nodiscard]] const std::vector<write_counters>& counters_of_rules() const { return ended_; }

private:
  enum class level : std::uint8_t { unknown, low, high };
  struct state {
    rule what;
    std::size_t number = 0; ///< in the constructor's list
    level is = level::unknown;
    level next = level::unknown; ///< what it becomes at `due`
    std::optional<instant> due;
    std::optional<instant> then_due; ///< of a rule with `after`: when `then` is written
    bool is_late = false;            ///< its time of day has passed while the rules were away
  };

  /// A word that is to be there.
  struct standing {
    enum class stage : std::uint8_t { waiting, asked, accepted, done };

    std::string word;
    std::size_t rule = 0; ///< who wrote it
    bool retry = true;
    stage is = stage::asked;
    instant since; ///< when it was first written
    instant accepted_at;
    bool rule_ended = false;           ///< the condition for it holds no more
    bool is_reported = false;          ///< that it waits
    duration pause{};                  ///< before it is written again,
    std::optional<instant> due;        ///< which is then
    std::optional<instant> report_due; ///< when it is reported that it waits
  };

  [[nodiscard]] level judge(const rule& x, std::string_view text);
  void report_unread(const rule& x, std::string_view text);
  void follow(state& x, std::string_view text, instant now);
  void make_up(state& x, instant previous, instant now);
  void on_time_of(state& x, instant now, std::vector<write_tuple>& out);
  void on_time_of(const std::string& key, standing& x, instant now, std::vector<write_tuple>& out);
  void enter(state& x, level next, instant now, std::vector<write_tuple>& out);
  void write_then(const state& x, instant now, std::vector<write_tuple>& out);
  void end_words_of(const state& x, const std::string& key);
  [[nodiscard]] std::string* read_from(std::string_view key);
  void write(const state& by, const std::string& to, const std::string& word, instant now,
             std::vector<write_tuple>& out);
  void replace(const std::string& key, const std::string& word);
  [[nodiscard]] standing* standing_at(std::string_view key);
  [[nodiscard]] bool take_outcome(std::string_view key, std::string_view text, instant now);
  void take_outcome(const std::string& key, standing& x, std::string_view outcome, instant now);
  void lose(const std::string& key, standing& x, std::string_view why);
  void again_later(standing& x, instant now);
  void notify(std::string what);

  std::vector<state> rules_;
  duration retry_{};
  std::vector<clock_change> clock_changes_;
  std::vector<std::string> watched_;
  std::vector<std::string> written_;
  std::vector<std::string> meta_;            ///< of them those of meta tuples
  std::map<std::string, standing> standing_; ///< by key, as in written_
  std::vector<write_counters> ended_;
  std::set<std::string> unread_; ///< keys reported because their texts are no numbers
  std::vector<std::string> notices_;
  std::vector<std::pair<std::string, std::string>> read_; ///< keys read `from`, newest texts
  rules_counters counters_;
};

} // namespace rubicon::proxy
