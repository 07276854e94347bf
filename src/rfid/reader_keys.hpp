// The keys of what a file may say about a reader of tags.
#pragma once

#include "core/describe/keys.hpp"
#include "rfid/reader_config.hpp"

namespace rubicon::rfid {

inline auto keys_of(const reader_config*) {
  return keys::of(
      keys::optional("name", &reader_config::name, keys::name_text{},
                     {"of the interface; no two readers have the same", "that of the peer"}),
      keys::required("position_m", &reader_config::place, keys::place{}, "of its antenna"),
      keys::optional("range", &reader_config::range_m, keys::metres{0.05, 100},
                     "tags farther away are not perceived"),
      keys::optional("period", &reader_config::period, keys::time_span{10ms, 1h},
                     "between two inventories"),
      keys::optional("miss_rate", &reader_config::miss_rate, keys::ratio{},
                     "probability that an inventory misses a tag in range"),
      keys::optional(
          "missed_max", &reader_config::missed_max, keys::whole<unsigned>{1, 1000},
          "number of consecutive inventories without a tag until it is considered gone"));
}

} // namespace rubicon::rfid
