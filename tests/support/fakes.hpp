// Fake neighbours of an actor under test: they write down what they are sent and never answer.
#pragma once

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include <caf/typed_actor.hpp>
#include <caf/typed_event_based_actor.hpp>

#include "actors/timer.hpp"
#include "scheduler/trace.hpp"
#include "support/virtual_world.hpp"

namespace rubicon::test {

template <class Handle>
class fake;

/// A fake of any kind of actor, `fake<air_actor> air(world)`. Must not outlive its world.
template <class... Messages>
class fake<caf::typed_actor<caf::reacts_to<Messages>...>> {
public:
  using handle_type = caf::typed_actor<caf::reacts_to<Messages>...>;

  explicit fake(virtual_world& world) : handle_(world.spawn(behave, heard_)) {}

  [[nodiscard]] const handle_type& handle() const { return handle_; }

  /// The handle as messages carry it, seen as whatever the receiver asks for.
  template <class Handle>
  operator scheduler::carried<Handle>() const { // NOLINT: reads as the handle itself would
    return {handle_};
  }

  /// Every message of that kind so far, in order.
  template <class Message>
  [[nodiscard]] std::vector<Message> all() const {
    std::vector<Message> found;
    for (const auto& [at, message] : *heard_) {
      if (const auto* x = std::get_if<Message>(&message))
        found.push_back(*x);
    }
    return found;
  }

  /// When each of them came.
  template <class Message>
  [[nodiscard]] std::vector<instant> times() const {
    std::vector<instant> found;
    for (const auto& [at, message] : *heard_) {
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
  [[nodiscard]] std::size_t size() const { return heard_->size(); }

  void forget() { heard_->clear(); }

  /// Every message of that kind.
  template <class Message>
  void forget() {
    std::erase_if(*heard_, [](const auto& x) { return std::holds_alternative<Message>(x.second); });
  }

private:
  using heard_messages = std::vector<std::pair<instant, std::variant<Messages...>>>;

  static typename handle_type::behavior_type behave(typename handle_type::pointer self,
                                                    const std::shared_ptr<heard_messages>& heard) {
    return {[self, heard](const Messages& x) { heard->emplace_back(now(self), x); }...};
  }

  std::shared_ptr<heard_messages> heard_ = std::make_shared<heard_messages>();
  handle_type handle_;
};

} // namespace rubicon::test
