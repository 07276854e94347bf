// Fake neighbours of an actor under test: they write down what they are sent, and answer as a
// script says.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "scheduler/actor.hpp"
#include "testkit/fixture.hpp"

namespace rubicon::test {

/// What a fake of an interface has been sent, and how it answers.
template <class Messages>
struct fake_memory;

template <class... Messages>
struct fake_memory<scheduler::message_list<Messages...>> {
  /// May be empty.
  template <class Message>
  using script = std::function<void(scheduler::actor&, const Message&)>;

  std::vector<std::pair<instant, std::variant<Messages...>>> received;
  std::tuple<script<Messages>...> scripts;
  bool acts = false; ///< a script is being carried out

  /// One handler for each message. @param thrown called with what a script has thrown
  template <class Handle, class Self, class Thrown>
  static typename Handle::behavior_type behave(Self* self, std::shared_ptr<fake_memory> memory,
                                               Thrown thrown) {
    return {[self, memory, thrown](const Messages& x) {
      memory->received.emplace_back(self->now(), x);
      const auto act = std::get<script<Messages>>(memory->scripts); // it may set another
      if (!act)
        return;
      memory->acts = true;
      try {
        act(*self, x);
      } catch (...) { // it belongs to the test
        thrown(std::current_exception());
      }
      memory->acts = false;
    }...};
  }
};

/// A fake of any kind of actor, `fake<air_actor> air(world, "air")`. Must not outlive its world.
template <class Handle>
class fake {
public:
  using handle_type = Handle;

  explicit fake(fixture& world) : world_(world), handle_(world.spawn(behave, &world, known_)) {}
  fake(fixture& world, std::string path)
      : world_(world), handle_(world.spawn_at(std::move(path), behave, &world, known_)) {}

  [[nodiscard]] const handle_type& handle() const { return handle_; }

  /// The handle as messages carry it, seen as whatever the receiver asks for.
  template <class Interface>
  operator scheduler::ref<Interface>() const { // NOLINT: reads as the handle itself would
    return handle_;
  }

  /// What it does from now on when such a message comes. What `script` returns, unless that is
  /// void, is sent back to the sender; others are sent to by send().
  template <class Message, class Script>
  void on(Script script) {
    auto& known = std::get<typename memory::template script<Message>>(known_->scripts);
    if constexpr (std::is_void_v<std::invoke_result_t<Script, const Message&>>)
      known = [script = std::move(script)](scheduler::actor&, const Message& x) { script(x); };
    else
      known = [this, script = std::move(script)](scheduler::actor& self, const Message& x) {
        if (const auto to = world_.mail_.actor_of(self.sender()))
          scheduler::actor_at(to)->deliver(scheduler::make_envelope(script(x)), &self);
      };
  }

  /// Sends a message of its own, from a test or a script.
  template <class Interface, class Message>
  void send(const scheduler::ref<Interface>& to, Message message) {
    handle_.get().send(to, std::move(message));
    if (!known_->acts)
      world_.settle();
  }

  /// Every message of that kind so far, in order.
  template <class Message>
  [[nodiscard]] std::vector<Message> all() const {
    std::vector<Message> found;
    for (const auto& [at, message] : known_->received) {
      if (const auto* x = std::get_if<Message>(&message))
        found.push_back(*x);
    }
    return found;
  }

  /// When each of them came.
  template <class Message>
  [[nodiscard]] std::vector<instant> times() const {
    std::vector<instant> found;
    for (const auto& [at, message] : known_->received) {
      if (std::holds_alternative<Message>(message))
        found.push_back(at);
    }
    return found;
  }

  template <class Message>
  [[nodiscard]] std::size_t count() const {
    return times<Message>().size();
  }

  /// Messages of all kinds.
  [[nodiscard]] std::size_t size() const { return known_->received.size(); }

  void forget() { known_->received.clear(); }

  /// Every message of that kind.
  template <class Message>
  void forget() {
    std::erase_if(known_->received,
                  [](const auto& x) { return std::holds_alternative<Message>(x.second); });
  }

private:
  using interface = typename Handle::interface;
  using memory = fake_memory<typename interface::messages>;

  static typename Handle::behavior_type
  behave(scheduler::shell<scheduler::no_state, interface>* self, fixture* world,
         std::shared_ptr<memory> known) {
    return memory::template behave<Handle>(
        self, std::move(known), [world](std::exception_ptr x) { world->thrown_ = std::move(x); });
  }

  fixture& world_;
  std::shared_ptr<memory> known_ = std::make_shared<memory>();
  handle_type handle_;
};

} // namespace rubicon::test
