#include "peer/message_calls.hpp"

#include <utility>

#include "peer/standalone.hpp"

namespace rubicon::peer {

peis::cause message_calls::send(std::uint16_t port, peer_id destination, payload octets,
                                bool reliable, peis::priority class_of_service,
                                outcome_callback then) {
  return peer_.call(
      [&](auto& kernel, auto request, auto time) {
        return kernel.messages().send(destination, port, std::move(octets), reliable,
                                      class_of_service, request, time);
      },
      std::move(then));
}

peis::cause message_calls::broadcast(std::uint16_t port, payload octets) {
  return peer_.call([&](auto& kernel, auto request, auto time) {
    return kernel.messages().broadcast(port, std::move(octets), request, time);
  });
}

bool message_calls::register_hook(std::uint16_t port, message_callback hook) {
  if (!kernel_.messages().hook_port(port))
    return false;
  callbacks_.add_hook(port, std::move(hook));
  return true;
}

bool message_calls::register_transit_hook(std::uint16_t port, peis::transit_hook hook) {
  return kernel_.messages().hook_transit(port, std::move(hook));
}

std::optional<std::vector<peer_id>> message_calls::trace(peer_id destination, duration timeout) {
  peis::request_id request;
  peer_.call([&](auto& kernel, auto id, auto time) {
    request = id;
    callbacks_.expect_route(id);
    return kernel.messages().trace(destination, id, time);
  });
  peer_.run_until([&] { return callbacks_.has_route(request); }, timeout);
  auto route = callbacks_.take_route(request);
  return route.empty() ? std::nullopt : std::optional(std::move(route));
}

} // namespace rubicon::peer
