// A program in an actor of its own, on its side: commands become messages to its node's actor, the
// answers become events.
#pragma once

#include <cstddef>
#include <optional>

#include "communication/interface.hpp"
#include "communication/process.hpp"
#include "communication/remote/remote_channels.hpp"
#include "communication/remote/remote_exchange.hpp"
#include "communication/remote/remote_node.hpp"
#include "communication/remote/remote_sends.hpp"
#include "communication/remote/remote_streams.hpp"
#include "communication/remote_messages.hpp"
#include "core/time.hpp"

namespace rubicon::communication {

/// Answers commands at once by what it knows of the program's streams and channels, and of the
/// node's tables. program_port at the node carries them out, and refuses what only the node knows.
///
/// Whoever owns one calls begin() before commands that are not given from within an event, and
/// sends what flush() returns after each of its functions.
class remote_process {
public:
  /// @param commands_max that the node has not taken; closing and disposing do not count
  explicit remote_process(remote::limits node, std::size_t commands_max = 256)
      : exchange_(node, commands_max) {}
  ~remote_process();                              // it is large: compiled once
  remote_process(const remote_process&) = delete; // interfaces point to it
  remote_process& operator=(const remote_process&) = delete;

  /// The program; it outlives this.
  [[nodiscard]] interface attach(communication_events& program);

  void begin(instant now) { exchange_.set_time(now); }
  void on_events(const remote::events_batch& x, instant now);
  [[nodiscard]] std::optional<remote::commands_batch> flush();

  [[nodiscard]] std::size_t commands_in_flight() const { return exchange_.commands_in_flight(); }
  [[nodiscard]] const remote_counters& counters() const { return exchange_.counters(); }

private:
  remote_exchange exchange_;
  remote_channels channels_{exchange_};
  remote_streams streams_{exchange_};
  remote_sends sends_{exchange_};
  remote_node node_{exchange_};
  process commands_{channels_, streams_, sends_, node_};
};

} // namespace rubicon::communication
