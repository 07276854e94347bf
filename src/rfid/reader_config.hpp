// What a reader of tags is like.
#pragma once

#include <string>

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::rfid {

struct reader_config {
  std::string name; ///< of the interface, one in its ecology
  position place;
  double range_m = 1;
  duration period = 500ms;  ///< between two inventories
  double miss_rate = 0;     ///< chance that an inventory misses a tag in range
  unsigned missed_max = 2;  ///< inventories without a tag until it is taken for gone
  double rssi_1m_dbm = -50; ///< of a tag at 1 m,
  double exponent = 2;      ///< falling with distance so
  double rssi_step_db = 1;  ///< a smaller change is not published
};

} // namespace rubicon::rfid
