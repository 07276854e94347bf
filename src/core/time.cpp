#include "core/time.hpp"

#include <array>
#include <cstdio>

namespace rubicon {

std::string to_text(instant x) {
  const auto microseconds =
      std::chrono::duration_cast<std::chrono::microseconds>(x.time_since_epoch()).count();
  std::array<char, 40> text{};
  const auto length = std::snprintf(text.data(), text.size(), "%lld.%06lld",
                                    static_cast<long long>(microseconds / 1'000'000),
                                    static_cast<long long>(microseconds % 1'000'000));
  return {text.data(), static_cast<std::size_t>(length)};
}

std::string to_text(duration x) {
  struct unit {
    duration length;
    const char* name;
  };
  static constexpr std::array<unit, 6> units{
      {{24h, "d"}, {1h, "h"}, {1min, "min"}, {1s, "s"}, {1ms, "ms"}, {1us, "us"}}};
  for (const auto& [length, name] : units) {
    if (x < length)
      continue;
    std::array<char, 40> text{};
    const auto size =
        std::snprintf(text.data(), text.size(), "%.4g %s",
                      static_cast<double>(x.count()) / static_cast<double>(length.count()), name);
    return {text.data(), static_cast<std::size_t>(size)};
  }
  return std::to_string(x.count()) + " ns";
}

} // namespace rubicon
