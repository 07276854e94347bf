// Packages of others that pass through, and hooks that may stop them (API-06).
#include <utility>

#include "peis/overlay/p2p.hpp"

namespace rubicon::peis {

void p2p::set_transit_hook(std::uint16_t port, transit_hook hook) {
  if (hook)
    transit_hooks_[port] = std::move(hook);
  else
    transit_hooks_.erase(port);
}

bool p2p::intercepts(const package_header& header, byte_view data) {
  const auto hooked = transit_hooks_.find(header.port);
  if (hooked == transit_hooks_.end() || header.seqlen > 0)
    return false;
  const auto hook = hooked->second;
  if (hook(header, data) == verdict::ignore)
    return false;
  ++counters_.intercepted;
  const bool broadcast = header.type == package_type::broadcast;
  events_.push_back(
      intercepted{header.port, header.source, broadcast ? any_peer : header.destination});
  return true;
}

} // namespace rubicon::peis
