// The keys of what a file may say about a translation.
#pragma once

#include "core/describe/keys.hpp"
#include "translate/translation.hpp"

namespace rubicon::translate {

inline auto keys_of(const translation*) {
  return keys::of(
      keys::optional("decimals", &translation::decimals, keys::whole<int>{0, 6},
                     "digits after the point"),
      keys::optional("unit", &translation::unit, keys::text{16},
                     {"published as `TO.unit`", "none"}),
      keys::optional("history", &translation::history, keys::whole<std::size_t>{1, history_max},
                     {"number of newest values in the tuple `TO.history`, or `FROM.history` "
                      "without `to`: CSV, one line each, oldest first, with the time in seconds of "
                      "the ecology and up to 100 octets of the value",
                      "none"}));
}

} // namespace rubicon::translate
