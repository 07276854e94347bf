// Actors under test, alone among fakes of their neighbours: in virtual time, without threads,
// sleeping, or a clock on the wall (ACT-01).
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "scheduler/world.hpp"
#include "testkit/failure.hpp"
#include "testkit/mail.hpp"

namespace spdlog {
class logger;
}

namespace rubicon::test {

/// When messages between the actors of a fixture are delivered.
enum class delivery : std::uint8_t {
  at_once,    ///< as in an ecology: each call returns when nothing more happens at that instant
  when_asked, ///< one by one, by expect(), step() and what lets time go on
};

/// Whom a pattern means: a handle, or what has a handle().
template <class T>
[[nodiscard]] caf::actor_id id_of(const T& x) {
  if constexpr (requires { x.handle(); })
    return x.handle().id();
  else
    return x.id();
}

/// Which messages are meant: `.from(a)`, `.where(predicate)`, and last `.to(b)` or `.to_anybody()`,
/// which does what was asked for.
template <class Message, class Result>
class [[nodiscard]] selection {
public:
  using action = std::function<Result(const message_pattern&)>;

  explicit selection(action what) : what_(std::move(what)) {
    pattern_.type = &scheduler::type_of<Message>::value;
  }

  template <class Sender>
  selection& from(const Sender& x) {
    pattern_.from = id_of(x);
    return *this;
  }

  /// @param fits is given the message
  template <class Predicate>
  selection& where(Predicate fits) {
    pattern_.fits = [fits = std::move(fits)](const scheduler::envelope& x) {
      return fits(*x.as<Message>());
    };
    return *this;
  }

  template <class Receiver>
  Result to(const Receiver& x) {
    pattern_.to = id_of(x);
    return what_(pattern_);
  }

  Result to_anybody() { return what_(pattern_); }

private:
  action what_;
  message_pattern pattern_;
};

/// A world whose time stands still until run_for() or run_until(). It keeps what actors log, and
/// how those that it has spawned have ended. Handles and fakes must not outlive it: declare it
/// first. Only messages to actors that it has spawned, fakes included, are held or befallen by
/// mishaps.
class fixture {
public:
  /// How an actor has ended.
  struct end {
    std::string path;
    std::string reason; ///< as text; `none` if it ended in good order

    friend bool operator==(const end&, const end&) = default;
  };

  explicit fixture(delivery when = delivery::at_once);
  ~fixture();
  fixture(const fixture&) = delete;
  fixture& operator=(const fixture&) = delete;

  /// Spawns a function-based actor at `path`. It has begun when this returns.
  template <class Fun, class... Args>
  auto spawn_at(std::string path, Fun fun, Args&&... args) {
    auto handle = world_.spawn(path, std::move(fun), std::forward<Args>(args)...);
    begin(handle.get(), std::move(path));
    return handle;
  }

  /// The same, where the path does not matter.
  template <class Fun, class... Args>
  auto spawn(Fun fun, Args&&... args) {
    return spawn_at("test/" + std::to_string(++spawned_), std::move(fun),
                    std::forward<Args>(args)...);
  }

  /// Sends a message that comes from nobody; from a fake: fake::send().
  template <class Handle, class Message>
  void send(const Handle& to, Message message) {
    scheduler::post(to, std::move(message));
    settle();
  }

  // -- time; whatever is on its way is delivered as time goes on

  void run_for(duration length);
  [[nodiscard]] instant now() const { return world_.now(); }

  /// Runs in steps of `step` until `done` holds. @returns whether it does before `limit` has passed
  bool run_until(const std::function<bool()>& done, duration limit, duration step = 10ms);

  // -- delivery::when_asked; with the other, nothing is ever on its way: logic_error

  /// The next message to `.to(b)` is such a one: delivers it, and returns it.
  /// @throws failure if it is another one, or none is on its way
  template <class Message>
  selection<Message, Message> expect() {
    return selection<Message, Message>([this](const message_pattern& x) {
      const auto& letter = expected(x);
      auto message = *letter.content->as<Message>();
      mail_.deliver(letter);
      settle();
      return message;
    });
  }

  /// The same, if there is one. @returns whether there was
  template <class Message>
  selection<Message, bool> allow() {
    return selection<Message, bool>([this](const message_pattern& x) { return allowed(x); });
  }

  /// No such message is on its way now. @throws failure if one is
  template <class Message>
  selection<Message, void> disallow() {
    return selection<Message, void>([this](const message_pattern& x) { disallowed(x); });
  }

  /// Nothing at all is on its way. @throws failure if something is
  void expect_nothing();

  /// Delivers the message that was sent first. @returns whether there was one
  bool step();

  /// Delivers all that is on its way, and what that leads to at this instant.
  void run();

  /// Lets time pass without delivering: what timers send meanwhile is on its way.
  void pass(duration length);

  // -- mishaps of the first message on its way that fits, or else of the next one that is sent

  template <class Message>
  selection<Message, void> drop() {
    return plan<Message>({mishap::kind::drop});
  }
  /// It is sent again, so to say, so much later.
  template <class Message>
  selection<Message, void> delay(duration length) {
    return plan<Message>({mishap::kind::delay, length});
  }
  template <class Message>
  selection<Message, void> duplicate() {
    return plan<Message>({mishap::kind::duplicate});
  }

  // -- what has happened

  /// Ends of spawned actors so far, in order.
  [[nodiscard]] const std::vector<end>& ends() const { return *ends_; }

  /// How many lines of the log hold `text`.
  [[nodiscard]] std::size_t logged(std::string_view text) const;

  [[nodiscard]] scheduler::world& world() { return world_; }

private:
  template <class Handle>
  friend class fake;

  void begin(scheduler::actor& who, std::string path);
  void settle();
  void throw_what_scripts_threw();
  void must_hold() const;
  const mail::letter& expected(const message_pattern& x);
  bool allowed(const message_pattern& x);
  void disallowed(const message_pattern& x);

  template <class Message>
  selection<Message, void> plan(mishap what) {
    return selection<Message, void>(
        [this, what](const message_pattern& x) { mail_.plan(x, what); });
  }

  std::ostringstream log_;
  std::shared_ptr<spdlog::logger> logger_before_;
  std::shared_ptr<std::vector<end>> ends_ = std::make_shared<std::vector<end>>();
  int spawned_ = 0;
  std::exception_ptr thrown_; ///< by a script of a fake; an actor's handlers cannot pass it on
  mail mail_;
  scheduler::world world_; ///< last: it goes first
};

} // namespace rubicon::test
