// A coordinator's end of the control plane: one for each host.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "control/system.hpp"
#include "core/time.hpp"
#include "deploy/messages.hpp"
#include "io/loop.hpp"

namespace rubicon::control {

/// Sends one request after the other, and reconnects when the connection was lost.
class client {
public:
  /// The answer, or why there is none: `cannot be reached: ...`, a verb first.
  using callback = std::function<void(std::variant<deploy::answer, std::string>)>;

  /// @param in the certificate that it holds is looked at anew for each connection
  /// @param host whose name the certificate there must have; empty: any of our authority's
  client(system& in, io::loop& where, std::string address, std::uint16_t port,
         std::string host = {});
  ~client();
  client(const client&) = delete;
  client& operator=(const client&) = delete;

  /// @pre no question is open
  /// @param f called once, on the loop's thread, at most a little after the timeout; not any more
  ///          when the client has ended, which it may end itself
  void ask(deploy::question x, duration timeout, callback f);

  [[nodiscard]] bool is_asking() const;

  /// `192.168.1.5:4242`
  [[nodiscard]] std::string place() const;

private:
  struct state;
  std::unique_ptr<state> state_;
};

} // namespace rubicon::control
