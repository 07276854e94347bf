// What a bridge beside a simulated server does at one instant.
#pragma once

#include <deque>
#include <iterator>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/component.hpp"

namespace rubicon::bridge {

/// Performs what a bridge wants, and what it wants when the server has answered, in this order.
/// @param Output a variant with components::publish and components::write, which go to the kernel
/// @param answer what each of the others makes the bridge want
template <class Output, class Answer>
[[nodiscard]] components::outputs follow_up(std::vector<Output> todo, const Answer& answer) {
  components::outputs out;
  std::deque<Output> waiting(std::make_move_iterator(todo.begin()),
                             std::make_move_iterator(todo.end()));
  while (!waiting.empty()) {
    auto next = std::move(waiting.front());
    waiting.pop_front();
    std::visit(
        [&](auto& x) {
          using kind = std::remove_cvref_t<decltype(x)>;
          if constexpr (std::is_same_v<kind, components::publish> ||
                        std::is_same_v<kind, components::write>)
            out.emplace_back(std::move(x));
          else
            for (auto& more : answer(x))
              waiting.push_back(std::move(more));
        },
        next);
  }
  return out;
}

/// @returns both, in this order
[[nodiscard]] inline components::outputs joined(components::outputs first,
                                                components::outputs second) {
  first.insert(first.end(), std::make_move_iterator(second.begin()),
               std::make_move_iterator(second.end()));
  return first;
}

} // namespace rubicon::bridge
