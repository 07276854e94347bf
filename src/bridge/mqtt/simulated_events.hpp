// What happens at a simulated broker, as a file says.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "core/time.hpp"

namespace rubicon::bridge {

/// What a broker has after it has ended and begun again.
enum class kept_messages : std::uint8_t { none, retained };

struct broker_restart {
  kept_messages keeps = kept_messages::none;
  duration at{};
};

/// By another client of the broker.
struct other_publication {
  std::string topic;
  std::string payload;
  bool retain = false;
  duration at{};
};

using simulated_event = std::variant<broker_restart, other_publication>;

[[nodiscard]] inline duration time_of(const simulated_event& x) {
  return std::visit([](const auto& each) { return each.at; }, x);
}

} // namespace rubicon::bridge
