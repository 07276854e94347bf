// An actor of ours. CAF counts references to it, notifies its monitors of its end and ends it by
// exit messages; messages, the mailbox and turns are the scheduler's.
//
// What happens when a handler, or the behaviour function itself, throws: the exception becomes an
// error (failure_of, or what set_exception_handler() makes of it), the actor ends with that as its
// reason, its state is destroyed and what is in its mailbox is dropped. Whoever monitors it gets
// one down_msg{source, reason}. The reason of an actor that quits in good order is the empty error,
// or an exit_reason. So a supervisor sets a down handler, spawns with `spawn_at<monitored>`, and
// finds the failed child by `handle.address() == down.source`; it may spawn the next at the same
// path from inside the down handler.
#pragma once

#include <cassert>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <caf/error.hpp>
#include <caf/exit_reason.hpp>
#include <caf/local_actor.hpp>
#include <caf/system_messages.hpp>

#include "core/time.hpp"
#include "scheduler/messages/behavior.hpp"
#include "scheduler/messages/envelope.hpp"
#include "scheduler/messages/ref.hpp"
#include "scheduler/trace.hpp"

namespace rubicon::scheduler {

/// sec::runtime_error with the exception's text, which `caf::to_string(reason)` of whoever gets the
/// down_msg shows.
[[nodiscard]] caf::error failure_of(const std::exception_ptr& x);

/// First in, first out; owns what is in it. Bounded by what others send: cores bound their queues,
/// and bulk senders wait for an answer.
class mailbox {
public:
  mailbox() = default;
  ~mailbox() { clear(); }
  mailbox(const mailbox&) = delete;
  mailbox& operator=(const mailbox&) = delete;

  [[nodiscard]] bool empty() const { return first_ == nullptr; }

  void push(envelope_ptr x) {
    auto* const added = x.release();
    (first_ == nullptr ? first_ : last_->next) = added;
    last_ = added;
  }

  /// @pre !empty()
  [[nodiscard]] envelope_ptr pop() {
    envelope_ptr x(first_);
    first_ = std::exchange(x->next, nullptr);
    return x;
  }

  void clear() {
    while (!empty())
      pop().reset();
  }

private:
  envelope* first_ = nullptr;
  envelope* last_ = nullptr; ///< if there is a first
};

template <class Interface, class Message>
[[nodiscard]] envelope_ptr envelope_for(Message&& x) {
  static_assert(accepts<Interface, Message>, "such an actor does not take that message");
  return make_envelope(std::forward<Message>(x));
}

/// The part of every actor that does not depend on its kind. All of it belongs to the thread that
/// executes its process; deliver() may be called by any.
class actor : public caf::local_actor, public traced_base {
public:
  using down_handler = std::function<void(const caf::down_msg&)>;
  using exit_handler = std::function<void(const caf::exit_msg&)>;
  using exception_handler = std::function<caf::error(std::exception_ptr&)>;

  enum class turn_result : std::uint8_t { waits, has_more, ended };

  explicit actor(caf::actor_config& config) : local_actor(config) {}

  // -- what handlers call

  template <class Interface, class Message>
  void send(const ref<Interface>& to, Message&& x) {
    if (to)
      to.get().deliver(envelope_for<Interface>(std::forward<Message>(x)), this);
  }

  /// At that time, or now if it is past.
  template <class Interface, class Message>
  void scheduled_send(const ref<Interface>& to, instant due, Message&& x) {
    if (to)
      send_at(due, to.strong(), envelope_for<Interface>(std::forward<Message>(x)));
  }

  template <class Interface, class Message>
  void delayed_send(const ref<Interface>& to, duration delay, Message&& x) {
    scheduled_send(to, now() + delay, std::forward<Message>(x));
  }

  /// Ecology time: the only clock an actor may read.
  [[nodiscard]] instant now() const;

  /// Who has sent the message that is being handled; 0: nobody.
  [[nodiscard]] caf::actor_id sender() const { return current_ != nullptr ? current_->sender : 0; }

  /// Ends it when what it is doing is done.
  void quit(caf::error reason = {});

  template <class Interface>
  void send_exit(const ref<Interface>& to, caf::error reason) {
    local_actor::send_exit(to.strong(), std::move(reason));
  }
  void send_exit(const caf::strong_actor_ptr& to, caf::error reason) {
    local_actor::send_exit(to, std::move(reason));
  }

  using local_actor::monitor;
  template <class Interface>
  void monitor(const ref<Interface>& whom) {
    local_actor::monitor(whom.strong()->get(), caf::message_priority::normal);
  }

  /// Called when one whom it monitors has ended; by default nothing is done.
  void set_down_handler(down_handler x) { hooks().on_down = std::move(x); }

  /// Called instead of ending when somebody asks for the end, unless by exit_reason::kill.
  void set_exit_handler(exit_handler x) { hooks().on_exit = std::move(x); }

  /// Makes the reason with which the actor ends of an exception; by default failure_of().
  void set_exception_handler(exception_handler x) { hooks().on_exception = std::move(x); }

  // -- what others call

  /// Hands it a message. @param from who sends it; nullptr: nobody
  void deliver(envelope_ptr x, actor* from);

  /// The same of what CAF sends: exits, and ends of others.
  using caf::abstract_actor::enqueue;
  void enqueue(caf::mailbox_element_ptr x, caf::execution_unit*) final;

  /// It has its first turn soon.
  void launch(caf::execution_unit*, bool, bool) final;

  /// Whether it has had its first turn.
  [[nodiscard]] bool has_begun() const { return begun_; }
  [[nodiscard]] bool has_ended() const { return ended_; }

  /// Handles up to so many messages. @pre this thread executes its process
  turn_result take_turn(std::size_t messages_max);

  /// Ends it at once, as exit_reason::kill does, without looking into its mailbox.
  void kill();

  void on_exit() final;
  [[nodiscard]] const char* name() const override { return "actor"; }

protected:
  /// Makes the state and returns the handlers.
  [[nodiscard]] virtual handler_set begin() = 0;
  virtual void destroy_state() = 0;

private:
  struct handlers {
    down_handler on_down;
    exit_handler on_exit;
    exception_handler on_exception;
  };

  handlers& hooks();
  void send_at(instant due, caf::strong_actor_ptr to, envelope_ptr x);

  template <class Action>
  void carry_out(Action action);
  void receive(envelope& x);
  void note_lost_copy();
  void handle_system_message(caf::mailbox_element& x);
  void on_exit_message(const caf::exit_msg& x);
  void fail(std::exception_ptr why);
  void finish();

  mailbox mailbox_;
  handler_set behavior_;
  std::unique_ptr<handlers> hooks_;
  const envelope* current_ = nullptr; ///< what it is handling
  bool is_ready_ = false;             ///< it waits for a turn, or has one
  bool begun_ = false;
  bool ended_ = false;
  bool quits_ = false;
  caf::error reason_; ///< of the end, once it quits
};

inline actor* actor_at(const caf::strong_actor_ptr& x) {
  return x ? static_cast<actor*>(x->get()) : nullptr;
}

template <class Interface>
actor& ref<Interface>::get() const {
  return *actor_at(who_);
}

/// Sends a message that comes from nobody, from any thread.
template <class Interface, class Message>
void post(const ref<Interface>& to, Message&& x) {
  if (to)
    to.get().deliver(envelope_for<Interface>(std::forward<Message>(x)), nullptr);
}

/// The same at that time, or now if it is past.
void post_at(const caf::strong_actor_ptr& to, instant due, envelope_ptr x);

template <class Interface, class Message>
void post_at(const ref<Interface>& to, instant due, Message&& x) {
  if (to)
    post_at(to.strong(), due, envelope_for<Interface>(std::forward<Message>(x)));
}

template <class Interface, class Message>
void post_after(const ref<Interface>& to, duration delay, Message&& x) {
  if (to)
    post_at(to, to.get().now() + delay, std::forward<Message>(x));
}

/// Asks it to end, from any thread.
void post_exit(const caf::strong_actor_ptr& to, caf::exit_reason reason);

template <class Interface>
void post_exit(const ref<Interface>& to, caf::exit_reason reason) {
  post_exit(to.strong(), reason);
}

struct no_state {};

/// An actor of a kind. Its state is destroyed at its end, whoever still holds a handle.
template <class State, class Interface>
class shell final : public actor {
public:
  using handle_type = ref<Interface>;
  using behavior_type = behavior<Interface>;

  /// What makes its handlers when it has its first turn.
  class beginning {
  public:
    virtual ~beginning() = default;
    [[nodiscard]] virtual behavior_type begin(shell* self) = 0;
  };

  shell(caf::actor_config& config, std::unique_ptr<beginning> begin)
      : actor(config), state(), beginning_(std::move(begin)) {}
  ~shell() final { destroy_state(); }

  /// Its handle, as anybody who asks for one of its messages sees it.
  template <class Wanted = Interface>
  [[nodiscard]] ref<Wanted> handle() {
    static_assert(covers<Interface, Wanted>, "it does not take all that is asked for");
    return ref<Wanted>(caf::strong_actor_ptr(this->ctrl()));
  }

  union {
    State state; ///< @pre it has not ended
  };

  // the same to itself
  using actor::delayed_send;
  using actor::scheduled_send;
  using actor::send;
  template <class Message>
  void send(shell* to, Message&& x) {
    actor::send(to->handle(), std::forward<Message>(x));
  }
  template <class Message>
  void scheduled_send(shell* to, instant due, Message&& x) {
    actor::scheduled_send(to->handle(), due, std::forward<Message>(x));
  }
  template <class Message>
  void delayed_send(shell* to, duration delay, Message&& x) {
    actor::delayed_send(to->handle(), delay, std::forward<Message>(x));
  }

private:
  handler_set begin() final { return std::exchange(beginning_, nullptr)->begin(this); }
  void destroy_state() final {
    beginning_.reset(); // if it ends before it begins
    if (std::exchange(has_state_, false))
      state.~State();
  }

  std::unique_ptr<beginning> beginning_;
  bool has_state_ = true;
};

/// What handlers and behaviour functions know their actor by; `Handle` is a ref.
template <class State, class Handle>
using actor_pointer = shell<State, typename Handle::interface>*;

} // namespace rubicon::scheduler
