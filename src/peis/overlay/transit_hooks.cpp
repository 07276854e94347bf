#include "peis/overlay/transit_hooks.hpp"

#include <utility>

namespace rubicon::peis {

void transit_hooks::set(std::uint16_t port, transit_hook hook) {
  if (hook)
    hooks_[port] = std::move(hook);
  else
    hooks_.erase(port);
}

bool transit_hooks::consume(const package_header& header, byte_view data, events& out) const {
  const auto hooked = hooks_.find(header.port);
  if (hooked == hooks_.end() || header.seqlen > 0)
    return false;
  const auto hook = hooked->second;
  if (hook(header, data) == verdict::ignore)
    return false;
  const bool broadcast = header.type == package_type::broadcast;
  out.push_back(intercepted{header.port, header.source, broadcast ? any_peer : header.destination});
  return true;
}

} // namespace rubicon::peis
