#include "io/bluetooth/packet_listener.hpp"

#include <cerrno>
#include <utility>

#include <sys/socket.h>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>

#include "io/context.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using boost::system::error_code;

struct packet_listener::state : std::enable_shared_from_this<state> {
  state(loop& where, descriptor x, callback f)
      : socket(context_of(where), x.take()), pause(context_of(where)), on_connection(std::move(f)) {
    error_code ignored;
    socket.non_blocking(true, ignored);
  }

  asio::posix::stream_descriptor socket;
  asio::steady_timer pause;
  callback on_connection;
  bool over = false;

  void wait() {
    socket.async_wait(asio::posix::stream_descriptor::wait_read,
                      [x = shared_from_this()](const error_code& error) {
                        if (x->over)
                          return;
                        if (error)
                          x->wait_later();
                        else
                          x->accept();
                      });
  }

  void accept() {
    descriptor x(::accept4(socket.native_handle(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    const bool may_go_on = x.get() != -1 || errno == EAGAIN || errno == EWOULDBLOCK ||
                           errno == EINTR || errno == ECONNABORTED;
    if (x.get() != -1)
      on_connection(std::move(x));
    if (over)
      return;
    if (may_go_on)
      wait();
    else
      wait_later();
  }

  void wait_later() {
    pause.expires_after(pause_after_error);
    pause.async_wait([x = shared_from_this()](const error_code&) {
      if (!x->over)
        x->wait();
    });
  }
};

packet_listener::packet_listener(loop& where, descriptor listening, callback on_connection)
    : state_(std::make_shared<state>(where, std::move(listening), std::move(on_connection))) {
  state_->wait();
}

packet_listener::~packet_listener() {
  if (!state_)
    return;
  state_->over = true;
  error_code ignored;
  state_->socket.close(ignored);
  state_->pause.cancel();
}

packet_listener::packet_listener(packet_listener&&) noexcept = default;

} // namespace rubicon::io
