// What only one may have: a name, an id.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <string_view>

#include "config/toml/problem.hpp"

namespace rubicon::config {

/// Values that must differ. Of two equal ones that later in the file is a problem.
template <class T>
class uniqueness {
public:
  /// @param what the value as messages have it: island name `kitchen`
  /// @returns whether it is the first of its kind
  bool add(T value, std::string_view what, mark at, complaints& problems,
           std::string_view how = "is already taken") {
    const auto [found, is_first] = places_.emplace(std::move(value), at);
    if (is_first)
      return true;
    auto& first = found->second;
    problems.add(std::max(first, at), std::string(what) + ' ' + std::string(how) + ' ' +
                                          place_text(std::min(first, at)));
    first = std::min(first, at);
    return false;
  }

private:
  std::map<T, mark> places_;
};

/// A name as keys of tuples are compared: without letter case.
[[nodiscard]] std::string folded(std::string_view name);

/// Names that differ in letter case alone are one: they become parts of tuple keys (TUP-03).
class name_uniqueness {
public:
  bool add(std::string_view name, std::string_view kind, mark at, complaints& problems);

private:
  uniqueness<std::string> names_;
};

} // namespace rubicon::config
