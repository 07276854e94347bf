#include "core/account/loss.hpp"

#include <array>

namespace rubicon {

namespace {

struct description {
  std::string_view name;
  std::string_view meaning;
};

constexpr std::array<description, loss_count> descriptions{{
#define RUBICON_LOSS_ENTRY(name, meaning) {#name, meaning},
    RUBICON_LOSSES(RUBICON_LOSS_ENTRY)
#undef RUBICON_LOSS_ENTRY
}};

} // namespace

std::string_view to_string(loss x) {
  return descriptions.at(static_cast<std::size_t>(x)).name;
}

std::string_view meaning_of(loss x) {
  return descriptions.at(static_cast<std::size_t>(x)).meaning;
}

std::optional<loss> parse_loss(std::string_view name) {
  for (std::size_t i = 0; i < loss_count; ++i)
    if (descriptions.at(i).name == name)
      return static_cast<loss>(i);
  return std::nullopt;
}

} // namespace rubicon
