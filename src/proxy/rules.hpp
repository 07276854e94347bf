// The smallest control program: thresholds with hysteresis from one tuple to another.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.hpp"

namespace rubicon::proxy {

/// When a tuple passes a threshold, writes another. A threshold that is not given is the same as
/// the other one; with neither the rule never writes. @pre below <= above if both are given
struct rule {
  std::string when;            ///< key watched, whoever owns it; keys have no letter case (TUP-03)
  std::optional<double> above; ///< at or above this: write `then`
  std::optional<double> below; ///< below this: write `otherwise`
  std::string write;           ///< key to write at its owner
  std::string then;            ///< empty: nothing is written
  std::string otherwise;       ///< empty: nothing is written
};

/// Write the word to the key, at the key's owner.
struct write_tuple {
  std::string key;
  std::string word;

  friend bool operator==(const write_tuple&, const write_tuple&) = default;
};

struct rules_counters {
  std::uint64_t values = 0;     ///< numbers that a rule watches
  std::uint64_t bad_values = 0; ///< texts that are no number: dropped
  std::uint64_t unwatched = 0;  ///< keys that no rule watches: dropped
  std::uint64_t writes = 0;
};

/// Each rule is a Schmitt trigger and writes only on a crossing:
///
///   unknown --at or above `above`--> high (writes then)
///   unknown --below `below`--------> low  (writes otherwise)
///   high --below `below`--> low           low --at or above `above`--> high
///
/// Between `below` (inclusive) and `above` (exclusive) a rule stays what it is.
class rules {
public:
  explicit rules(std::vector<rule> list = {});

  /// Keys to subscribe to with any owner, and keys whose owners must be found: each once, in order
  /// of the rules.
  [[nodiscard]] const std::vector<std::string>& watched() const { return watched_; }
  [[nodiscard]] const std::vector<std::string>& written() const { return written_; }

  /// A tuple has a new value: a number as std::from_chars reads it, the whole text, finite.
  [[nodiscard]] std::vector<write_tuple> on_value(std::string_view key, std::string_view text,
                                                  instant now);

  /// The owner of `key` has become known, or is another one: repeats the word that stands, for it
  /// may never have reached an owner.
  [[nodiscard]] std::vector<write_tuple> on_owner(std::string_view key, instant now);

  [[nodiscard]] const rules_counters& counters() const { return counters_; }

private:
  enum class level : std::uint8_t { unknown, low, high };
  struct state {
    rule what;
    level is = level::unknown;
  };

  void enter(state& x, level next, std::vector<write_tuple>& out);

  std::vector<state> rules_;
  std::vector<std::string> watched_;
  std::vector<std::string> written_;
  std::map<std::string, std::string> standing_; ///< key as in written_ -> word to be there
  rules_counters counters_;
};

} // namespace rubicon::proxy
