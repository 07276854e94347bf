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

/// Asks one question after the other, and finds the host anew when it was gone.
class client {
public:
  /// The answer, or why there is none.
  using callback = std::function<void(std::variant<deploy::answer, std::string>)>;

  client(system& in, io::loop& where, std::string address, std::uint16_t port);
  ~client();
  client(const client&) = delete;
  client& operator=(const client&) = delete;

  /// @pre no question is open
  /// @param f called once, on the loop's thread, at most a little after the timeout; not any more
  ///          when the client has ended
  void ask(deploy::question x, duration timeout, callback f);

  [[nodiscard]] bool is_asking() const;

  /// `192.168.1.5:4242`
  [[nodiscard]] std::string place() const;

private:
  struct state;
  class asker;
  std::shared_ptr<state> state_;
};

} // namespace rubicon::control
