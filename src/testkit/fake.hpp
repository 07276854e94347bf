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

#include <caf/actor.hpp>
#include <caf/actor_cast.hpp>
#include <caf/send.hpp>
#include <caf/typed_actor.hpp>
#include <caf/typed_event_based_actor.hpp>

#include "actors/timer.hpp"
#include "scheduler/trace.hpp"
#include "testkit/fixture.hpp"

namespace rubicon::test {

template <class Handle>
class fake;

/// A fake of any kind of actor, `fake<air_actor> air(world, "air")`. Must not outlive its world.
template <class... Messages>
class fake<caf::typed_actor<caf::reacts_to<Messages>...>> {
public:
  using handle_type = caf::typed_actor<caf::reacts_to<Messages>...>;

  explicit fake(fixture& world) : world_(world), handle_(world.spawn(behave, &world, known_)) {}
  fake(fixture& world, std::string path)
      : world_(world), handle_(world.spawn_at(std::move(path), behave, &world, known_)) {}

  [[nodiscard]] const handle_type& handle() const { return handle_; }

  /// The handle as messages carry it, seen as whatever the receiver asks for.
  template <class Handle>
  operator scheduler::carried<Handle>() const { // NOLINT: reads as the handle itself would
    return {handle_};
  }

  /// What it does from now on when such a message comes. What `script` returns, unless that is
  /// void, is sent back to the sender; others are sent to by send().
  template <class Message, class Script>
  void on(Script script) {
    auto& known = std::get<script_of<Message>>(known_->scripts);
    if constexpr (std::is_void_v<std::invoke_result_t<Script, const Message&>>)
      known.act = [script = std::move(script)](pointer, const Message& x) { script(x); };
    else
      known.act = [script = std::move(script)](pointer self, const Message& x) {
        caf::unsafe_send_as(self, caf::actor_cast<caf::actor>(self->current_sender()), script(x));
      };
  }

  /// Sends a message of its own, from a test or a script.
  template <class Handle, class Message>
  void send(const Handle& to, Message message) {
    caf::send_as(handle_, to, std::move(message));
    if (!known_->acts)
      world_.settle();
  }

  /// Every message of that kind so far, in order.
  template <class Message>
  [[nodiscard]] std::vector<Message> all() const {
    std::vector<Message> found;
    for (const auto& [at, message] : known_->heard) {
      if (const auto* x = std::get_if<Message>(&message))
        found.push_back(*x);
    }
    return found;
  }

  /// When each of them came.
  template <class Message>
  [[nodiscard]] std::vector<instant> times() const {
    std::vector<instant> found;
    for (const auto& [at, message] : known_->heard) {
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
  [[nodiscard]] std::size_t size() const { return known_->heard.size(); }

  void forget() { known_->heard.clear(); }

  /// Every message of that kind.
  template <class Message>
  void forget() {
    std::erase_if(known_->heard,
                  [](const auto& x) { return std::holds_alternative<Message>(x.second); });
  }

private:
  using pointer = typename handle_type::pointer;

  template <class Message>
  struct script_of {
    std::function<void(pointer, const Message&)> act; ///< may be empty
  };

  struct knowledge {
    std::vector<std::pair<instant, std::variant<Messages...>>> heard;
    std::tuple<script_of<Messages>...> scripts;
    bool acts = false; ///< a script is being carried out
  };

  static typename handle_type::behavior_type behave(pointer self, fixture* world,
                                                    const std::shared_ptr<knowledge>& known) {
    return {[self, world, known](const Messages& x) {
      known->heard.emplace_back(now(self), x);
      const auto act = std::get<script_of<Messages>>(known->scripts).act; // it may set another
      if (!act)
        return;
      known->acts = true;
      try {
        act(self, x);
      } catch (...) { // it belongs to the test
        world->thrown_ = std::current_exception();
      }
      known->acts = false;
    }...};
  }

  fixture& world_;
  std::shared_ptr<knowledge> known_ = std::make_shared<knowledge>();
  handle_type handle_;
};

} // namespace rubicon::test
