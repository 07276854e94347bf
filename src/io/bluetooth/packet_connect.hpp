// Waiting for a packet socket to connect (LNK-07).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "core/time.hpp"
#include "io/descriptor.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

/// One attempt: calls back once, on the loop's thread, never from within the constructor.
/// Destroying it gives the attempt up without a call.
class packet_connect {
public:
  /// The connected socket, or why there is none. May destroy the attempt.
  using callback = std::function<void(std::variant<descriptor, std::string>)>;

  /// @param connecting becomes writable when it has connected, or has failed
  packet_connect(loop& where, descriptor connecting, duration timeout, callback on_result);
  ~packet_connect();
  packet_connect(packet_connect&&) noexcept;
  packet_connect& operator=(packet_connect&&) noexcept;

private:
  struct state;
  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
