// How many messages of a broker a bridge reads.
#pragma once

#include <cstddef>

#include "bridge/table/per_second_limit.hpp"
#include "core/time.hpp"

namespace rubicon::bridge {

class flood_limit {
public:
  static constexpr std::size_t received_max = 1000;   ///< in a second, without retained ones;
                                                      ///< later ones wait for the next second
  static constexpr std::size_t retained_max = 50'000; ///< after a connection

  void on_connected() { retained_ = 0; }

  /// When messages without retained ones are accepted again.
  [[nodiscard]] instant next() const { return received_.next(); }

  /// Another message has come. @returns whether it is within the limits
  [[nodiscard]] bool accepts(bool retained, instant now) {
    if (retained)
      return retained_ < retained_max && ++retained_ > 0;
    return received_.accepts(now);
  }

private:
  per_second_limit received_{received_max};
  std::size_t retained_ = 0;
};

} // namespace rubicon::bridge
