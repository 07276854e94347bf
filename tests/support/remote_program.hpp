// A program that is not in the actor of its node, and what carries messages between the two sides:
// they take no time.
#pragma once

#include <optional>

#include "communication/program_port.hpp"
#include "communication/remote_process.hpp"

namespace rubicon::test {

class remote_program {
public:
  template <class Node>
  remote_program(Node& node, communication::communication_events& events)
      : port(node), process(port.limits()), layer(process.attach(events)) {}

  /// Carries all that is in flight.
  /// @param carry_out a function of a function that gives commands: as a program at the node would
  template <class CarryOut>
  void exchange(instant now, CarryOut carry_out) {
    if (is_exchanging_)
      return;
    is_exchanging_ = true;
    for (bool again = true; again;) {
      if (const auto events = port.take_events())
        process.on_events(*events, now);
      const auto commands = process.flush();
      again = commands.has_value();
      if (again)
        carry_out([&] { port.on_commands(*commands); });
    }
    is_exchanging_ = false;
  }

  communication::program_port port;
  communication::remote_process process;
  communication::interface layer;

private:
  bool is_exchanging_ = false;
};

} // namespace rubicon::test
