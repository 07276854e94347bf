// What the system knows of the other side of a TCP connection.
#pragma once

#include <cstddef>

namespace rubicon::io {

/// Octets written to the socket that the other side's system has not acknowledged.
[[nodiscard]] std::size_t unacknowledged(int socket);

/// Octets that may be unacknowledged for want of room at the other side; no limit where the system
/// does not report it (Linux before 5.4).
[[nodiscard]] std::size_t window_of_other_side(int socket);

} // namespace rubicon::io
