// Which callback of a program is for which event of its kernel.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "peer/callbacks.hpp"

namespace rubicon::peer {

/// Names subscriptions and requests. Calls nothing itself: on() returns what is to be called, which
/// stays valid whatever is added or removed meanwhile.
class callback_table {
public:
  using call = std::function<void()>; ///< empty: no callback is registered

  [[nodiscard]] peis::subscription_id add_watcher(tuple_callback changed, tuple_callback deleted);
  void remove_watcher(peis::subscription_id id) { watchers_.erase(id); }

  /// @param then is called once; may be empty
  [[nodiscard]] peis::request_id add_request(outcome_callback then);

  /// The route that this request is to find is kept until it is taken.
  void expect_route(peis::request_id request) { routes_[request]; }
  [[nodiscard]] bool has_route(peis::request_id request) const {
    return !routes_.at(request).empty();
  }
  /// @pre it is expected
  [[nodiscard]] std::vector<peer_id> take_route(peis::request_id request);

  void add_hook(std::uint16_t port, message_callback hook);
  void set_host_callback(host_callback x) { on_host_ = std::move(x); }

  [[nodiscard]] call on(const peis::tuple_changed& x) const;
  [[nodiscard]] call on(const peis::tuple_deleted& x) const;
  [[nodiscard]] call on(const peis::outcome& x);
  [[nodiscard]] call on(const peis::host_appeared& x) const;
  [[nodiscard]] call on(const peis::host_vanished& x) const;
  [[nodiscard]] std::vector<message_callback> hooks(std::uint16_t port) const; ///< as added
  void on(peis::traced& x);

private:
  struct watcher {
    tuple_callback changed;
    tuple_callback deleted;
  };

  std::map<peis::subscription_id, std::shared_ptr<watcher>> watchers_;
  std::map<peis::request_id, outcome_callback> expected_;
  std::map<peis::request_id, std::vector<peer_id>> routes_;
  std::map<std::uint16_t, std::vector<message_callback>> hooks_;
  host_callback on_host_;
  std::uint64_t next_subscription_ = 1;
  std::uint64_t next_request_ = 1;
};

} // namespace rubicon::peer
