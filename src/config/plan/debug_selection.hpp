// Whose messages a debug log has (NFR-02).
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "config/plan/ecology.hpp"

namespace rubicon::config {

/// Patterns of actors' paths: a module, which is the first part of a path (`mote`), a path
/// (`mote/kitchen/stove`), or the beginning of several, up to a `/` (`mote/kitchen`). `*` means
/// all.
class debug_selection {
public:
  /// Of everybody.
  debug_selection() = default;
  /// @param patterns empty: of no actor
  explicit debug_selection(std::vector<std::string> patterns) : patterns_(std::move(patterns)) {}

  [[nodiscard]] bool has(std::string_view path) const;

  /// `mote/kitchen, gateway`; `nobody` or `everybody`
  [[nodiscard]] std::string text() const;

private:
  std::vector<std::string> patterns_{"*"};
};

/// Patterns in a text, between commas or blanks.
[[nodiscard]] std::vector<std::string> debug_patterns(std::string_view text);

inline constexpr std::size_t debug_patterns_max = 64;

/// The paths that the actors of an ecology have, as far as they are known before it runs.
class debug_names {
public:
  /// @param x with the motes of its islands, or without
  explicit debug_names(const ecology_description& x);

  /// @param name `kitchen/stove`
  void add_mote(const std::string& name);

  /// Why the pattern matches no actor, with a suggestion; empty: it may match one.
  [[nodiscard]] std::string problem(std::string_view pattern) const;

  /// The first problem among them; empty: there is none.
  [[nodiscard]] std::string problem(const std::vector<std::string>& patterns) const;

private:
  void add(std::string path);
  [[nodiscard]] std::vector<std::string> modules() const;

  std::set<std::string, std::less<>> paths_; ///< and all their beginnings
};

} // namespace rubicon::config
