#include "io/tcp/tcp_listener.hpp"

#include <utility>

#include <boost/asio/error.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "io/context.hpp"
#include "io/tcp/tcp_socket.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

error_code listen_at(tcp::acceptor& acceptor, const tcp::endpoint& where) {
  error_code error;
  acceptor.open(where.protocol(), error);
  if (!error)
    acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error)
    acceptor.bind(where, error);
  if (!error)
    acceptor.listen(tcp::acceptor::max_listen_connections, error);
  if (error) {
    error_code ignored;
    acceptor.close(ignored);
  }
  return error;
}

struct tcp_listener::state : std::enable_shared_from_this<state> {
  state(loop& where, callback f)
      : acceptor(context_of(where)), pause(context_of(where)), on_connection(std::move(f)) {}

  tcp::acceptor acceptor;
  asio::steady_timer pause;
  callback on_connection;
  std::uint16_t port = 0;
  duration wanted_rest{};
  bool over = false;

  void accept() {
    acceptor.async_accept([x = shared_from_this()](const error_code& error, tcp::socket socket) {
      x->on_accepted(error, std::move(socket));
    });
  }

  void on_accepted(const error_code& error, tcp::socket socket) {
    if (over)
      return;
    if (!error) {
      error_code gone; // then it is known by no address, and its first octet shows it
      const auto from = socket.remote_endpoint(gone).address();
      on_connection(stream_of(std::move(socket)),
                    from.is_v4() ? from.to_v4().to_bytes() : ipv4_address{});
    }
    if (over)
      return;
    const bool may_go_on = !error || error == asio::error::connection_aborted;
    const auto length = std::exchange(wanted_rest, {}) + (may_go_on ? 0ms : pause_after_error);
    if (length == 0ms) {
      accept();
      return;
    }
    pause.expires_after(length);
    pause.async_wait([x = shared_from_this()](const error_code&) {
      if (!x->over)
        x->accept();
    });
  }
};

tcp_listener::tcp_listener(std::shared_ptr<state> x) : state_(std::move(x)) {}

std::variant<tcp_listener, std::string> tcp_listener::open(loop& where, const std::string& address,
                                                           std::uint16_t first_port,
                                                           callback on_connection) {
  const auto refusal = [&](const error_code& error) {
    return "cannot listen on " + address + ':' + std::to_string(first_port) + ": " +
           error.message();
  };
  error_code error;
  const auto parsed = asio::ip::make_address_v4(address, error);
  if (error)
    return refusal(error);
  auto x = std::make_shared<state>(where, std::move(on_connection));
  auto port = first_port;
  error = listen_at(x->acceptor, {parsed, port});
  while (error == asio::error::address_in_use && port != 0 && port != 0xffff)
    error = listen_at(x->acceptor, {parsed, ++port});
  if (error)
    return refusal(error);
  x->port = x->acceptor.local_endpoint(error).port();
  x->accept();
  return tcp_listener(std::move(x));
}

tcp_listener::~tcp_listener() {
  if (!state_)
    return;
  state_->over = true;
  error_code ignored;
  state_->acceptor.close(ignored);
  state_->pause.cancel();
}

tcp_listener::tcp_listener(tcp_listener&&) noexcept = default;

tcp_listener& tcp_listener::operator=(tcp_listener&& other) noexcept {
  const tcp_listener replaced(std::exchange(state_, std::exchange(other.state_, nullptr)));
  return *this;
}

std::uint16_t tcp_listener::port() const {
  return state_->port;
}

void tcp_listener::rest(duration length) {
  state_->wanted_rest = length;
}

std::string why_taken(loop& where, const std::string& address, std::uint16_t port) {
  const auto opened = tcp_listener::open(where, address, port, [](auto&&...) {});
  if (const auto* why = std::get_if<std::string>(&opened))
    return *why;
  return std::get<tcp_listener>(opened).port() == port
             ? ""
             : "port " + std::to_string(port) + " of " + address + " is taken";
}

} // namespace rubicon::io
