// From what some tuples say to other tuples, and what they have said before (SVC-09).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "translate/translation.hpp"

namespace rubicon::translate {

/// Set this own tuple.
struct publish {
  std::string key;
  std::string text;

  friend bool operator==(const publish&, const publish&) = default;
};

/// Delete this own tuple.
struct erase {
  std::string key;

  friend bool operator==(const erase&, const erase&) = default;
};

struct translator_counters {
  std::uint64_t translated = 0;
  std::uint64_t bad_values = 0;  ///< no numbers, or no finite result: dropped
  std::uint64_t long_values = 0; ///< texts of more than text_max octets: dropped
  std::uint64_t bad_keys = 0;    ///< targets over the limits of keys: dropped
  std::uint64_t refused = 0;     ///< beyond targets_max: dropped
  std::uint64_t own_tuples = 0;  ///< what it has published itself: ignored
};
RUBICON_FIELDS(translator_counters, translated, bad_values, long_values, bad_keys, refused,
               own_tuples);

/// Each rule whose pattern matches publishes a tuple of its own for a value. A value that comes
/// from a tuple that it has set itself is ignored, so that no rule feeds itself or another one.
///
/// KEY.history, of the tuple that is published, or of the one that is watched if the rule publishes
/// none, has a line for each of the newest values, oldest first: `12.004160,22.3`, the time of its
/// arrival in seconds; a text as RFC 4180 quotes it, in which control characters are blanks.
class translator {
public:
  using output = std::variant<publish, erase>;
  using outputs = std::vector<output>;

  static constexpr std::size_t targets_max = 1000;     ///< tuples published, each with its history
  static constexpr std::size_t text_max = 1000;        ///< octets of a text that is passed on
  static constexpr std::size_t history_text_max = 100; ///< octets of one in a history; cut

  explicit translator(std::vector<translation> rules = {});

  /// Keys to subscribe to with any owner, each once, in order of the rules.
  [[nodiscard]] const std::vector<std::string>& watched() const { return watched_; }

  /// @param own the tuple's owner is who publishes the translations
  [[nodiscard]] outputs on_value(std::string_view key, std::string_view text, bool own,
                                 instant now);

  /// A tuple is there no more: nor is what was made of it. Histories stay.
  [[nodiscard]] outputs on_gone(std::string_view key, bool own);

  [[nodiscard]] const translator_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t targets() const { return targets_.size(); }

private:
  struct target {
    std::string source;        ///< key of the newest value
    bool is_published = false; ///< the tuple is there
    std::deque<std::string> lines;
  };

  [[nodiscard]] bool is_ours(std::string_view key) const;
  [[nodiscard]] target* target_at(const std::string& key);
  void publish_result(const translation& rule, const std::string& base, std::string_view key,
                      std::string_view text, instant now, outputs& out);

  std::vector<translation> rules_;
  std::vector<std::string> watched_;
  std::map<std::string, target> targets_; ///< by folded key
  translator_counters counters_;
};

} // namespace rubicon::translate
