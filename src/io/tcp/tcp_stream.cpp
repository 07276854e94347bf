#include "io/tcp/tcp_stream.hpp"

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

#include "io/tcp/tcp_socket.hpp"
#include "io/tcp/tcp_window.hpp"

namespace rubicon::io {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

constexpr std::size_t input_min = 16 * 1024;
constexpr std::size_t input_max = 128 * 1024; // of each link, however many there are
constexpr std::size_t pieces_max = 64;        ///< payloads in one write
constexpr duration look_gap = 1ms;            // at what was acknowledged
constexpr duration quiet_look_gap = 10ms;     // the same, when nothing has been for some time
constexpr duration quiet_after = 100ms;
constexpr duration patience_max = 500ms; // with a window that has no room for a whole

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

  explicit state(asio::ip::tcp::socket x)
      : socket(std::move(x)), patience(socket.get_executor()), next_look(socket.get_executor()) {
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
  asio::steady_timer next_look; ///< at what the other side has acknowledged
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
  // While paced:
  bool paced = false;
  bool look_due = false;
  std::uint64_t written = 0;  ///< octets that the system has
  std::uint64_t reported = 0; ///< of these, passed to on_sent()
  std::chrono::steady_clock::time_point
      moved; ///< when something was last acknowledged or written, or began to wait

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
    const bool whole = paced && now == phase::open;
    auto room = whole ? room_at_other_side() : SIZE_MAX;
    while (!output.empty() && !error && (gone > 0 || output.front().size() <= room)) {
      const auto some = write_some(error, whole ? 1 : pieces_max);
      sent += some;
      room -= whole ? std::min(room, some) : 0;
    }
    written += sent;
    if (error == asio::error::would_block || error == asio::error::try_again)
      flush_when_possible();
    else if (error)
      on_write_failed(error);
    if (whole)
      look(sent > 0);
    else if (sent > 0 && now == phase::open)
      report(written);
    if (now == phase::draining && output.empty())
      linger();
  }

  void report(std::uint64_t total) {
    if (const auto last = std::exchange(reported, std::max(reported, total)); last < reported)
      to_owner.on_sent(reported - last);
  }

  /// A whole that is cut by a window without room for it might never be completed. If nothing moves
  /// for long, word of more room may have been lost: TCP asks for it if it has something to send.
  std::size_t room_at_other_side() {
    const auto in_transit = unacknowledged(socket.native_handle());
    if (in_transit == 0 && moved + patience_max <= std::chrono::steady_clock::now())
      return output.empty() ? 0 : output.front().size();
    const auto window = window_of_other_side(socket.native_handle());
    return window - std::min(window, in_transit);
  }

  /// Reports what has been acknowledged, and looks again while there is more to come.
  void look(bool has_written) {
    const auto in_transit = unacknowledged(socket.native_handle());
    const auto acknowledged = written - std::min<std::uint64_t>(written, in_transit);
    const auto at = std::chrono::steady_clock::now();
    if (has_written || acknowledged > reported)
      moved = at;
    if ((in_transit > 0 || !output.empty()) && !std::exchange(look_due, true)) {
      next_look.expires_after(at - moved < quiet_after ? look_gap : quiet_look_gap);
      next_look.async_wait([x = shared_from_this()](const error_code&) {
        x->look_due = false;
        if (!x->write_due)
          x->flush();
      });
    }
    report(acknowledged);
  }

  std::size_t write_some(error_code& error, std::size_t count_max) {
    std::array<asio::const_buffer, pieces_max> pieces;
    const auto count = std::min(output.size(), count_max);
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
    const bool was_open = now == phase::open;
    end();
    if (was_open)
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
    next_look.cancel();
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
  if (state_->paced && state_->output.empty())
    state_->moved = std::chrono::steady_clock::now();
  state_->unsent += octets.size();
  state_->output.push_back(std::move(octets));
  state_->flush_soon();
}

void tcp_stream::pace() {
  assert(state_ && state_->started);
  state_->paced = true;
  state_->moved = std::chrono::steady_clock::now();
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
