// The keys of what a file may say about a component of a host.
#pragma once

#include "core/describe/keys.hpp"
#include "peisinit/component.hpp"

namespace rubicon::peisinit {

inline auto keys_of(const component*) {
  return keys::of(
      keys::optional("state", &component::on, keys::word<bool>{{{"on", true}, {"off", false}}},
                     "whether it starts with its init"),
      keys::optional("delay", &component::delay, keys::time_span{100ms, 1h},
                     "from an unrequested end to the next start"),
      keys::optional("semantics", &component::semantics, keys::text{1000},
                     {"its abilities, for planners; published as a tuple", "none"}),
      keys::optional("proxy", &component::proxy, keys::text{1000},
                     {"the object that it is a proxy of; published as a tuple", "none"}),
      keys::optional("arguments", &component::arguments, keys::text{1000},
                     {"extra arguments of a command", "none"}));
}

} // namespace rubicon::peisinit
