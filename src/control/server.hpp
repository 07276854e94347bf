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
/// With certificates only who shows one of the authority is listened to; who has not after
/// `unknown_max` is closed. Each connection has one question under way, and files come over one
/// connection at a time: what a stranger and what a friend can make it hold has a bound.
class server {
public:
  /// Answers a question, on the loop's thread, with the kind of answer that it has. Must not
  /// destroy the server.
  using handler = std::function<deploy::answer(deploy::question)>;
  /// A line for who looks after this computer: who was refused, what became of a new certificate.
  using teller = std::function<void(const std::string&)>;

  static constexpr duration unknown_max = 5s;  ///< without saying who it is
  static constexpr duration silence_max = 10s; ///< within a question, or a small one as a whole
  static constexpr duration files_max = 60s;   ///< for a question with files
  static constexpr duration unread_max = 60s;  ///< for an answer
  static constexpr duration idle_max = 10min;  ///< from an answer to the next question
  static constexpr std::size_t known_max = 32; ///< connections of those who are believed

  /// @param in the certificate that it holds is looked at anew when somebody connects
  /// @param address IPv4 address of this computer, 0.0.0.0 for all
  /// @param port 0 lets the system choose
  /// @returns the server, or why there is none
  [[nodiscard]] static std::variant<server, std::string> open(system& in, io::loop& where,
                                                              const std::string& address,
                                                              std::uint16_t port, handler f,
                                                              teller tell = {});
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
