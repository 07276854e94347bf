// Takes outputs of a core apart in tests.
#pragma once

#include <variant>
#include <vector>

namespace rubicon::test {

/// The outputs of kind T, in order.
template <class T, class Variant>
[[nodiscard]] std::vector<T> pick(const std::vector<Variant>& outputs) {
  std::vector<T> picked;
  for (const auto& output : outputs) {
    if (const auto* x = std::get_if<T>(&output))
      picked.push_back(*x);
  }
  return picked;
}

} // namespace rubicon::test
