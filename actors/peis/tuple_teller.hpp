// What components do to tuples, reported to an observer.
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

class tuple_teller {
public:
  using listener = std::function<void(const report::tuple_write&)>;

  tuple_teller(const config::ecology_description& names, listener to);

  /// Those that are requests of a component to its peer.
  void write(const scheduler::delivery& x);

private:
  /// @param owner nothing: the component's own peer
  /// @param value in text, or octets
  void report_write(const scheduler::delivery& x, std::optional<peer_id> owner,
                    std::string_view key, std::string_view value, bool deleted = false);
  template <class Set>
  void report_set(const scheduler::delivery& x, std::optional<peer_id> owner, const Set& set);

  std::map<peer_id, std::string> names_;
  listener listener_;
  report::tuple_write write_; ///< again and again: there are many, and texts need memory
};

} // namespace rubicon
