#include "io/tcp_stream.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <deque>
#include <span>
#include <utility>

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "io/tcp_socket.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

constexpr std::size_t input_min = 16 * 1024;
constexpr std::size_t input_max = 128 * 1024; // of each link, however many there are
constexpr std::size_t pieces_max = 64;        ///< payloads in one write

/// Without these options a stream still works.
void set_option(asio::ip::tcp::socket& socket, int name, int value) {
  static_cast<void>(::setsockopt(socket.native_handle(), IPPROTO_TCP, name, &value, sizeof value));
}

} // namespace

///   open --close()--> draining --all sent--> lingering --end of stream, or time--> over
///    |                   +------------ error, or time ------------------------------^
///    +--end of stream, error---------------------------------------------------------
struct tcp_stream::state : std::enable_shared_from_this<state> {
  enum class phase : std::uint8_t { open, draining, lingering, over };

  explicit state(asio::ip::tcp::socket x) : socket(std::move(x)), patience(socket.get_executor()) {
    error_code ignored;
    socket.non_blocking(true, ignored);
    set_option(socket, TCP_NODELAY, 1);
#ifdef TCP_NOTSENT_LOWAT
    set_option(socket, TCP_NOTSENT_LOWAT, unsent_in_system);
#endif
    const auto remote = socket.remote_endpoint(ignored);
    if (!ignored)
      name = remote.address().to_string() + ':' + std::to_string(remote.port());
  }

  asio::ip::tcp::socket socket;
  asio::steady_timer patience;
  std::string name;
  callbacks to_owner;
  std::function<void()> on_done;
  phase now = phase::open;
  bool started = false;
  bool wanted = true;   ///< the owner takes more
  bool reading = false; ///< on_received() will come
  bytes input;
  std::deque<payload> output;
  std::size_t gone = 0; ///< octets of output.front() that have left
  std::size_t unsent = 0;
  bool broken = false;    ///< nothing can be sent any more
  bool write_due = false; ///< flush() is about to run, or waits for room

  void receive() {
    if (std::exchange(reading, true))
      return;
    socket.async_read_some(asio::buffer(input),
                           [x = shared_from_this()](const error_code& error, std::size_t size) {
                             x->on_received(error, size);
                           });
  }

  void on_received(const error_code& error, std::size_t size) {
    reading = false;
    if (now == phase::over)
      return;
    if (error) {
      fail(error);
      return;
    }
    if (now == phase::open)
      to_owner.on_octets(byte_view(input).first(size));
    if (now == phase::over)
      return;
#ifdef TCP_QUICKACK
    set_option(socket, TCP_QUICKACK, 1); // the system forgets it by itself
#endif
    if (size == input.size() && size < input_max)
      input.resize(2 * size);
    if (wanted || now != phase::open)
      receive();
  }

  void flush_soon() {
    if (std::exchange(write_due, true))
      return;
    asio::post(socket.get_executor(), [x = shared_from_this()] { x->flush(); });
  }

  void flush() {
    write_due = false;
    if (now == phase::over)
      return;
    error_code error;
    std::size_t sent = 0;
    while (!output.empty() && !error)
      sent += write_some(error);
    if (error == asio::error::would_block || error == asio::error::try_again)
      flush_when_possible();
    else if (error)
      on_write_failed(error);
    if (sent > 0 && now == phase::open)
      to_owner.on_sent(sent);
    if (now == phase::draining && output.empty())
      linger();
  }

  std::size_t write_some(error_code& error) {
    std::array<asio::const_buffer, pieces_max> pieces;
    const auto count = std::min(output.size(), pieces.size());
    for (std::size_t i = 0; i < count; ++i)
      pieces[i] = asio::buffer(output[i].view().data(), output[i].size());
    pieces[0] += gone;
    const auto sent = socket.write_some(std::span(pieces).first(count), error);
    unsent -= sent;
    gone += sent;
    while (!output.empty() && gone >= output.front().size()) {
      gone -= output.front().size();
      output.pop_front();
    }
    return sent;
  }

  void flush_when_possible() {
    write_due = true;
    socket.async_wait(asio::ip::tcp::socket::wait_write,
                      [x = shared_from_this()](const error_code&) { x->flush(); });
  }

  /// What had arrived before is still to be read; reading finds the failure too.
  void on_write_failed(const error_code& error) {
    if (now != phase::open) {
      fail(error);
      return;
    }
    broken = true;
    output.clear();
    unsent = 0;
  }

  void fail(const error_code& error) {
    const bool told = now == phase::open;
    end();
    if (told)
      to_owner.on_closed(error == asio::error::eof ? "closed by the other side" : error.message());
  }

  void close(std::function<void()> done) {
    if (now != phase::open) {
      if (done)
        asio::post(socket.get_executor(), std::move(done));
      return;
    }
    on_done = std::move(done);
    now = phase::draining;
    end_after(drain_max);
    if (output.empty())
      linger();
  }

  /// Closing with octets unread would make the system take back what has not arrived yet.
  void linger() {
    now = phase::lingering;
    error_code ignored;
    socket.shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
    end_after(linger_max);
    if (!std::exchange(started, true))
      input.resize(input_min);
    receive();
  }

  void end_after(duration length) {
    patience.expires_after(length);
    patience.async_wait([x = shared_from_this()](const error_code& error) {
      if (!error)
        x->end();
    });
  }

  void reset() {
    error_code ignored;
    socket.set_option(asio::socket_base::linger(true, 0), ignored);
    end();
  }

  void end() {
    if (std::exchange(now, phase::over) == phase::over)
      return;
    error_code ignored;
    socket.close(ignored);
    patience.cancel();
    output.clear();
    if (on_done)
      asio::post(socket.get_executor(), std::exchange(on_done, nullptr));
  }
};

tcp_stream::tcp_stream() = default;

tcp_stream::tcp_stream(std::shared_ptr<state> x) : state_(std::move(x)) {}

tcp_stream::~tcp_stream() {
  if (state_ && state_->now == state::phase::open)
    state_->end();
}

tcp_stream::tcp_stream(tcp_stream&&) noexcept = default;

tcp_stream& tcp_stream::operator=(tcp_stream&& other) noexcept {
  const tcp_stream replaced(std::exchange(state_, std::exchange(other.state_, nullptr)));
  return *this;
}

void tcp_stream::start(callbacks x) {
  assert(state_ && !state_->started && x.on_octets && x.on_sent && x.on_closed);
  if (state_->now != state::phase::open)
    return;
  state_->to_owner = std::move(x);
  state_->started = true;
  state_->input.resize(input_min);
  state_->receive();
}

void tcp_stream::read(bool wanted) {
  assert(state_ && state_->started);
  state_->wanted = wanted;
  if (wanted && state_->now == state::phase::open)
    state_->receive();
}

void tcp_stream::send(payload octets) {
  assert(state_ && state_->started);
  if (state_->now != state::phase::open || state_->broken || octets.empty())
    return;
  state_->unsent += octets.size();
  state_->output.push_back(std::move(octets));
  state_->flush_soon();
}

std::size_t tcp_stream::unsent() const {
  return state_ ? state_->unsent : 0;
}

void tcp_stream::close(std::function<void()> done) {
  assert(state_);
  state_->close(std::move(done));
}

void tcp_stream::reset() {
  assert(state_);
  state_->reset();
}

std::string tcp_stream::remote_address() const {
  return state_ ? state_->name : std::string();
}

tcp_stream stream_of(asio::ip::tcp::socket connected) {
  return tcp_stream(std::make_shared<tcp_stream::state>(std::move(connected)));
}

} // namespace rubicon::io
