// What components do to tuples, told to somebody who only looks.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "config/ecology.hpp"
#include "core/address.hpp"
#include "report/history.hpp"
#include "scheduler/trace.hpp"

namespace rubicon {

class tuple_teller {
public:
  using listener = std::function<void(const report::tuple_write&)>;

  tuple_teller(const config::ecology_description& names, listener tell);

  /// Those that are requests of a component to its peer.
  void write(const scheduler::delivery& x) const;

private:
  /// @param owner nothing: the component's own peer
  void tell(const scheduler::delivery& x, std::optional<peer_id> owner, const std::string& key,
            std::string value, bool deleted = false) const;

  std::map<peer_id, std::string> names_;
  listener tell_;
};

} // namespace rubicon
