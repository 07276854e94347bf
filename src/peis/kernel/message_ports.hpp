// Which ports of a kernel accept messages.
#pragma once

#include <bitset>
#include <cstdint>

#include "peis/kernel/kernel_events.hpp"
#include "peis/wire/package.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Messages for a hooked port are outputs; others are counted and dropped.
class message_ports {
public:
  [[nodiscard]] static constexpr bool is_user_port(std::uint16_t port) {
    return port >= port::user_first && port < port::count;
  }

  /// @returns false unless the port is a user port
  bool hook(std::uint16_t port);

  /// @pre x.port < port::count
  void deliver(message x, outputs& out);

  [[nodiscard]] std::uint64_t unhooked() const { return unhooked_; }

private:
  std::bitset<port::count> hooked_;
  std::uint64_t unhooked_ = 0;
};

} // namespace rubicon::peis
