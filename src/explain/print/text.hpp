// The answers of `rubicon explain`, as text for people and as JSON.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "explain/traces.hpp"

namespace rubicon::explain {

/// What the record holds, and which messages and tuples can be asked for.
struct listing {
  bool lost_only = false;
  std::string from;       ///< `kitchen` or `kitchen/fan`: source of messages; empty: anybody
  std::size_t limit = 20; ///< the newest; 0: all
};

/// How text is laid out.
struct text_style {
  std::size_t width = 100; ///< at which paths are wrapped
  bool colour = false;
  std::size_t room = 10'000; ///< of a line in a list, where the rest is cut
};

/// The messages of a listing, oldest first.
[[nodiscard]] std::vector<std::size_t> selected(const traces& all, const listing& asked);

/// Why messages of a listing were lost or refused, and how many for each cause, the most frequent
/// first.
[[nodiscard]] std::vector<std::pair<std::string, std::size_t>> loss_causes(const traces& all,
                                                                           const listing& asked);

[[nodiscard]] std::string list_text(const traces& all, const listing& asked,
                                    const text_style& style);
[[nodiscard]] std::string list_json(const traces& all, const listing& asked);

/// The whole path of one message, and of what came of it.
[[nodiscard]] std::string message_text(const traces& all, std::size_t index,
                                       const text_style& style);
[[nodiscard]] std::string message_json(const traces& all, std::size_t index);

/// Where a value came from, and which subscribers received it.
[[nodiscard]] std::string tuple_text(const traces& all, std::size_t index, const text_style& style);
[[nodiscard]] std::string tuple_json(const traces& all, std::size_t index);

/// All values that a tuple has had, a line each.
[[nodiscard]] std::string values_text(const traces& all, const std::vector<std::size_t>& indices,
                                      std::size_t limit, const text_style& style);
[[nodiscard]] std::string values_json(const traces& all, const std::vector<std::size_t>& indices,
                                      std::size_t limit);

/// What somebody means by a name: a message `kitchen/climate-7#12` or `1/7#12`, or a tuple's key.
struct nothing_found {
  std::vector<std::string> known; ///< what is of that kind and could be meant
  bool is_ambiguous = false;      ///< a tuple that several peers have: `key@peer` is one
};
struct message_found {
  std::size_t index = 0;
};
struct tuples_found {
  std::vector<std::size_t> indices; ///< of all values, oldest first; at least one
};
[[nodiscard]] std::variant<nothing_found, message_found, tuples_found> find(const traces& all,
                                                                            std::string_view name);

/// The value at a time; nothing if there was none yet. @pre `indices` are of one tuples_found
[[nodiscard]] std::optional<std::size_t>
value_at(const traces& all, const std::vector<std::size_t>& indices, instant when);

} // namespace rubicon::explain
