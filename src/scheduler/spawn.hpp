// Spawning an actor at its place in the ecology.
#pragma once

#include <string>
#include <type_traits>
#include <utility>

#include <caf/abstract_actor.hpp>
#include <caf/actor_cast.hpp>
#include <caf/infer_handle.hpp>
#include <caf/local_actor.hpp>
#include <caf/spawn_options.hpp>
#include <caf/stateful_actor.hpp>

#include "scheduler/trace.hpp"

namespace rubicon::scheduler {

/// Whether CAF would initialise the first member of an actor's state from the pointer to the actor,
/// as C++20 lets it: a handle would be the actor's own, a bool would be true.
template <class Impl>
struct has_treacherous_state : std::false_type {};

template <class State, class Base>
struct has_treacherous_state<caf::stateful_actor<State, Base>>
    : std::bool_constant<std::is_aggregate_v<State> &&
                         std::is_constructible_v<State, caf::stateful_actor<State, Base>*>> {};

template <class Fun>
constexpr void check_state() {
  static_assert(!has_treacherous_state<caf::infer_impl_from_fun_t<Fun>>::value,
                "the actor's state needs a default constructor of its own, `state() = default;`");
}

/// Gives a traced actor its path, its process and the recorder of its system; does nothing to other
/// actors.
void place(caf::abstract_actor& who, std::string path, process& where);

/// That of an actor; the supervisor's if it was placed in none.
[[nodiscard]] process& process_of(caf::abstract_actor& who);

/// Spawns from inside a handler, for a supervisor: `spawn_in<caf::monitored>(process, self, path,
/// fun, ...)`. The child cannot run before the handler returns, so no message escapes the trace.
template <caf::spawn_options Options = caf::no_spawn_options, class Self, class Fun, class... Args>
auto spawn_in(process& where, Self* self, std::string path, Fun fun, Args&&... args) {
  check_state<Fun>();
  auto handle = self->template spawn<Options>(std::move(fun), std::forward<Args>(args)...);
  place(*caf::actor_cast<caf::abstract_actor*>(handle), std::move(path), where);
  return handle;
}

/// The same in the process of `self`.
template <caf::spawn_options Options = caf::no_spawn_options, class Self, class Fun, class... Args>
auto spawn_at(Self* self, std::string path, Fun fun, Args&&... args) {
  return spawn_in<Options>(process_of(*self), self, std::move(path), std::move(fun),
                           std::forward<Args>(args)...);
}

} // namespace rubicon::scheduler
