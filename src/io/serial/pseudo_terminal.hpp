// A pseudo-terminal that other programs take for the serial port of a mote.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "core/bytes.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

/// Programs come and go at the other end, which has the name of a link. While none is there,
/// nothing is stored for it. Callbacks run on the loop's thread, never from within a call, and may
/// destroy the terminal.
class pseudo_terminal {
public:
  struct callbacks {
    /// What a program has written; valid during the call.
    std::function<void(byte_view)> on_octets;
    /// Whether a program has the other end open; there is none at first.
    std::function<void(bool)> on_attached;
  };

  /// @param link made, or taken over from a process that has ended, and removed at the end
  /// @param room octets that may wait for a program that does not read
  /// @returns the terminal, or why it cannot be had
  [[nodiscard]] static std::variant<pseudo_terminal, std::string>
  open(loop& where, const std::string& link, std::size_t room);

  /// No terminal; may only be assigned to.
  pseudo_terminal();
  ~pseudo_terminal();
  pseudo_terminal(pseudo_terminal&&) noexcept;
  pseudo_terminal& operator=(pseudo_terminal&&) noexcept;

  /// @pre called once
  void start(callbacks x);

  /// Whether more is to be received. While not, what comes waits in the system.
  void read(bool wanted);

  /// @returns whether a program is there and there was room for all of the octets; otherwise none
  /// of them goes
  bool send(payload octets);

private:
  struct state;
  explicit pseudo_terminal(std::shared_ptr<state> x);

  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
