// Actors under test, in virtual time: no threads, no sleeping, no clock on the wall (ACT-01).
#pragma once

#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <caf/actor_cast.hpp>
#include <caf/send.hpp>

#include "core/time.hpp"
#include "scheduler/world.hpp"

namespace spdlog {
class logger;
}

namespace rubicon::test {

/// A world whose time stands still unless run_for() lets it go on. It keeps what actors log, how
/// those that it spawned have ended, and, where asked for, what others were sent. Handles and fakes
/// must not outlive it, so declare it first.
class virtual_world {
public:
  /// How an actor has ended.
  struct end {
    std::string path;
    std::string reason; ///< as text; `none` if it ended in good order

    friend bool operator==(const end&, const end&) = default;
  };

  virtual_world();
  ~virtual_world();
  virtual_world(const virtual_world&) = delete;
  virtual_world& operator=(const virtual_world&) = delete;

  /// Spawns a function-based actor at `path`.
  template <class Fun, class... Args>
  auto spawn_at(std::string path, Fun fun, Args&&... args) {
    auto handle = world_.spawn(path, std::move(fun), std::forward<Args>(args)...);
    caf::actor_cast<caf::abstract_actor*>(handle)->attach_functor(
        [ends = ends_, path = std::move(path)](const caf::error& reason) {
          ends->push_back({path, caf::to_string(reason)});
        });
    world_.drain();
    return handle;
  }

  /// The same, where the path does not matter. The actor has begun when this returns.
  template <class Fun, class... Args>
  auto spawn(Fun fun, Args&&... args) {
    return spawn_at("test/" + std::to_string(++spawned_), std::move(fun),
                    std::forward<Args>(args)...);
  }

  /// Sends a message and lets everybody do what follows from it at this moment.
  template <class Handle, class Message>
  void send(const Handle& to, Message message) {
    caf::anon_send(to, std::move(message));
    world_.drain();
  }

  void run_for(duration length) { world_.run_for(length); }
  [[nodiscard]] instant now() const { return world_.now(); }

  /// Runs in steps of `step` until `done` holds. @returns whether it does before `limit` has passed
  bool run_until(const std::function<bool()>& done, duration limit, duration step = 10ms);

  /// Ends of spawned actors so far, in order.
  [[nodiscard]] const std::vector<end>& ends() const { return *ends_; }

  /// Remembers from now on what actors are sent whose paths begin so. One prefix at a time.
  void follow(std::string path_prefix);

  /// What has been sent to actors that are followed: `path message`, in order.
  [[nodiscard]] const std::vector<std::string>& followed() const { return followed_; }

  /// How many lines of the log hold `text`.
  [[nodiscard]] std::size_t logged(std::string_view text) const;

  [[nodiscard]] scheduler::world& world() { return world_; }

private:
  std::ostringstream log_;
  std::shared_ptr<spdlog::logger> logger_before_;
  std::shared_ptr<std::vector<end>> ends_ = std::make_shared<std::vector<end>>();
  std::vector<std::string> followed_;
  int spawned_ = 0;
  scheduler::world world_; ///< last: it goes first
};

} // namespace rubicon::test
