#include "communication/remote_process.hpp"

namespace rubicon::communication {

namespace {

/// Whether a part of a program handles this event.
template <class Part, class Event>
concept handles = requires(Part& part, const Event& event) {
  part.apply(event);
};

} // namespace

remote_process::~remote_process() = default;

interface remote_process::attach(communication_events& program) {
  exchange_.set_program(&program);
  if (program.wants_ticks())
    exchange_.command(remote::want_ticks{});
  return interface(commands_);
}

std::optional<remote::commands_batch> remote_process::flush() {
  exchange_.dispatch();
  sends_.command_holds();
  return exchange_.take_batch();
}

/// As at the node, events reach the program when the state is complete.
void remote_process::on_events(const remote::events_batch& x, instant now) {
  exchange_.set_time(now);
  exchange_.on_batch(x.taken, x.all.size());
  const auto apply = [this]<class Event>(const Event& event) {
    if constexpr (handles<remote_channels, Event>)
      channels_.apply(event);
    else if constexpr (handles<remote_streams, Event>)
      streams_.apply(event);
    else if constexpr (handles<remote_sends, Event>)
      sends_.apply(event);
    else
      node_.apply(event);
  };
  for (const auto& each : x.all)
    std::visit(apply, each);
  exchange_.dispatch();
}

} // namespace rubicon::communication
