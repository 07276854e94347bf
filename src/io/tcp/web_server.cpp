#include "io/tcp/web_server.hpp"

#include <algorithm>
#include <exception>
#include <list>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "core/text/ipv4_network.hpp"
#include "io/tcp/signals_blocked.hpp"
#include "io/tcp/tcp_socket.hpp"

namespace rubicon::io {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

constexpr const char* policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::string_view view_of(beast::string_view x) {
  return {x.data(), x.size()};
}

/// As long for a wrong one as for the right one.
bool is_same(std::string_view x, std::string_view secret) {
  unsigned differs = x.size() == secret.size() ? 0 : 1;
  for (std::size_t i = 0; i < x.size(); ++i)
    differs |= static_cast<unsigned char>(x[i]) ^
               static_cast<unsigned char>(secret.empty() ? 0 : secret[i % secret.size()]);
  return differs == 0;
}

/// Whether a host, with or without its port, has one of these names.
bool is_one_of(std::string_view host, const std::vector<std::string>& names) {
  std::string name(host.substr(0, host.rfind(':')));
  std::ranges::transform(name, name.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  });
  return std::ranges::find(names, name) != names.end();
}

/// A name of this computer that nobody else can give to a host of theirs, an address, or one of
/// those that the site has.
bool is_own_host(std::string_view host, const std::vector<std::string>& names) {
  const auto name = host.substr(0, host.rfind(':'));
  return name == "localhost" || name == "[::1]" || parse_ipv4_address(std::string(name)) ||
         is_one_of(host, names);
}

/// A page that has come from this server: then the browser says the same of both; or through a
/// proxy of one of the names, which may encrypt, and may send another `Host`.
bool is_own_origin(std::string_view origin, std::string_view host,
                   const std::vector<std::string>& names) {
  constexpr std::string_view plain = "http://";
  constexpr std::string_view encrypted = "https://";
  if (origin.starts_with(plain)) {
    const auto from = origin.substr(plain.size());
    return from == host || is_one_of(from, names);
  }
  return origin.starts_with(encrypted) && is_one_of(origin.substr(encrypted.size()), names);
}

/// One that can be closed for another.
class closable {
public:
  closable() = default;
  virtual ~closable() = default;
  closable(const closable&) = delete;
  closable& operator=(const closable&) = delete;
  virtual void close() = 0;
};

struct served {
  web_site site;
  std::size_t connections = 0;
  std::list<closable*> unauthorised; ///< who have not shown the token, the oldest first
};

/// One that is counted while it lives.
class place {
public:
  explicit place(served& all) : all_(&all) { ++all_->connections; }
  ~place() {
    if (all_ != nullptr)
      --all_->connections;
  }
  place(place&& x) noexcept : all_(std::exchange(x.all_, nullptr)) {}
  place& operator=(place&&) = delete;

private:
  served* all_;
};

class live_socket : public std::enable_shared_from_this<live_socket> {
public:
  live_socket(tcp::socket socket, served& all, place taken)
      : place_(std::move(taken)), socket_(std::move(socket)), timer_(socket_.get_executor()),
        session_(all.site.on_session()) {}

  void start(const http::request<http::empty_body>& request) {
    auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
    timeout.idle_timeout = std::chrono::duration_cast<std::chrono::seconds>(web_server::patience);
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(web_server::question_octets_max);
    socket_.text(true);
    socket_.async_accept(request, [x = shared_from_this()](const error_code& error) {
      if (error)
        return;
      x->read();
      x->send_news();
    });
  }

private:
  void read() {
    socket_.async_read(buffer_, [x = shared_from_this()](const error_code& error, std::size_t) {
      if (error)
        return x->end();
      try {
        x->answer_ = x->session_->on_text(beast::buffers_to_string(x->buffer_.data()));
      } catch (const std::exception&) {
        return x->end();
      }
      x->buffer_.consume(x->buffer_.size());
      x->write_next();
    });
  }

  /// Sends news every news_every, unless something is being written.
  void send_news() {
    if (is_over_)
      return;
    try {
      if (auto news = is_writing_ ? std::nullopt : session_->news())
        write(std::move(*news), false);
    } catch (const std::exception&) {
      return end();
    }
    timer_.expires_after(web_server::news_every);
    timer_.async_wait([x = shared_from_this()](const error_code& error) {
      if (!error)
        x->send_news();
    });
  }

  void write_next() {
    if (answer_ && !is_writing_)
      write(*std::exchange(answer_, std::nullopt), true);
  }

  void write(std::string text, bool is_answer) {
    is_writing_ = true;
    leaving_ = std::move(text);
    socket_.async_write(asio::buffer(leaving_),
                        [x = shared_from_this(), is_answer](const error_code& error, std::size_t) {
                          x->is_writing_ = false;
                          if (error)
                            return x->end();
                          if (is_answer)
                            x->read();
                          x->write_next();
                        });
  }

  void end() {
    is_over_ = true;
    timer_.cancel();
    beast::get_lowest_layer(socket_).close();
  }

  place place_;
  websocket::stream<beast::tcp_stream, false> socket_;
  asio::steady_timer timer_;
  std::unique_ptr<web_session> session_;
  beast::flat_buffer buffer_;
  std::optional<std::string> answer_; ///< that waits for something else to have left
  std::string leaving_;
  bool is_writing_ = false;
  bool is_over_ = false;
};

class http_connection : public closable, public std::enable_shared_from_this<http_connection> {
public:
  http_connection(tcp::socket socket, served& all)
      : all_(all), place_(all), stream_(std::move(socket)),
        buffer_(web_server::request_octets_max + 1) {
    all_.unauthorised.push_back(this);
  }
  ~http_connection() override { all_.unauthorised.remove(this); }

  void close() override {
    all_.unauthorised.remove(this);
    stream_.close();
  }

  void read() {
    parser_.emplace();
    parser_->header_limit(web_server::request_octets_max);
    parser_->body_limit(0);
    stream_.expires_after(std::chrono::duration_cast<std::chrono::seconds>(web_server::patience));
    http::async_read(stream_, buffer_, *parser_,
                     [x = shared_from_this()](const error_code& error, std::size_t) {
                       if (!error)
                         x->on_request();
                     });
  }

private:
  void on_request() {
    const auto& request = parser_->get();
    const auto host = view_of(request[http::field::host]);
    if (!is_own_host(host, all_.site.hosts))
      return refuse(http::status::forbidden, "this host name is not served here\n");
    const auto target = view_of(request.target());
    const auto slash = all_.site.token.empty() ? 0 : target.find('/', 1);
    if (!target.starts_with('/') || slash == std::string_view::npos ||
        !is_same(target.substr(1, slash == 0 ? 0 : slash - 1), all_.site.token))
      return refuse(http::status::not_found, "not found: open the address that rubicon prints\n");
    if (!all_.site.token.empty())
      all_.unauthorised.remove(this);
    const auto name = target.substr(slash + 1, target.find('?') - slash - 1);
    if (websocket::is_upgrade(request)) {
      if (name != all_.site.socket_name || !all_.site.on_session)
        return refuse(http::status::not_found, "not found\n");
      if (!is_own_origin(view_of(request[http::field::origin]), host, all_.site.hosts))
        return refuse(http::status::forbidden, "only the page served here may connect\n");
      stream_.expires_never();
      std::make_shared<live_socket>(stream_.release_socket(), all_, std::move(place_))
          ->start(request);
      return;
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return refuse(http::status::method_not_allowed, "only GET and HEAD are supported\n");
    const auto found = all_.site.files.find(std::string(name));
    if (found != all_.site.files.end())
      return send(http::status::ok, found->second);
    auto made = all_.site.on_request ? all_.site.on_request(name) : std::nullopt;
    if (!made)
      return refuse(http::status::not_found, "not found\n");
    made_ = std::move(*made);
    send(http::status::ok, made_);
  }

  void refuse(http::status status, const char* why) {
    made_ = {"text/plain; charset=utf-8", why};
    send(status, made_);
  }

  void send(http::status status, const web_file& what) {
    const auto& request = parser_->get();
    response_ = {status, request.version()};
    response_.set(http::field::content_type, what.type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("Content-Security-Policy", policy);
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.keep_alive(request.keep_alive() && status == http::status::ok);
    response_.content_length(what.content.size());
    if (request.method() != http::verb::head)
      response_.body() = {what.content.data(), what.content.size()};
    const bool goes_on = response_.keep_alive();
    stream_.expires_after(std::chrono::duration_cast<std::chrono::seconds>(web_server::patience));
    http::async_write(stream_, response_,
                      [x = shared_from_this(), goes_on](const error_code& error, std::size_t) {
                        if (!error && goes_on)
                          return x->read();
                        error_code ignored;
                        x->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                      });
  }

  served& all_;
  place place_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::response<http::span_body<const char>> response_; ///< of what the site, or made_, has
  web_file made_;
};

} // namespace

struct web_server::state {
  explicit state(web_site x)
      : all{std::move(x), 0, {}}, acceptor(context), pause(context), timer(context) {}

  ~state() {
    context.stop();
    if (thread.joinable())
      thread.join();
  }

  std::string open() {
    error_code error;
    const auto address = asio::ip::make_address_v4(all.site.address, error);
    const tcp::endpoint where(address, all.site.port);
    if (!error)
      error = listen_at(acceptor, where);
    if (error)
      return "cannot listen on " + all.site.address + ':' + std::to_string(all.site.port) + ": " +
             error.message();
    port = acceptor.local_endpoint().port();
    accept();
    if (all.site.on_time)
      go_on();
    const signals_blocked here; // they are the program's
    thread = std::thread([this] { run(); });
    return {};
  }

  void run() {
    while (!context.stopped()) {
      try {
        context.run();
      } catch (const std::exception&) { // out of memory, say: its connection has gone with it
      }
    }
  }

  void go_on() {
    timer.expires_after(news_every);
    timer.async_wait([this](const error_code& error) {
      if (error)
        return;
      all.site.on_time();
      go_on();
    });
  }

  void accept() {
    acceptor.async_accept([this](const error_code& error, tcp::socket socket) {
      if (error == asio::error::operation_aborted)
        return;
      if (error) { // out of descriptors, say
        pause.expires_after(100ms);
        pause.async_wait([this](const error_code& over) {
          if (!over)
            accept();
        });
        return;
      }
      accept();
      if (all.connections >= connections_max && !all.unauthorised.empty())
        all.unauthorised.front()->close(); // its place is free when its read has ended
      else if (all.connections >= connections_max)
        return;
      error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored); // answers are small, and waited for
      std::make_shared<http_connection>(std::move(socket), all)->read();
    });
  }

  served all; ///< before the context, whose handlers keep connections alive
  asio::io_context context{1};
  tcp::acceptor acceptor;
  asio::steady_timer pause;
  asio::steady_timer timer;
  std::uint16_t port = 0;
  std::thread thread;
};

std::variant<web_server, std::string> web_server::open(web_site site) {
  auto made = std::make_unique<state>(std::move(site));
  if (auto why = made->open(); !why.empty())
    return why;
  return web_server(std::move(made));
}

web_server::web_server(std::unique_ptr<state> x) : state_(std::move(x)) {}
web_server::~web_server() = default;
web_server::web_server(web_server&&) noexcept = default;
web_server& web_server::operator=(web_server&&) noexcept = default;

std::uint16_t web_server::port() const {
  return state_->port;
}

} // namespace rubicon::io
