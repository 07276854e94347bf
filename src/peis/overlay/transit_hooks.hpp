// Packages of others that pass through, and hooks that may stop them (API-06).
#pragma once

#include <cstdint>
#include <functional>
#include <map>

#include "core/bytes.hpp"
#include "peis/overlay/p2p_events.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis {

/// What a hook makes of a package that passes through.
enum class verdict : std::uint8_t { ignore, consume };

/// Must not call the kernel. The octets are valid during the call only.
using transit_hook = std::function<verdict(const package_header&, byte_view)>;

class transit_hooks {
public:
  void set(std::uint16_t port, transit_hook hook); ///< an empty one ends it

  /// Shows a package to the hook of its port. @returns whether it was consumed
  [[nodiscard]] bool consume(const package_header& header, byte_view data, events& out) const;

private:
  std::map<std::uint16_t, transit_hook> hooks_; ///< by port
};

} // namespace rubicon::peis
