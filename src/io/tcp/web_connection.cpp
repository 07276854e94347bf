#include "io/tcp/web_connection.hpp"

#include <array>
#include <chrono>
#include <optional>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>

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

/// Without the library's words for an end of TLS that was not announced.
std::string words_of(const error_code& x) {
  return x == asio::ssl::error::stream_truncated ? error_code(asio::error::eof).message()
                                                 : x.message();
}

/// The octets of a WebSocket as they are.
class plain_layer {
public:
  using stream_type = beast::tcp_stream;

  explicit plain_layer(const web_client_settings& /*to*/) {}

  [[nodiscard]] static stream_type stream(asio::io_context& context) {
    return stream_type(context);
  }
  [[nodiscard]] static std::string prepare(stream_type& /*x*/) { return {}; }

  template <class Done>
  static void shake_hands(stream_type& /*x*/, const Done& done) {
    done(std::string());
  }
};

/// The same, encrypted. The server must have a certificate for its name or address, unless nobody
/// is to verify it.
class tls_layer {
public:
  using stream_type = beast::ssl_stream<beast::tcp_stream>;

  explicit tls_layer(const web_client_settings& to) : to_(to) {
    SSL_CTX_set_min_proto_version(context_.native_handle(), TLS1_2_VERSION);
  }

  [[nodiscard]] stream_type stream(asio::io_context& context) {
    return stream_type(context, context_);
  }

  /// @returns why there cannot be a connection; empty: there can
  [[nodiscard]] std::string prepare(stream_type& x) {
    auto* const tls = x.native_handle();
    error_code not_numeric;
    static_cast<void>(asio::ip::make_address_v4(to_.host, not_numeric));
    if (not_numeric) // a server may have several names
      SSL_set_tlsext_host_name(tls, to_.host.c_str());
    if (!to_.verify)
      return {};
    if (not_numeric)
      SSL_set1_host(tls, to_.host.c_str());
    else
      X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(tls), to_.host.c_str());
    auto* const context = context_.native_handle();
    const bool is_read =
        to_.ca_file.empty()
            ? SSL_CTX_set_default_verify_paths(context) == 1
            : SSL_CTX_load_verify_locations(context, to_.ca_file.c_str(), nullptr) == 1;
    ERR_clear_error();
    if (!is_read)
      return "no certificates can be read from " +
             (to_.ca_file.empty() ? std::string("the system") : to_.ca_file);
    error_code error;
    x.set_verify_mode(asio::ssl::verify_peer, error);
    return error ? error.message() : std::string();
  }

  template <class Done>
  void shake_hands(stream_type& x, Done done) {
    beast::get_lowest_layer(x).expires_after(whole_seconds(web_client::answer_max));
    x.async_handshake(asio::ssl::stream_base::client,
                      [this, &x, done = std::move(done)](const error_code& error) {
                        done(error ? failure(x, error) : std::string());
                      });
  }

private:
  [[nodiscard]] std::string failure(stream_type& x, const error_code& error) const {
    const auto verdict = SSL_get_verify_result(x.native_handle());
    if (to_.verify && verdict != X509_V_OK)
      return "the certificate of " + to_.host +
             " is not believed: " + X509_verify_cert_error_string(verdict);
    if (error == beast::error::timeout)
      return words_of(error);
    return "no TLS with " + to_.host + ':' + std::to_string(to_.port) + ": " + words_of(error);
  }

  const web_client_settings& to_;
  asio::ssl::context context_{asio::ssl::context::tls_client};
};

/// @param Layer that the WebSocket uses, one of those above
template <class Layer>
class connection_over final : public web_connection,
                              public std::enable_shared_from_this<connection_over<Layer>> {
public:
  connection_over(asio::io_context& context, web_boxes& boxes, const web_client_settings& to)
      : boxes_(boxes), to_(to), resolver_(context), layer_(to), socket_(layer_.stream(context)) {}

  void begin() override {
    boxes_.count_attempt();
    if (auto why = layer_.prepare(socket_.next_layer()); !why.empty())
      return end(std::move(why));
    error_code not_numeric;
    const auto address = asio::ip::make_address_v4(to_.host, not_numeric);
    if (!not_numeric)
      return connect(std::array{tcp::endpoint(address, to_.port)});
    resolver_.async_resolve(tcp::v4(), to_.host, std::to_string(to_.port),
                            [x = this->shared_from_this()](
                                const error_code& error, const tcp::resolver::results_type& found) {
                              if (error)
                                return x->end(attempt_failure(error));
                              x->connect(found);
                            });
  }

  [[nodiscard]] bool is_over() const override { return over_; }

  void send_waiting() override {
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
                        [x = this->shared_from_this()](const error_code& error, std::size_t) {
                          x->is_writing_ = false;
                          if (error)
                            return x->end(words_of(error));
                          x->boxes_.on_sent();
                          x->send_waiting();
                        });
  }

  void read() override {
    if (over_ || is_reading_ || !is_open_)
      return;
    is_reading_ = true;
    socket_.async_read_some(buffer_, read_octets,
                            [x = this->shared_from_this()](const error_code& error, std::size_t) {
                              x->is_reading_ = false;
                              if (error)
                                return x->end(words_of(error));
                              x->on_octets();
                            });
  }

  void end(std::string cause) override {
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
    below.async_connect(all, [x = this->shared_from_this()](const error_code& error, const auto&) {
      if (error)
        return x->end(words_of(error));
      x->layer_.shake_hands(x->socket_.next_layer(), [x](const std::string& why) {
        if (!why.empty())
          return x->end(why);
        x->greet();
      });
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
                            [x = this->shared_from_this()](const error_code& error) {
                              if (error)
                                return x->end(words_of(error));
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
  Layer layer_;
  websocket::stream<typename Layer::stream_type, false> socket_;
  beast::flat_buffer buffer_;
  std::string leaving_;
  bool is_open_ = false;
  bool is_reading_ = false;
  bool is_writing_ = false;
  bool is_dropped_ = false; ///< the message that is being read is too long
  bool over_ = false;
};

} // namespace

std::shared_ptr<web_connection> make_web_connection(asio::io_context& context, web_boxes& boxes,
                                                    const web_client_settings& to) {
  if (to.tls)
    return std::make_shared<connection_over<tls_layer>>(context, boxes, to);
  return std::make_shared<connection_over<plain_layer>>(context, boxes, to);
}

} // namespace rubicon::io
