#include "io/bluetooth/packet_stream.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <deque>
#include <string>
#include <utility>

#include <sys/socket.h>
#include <sys/uio.h>

#include <boost/asio/error.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "io/context.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

constexpr int packets_of_a_turn = 16;
constexpr auto no_wait = MSG_DONTWAIT | MSG_NOSIGNAL;

std::string message_of(int error) {
  return error_code(error, boost::system::system_category()).message();
}

bool is_full(int error) {
  return error == EAGAIN || error == EWOULDBLOCK;
}

} // namespace

///   open --close()--> draining --all sent, error, or time--> over
///    +--end of stream, error, packet too long---------------^
struct packet_stream::state : std::enable_shared_from_this<state> {
  enum class phase : std::uint8_t { open, draining, over };

  state(loop& where, descriptor x, std::size_t octets)
      : socket(context_of(where), x.take()), patience(context_of(where)), pause(context_of(where)),
        room(octets) {
    error_code ignored;
    socket.non_blocking(true, ignored);
  }

  asio::posix::stream_descriptor socket;
  asio::steady_timer patience;
  asio::steady_timer pause; ///< of a system without memory for a packet
  std::size_t room;
  callbacks to_owner;
  std::function<void()> on_done;
  phase now = phase::open;
  bool started = false;
  bool wanted = true;   ///< the owner takes more
  bool reading = false; ///< take_some() will come
  bool broken = false;  ///< nothing can be sent any more
  bool write_due = false;
  std::size_t packet_size = packet_max; ///< that the medium takes, as far as is known
  std::array<std::uint8_t, packet_max> input{};
  std::deque<payload> output;
  std::size_t gone = 0; ///< octets of output.front() that have left
  std::size_t unsent = 0;

  void receive() {
    if (now != phase::open || !wanted || std::exchange(reading, true))
      return;
    socket.async_wait(asio::posix::stream_descriptor::wait_read,
                      [x = shared_from_this()](const error_code& error) {
                        x->reading = false;
                        if (error)
                          x->fail(error.message());
                        else
                          x->take_some();
                      });
  }

  void take_some() {
    for (int i = 0; i < packets_of_a_turn && now == phase::open && wanted; ++i) {
      iovec piece{input.data(), input.size()};
      msghdr packet{};
      packet.msg_iov = &piece;
      packet.msg_iovlen = 1;
      const auto size = ::recvmsg(socket.native_handle(), &packet, MSG_DONTWAIT);
      if (size < 0 && (is_full(errno) || errno == EINTR))
        break;
      if (size < 0)
        return fail(message_of(errno));
      if (size == 0)
        return fail("closed by the other side");
      if ((packet.msg_flags & MSG_TRUNC) != 0)
        return fail("a packet of more than " + std::to_string(packet_max) + " octets arrived");
      to_owner.on_packet(byte_view(input).first(static_cast<std::size_t>(size)));
    }
    receive();
  }

  void flush_soon() {
    if (std::exchange(write_due, true))
      return;
    asio::post(socket.get_executor(), [x = shared_from_this()] { x->flush(); });
  }

  void flush() {
    write_due = false;
    std::size_t sent = 0;
    while (now != phase::over && !output.empty() && !write_due) {
      const auto size = write_some();
      if (size < 0)
        on_write_failed(errno);
      else
        sent += static_cast<std::size_t>(size);
    }
    if (now == phase::draining && output.empty())
      end();
    if (sent > 0 && now == phase::open)
      to_owner.on_sent(sent);
  }

  ssize_t write_some() {
    const auto rest = output.front().view().subspan(gone);
    const auto size =
        ::send(socket.native_handle(), rest.data(), std::min(rest.size(), packet_size), no_wait);
    if (size < 0)
      return size;
    gone += static_cast<std::size_t>(size);
    unsent -= static_cast<std::size_t>(size);
    if (gone >= output.front().size()) {
      output.pop_front();
      gone = 0;
    }
    return size;
  }

  void on_write_failed(int error) {
    if (error == EINTR)
      return;
    if (is_full(error)) {
      flush_when_possible();
    } else if (error == ENOBUFS || error == ENOMEM) {
      flush_later();
    } else if (error == EMSGSIZE && packet_size > packet_min) {
      packet_size = std::max(packet_min, packet_size / 2);
    } else { // what had arrived before is still to be read; reading finds the failure too
      broken = true;
      output.clear();
      unsent = 0;
    }
  }

  void flush_when_possible() {
    write_due = true;
    socket.async_wait(asio::posix::stream_descriptor::wait_write,
                      [x = shared_from_this()](const error_code&) { x->flush(); });
  }

  void flush_later() {
    write_due = true;
    pause.expires_after(pause_after_error);
    pause.async_wait([x = shared_from_this()](const error_code&) { x->flush(); });
  }

  void fail(const std::string& why) {
    if (now != phase::open)
      return;
    end();
    to_owner.on_closed(why);
  }

  void close(std::function<void()> done) {
    if (now != phase::open) {
      if (done)
        asio::post(socket.get_executor(), std::move(done));
      return;
    }
    on_done = std::move(done);
    now = phase::draining;
    if (output.empty()) {
      end();
      return;
    }
    patience.expires_after(drain_max);
    patience.async_wait([x = shared_from_this()](const error_code& error) {
      if (!error)
        x->end();
    });
  }

  void end() {
    if (std::exchange(now, phase::over) == phase::over)
      return;
    error_code ignored;
    socket.close(ignored);
    patience.cancel();
    pause.cancel();
    output.clear();
    unsent = 0;
    if (on_done)
      asio::post(socket.get_executor(), std::exchange(on_done, nullptr));
  }
};

packet_stream::packet_stream() = default;

packet_stream::packet_stream(loop& where, descriptor connected, std::size_t room)
    : state_(std::make_shared<state>(where, std::move(connected), room)) {}

packet_stream::~packet_stream() {
  if (state_ && state_->now == state::phase::open)
    state_->end();
}

packet_stream::packet_stream(packet_stream&&) noexcept = default;

packet_stream& packet_stream::operator=(packet_stream&& other) noexcept {
  packet_stream replaced;
  replaced.state_ = std::exchange(state_, std::exchange(other.state_, nullptr));
  return *this;
}

void packet_stream::start(callbacks x) {
  assert(state_ && !state_->started && x.on_packet && x.on_sent && x.on_closed);
  state_->to_owner = std::move(x);
  state_->started = true;
  state_->receive();
}

void packet_stream::read(bool wanted) {
  assert(state_ && state_->started);
  state_->wanted = wanted;
  state_->receive();
}

bool packet_stream::send(payload packet) {
  assert(state_ && state_->started);
  if (state_->now != state::phase::open || state_->broken || packet.empty())
    return true;
  if (state_->unsent + packet.size() > state_->room)
    return false;
  state_->unsent += packet.size();
  state_->output.push_back(std::move(packet));
  state_->flush_soon();
  return true;
}

std::size_t packet_stream::unsent() const {
  return state_ ? state_->unsent : 0;
}

void packet_stream::close(std::function<void()> done) {
  assert(state_);
  state_->close(std::move(done));
}

} // namespace rubicon::io
