// What only one may have: a name, an id.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <string_view>

#include "config/toml/problem.hpp"

namespace rubicon::config {

/// Remembers who had something, and complains about the one later in the file.
template <class T>
class claims {
public:
  /// @param what the thing as it is shown: island name `kitchen`
  /// @returns whether nobody had it
  bool claim(T thing, std::string_view what, mark at, complaints& problems,
             std::string_view how = "is already taken") {
    const auto [holder, fresh] = holders_.emplace(std::move(thing), at);
    if (fresh)
      return true;
    auto& first = holder->second;
    problems.add(std::max(first, at), std::string(what) + ' ' + std::string(how) + ' ' +
                                          place_text(std::min(first, at)));
    first = std::min(first, at);
    return false;
  }

private:
  std::map<T, mark> holders_;
};

/// A name as keys of tuples are compared: without letter case.
[[nodiscard]] std::string folded(std::string_view name);

/// Names that differ in letter case alone are one: they become parts of tuple keys (TUP-03).
class name_claims {
public:
  bool claim(std::string_view name, std::string_view kind, mark at, complaints& problems);

private:
  claims<std::string> names_;
};

} // namespace rubicon::config
