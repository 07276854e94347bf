// What an actor does about each message: a set of handlers, found by the number of the type.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "scheduler/messages/envelope.hpp"
#include "scheduler/messages/ref.hpp"

namespace rubicon::scheduler {

/// Handlers of any interface, as an actor keeps them.
class handler_set {
public:
  using handler = void (*)(void* set, envelope& x);
  using handler_table = std::vector<handler>; ///< by message_type::index; nullptr: not taken

  handler_set() = default;

  /// @returns whether it is a message that is taken; then it was handled
  bool handle(envelope& x) const {
    const auto what = table_ != nullptr ? (*table_)[x.type().index()] : nullptr;
    if (what != nullptr)
      what(set_.get(), x);
    return what != nullptr;
  }

  void clear() {
    table_ = nullptr;
    set_.reset();
  }

protected:
  handler_set(std::shared_ptr<void> set, const handler_table& table)
      : set_(std::move(set)), table_(&table) {}

private:
  std::shared_ptr<void> set_;
  const handler_table* table_ = nullptr;
};

/// One handler for each message of the interface, in any order: functions of the message that
/// return nothing. A message without one does not compile.
template <class Interface>
class behavior : public handler_set {
public:
  template <class... Handlers>
  behavior(Handlers... handlers) // NOLINT: a behaviour function returns them in braces
      : behavior(std::make_shared<overloaded<Handlers...>>(
                     overloaded<Handlers...>{std::move(handlers)...}),
                 typename Interface::messages{}) {}

private:
  template <class... Handlers>
  struct overloaded : Handlers... {
    using Handlers::operator()...;
  };

  template <class Set, class... Messages>
  behavior(std::shared_ptr<Set> set, message_list<Messages...>)
      : handler_set(std::move(set), table_of<Set, Messages...>()) {
    static_assert((std::is_invocable_v<Set&, Messages&> && ...),
                  "the actor has no handler for a message of its interface");
  }

  template <class Set, class... Messages>
  static const handler_table& table_of() {
    static const handler_table table = [] {
      handler_table by_type(message_type::count());
      ((by_type[type_of<Messages>::value.index()] =
            [](void* set, envelope& x) {
              (*static_cast<Set*>(set))(static_cast<carrier<Messages>&>(x).content);
            }),
       ...);
      return by_type;
    }();
    return table;
  }
};

} // namespace rubicon::scheduler
