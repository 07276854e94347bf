// What of a proxy class may change while its proxies run (ACT-10).
#pragma once

#include <string>

#include "core/describe/changes.hpp"
#include "core/describe/fields.hpp"
#include "proxy/classes/proxy_class.hpp"

namespace rubicon::proxy {

/// Keys that the lists in class_keys.hpp call changeable.
struct class_change {
  std::string class_name;
  keys::key_changes settings = {};       ///< of its proxy_settings
  std::string field = {};                ///< whose keys change; empty: no field's
  keys::key_changes field_settings = {}; ///< of that field
};
RUBICON_FIELDS(class_change, class_name, settings, field, field_settings);

/// @pre it is about this class, and the class has the field
void apply(const class_change& x, proxy_class& to);

/// `period 5 s, unit of temperature K`; empty if nothing changes.
[[nodiscard]] std::string to_text(const class_change& x);

} // namespace rubicon::proxy
