#include <chrono>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "io/tcp/web_server.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace std::chrono_literals;

namespace {

/// A browser, or somebody who is none.
class client {
public:
  explicit client(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{10, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    REQUIRE(::connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0);
  }
  ~client() { ::close(socket_); }
  client(const client&) = delete;
  client& operator=(const client&) = delete;

  void send(const std::string& text) {
    static_cast<void>(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL));
  }

  /// Until so much has come, or the other side has closed.
  std::string read_until(const std::string& end) {
    while (text_.find(end) == std::string::npos) {
      char some[4096];
      const auto count = ::recv(socket_, some, sizeof some, 0);
      if (count <= 0)
        break;
      text_.append(some, static_cast<std::size_t>(count));
    }
    return text_;
  }

  bool is_closed() {
    char some[4096];
    ssize_t count = 1;
    while (count > 0)
      count = ::recv(socket_, some, sizeof some, 0);
    return count == 0 || errno == ECONNRESET;
  }

  /// A frame as a browser sends it, masked by zeroes.
  void say(const std::string& text) {
    std::string frame("\x81", 1);
    if (text.size() < 126) {
      frame += static_cast<char>(0x80 | text.size());
    } else {
      frame += static_cast<char>(0xff);
      for (int i = 7; i >= 0; --i)
        frame += static_cast<char>(text.size() >> (8 * i));
    }
    send(frame + std::string(4, '\0') + text);
  }

private:
  int socket_;
  std::string text_;
};

class echo : public io::web_session {
public:
  std::string on_text(std::string_view text) override {
    if (text == "fail")
      throw std::runtime_error("failed");
    return "echo " + std::string(text);
  }
  std::optional<std::string> news() override {
    return told_++ == 0 ? std::optional<std::string>("news") : std::nullopt;
  }

private:
  int told_ = 0;
};

io::web_server served(std::vector<std::string> hosts = {}) {
  io::web_site site;
  site.hosts = std::move(hosts);
  site.token = "secret";
  site.files = {{"", {"text/html", "<p>page"}}, {"page.js", {"text/javascript", "script"}}};
  site.on_session = [] { return std::make_unique<echo>(); };
  auto opened = io::web_server::open(std::move(site));
  REQUIRE(std::holds_alternative<io::web_server>(opened));
  return std::move(std::get<io::web_server>(opened));
}

std::string request(const io::web_server& server, const std::string& target,
                    const std::string& more = {}, const std::string& host = {},
                    const std::string& method = "GET") {
  return method + ' ' + target + " HTTP/1.1\r\nHost: " +
         (host.empty() ? "127.0.0.1:" + std::to_string(server.port()) : host) + "\r\n" + more +
         "\r\n";
}

std::string answer(const io::web_server& server, const std::string& text,
                   const std::string& end = "\r\n\r\n") {
  client x(server.port());
  x.send(text);
  return x.read_until(end);
}

std::string upgrade(const std::string& origin) {
  return "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
         (origin.empty() ? "" : "Origin: " + origin + "\r\n");
}

} // namespace

TEST_CASE("the page is there for who knows the token, and may run nothing but its own",
          "[io][web]") {
  const auto server = served();
  const auto page = answer(server, request(server, "/secret/"), "<p>page");
  CHECK(page.starts_with("HTTP/1.1 200"));
  CHECK(page.find("default-src 'none'") != std::string::npos);
  CHECK(page.find("frame-ancestors 'none'") != std::string::npos);
  CHECK(page.find("nosniff") != std::string::npos);
  CHECK(page.find("no-referrer") != std::string::npos);
  CHECK(answer(server, request(server, "/secret/page.js"), "\r\n\r\nscript").ends_with("script"));
  for (const auto* path : {"/", "/secret", "/secre/", "/secrett/", "/Secret/", "//", "/secret/../x",
                           "/secret/etc/passwd", "/x/page.js"})
    CHECK(answer(server, request(server, path)).starts_with("HTTP/1.1 404"));
}

TEST_CASE("other hosts, methods and nonsense are refused", "[io][web]") {
  const auto server = served();
  CHECK(
      answer(server, request(server, "/secret/", {}, "evil.example")).starts_with("HTTP/1.1 403"));
  CHECK(answer(server, request(server, "/secret/", {}, "evil.example:80"))
            .starts_with("HTTP/1.1 403"));
  CHECK(answer(server, request(server, "/secret/", {}, "localhost:1")).starts_with("HTTP/1.1 200"));
  CHECK(answer(server, request(server, "/secret/", {}, {}, "DELETE")).starts_with("HTTP/1.1 405"));
  CHECK(answer(server, request(server, "/secret/", {}, {}, "HEAD")).ends_with("\r\n\r\n"));
  CHECK_FALSE(answer(server, std::string(100'000, 'x')).starts_with("HTTP/1.1 200"));
  CHECK_FALSE(answer(server, std::string("\0\xff\r\n\r\n", 6)).starts_with("HTTP/1.1 200"));
  CHECK(
      answer(server, request(server, "/secret/", "Content-Length: 9999999\r\n")).find("<p>page") ==
      std::string::npos);
}

TEST_CASE("a site without a token makes its files as they are requested", "[io][web]") {
  io::web_site site;
  int made = 0;
  site.on_request = [&made](std::string_view name) {
    return name == "metrics"
               ? std::optional(io::web_file{"text/plain", std::to_string(++made) + "."})
               : std::nullopt;
  };
  auto opened = io::web_server::open(std::move(site));
  REQUIRE(std::holds_alternative<io::web_server>(opened));
  const auto server = std::move(std::get<io::web_server>(opened));
  CHECK(answer(server, request(server, "/metrics"), "1.").ends_with("\r\n\r\n1."));
  CHECK(answer(server, request(server, "/metrics?x=y"), "2.").ends_with("\r\n\r\n2."));
  for (const auto* path : {"/", "/metric", "/metrics/", "//metrics", "/live", "metrics"})
    CHECK(!answer(server, request(server, path)).starts_with("HTTP/1.1 200"));
  CHECK(answer(server, request(server, "/live",
                               upgrade("http://127.0.0.1:" + std::to_string(server.port()))))
            .starts_with("HTTP/1.1 404"));
  CHECK(
      answer(server, request(server, "/metrics", {}, "evil.example")).starts_with("HTTP/1.1 403"));
}

TEST_CASE("a WebSocket is for the own page alone", "[io][web]") {
  const auto server = served();
  const auto own = "http://127.0.0.1:" + std::to_string(server.port());
  const auto status = [&](const std::string& target, const std::string& origin) {
    return answer(server, request(server, target, upgrade(origin))).substr(0, 12);
  };
  CHECK(status("/secret/live", own) == "HTTP/1.1 101");
  CHECK(status("/secret/live", "http://evil.example") == "HTTP/1.1 403");
  CHECK(status("/secret/live", "null") == "HTTP/1.1 403");
  CHECK(status("/secret/live", "") == "HTTP/1.1 403");
  CHECK(status("/wrong/live", own) == "HTTP/1.1 404");
  CHECK(status("/secret/page.js", own) == "HTTP/1.1 404");
}

TEST_CASE("a page is served under further names that it was given, also behind a proxy",
          "[io][web][security]") {
  const auto server = served({"house.example"});
  const auto status = [&](const std::string& host, const std::string& origin) {
    return answer(server, request(server, "/secret/live", upgrade(origin), host)).substr(0, 12);
  };
  CHECK(answer(server, request(server, "/secret/", {}, "House.Example:8443"))
            .starts_with("HTTP/1.1 200"));
  CHECK(status("house.example", "https://house.example") == "HTTP/1.1 101");
  CHECK(status("house.example:8080", "http://house.example:8080") == "HTTP/1.1 101");
  CHECK(status("127.0.0.1:1", "https://house.example:8443") == "HTTP/1.1 101");
  CHECK(status("house.example", "https://evil.example") == "HTTP/1.1 403");
  CHECK(status("house.example", "https://house.example.evil.example") == "HTTP/1.1 403");
  CHECK(status("house.example", "null") == "HTTP/1.1 403");
  CHECK(status("evil.example", "https://house.example") == "HTTP/1.1 403");
}

TEST_CASE("what is asked is answered, and news come unasked", "[io][web]") {
  const auto server = served();
  client x(server.port());
  x.send(request(server, "/secret/live",
                 upgrade("http://127.0.0.1:" + std::to_string(server.port()))));
  x.read_until("\r\n\r\n");
  CHECK(x.read_until("news").find("news") != std::string::npos);
  x.say("hello");
  CHECK(x.read_until("echo hello").find("echo hello") != std::string::npos);
  for (int i = 0; i < 100; ++i)
    x.say(std::to_string(i));
  CHECK(x.read_until("echo 99").find("echo 99") != std::string::npos);
}

TEST_CASE("a question that is too long ends the connection", "[io][web]") {
  const auto server = served();
  client x(server.port());
  x.send(request(server, "/secret/live",
                 upgrade("http://127.0.0.1:" + std::to_string(server.port()))));
  x.read_until("news");
  x.say(std::string(io::web_server::question_octets_max + 1, 'x'));
  CHECK(x.is_closed());
}

TEST_CASE("who is silent makes room for who has the token", "[io][web][security]") {
  const auto server = served();
  const bool is_slow = GENERATE(false, true); // else not a word
  std::vector<std::unique_ptr<client>> many;
  for (std::size_t i = 0; i < io::web_server::connections_max + 10; ++i) {
    many.push_back(std::make_unique<client>(server.port()));
    if (is_slow)
      many.back()->send("GET");
  }
  std::this_thread::sleep_for(200ms);
  for (int i = 0; i < 20; ++i)
    CHECK(answer(server, request(server, "/secret/"), "<p>page").starts_with("HTTP/1.1 200"));
  CHECK(many.front()->is_closed());
}

TEST_CASE("a server with many connections closes further ones, and goes on when some have gone",
          "[io][web]") {
  const auto server = served();
  {
    std::vector<std::unique_ptr<client>> many;
    for (std::size_t i = 0; i < io::web_server::connections_max; ++i) {
      many.push_back(std::make_unique<client>(server.port()));
      many.back()->send(request(server, "/secret/"));
      many.back()->read_until("<p>page");
    }
    client one_more(server.port());
    one_more.send(request(server, "/secret/"));
    CHECK(one_more.is_closed());
  }
  for (int i = 0;; ++i) {
    if (answer(server, request(server, "/secret/"), "<p>page").starts_with("HTTP/1.1 200"))
      break;
    REQUIRE(i < 100);
    std::this_thread::sleep_for(50ms);
  }
}

TEST_CASE("a session that fails ends its own connection alone", "[io][web]") {
  const auto server = served();
  const auto head =
      request(server, "/secret/live", upgrade("http://127.0.0.1:" + std::to_string(server.port())));
  client good(server.port());
  good.send(head);
  good.read_until("news");
  client bad(server.port());
  bad.send(head);
  bad.read_until("news");
  bad.say("fail");
  CHECK(bad.is_closed());
  good.say("hello");
  CHECK(good.read_until("echo hello").find("echo hello") != std::string::npos);
}

TEST_CASE("two requests at once are both answered", "[io][web]") {
  const auto server = served();
  client x(server.port());
  x.send(request(server, "/secret/") + request(server, "/secret/page.js"));
  const auto text = x.read_until("\r\n\r\nscript");
  CHECK(text.find("<p>page") != std::string::npos);
  CHECK(text.ends_with("script"));
}

TEST_CASE("a port that is taken is told", "[io][web]") {
  const auto server = served();
  io::web_site site;
  site.token = "x";
  site.port = server.port();
  const auto opened = io::web_server::open(std::move(site));
  REQUIRE(std::holds_alternative<std::string>(opened));
  CHECK(std::get<std::string>(opened).find("cannot listen on 127.0.0.1:") == 0);
}

TEST_CASE("a server ends while browsers are connected", "[io][web]") {
  auto server = std::make_unique<io::web_server>(served());
  client x(server->port());
  x.send(request(*server, "/secret/live",
                 upgrade("http://127.0.0.1:" + std::to_string(server->port()))));
  x.read_until("news");
  client y(server->port());
  y.send("GET /secr");
  server.reset();
  CHECK(x.is_closed());
}
