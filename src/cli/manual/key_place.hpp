// Where keys of a file may stand, and which of them are meant by a part of their path.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/toml/schema.hpp"

namespace rubicon::cli {

/// A part of a path.
struct key_step {
  std::string name;     ///< NAME: any
  config::part part{};  ///< of what stands behind it
  std::string choice{}; ///< that its table must have: `app = "sampler"`; empty: none
};

/// One place of a key.
struct key_place {
  std::vector<key_step> steps; ///< the last one is the key
  const config::key_description* key = nullptr;
  std::string title; ///< of its table

  /// `island.duty_cycle.period`
  [[nodiscard]] std::string path() const;
};

/// All keys of a file, in its order. @pre `file` lives longer
[[nodiscard]] std::vector<key_place> all_places(const config::table_description& file);

/// The places whose path is, or ends with, these parts between dots; * stands for one or more
/// parts. A whole path wins over one in which NAME is a name, and that over ends of others.
/// Brackets of headers do not count.
[[nodiscard]] std::vector<key_place> places_of(const std::vector<key_place>& all,
                                               std::string_view wanted);

/// Up to three keys that are nearest to one that does not exist.
[[nodiscard]] std::vector<std::string> nearest_keys(const std::vector<key_place>& all,
                                                    std::string_view wanted);

} // namespace rubicon::cli
