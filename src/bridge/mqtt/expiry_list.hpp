// Names, each with the time at which something is due for it.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace rubicon::bridge {

/// Costs nothing until a name is due, however many there are.
class expiry_list {
public:
  static constexpr std::size_t names_max = 10'000;

  /// A name that is in the list keeps its time.
  /// @returns whether it is in the list: there may be no room
  bool add(const std::string& name, instant due);
  void erase(const std::string& name) { names_.erase(name); }

  /// Those that are due, which are not in the list any more.
  [[nodiscard]] std::vector<std::string> take(instant now);
  /// When to take; may be too early.
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] const std::map<std::string, instant>& names() const { return names_; }

private:
  std::map<std::string, instant> names_;
  instant earliest_{}; ///< none is due before, if there are any
};

} // namespace rubicon::bridge
