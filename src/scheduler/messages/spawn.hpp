// Spawning an actor at its place in the ecology.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include <caf/actor_config.hpp>
#include <caf/actor_system.hpp>
#include <caf/make_actor.hpp>

#include "scheduler/actor.hpp"

namespace rubicon::scheduler {

enum class spawn_option : std::uint8_t {
  none,
  monitored, ///< by whoever spawns it
};
inline constexpr auto monitored = spawn_option::monitored;

/// The actor that a behaviour function begins: `Handle::behavior_type f(actor_pointer<State,
/// Handle> self, ...)`, or such a lambda.
template <class Fun>
struct begun_by : begun_by<decltype(&Fun::operator())> {};
template <class State, class Interface, class... More>
struct begun_by<behavior<Interface> (*)(shell<State, Interface>*, More...)> {
  using type = shell<State, Interface>;
};
template <class Fun, class State, class Interface, class... More>
struct begun_by<behavior<Interface> (Fun::*)(shell<State, Interface>*, More...) const> {
  using type = shell<State, Interface>;
};

/// A behaviour function with what it is given besides its actor.
template <class Shell, class Fun, class... Args>
class bound_beginning final : public Shell::beginning {
public:
  template <class... Given>
  explicit bound_beginning(Fun fun, Given&&... args)
      : fun_(std::move(fun)), args_(std::forward<Given>(args)...) {}

  typename Shell::behavior_type begin(Shell* self) override {
    return std::apply([this, self](Args&... each) { return fun_(self, std::move(each)...); },
                      args_);
  }

private:
  Fun fun_;
  std::tuple<Args...> args_;
};

/// Gives an actor its path, its process and the recorder of its system.
void place(actor& who, std::string path, process& where);

[[nodiscard]] caf::execution_unit* unit_of(process& x);

/// Makes one with its path and its recorder, but does not let it begin: launch() does.
template <class Fun, class... Args>
auto make_at(caf::actor_system& system, process& where, std::string path, Fun fun, Args&&... args) {
  using its_shell = typename begun_by<Fun>::type;
  using its_beginning = bound_beginning<its_shell, Fun, std::decay_t<Args>...>;
  caf::actor_config config;
  config.host = unit_of(where);
  auto made = caf::make_actor<its_shell, caf::strong_actor_ptr>(
      system.next_actor_id(), system.node(), &system, config,
      std::make_unique<its_beginning>(std::move(fun), std::forward<Args>(args)...));
  place(*actor_at(made), std::move(path), where);
  return typename its_shell::handle_type(std::move(made));
}

/// Spawns from inside a handler, for a supervisor: `spawn_in<monitored>(process, self, path, fun,
/// ...)`. The child cannot run before the handler returns, so no message escapes the trace.
template <spawn_option Option = spawn_option::none, class Fun, class... Args>
auto spawn_in(process& where, actor* self, std::string path, Fun fun, Args&&... args) {
  auto made =
      make_at(self->system(), where, std::move(path), std::move(fun), std::forward<Args>(args)...);
  if constexpr (Option == spawn_option::monitored)
    self->monitor(made);
  made.get().launch(nullptr, false, false);
  return made;
}

/// The same in the process of `self`.
template <spawn_option Option = spawn_option::none, class Fun, class... Args>
auto spawn_at(actor* self, std::string path, Fun fun, Args&&... args) {
  return spawn_in<Option>(*self->where(), self, std::move(path), std::move(fun),
                          std::forward<Args>(args)...);
}

} // namespace rubicon::scheduler
