// For files of this room only: the Asio context behind a loop.
#pragma once

#include <boost/asio/io_context.hpp>

#include "core/time.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

/// A socket that has failed is tried again after so long.
inline constexpr duration pause_after_error = 100ms;

/// Handlers posted or completed here run inside loop::poll() and loop::wait_until().
[[nodiscard]] boost::asio::io_context& context_of(loop& x);

} // namespace rubicon::io
