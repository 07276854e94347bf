// For files of this room only: makes streams of connected sockets.
#pragma once

#include <boost/asio/ip/tcp.hpp>

#include "io/tcp_stream.hpp"

namespace rubicon::io {

[[nodiscard]] tcp_stream stream_of(boost::asio::ip::tcp::socket connected);

} // namespace rubicon::io
