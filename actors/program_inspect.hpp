// CAF's inspect for the variants in what programs in actors of their own and their motes tell each
// other.
#pragma once

#include <cstdint>
#include <type_traits>
#include <variant>

#include <caf/deserializer.hpp>
#include <caf/sec.hpp>
#include <caf/serializer.hpp>

#include "actors/inspect.hpp"
#include "communication/remote_messages.hpp"

namespace rubicon::communication::remote {

/// The alternative of that index, with default values. @returns false if there is none
template <class... Each>
bool become(std::variant<Each...>& x, std::uint8_t index) {
  std::uint8_t next = 0;
  return ((next++ == index ? (x = Each{}, true) : false) || ...);
}

/// Of commands and events: which alternative, and then the alternative itself.
template <class F, class... Each>
typename F::result_type inspect(F& f, std::variant<Each...>& x) {
  auto index = static_cast<std::uint8_t>(x.index());
  if constexpr (std::is_base_of_v<caf::deserializer, F>) {
    if (auto error = f(index))
      return error;
    if (!become(x, index))
      return caf::sec::unknown_type;
  } else if constexpr (std::is_base_of_v<caf::serializer, F>) {
    if (auto error = f(index))
      return error;
  }
  return std::visit([&f](auto& y) { return f(y); }, x);
}

} // namespace rubicon::communication::remote
