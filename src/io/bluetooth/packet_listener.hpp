// A packet socket that others connect to.
#pragma once

#include <functional>
#include <memory>

#include "io/descriptor.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

/// Accepts connections until it is destroyed. When the process runs out of descriptors it waits a
/// while and goes on.
class packet_listener {
public:
  /// Gets each new connection. May destroy the listener.
  using callback = std::function<void(descriptor)>;

  packet_listener(loop& where, descriptor listening, callback on_connection);
  ~packet_listener();
  packet_listener(packet_listener&&) noexcept;
  packet_listener& operator=(packet_listener&&) = delete;

private:
  struct state;
  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
