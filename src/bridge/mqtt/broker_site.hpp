// A simulated broker and what is to happen at it, for longer than a bridge lives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "bridge/mqtt/simulated_broker.hpp"
#include "bridge/mqtt/simulated_events.hpp"

namespace rubicon::bridge {

class broker_site {
public:
  /// @param events in any order; at the same time in this one
  explicit broker_site(std::vector<simulated_event> events = {});

  /// The next event that is due; each is returned once.
  [[nodiscard]] std::optional<simulated_event> take(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Events that nobody has taken happen without any client. For a bridge that begins.
  void catch_up(instant now);

  /// The id of a client that connects for the first time.
  [[nodiscard]] std::uint32_t new_client() { return ++clients_; }

  [[nodiscard]] simulated_broker& broker() { return broker_; }
  [[nodiscard]] const simulated_broker& broker() const { return broker_; }

private:
  simulated_broker broker_;
  std::vector<simulated_event> events_; ///< in order of time
  std::size_t next_ = 0;
  std::uint32_t clients_ = 0; ///< so far
};

} // namespace rubicon::bridge
