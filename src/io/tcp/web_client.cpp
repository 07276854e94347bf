#include "io/tcp/web_client.hpp"

#include <array>
#include <chrono>
#include <deque>
#include <exception>
#include <iterator>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include "io/tcp/signals_blocked.hpp"
#include "io/tcp/tcp_socket.hpp"

namespace rubicon::io {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::size_t read_octets = 16 * 1024; ///< at a time

std::chrono::seconds whole_seconds(duration x) {
  return std::chrono::duration_cast<std::chrono::seconds>(x);
}

/// What both threads use.
class web_boxes {
public:
  explicit web_boxes(std::function<void()> wake) : wake_(std::move(wake)) {}

  // For the owner.

  /// @returns whether reading was paused for want of room
  bool take(std::vector<web_event>& to) {
    const std::lock_guard lock(mutex_);
    const bool paused = std::exchange(paused_, false);
    to.assign(std::make_move_iterator(inbox_.begin()), std::make_move_iterator(inbox_.end()));
    inbox_.clear();
    inbox_octets_ = 0;
    seen_life_ = life_;
    return paused;
  }

  /// @returns whether the client's thread has to look
  bool add(std::string text) {
    const std::lock_guard lock(mutex_);
    if (!is_connected_ || seen_life_ != life_) {
      ++counters_.not_sent;
      return false;
    }
    if (outbox_.size() >= web_client::outbox_max)
      overflowed_ = true;
    else
      outbox_.push_back(std::move(text));
    return outbox_.size() == 1 || overflowed_;
  }

  web_client_counters counters() const {
    const std::lock_guard lock(mutex_);
    return counters_;
  }

  // For the client's thread.

  void count_attempt() {
    const std::lock_guard lock(mutex_);
    ++counters_.attempts;
  }

  void begin_life() {
    const std::lock_guard lock(mutex_);
    ++life_;
    is_connected_ = true;
    report(web_connected{});
  }

  void end_life(std::string cause) {
    const std::lock_guard lock(mutex_);
    ++life_;
    is_connected_ = false;
    counters_.not_sent += outbox_.size();
    counters_.queue_full += std::exchange(overflowed_, false) ? 1 : 0;
    outbox_.clear();
    paused_ = false;
    report(web_disconnected{std::move(cause)});
  }

  /// @returns whether there is room for more; else take() says that reading was paused
  bool on_message(std::optional<std::string> text, bool is_text) {
    const std::lock_guard lock(mutex_);
    ++counters_.received;
    counters_.not_text += is_text ? 0 : 1;
    counters_.oversized += text ? 0 : 1;
    if (text && is_text) {
      inbox_octets_ += text->size();
      report(web_message{*std::move(text)});
    }
    paused_ =
        inbox_.size() >= web_client::inbox_max || inbox_octets_ >= web_client::inbox_octets_max;
    counters_.read_pauses += paused_ ? 1 : 0;
    return !paused_;
  }

  void on_sent() {
    const std::lock_guard lock(mutex_);
    ++counters_.sent;
    if (auto* last = inbox_.empty() ? nullptr : std::get_if<web_sent>(&inbox_.back()))
      ++last->count;
    else
      report(web_sent{1});
  }

  bool has_overflowed() const {
    const std::lock_guard lock(mutex_);
    return overflowed_;
  }

  std::optional<std::string> next_to_send() {
    const std::lock_guard lock(mutex_);
    if (outbox_.empty())
      return std::nullopt;
    std::optional<std::string> out(std::move(outbox_.front()));
    outbox_.pop_front();
    return out;
  }

private:
  /// @pre the mutex is held
  void report(web_event x) {
    inbox_.push_back(std::move(x));
    if (inbox_.size() == 1 && wake_)
      wake_();
  }

  mutable std::mutex mutex_;
  std::function<void()> wake_;
  bool is_connected_ = false;
  bool overflowed_ = false;
  bool paused_ = false;
  std::uint64_t life_ = 0;      ///< changes when a connection begins, and when it ends
  std::uint64_t seen_life_ = 0; ///< when take() was called last
  std::deque<std::string> outbox_;
  std::deque<web_event> inbox_;
  std::size_t inbox_octets_ = 0;
  web_client_counters counters_;
};

/// One attempt, and the connection that comes of it. Handlers keep it alive.
class web_connection : public std::enable_shared_from_this<web_connection> {
public:
  web_connection(asio::io_context& context, web_boxes& boxes, const web_client_settings& to)
      : boxes_(boxes), to_(to), resolver_(context), socket_(context) {}

  void begin() {
    boxes_.count_attempt();
    error_code not_numeric;
    const auto address = asio::ip::make_address_v4(to_.host, not_numeric);
    if (!not_numeric)
      return connect(std::array{tcp::endpoint(address, to_.port)});
    resolver_.async_resolve(tcp::v4(), to_.host, std::to_string(to_.port),
                            [x = shared_from_this()](const error_code& error,
                                                     const tcp::resolver::results_type& found) {
                              if (error)
                                return x->end(attempt_failure(error));
                              x->connect(found);
                            });
  }

  [[nodiscard]] bool is_over() const { return over_; }

  void send_waiting() {
    if (over_ || !is_open_)
      return;
    if (boxes_.has_overflowed())
      return end("too much waits to be sent");
    if (is_writing_)
      return;
    auto next = boxes_.next_to_send();
    if (!next)
      return;
    is_writing_ = true;
    leaving_ = *std::move(next);
    socket_.async_write(asio::buffer(leaving_),
                        [x = shared_from_this()](const error_code& error, std::size_t) {
                          x->is_writing_ = false;
                          if (error)
                            return x->end(error.message());
                          x->boxes_.on_sent();
                          x->send_waiting();
                        });
  }

  /// Once more after a pause.
  void read() {
    if (over_ || is_reading_ || !is_open_)
      return;
    is_reading_ = true;
    socket_.async_read_some(buffer_, read_octets,
                            [x = shared_from_this()](const error_code& error, std::size_t) {
                              x->is_reading_ = false;
                              if (error)
                                return x->end(error.message());
                              x->on_octets();
                            });
  }

  void end(std::string cause) {
    if (std::exchange(over_, true))
      return;
    beast::get_lowest_layer(socket_).close();
    boxes_.end_life(std::move(cause));
  }

private:
  template <class Endpoints>
  void connect(const Endpoints& all) {
    auto& below = beast::get_lowest_layer(socket_);
    below.expires_after(whole_seconds(web_client::answer_max));
    below.async_connect(all, [x = shared_from_this()](const error_code& error, const auto&) {
      if (error)
        return x->end(error.message());
      x->greet();
    });
  }

  void greet() {
    auto& below = beast::get_lowest_layer(socket_);
    below.expires_never(); // from here on the WebSocket has a timeout of its own
    error_code ignored;
    below.socket().set_option(tcp::no_delay(true), ignored); // messages are small, and in time
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = whole_seconds(web_client::answer_max);
    timeout.idle_timeout = whole_seconds(web_client::silence_max);
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(web_client::message_end_max);
    socket_.text(true);
    socket_.async_handshake(to_.host + ':' + std::to_string(to_.port), to_.path,
                            [x = shared_from_this()](const error_code& error) {
                              if (error)
                                return x->end(error.message());
                              x->is_open_ = true;
                              x->boxes_.begin_life();
                              x->read();
                            });
  }

  /// Of one message, which may be incomplete.
  void on_octets() {
    if (is_dropped_ || buffer_.size() > web_client::message_max) {
      is_dropped_ = true;
      buffer_.clear();
    }
    bool has_room = true;
    if (socket_.is_message_done()) {
      std::optional<std::string> text;
      if (!std::exchange(is_dropped_, false))
        text = beast::buffers_to_string(buffer_.data());
      buffer_.clear();
      has_room = boxes_.on_message(std::move(text), socket_.got_text());
    }
    if (has_room)
      read();
  }

  web_boxes& boxes_;
  const web_client_settings& to_;
  tcp::resolver resolver_;
  websocket::stream<beast::tcp_stream, false> socket_;
  beast::flat_buffer buffer_;
  std::string leaving_;
  bool is_open_ = false;
  bool is_reading_ = false;
  bool is_writing_ = false;
  bool is_dropped_ = false; ///< the message that is being read is too long
  bool over_ = false;
};

} // namespace

class web_client::state {
public:
  state(web_client_settings settings, std::function<void()> wake)
      : settings_(std::move(settings)), boxes_(std::move(wake)) {
    const signals_blocked here;
    thread_ = std::thread([this] { run(); });
  }

  ~state() {
    context_.stop();
    thread_.join();
  }
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  void connect() {
    asio::post(context_, [this] {
      if (connection_ && !connection_->is_over())
        return;
      connection_ = std::make_shared<web_connection>(context_, boxes_, settings_);
      connection_->begin();
    });
  }

  void send(std::string text) {
    if (boxes_.add(std::move(text)))
      asio::post(context_, [this] {
        if (connection_)
          connection_->send_waiting();
      });
  }

  std::vector<web_event> take() {
    std::vector<web_event> out;
    if (boxes_.take(out))
      asio::post(context_, [this] {
        if (connection_)
          connection_->read();
      });
    return out;
  }

  [[nodiscard]] web_client_counters counters() const { return boxes_.counters(); }

private:
  void run() {
    while (!context_.stopped()) {
      try {
        context_.run();
      } catch (const std::exception& x) { // out of memory, say
        if (connection_)
          connection_->end(x.what());
      }
    }
  }

  const web_client_settings settings_;
  web_boxes boxes_; ///< before the context, whose handlers keep connections alive
  asio::io_context context_{1};
  asio::executor_work_guard<asio::io_context::executor_type> work_{context_.get_executor()};
  std::shared_ptr<web_connection> connection_; ///< of the thread
  std::thread thread_;
};

web_client::web_client(web_client_settings settings, std::function<void()> wake)
    : state_(std::make_unique<state>(std::move(settings), std::move(wake))) {}

web_client::~web_client() = default;

void web_client::connect() {
  state_->connect();
}

void web_client::send(std::string text) {
  state_->send(std::move(text));
}

std::vector<web_event> web_client::take() {
  return state_->take();
}

web_client_counters web_client::counters() const {
  return state_->counters();
}

} // namespace rubicon::io
