// What of a proxy class may change while its proxies run (ACT-10).
#pragma once

#include <optional>
#include <string>

#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "proxy/classes/proxy_class.hpp"

namespace rubicon::proxy {

/// What is not set stays as it is.
struct class_change {
  std::string class_name;
  std::optional<duration> answer_timeout = {}; ///< these are as in proxy_settings
  std::optional<duration> retry_for = {};
  std::optional<duration> period = {};
  std::optional<duration> stale_after = {};
  std::optional<duration> inactive_after = {};
  std::optional<duration> retire_after = {};
  std::string field = {}; ///< whose next ones change; empty: they are not set
  std::optional<std::string> unit = {};
  std::optional<double> scale = {};
  std::optional<double> add = {};
  std::optional<int> decimals = {};
};
RUBICON_FIELDS(class_change, class_name, answer_timeout, retry_for, period, stale_after,
               inactive_after, retire_after, field, unit, scale, add, decimals);

/// @pre it is about this class, and the class has the field
void apply(const class_change& x, proxy_class& to);

/// `period 5 s, temperature in K`; empty if nothing is set.
[[nodiscard]] std::string to_text(const class_change& x);

} // namespace rubicon::proxy
