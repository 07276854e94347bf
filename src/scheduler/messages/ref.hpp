// Handles of actors. Each names an interface, the list of the messages that such an actor takes:
// what is not in the list cannot be sent, and what is in it cannot be forgotten by the actor.
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>

#include <caf/abstract_actor.hpp>
#include <caf/actor_addr.hpp>
#include <caf/actor_control_block.hpp>

#include "core/hash.hpp"

namespace rubicon::scheduler {

class actor;

/// The actor of ours behind CAF's handle; nullptr: the handle is empty.
[[nodiscard]] actor* actor_at(const caf::strong_actor_ptr& x);

template <class... Messages>
struct message_list {
  template <class Message>
  static constexpr bool has = (std::is_same_v<Message, Messages> || ...);

  template <class... More>
  using and_also = message_list<Messages..., More...>;

  /// Whether all of them are in that list.
  template <class Other>
  static constexpr bool are_in = (Other::template has<Messages> && ...);
};

/// `struct lamp_interface : takes<switch_on, status_request> {};`
template <class... Messages>
struct takes {
  using messages = message_list<Messages...>;
};

/// The messages of another interface, and more.
template <class Base, class... Messages>
struct extends {
  using messages = typename Base::messages::template and_also<Messages...>;
};

template <class Interface, class Message>
inline constexpr bool accepts = Interface::messages::template has<std::remove_cvref_t<Message>>;

/// Whether who has the interface `Whole` can stand where `Part` is asked for.
template <class Whole, class Part>
inline constexpr bool covers = Part::messages::template are_in<typename Whole::messages>;

template <class Interface>
class behavior;

/// An actor with that interface; keeps it alive. `Interface` need not be complete before something
/// is sent. Inside a message it is part of no trace, because actors are numbered by chance.
template <class Interface>
class ref {
public:
  using interface = Interface;
  using behavior_type = behavior<Interface>;

  ref() = default;
  ref(std::nullptr_t) {} // NOLINT: an empty handle
  explicit ref(caf::strong_actor_ptr who) : who_(std::move(who)) {}

  template <class Other>
  requires(!std::is_same_v<Other, Interface> && covers<Other, Interface>) ref(const ref<Other>& x)
      : who_(x.strong()) {} // NOLINT: it takes all that is asked for

  explicit operator bool() const { return static_cast<bool>(who_); }
  [[nodiscard]] bool operator!() const { return !who_; }

  /// @pre it is not empty
  [[nodiscard]] actor& get() const;
  [[nodiscard]] const caf::strong_actor_ptr& strong() const { return who_; }
  [[nodiscard]] caf::actor_addr address() const {
    return who_ ? who_->address() : caf::actor_addr();
  }
  [[nodiscard]] caf::actor_id id() const { return who_ ? who_->id() : 0; }

  // as content of a message
  void fold_into(fold64&) const {}
  void print_to(std::string& out) const { out += who_ ? "actor" : "nobody"; }

  friend bool operator==(const ref& a, const ref& b) { return a.who_ == b.who_; }
  friend bool operator==(const ref& a, std::nullptr_t) { return !a.who_; }

private:
  caf::strong_actor_ptr who_;
};

} // namespace rubicon::scheduler
