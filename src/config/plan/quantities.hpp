// What motes may measure: the quantities that every file knows, and those that a file adds.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "device/transducer_config.hpp"

namespace rubicon::config {

class quantities {
public:
  /// Own ones that a file may have: a descriptor has a bit for each quantity (DIS-09).
  static constexpr std::size_t own_max = device::quantities_max - device::first_own_quantity;

  struct entry {
    std::string name;
    std::string meaning; ///< what it is measured in
    std::string unit;    ///< as tuples publish it; empty: none
  };

  quantities();

  /// The next own one. @pre there are less than own_max
  void add(std::string name, std::string unit);

  /// In the order of their numbers, the signal strength among them.
  [[nodiscard]] const std::deque<entry>& all() const { return all_; }

  /// How a file calls it. @pre it is one of these, as in the next one
  [[nodiscard]] const std::string& word_of(device::quantity x) const;
  [[nodiscard]] const std::string& unit_of(device::quantity x) const;

private:
  std::deque<entry> all_; ///< names stay where they are
};

} // namespace rubicon::config
