#include "peis/kernel/message_ports.hpp"

#include <utility>

namespace rubicon::peis {

bool message_ports::hook(std::uint16_t port) {
  if (!is_user_port(port))
    return false;
  hooked_.set(port);
  return true;
}

void message_ports::deliver(message x, outputs& out) {
  if (hooked_.test(x.port))
    out.emplace_back(std::move(x));
  else
    ++unhooked_;
}

} // namespace rubicon::peis
