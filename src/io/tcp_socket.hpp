// For files of this room only: makes streams of connected sockets, and listens for them.
#pragma once

#include <boost/asio/ip/tcp.hpp>

#include "io/tcp_stream.hpp"

namespace rubicon::io {

[[nodiscard]] tcp_stream stream_of(boost::asio::ip::tcp::socket connected);

/// Opens the acceptor at an address that a process before may have had; closed again if that fails.
[[nodiscard]] boost::system::error_code listen_at(boost::asio::ip::tcp::acceptor& acceptor,
                                                  const boost::asio::ip::tcp::endpoint& where);

} // namespace rubicon::io
