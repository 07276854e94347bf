// Notifies an observer of what components do to tuples.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "config/plan/ecology.hpp"
#include "core/address.hpp"
#include "report/history.hpp"
#include "scheduler/trace.hpp"

namespace rubicon {

class tuple_notifier {
public:
  using listener = std::function<void(const report::tuple_write&)>;

  tuple_notifier(const config::ecology_description& names, listener to);

  /// Notifies of it if it is a request of a component to its peer.
  void on_delivery(const scheduler::delivery& x);

private:
  /// @param owner nothing: the component's own peer
  /// @param value in text, or octets
  void notify(const scheduler::delivery& x, std::optional<peer_id> owner, std::string_view key,
              std::string_view value, bool deleted = false);
  template <class Set>
  void notify_of(const scheduler::delivery& x, std::optional<peer_id> owner, const Set& set);

  std::map<peer_id, std::string> names_;
  listener listener_;
  report::tuple_write write_; ///< again and again: there are many, and texts need memory
};

} // namespace rubicon
