// The smallest control program: from what a tuple says, and for how long, to other tuples.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "proxy/rules_config.hpp"

namespace rubicon::proxy {

/// Write the word to the key, at the key's owner.
struct write_tuple {
  std::string key;
  std::string word;
  bool again = false; ///< since the last time it was written it has failed
  bool meta = false;  ///< as in rule_write

  friend bool operator==(const write_tuple&, const write_tuple&) = default;
};

struct rules_counters {
  std::uint64_t values = 0;     ///< numbers that a rule watches
  std::uint64_t bad_values = 0; ///< texts that are no number: dropped
  std::uint64_t unwatched = 0;  ///< keys that no rule watches: dropped
  std::uint64_t writes = 0;
  std::uint64_t repeats = 0; ///< of them those because one before had failed
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
/// a tuple that nobody has is not written.
///
/// Where a proxy tells by `KEY.outcome` that what was written to KEY has failed, is unreachable or
/// timed out, the word that stands is written again: after `retry`, then after twice that, up to
/// retry_max.
class rules {
public:
  static constexpr duration retry_max = 1min;

  /// @param retry 0: nothing is written again
  explicit rules(std::vector<rule> list = {}, duration retry = 5s);

  /// Keys to subscribe to with any owner, and keys whose owners must be found: each once, in order
  /// of the rules.
  [[nodiscard]] const std::vector<std::string>& watched() const { return watched_; }
  [[nodiscard]] const std::vector<std::string>& written() const { return written_; }

  /// Whether this key is that of a meta tuple, as written() and write_tuple have it.
  [[nodiscard]] bool is_meta(std::string_view key) const;

  /// Before anything else: finds the next time of each rule that has one. deadline() is good then.
  void start(instant now);

  /// A tuple has a new value; for thresholds a number as std::from_chars reads it, the whole text,
  /// finite.
  [[nodiscard]] std::vector<write_tuple> on_value(std::string_view key, std::string_view text,
                                                  instant now);

  /// A tuple is there no more.
  void on_gone(std::string_view key);

  [[nodiscard]] std::vector<write_tuple> on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  /// The owner of `key` has become known, or is another one: repeats the word that stands, for it
  /// may never have reached an owner.
  [[nodiscard]] std::vector<write_tuple> on_owner(std::string_view key, instant now);

  [[nodiscard]] const rules_counters& counters() const { return counters_; }

private:
  enum class level : std::uint8_t { unknown, low, high };
  struct state {
    rule what;
    level is = level::unknown;
    level next = level::unknown; ///< what it becomes at `due`
    std::optional<instant> due;
    std::optional<instant> then_due; ///< of a rule with `after`: when `then` is written
  };

  [[nodiscard]] level judge(const rule& x, std::string_view text);
  void follow(state& x, std::string_view text, instant now);
  void on_time_of(state& x, instant now, std::vector<write_tuple>& out);
  void enter(state& x, level next, instant now, std::vector<write_tuple>& out);
  void write_then(const rule& x, std::vector<write_tuple>& out);
  [[nodiscard]] std::string* read_from(std::string_view key);
  void write(const std::string& to, const std::string& word, std::vector<write_tuple>& out);
  [[nodiscard]] bool take_outcome(std::string_view key, std::string_view text, instant now);

  /// A word that is to be there.
  struct standing {
    std::string word;
    duration pause{};           ///< before it is written again,
    std::optional<instant> due; ///< which is then
  };

  std::vector<state> rules_;
  duration retry_{};
  std::vector<std::string> watched_;
  std::vector<std::string> written_;
  std::vector<std::string> meta_;                         ///< of them those of meta tuples
  std::map<std::string, standing> standing_;              ///< by key, as in written_
  std::vector<std::pair<std::string, std::string>> read_; ///< keys read `from`, newest texts
  rules_counters counters_;
};

} // namespace rubicon::proxy
