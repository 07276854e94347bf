// For files of this room only: makes streams of connected sockets, listens for them,
// and says why an attempt failed.
#pragma once

#include <string>

#include <boost/asio/ip/tcp.hpp>

#include "io/tcp/tcp_stream.hpp"

namespace rubicon::io {

[[nodiscard]] tcp_stream stream_of(boost::asio::ip::tcp::socket connected);

/// Opens the acceptor at an address that a process before may have had; closed again if that fails.
[[nodiscard]] boost::system::error_code listen_at(boost::asio::ip::tcp::acceptor& acceptor,
                                                  const boost::asio::ip::tcp::endpoint& where);

/// In words; is_unknown_host() knows them.
[[nodiscard]] std::string attempt_failure(const boost::system::error_code& x);

} // namespace rubicon::io
