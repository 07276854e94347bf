#include "io/tcp/tcp_connect.hpp"

#include <array>
#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "io/context.hpp"
#include "io/tcp/tcp_socket.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::string_view unknown_host = "no host has this name";

} // namespace

std::string attempt_failure(const error_code& x) {
  return x == asio::error::host_not_found ? std::string(unknown_host) : x.message();
}

bool is_unknown_host(std::string_view why) {
  return why.ends_with(unknown_host);
}

struct tcp_connect::state : std::enable_shared_from_this<state> {
  state(loop& where, std::string to, callback f)
      : socket(context_of(where)), resolver(context_of(where)), patience(context_of(where)),
        target(std::move(to)), on_result(std::move(f)) {}

  tcp::socket socket;
  tcp::resolver resolver;
  asio::steady_timer patience;
  std::string target;
  callback on_result;
  bool over = false;

  void begin(const std::string& host, std::uint16_t port, duration timeout) {
    patience.expires_after(timeout);
    patience.async_wait([x = shared_from_this()](const error_code& error) {
      if (!error)
        x->finish(asio::error::timed_out);
    });
    error_code not_numeric;
    const auto address = asio::ip::make_address_v4(host, not_numeric);
    if (!not_numeric) {
      connect_to(std::array{tcp::endpoint(address, port)});
      return;
    }
    resolver.async_resolve(tcp::v4(), host, std::to_string(port),
                           [x = shared_from_this()](const error_code& error,
                                                    const tcp::resolver::results_type& found) {
                             if (error)
                               x->finish(error);
                             else if (!x->over)
                               x->connect_to(found);
                           });
  }

  template <class Endpoints>
  void connect_to(const Endpoints& all) {
    asio::async_connect(socket, all,
                        [x = shared_from_this()](const error_code& error, const tcp::endpoint&) {
                          x->finish(error);
                        });
  }

  void finish(const error_code& error) {
    if (over)
      return;
    stop();
    if (error)
      on_result(target + ": " + attempt_failure(error));
    else
      on_result(stream_of(std::move(socket)));
  }

  void stop() {
    over = true;
    patience.cancel();
    resolver.cancel();
  }
};

tcp_connect::tcp_connect(loop& where, std::string host, std::uint16_t port, duration timeout,
                         callback on_result)
    : state_(
          std::make_shared<state>(where, host + ':' + std::to_string(port), std::move(on_result))) {
  state_->begin(host, port, timeout);
}

tcp_connect::~tcp_connect() {
  if (!state_)
    return;
  state_->stop();
  error_code ignored;
  state_->socket.close(ignored);
}

tcp_connect::tcp_connect(tcp_connect&&) noexcept = default;

tcp_connect& tcp_connect::operator=(tcp_connect&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}

} // namespace rubicon::io
