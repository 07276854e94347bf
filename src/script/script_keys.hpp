// The keys of what a file may say about programs in Lua.
#pragma once

#include "core/describe/keys.hpp"
#include "script/source.hpp"

namespace rubicon::script {

inline auto keys_of(const limits*) {
  return keys::of(
      keys::optional("memory", &limits::memory, keys::whole<std::uint32_t>{4096, 1 << 24},
                     "octets of its heap above that of an empty script; a script that needs more "
                     "ends with an error"),
      keys::optional("instructions", &limits::instructions,
                     keys::whole<std::uint32_t>{1000, 1'000'000'000},
                     "of the Lua machine in one event; a script that needs more ends with an "
                     "error"));
}

} // namespace rubicon::script
