// A host's end of the control plane.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "control/system.hpp"
#include "deploy/messages.hpp"
#include "io/loop.hpp"

namespace rubicon::control {

/// Takes questions from open() on until it is destroyed. While it lives, its loop runs.
class server {
public:
  /// Answers a question, on the loop's thread, with the kind of answer that it has.
  using handler = std::function<deploy::answer(deploy::question)>;

  /// @param address IPv4 address of this computer, 0.0.0.0 for all
  /// @param port 0 lets the system choose
  /// @returns the server, or why there is none
  [[nodiscard]] static std::variant<server, std::string>
  open(system& in, io::loop& where, const std::string& address, std::uint16_t port, handler f);
  ~server();
  server(server&&) noexcept;
  server& operator=(server&&) noexcept;

  [[nodiscard]] std::uint16_t port() const;

private:
  struct state;
  explicit server(std::unique_ptr<state> x);

  std::unique_ptr<state> state_;
};

} // namespace rubicon::control
