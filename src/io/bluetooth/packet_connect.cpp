#include "io/bluetooth/packet_connect.hpp"

#include <cerrno>
#include <utility>

#include <sys/socket.h>

#include <boost/asio/error.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>

#include "io/context.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using boost::system::error_code;

struct packet_connect::state : std::enable_shared_from_this<state> {
  state(loop& where, descriptor x, callback f)
      : socket(context_of(where), x.take()), patience(context_of(where)), on_result(std::move(f)) {}

  asio::posix::stream_descriptor socket;
  asio::steady_timer patience;
  callback on_result;
  bool over = false;

  void begin(duration timeout) {
    patience.expires_after(timeout);
    patience.async_wait([x = shared_from_this()](const error_code& error) {
      if (!error)
        x->finish(asio::error::timed_out);
    });
    socket.async_wait(
        asio::posix::stream_descriptor::wait_write,
        [x = shared_from_this()](const error_code& error) { x->finish(x->outcome(error)); });
  }

  [[nodiscard]] error_code outcome(const error_code& waited) {
    int error = 0;
    socklen_t size = sizeof error;
    if (waited || ::getsockopt(socket.native_handle(), SOL_SOCKET, SO_ERROR, &error, &size) != 0)
      return waited;
    return {error, boost::system::system_category()};
  }

  void finish(const error_code& error) {
    if (std::exchange(over, true))
      return;
    patience.cancel();
    if (error) {
      stop();
      on_result(error.message());
    } else {
      on_result(descriptor(socket.release()));
    }
  }

  void stop() {
    over = true;
    patience.cancel();
    error_code ignored;
    socket.close(ignored);
  }
};

packet_connect::packet_connect(loop& where, descriptor connecting, duration timeout,
                               callback on_result)
    : state_(std::make_shared<state>(where, std::move(connecting), std::move(on_result))) {
  state_->begin(timeout);
}

packet_connect::~packet_connect() {
  if (state_ && !state_->over)
    state_->stop();
}

packet_connect::packet_connect(packet_connect&&) noexcept = default;

packet_connect& packet_connect::operator=(packet_connect&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}

} // namespace rubicon::io
