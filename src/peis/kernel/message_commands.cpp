#include "peis/kernel/message_commands.hpp"

#include <utility>

#include "peis/kernel/kernel_turn.hpp"

namespace rubicon::peis {

outputs message_commands::send(peer_id destination, std::uint16_t port, payload octets,
                               bool reliable, priority class_of_service, request_id request,
                               instant now) {
  kernel_turn turn(layers_, now);
  if (!message_ports::is_user_port(port)) {
    turn.report(request, cause::bad_port);
  } else if (destination == layers_.self()) {
    layers_.ports.deliver({port, layers_.self(), false, std::move(octets)}, layers_.out);
    turn.report(request, cause::none);
  } else {
    layers_.network.send(
        {destination, port, {{}, std::move(octets)}, reliable, class_of_service, request});
  }
  return turn.finish();
}

outputs message_commands::broadcast(std::uint16_t port, payload octets, request_id request,
                                    instant now) {
  kernel_turn turn(layers_, now);
  turn.report(request, message_ports::is_user_port(port)
                           ? layers_.network.broadcast(port, std::move(octets))
                           : cause::bad_port);
  return turn.finish();
}

outputs message_commands::trace(peer_id destination, request_id request, instant now) {
  layers_.network.trace(destination, request, now);
  return kernel_turn(layers_, now).finish();
}

bool message_commands::hook_port(std::uint16_t port) {
  return layers_.ports.hook(port);
}

bool message_commands::hook_transit(std::uint16_t port, transit_hook hook) {
  if (!message_ports::is_user_port(port))
    return false;
  layers_.network.set_transit_hook(port, std::move(hook));
  return true;
}

} // namespace rubicon::peis
