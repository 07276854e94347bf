// What CAF can ask of its clock, as values.
#pragma once

#include <compare>
#include <cstdint>
#include <variant>

#include <caf/abstract_actor.hpp>
#include <caf/actor_control_block.hpp>
#include <caf/group.hpp>
#include <caf/intrusive_ptr.hpp>
#include <caf/mailbox_element.hpp>
#include <caf/message.hpp>
#include <caf/message_id.hpp>
#include <caf/resumable.hpp>

#include "core/provenance.hpp"
#include "core/time.hpp"

namespace rubicon::scheduler {

/// A delayed message to an actor.
struct actor_message {
  caf::strong_actor_ptr receiver;
  caf::mailbox_element_ptr content;
  std::uint64_t number = 0; ///< of a message that may be moved; 0: it may not
  provenance from = {};
};

/// A delayed message to the members of a group.
struct group_message {
  caf::group target;
  caf::strong_actor_ptr sender;
  caf::message content;
};

enum class timeout_kind : std::uint8_t {
  ordinary, ///< one per actor and type
  multi,    ///< any number per actor and type
  request,  ///< the answer to a request is overdue
};

/// Which timeout, for cancelling it.
struct timeout_key {
  caf::actor_id actor = 0;
  timeout_kind kind = timeout_kind::ordinary;
  std::uint64_t what = 0; ///< type of a receive timeout, or the number of a request

  friend auto operator<=>(const timeout_key&, const timeout_key&) = default;
};

/// A timeout that CAF may cancel.
struct actor_timeout {
  caf::strong_actor_ptr self;
  timeout_key key;
  std::uint64_t id = 0;  ///< of a receive timeout
  caf::message_id mid{}; ///< of a request's answer
};

/// An actor that was spawned for another process, and has not had its first turn.
class first_turn {
public:
  /// @param what comes with one reference count
  explicit first_turn(caf::resumable* what) : what_(what, false) {}

  /// With the reference count.
  [[nodiscard]] caf::resumable* take() { return what_.release(); }

private:
  caf::intrusive_ptr<caf::resumable> what_;
};

using timeout = std::variant<actor_message, actor_timeout, group_message, first_turn>;

// What another thread may ask of the clock.
struct add_timeout {
  instant due;
  timeout what;
};

struct cancel_timeout {
  timeout_key key;
};

struct cancel_actor {
  caf::actor_id actor;
};

struct cancel_everything {};

} // namespace rubicon::scheduler
