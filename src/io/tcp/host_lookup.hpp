// The address of a host, from its name.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "core/text/ipv4_network.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

/// Looks the IPv4 address of a host up, once; destroying it gives up without a call.
class host_lookup {
public:
  /// The address, or why there is none: `robot: no host has this name`.
  using callback = std::function<void(std::variant<ipv4_address, std::string>)>;

  /// Calls back on the loop's thread, never from within the constructor. May be destroyed then.
  host_lookup(loop& where, const std::string& host, callback on_result);
  ~host_lookup();
  host_lookup(host_lookup&&) noexcept;
  host_lookup& operator=(host_lookup&&) = delete;

private:
  struct state;
  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
