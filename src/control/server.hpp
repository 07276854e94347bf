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
///
/// With certificates, only clients that show one of the authority are answered; a connection that
/// has shown none after `unknown_max` is closed. Each connection has one question open, and files
/// come over one connection at a time: what unknown and known clients can make it hold has a bound.
class server {
public:
  /// Answers a question, on the loop's thread, with the kind of answer that it has. Must not
  /// destroy the server.
  using handler = std::function<deploy::answer(deploy::question)>;
  /// A log line for the operator of this computer: refused connections, results of renewals.
  using reporter = std::function<void(const std::string&)>;

  static constexpr duration unknown_max = 5s;  ///< to authenticate
  static constexpr duration silence_max = 10s; ///< within a question, or a small one as a whole
  static constexpr duration files_max = 60s;   ///< for a question with files
  static constexpr duration unread_max = 60s;  ///< for an answer
  static constexpr duration idle_max = 10min;  ///< from an answer to the next question
  static constexpr std::size_t known_max = 32; ///< authenticated connections

  /// @param in its certificate is checked again at each connection
  /// @param address IPv4 address of this computer, 0.0.0.0 for all
  /// @param port 0 lets the system choose
  /// @returns the server, or why there is none
  [[nodiscard]] static std::variant<server, std::string> open(system& in, io::loop& where,
                                                              const std::string& address,
                                                              std::uint16_t port, handler f,
                                                              reporter report = {});
  ~server();
  server(server&&) noexcept;
  server& operator=(server&&) noexcept;

  [[nodiscard]] std::uint16_t port() const;

  /// Takes the certificate that the files hold now, and says so, or why not.
  void renew();

private:
  struct state;
  explicit server(std::unique_ptr<state> x);

  std::unique_ptr<state> state_;
};

} // namespace rubicon::control
