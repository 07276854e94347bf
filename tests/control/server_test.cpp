// Both ends of the control plane, in one process over loopback.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "control/client.hpp"
#include "control/frame.hpp"
#include "control/octets.hpp"
#include "control/server.hpp"
#include "io/files/temporary_folder.hpp"
#include "io/tcp/tcp_connect.hpp"
#include "io/tcp/tcp_listener.hpp"
#include "io/tcp/tcp_stream.hpp"
#include "io/tls/certificates.hpp"
#include "io/tls/secure_stream.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

/// A socket that is connected.
int connected(std::uint16_t port) {
  const int stranger = ::socket(AF_INET, SOCK_STREAM, 0);
  REQUIRE(stranger != -1);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::connect(stranger, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0);
  return stranger;
}

/// Connects, says something that is no TLS or nothing at all, and goes.
void intrude(std::uint16_t port, std::size_t octets) {
  const int stranger = connected(port);
  const std::string garbage(octets, static_cast<char>('a' + octets % 26));
  static_cast<void>(::send(stranger, garbage.data(), garbage.size(), MSG_NOSIGNAL));
  ::close(stranger);
}

/// Certificates of an authority of their own.
class certified {
public:
  explicit certified(const std::vector<std::string>& names) {
    REQUIRE(io::make_authority(path(), {}, io::system_time()).index() == 0);
    for (const auto& name : names)
      REQUIRE(io::make_certificate(path(), {name}, io::system_time()).index() == 0);
  }

  [[nodiscard]] control::tls_files of(const std::string& name) const {
    return {path() + '/' + name + ".crt", path() + '/' + name + ".key", path() + "/ca.crt"};
  }

  [[nodiscard]] std::string path() const { return (folder_.path() / "certs").string(); }

private:
  const io::temporary_folder folder_{"rubicon-control"};
};

using reply = std::variant<deploy::answer, std::string>;

/// Lets the loop run until the client has its answer.
reply ask(io::loop& loop, control::client& client, deploy::question x, duration timeout = 5s) {
  std::optional<reply> found;
  client.ask(std::move(x), timeout, [&](reply answer) { found = std::move(answer); });
  const auto until = std::chrono::steady_clock::now() + 20s;
  while (!found && std::chrono::steady_clock::now() < until)
    loop.wait_until(std::chrono::steady_clock::now() + 50ms);
  REQUIRE(found);
  return *std::move(found);
}

/// Lets the loop run until something is so.
template <class F>
bool comes_true(io::loop& loop, F is_so, duration at_most = 10s) {
  const auto until = std::chrono::steady_clock::now() + at_most;
  while (!is_so() && std::chrono::steady_clock::now() < until)
    loop.wait_until(std::chrono::steady_clock::now() + 20ms);
  return is_so();
}

/// What a server says to whoever looks after its computer.
struct journal {
  std::vector<std::string> lines;

  [[nodiscard]] bool has(const std::string& part) const {
    for (const auto& line : lines)
      if (line.find(part) != std::string::npos)
        return true;
    return false;
  }
};

/// Says these octets, as whoever has the certificate, and waits until it is closed.
bool is_closed_after(io::loop& loop, std::uint16_t port, const control::tls_files& tls,
                     const bytes& octets) {
  const auto own = tls.empty() ? std::nullopt
                               : std::optional(std::get<io::tls_identity>(
                                     io::tls_identity::load(tls, io::system_time())));
  bool is_closed = false;
  std::optional<io::secure_stream> stream;
  const io::tcp_connect attempt(loop, "127.0.0.1", port, 2s, [&](auto opened) {
    stream.emplace(
        std::get<io::tcp_stream>(std::move(opened)), own, io::tls_session::side::client, "",
        io::secure_stream::callbacks{[&](const auto&) { stream->send(octets); }, [](byte_view) {},
                                     [] {}, [&](const auto&) { is_closed = true; }});
    if (!own)
      stream->send(octets);
  });
  return comes_true(
      loop, [&] { return is_closed; }, 4s);
}

/// Of a long text.
std::string description(const std::string& x) {
  return std::to_string(x.size()) + ' ' + x.substr(0, 1);
}

deploy::answer echo(deploy::question x) {
  if (auto* offered = std::get_if<deploy::offer>(&x))
    return deploy::verdict{{description(offered->what.toml)}, true};
  if (auto* asked = std::get_if<deploy::ask_news>(&x)) {
    deploy::news out;
    out.line = asked->line + 1;
    out.lines.emplace_back(asked->change, 'y');
    out.lives.resize(1);
    out.lives[0].newest.report.ecology = "house";
    return out;
  }
  return deploy::greeting{"1.2.3"};
}

} // namespace

TEST_CASE("a question is answered by another system", "[control]") {
  io::loop loop;
  control::system theirs{{}};
  auto opened = control::server::open(theirs, loop, "127.0.0.1", 0, echo);
  REQUIRE(std::holds_alternative<control::server>(opened));
  auto& server = std::get<control::server>(opened);
  control::system ours{{}};
  control::client client(ours, loop, "127.0.0.1", server.port());

  const auto greeted = ask(loop, client, deploy::greeting{"9"});
  CHECK(std::get<deploy::greeting>(std::get<deploy::answer>(greeted)).version == "1.2.3");
  deploy::offer big;
  big.what.toml = std::string(std::size_t{8} << 20, 'x');
  const auto offered = ask(loop, client, big);
  CHECK(std::get<deploy::verdict>(std::get<deploy::answer>(offered)).problems.at(0) ==
        description(big.what.toml));
  const auto received = ask(loop, client, deploy::ask_news{"id", 41, 8'000'000});
  const auto& news = std::get<deploy::news>(std::get<deploy::answer>(received));
  CHECK(news.line == 42);
  CHECK(news.lines.at(0) == std::string(8'000'000, 'y'));
  CHECK(news.lives.at(0).newest.report.ecology == "house");
  CHECK(std::holds_alternative<std::string>(
      control::server::open(theirs, loop, "127.0.0.1", server.port(), echo)));
}

TEST_CASE("nobody there, and somebody who says nothing, are told soon", "[control]") {
  io::loop loop;
  control::system ours{{}};
  {
    control::client client(ours, loop, "127.0.0.1", 9);
    CHECK(
        std::get<std::string>(ask(loop, client, deploy::greeting{"9"})).find("cannot be reached") !=
        std::string::npos);
  }
  std::vector<io::tcp_stream> taken;
  auto silent =
      io::tcp_listener::open(loop, "127.0.0.1", 0, [&](io::tcp_stream x, const ipv4_address&) {
        taken.push_back(std::move(x));
      });
  control::client client(ours, loop, "127.0.0.1", std::get<io::tcp_listener>(silent).port());
  const auto begun = std::chrono::steady_clock::now();
  CHECK(std::holds_alternative<std::string>(ask(loop, client, deploy::greeting{"9"}, 1s)));
  CHECK(std::chrono::steady_clock::now() - begun < 10s);
}

TEST_CASE("a host that comes back is found again", "[control][NFR-08]") {
  io::loop loop;
  control::system ours{{}};
  std::uint16_t port = 0;
  std::optional<control::client> client;
  for (int life = 0; life < 3; ++life) {
    control::system theirs{{}};
    auto opened = control::server::open(theirs, loop, "127.0.0.1", port, echo);
    REQUIRE(std::holds_alternative<control::server>(opened));
    port = std::get<control::server>(opened).port();
    if (!client)
      client.emplace(ours, loop, "127.0.0.1", port);
    bool answered = false;
    for (int attempt = 0; attempt < 10 && !answered; ++attempt)
      answered = std::holds_alternative<deploy::answer>(ask(loop, *client, deploy::greeting{"9"}));
    CHECK(answered);
  }
}

TEST_CASE(
    "only who has a certificate of the authority is listened to, and strangers disturb nobody",
    "[control]") {
  const certified ours({"kitchen", "me"});
  const certified foreign({"me"});
  io::loop loop;
  control::system host{ours.of("kitchen")};
  auto opened = control::server::open(host, loop, "127.0.0.1", 0, echo);
  REQUIRE(std::holds_alternative<control::server>(opened));
  const auto port = std::get<control::server>(opened).port();

  control::system coordinator{ours.of("me")};
  control::client client(coordinator, loop, "127.0.0.1", port);
  const auto is_answered = [&] {
    return std::holds_alternative<deploy::answer>(ask(loop, client, deploy::greeting{"9"}, 2s));
  };
  CHECK(is_answered());
  {
    control::system stranger{foreign.of("me")};
    control::client refused(stranger, loop, "127.0.0.1", port);
    CHECK(std::holds_alternative<std::string>(ask(loop, refused, deploy::greeting{"9"}, 2s)));
    control::system bare{{}};
    control::client naked(bare, loop, "127.0.0.1", port);
    CHECK(std::holds_alternative<std::string>(ask(loop, naked, deploy::greeting{"9"}, 2s)));
  }
  for (std::size_t i = 0; i < 100; ++i) {
    INFO(i);
    for (std::size_t octets : {7 * i % 400, std::size_t{0}, std::size_t{1500}})
      intrude(port, octets);
    REQUIRE(is_answered());
  }
}

TEST_CASE("who is refused, and why, is told in words at both ends", "[control]") {
  const certified ours({"kitchen", "bedroom", "me"});
  const certified foreign({"me"});
  io::loop loop;
  journal log;
  control::system host{ours.of("kitchen"), "kitchen"};
  auto opened = control::server::open(host, loop, "127.0.0.1", 0, echo,
                                      [&](const std::string& line) { log.lines.push_back(line); });
  const auto port = std::get<control::server>(opened).port();
  const auto why = [&](const control::tls_files& tls, const std::string& name) {
    control::system who{tls};
    control::client client(who, loop, "127.0.0.1", port, name);
    const auto found = ask(loop, client, deploy::greeting{"9"});
    const auto* text = std::get_if<std::string>(&found);
    return text == nullptr ? "" : *text;
  };
  CHECK(why(ours.of("me"), "kitchen").empty());
  CHECK(why(ours.of("me"), "bedroom") ==
        "presented the certificate of `kitchen`, not of `bedroom`");
  CHECK(why(foreign.of("me"), "kitchen") ==
        "has a certificate `kitchen` of another authority, and rejected our certificate");
  CHECK(why({}, "").starts_with("does not answer as a rubicon host without certificates"));
  CHECK(comes_true(loop, [&] { return log.has("does not speak TLS"); }));
  CHECK(log.has(
      "127.0.0.1 was rejected: it rejected our certificate `kitchen`: it was signed by another"));
  CHECK(log.has("it expects another host"));

  control::system bare{{}};
  auto plain = control::server::open(bare, loop, "127.0.0.1", 0, echo);
  control::system me{ours.of("me")};
  control::client client(me, loop, "127.0.0.1", std::get<control::server>(plain).port());
  CHECK(std::get<std::string>(ask(loop, client, deploy::greeting{"9"})) ==
        "does not speak TLS: it has no certificates");
}

TEST_CASE("a list of revoked certificates travels with whoever asks, and shuts out at once",
          "[control]") {
  const certified ours({"kitchen", "me", "thief"});
  io::loop loop;
  journal log;
  control::system host{ours.of("kitchen"), "kitchen", ours.path() + "/state"};
  auto opened = control::server::open(host, loop, "127.0.0.1", 0, echo,
                                      [&](const std::string& line) { log.lines.push_back(line); });
  const auto port = std::get<control::server>(opened).port();
  control::system thief{ours.of("thief")};
  control::client stolen(thief, loop, "127.0.0.1", port, "kitchen");
  CHECK(std::holds_alternative<deploy::answer>(ask(loop, stolen, deploy::ask_news{})));

  REQUIRE(io::revoke_certificate(ours.path(), "thief", io::system_time()).index() == 0);
  const auto list = ours.path() + "/ca.crl";
  std::filesystem::rename(list, list + ".kept"); // the host's folder is another one
  control::system me{ours.of("me")};
  control::client client(me, loop, "127.0.0.1", port, "kitchen");
  CHECK(std::holds_alternative<deploy::answer>(ask(loop, client, deploy::ask_news{})));
  CHECK_FALSE(host.own().revoked());
  std::filesystem::rename(list + ".kept", list);
  CHECK(std::holds_alternative<deploy::answer>(ask(loop, client, deploy::greeting{"9"})));
  CHECK_FALSE(host.own().revoked()); // another version may not know what it is
  CHECK(std::holds_alternative<deploy::answer>(ask(loop, client, deploy::ask_news{})));
  REQUIRE(host.own().revoked());
  CHECK(log.has("accepts list 1 of revoked certificates, with 1"));
  CHECK(log.has("127.0.0.1 was rejected: it has a certificate `thief` that was revoked"));
  CHECK(std::holds_alternative<deploy::answer>(ask(loop, client, deploy::ask_news{})));

  std::filesystem::remove(list);
  CHECK(std::holds_alternative<std::string>(ask(loop, stolen, deploy::ask_news{})));
  control::system again{ours.of("thief")};
  control::client other(again, loop, "127.0.0.1", port, "kitchen");
  CHECK(std::get<std::string>(ask(loop, other, deploy::ask_news{})) ==
        "rejected our certificate `thief`: it was revoked");
}

TEST_CASE("strangers who say nothing hold few connections, and nobody up", "[control]") {
  const certified ours({"kitchen", "me"});
  io::loop loop;
  control::system host{ours.of("kitchen")};
  auto opened = control::server::open(host, loop, "127.0.0.1", 0, echo);
  const auto port = std::get<control::server>(opened).port();
  std::vector<int> strangers;
  for (int i = 0; i < 60; ++i)
    strangers.push_back(connected(port));
  control::system coordinator{ours.of("me")};
  control::client client(coordinator, loop, "127.0.0.1", port);
  CHECK(std::holds_alternative<deploy::answer>(ask(loop, client, deploy::greeting{"9"})));
  const auto closed = [&] {
    return std::count_if(strangers.begin(), strangers.end(), [](int x) {
      char octet = 0;
      return ::recv(x, &octet, 1, MSG_DONTWAIT) == 0;
    });
  };
  CHECK(closed() >= 60 - 16);
  CHECK(comes_true(loop, [&] { return closed() == 60; })); // after 5 s
  for (const int each : strangers)
    ::close(each);
  CHECK(std::holds_alternative<deploy::answer>(ask(loop, client, deploy::greeting{"9"})));
}

TEST_CASE("who is believed and breaks the rules is closed, and others go on", "[control]") {
  const certified ours({"kitchen", "me", "other"});
  for (const bool is_plain : {false, true}) {
    const auto files = [&](const std::string& name) {
      return is_plain ? control::tls_files{} : ours.of(name);
    };
    io::loop loop;
    journal log;
    control::system host{files("kitchen")};
    auto opened =
        control::server::open(host, loop, "127.0.0.1", 0, echo,
                              [&](const std::string& line) { log.lines.push_back(line); });
    const auto port = std::get<control::server>(opened).port();
    control::system coordinator{files("me")};
    control::client client(coordinator, loop, "127.0.0.1", port);
    const auto greeting = control::octets_of(deploy::question(deploy::greeting{"9"}));
    auto announced = control::encode_header({2, 1, {}});
    for (std::size_t i = 8; i < 12; ++i)
      announced[i] = 0xff;
    auto unread = control::encode_header({0, 1, bytes(3)});
    unread.insert(unread.end(), 3, 0xff);
    auto twice = control::encode_header({0, 1, greeting});
    twice.insert(twice.end(), greeting.begin(), greeting.end());
    const auto once = twice;
    twice.insert(twice.end(), once.begin(), once.end());
    const bytes others[] = {announced, unread, twice, control::encode_header({77, 1, {}}),
                            to_bytes(std::string_view("GET / HTTP/1.1\r\n\r\n"))};
    for (const auto& each : others) {
      CHECK(is_closed_after(loop, port, files("other"), each));
      CHECK(std::holds_alternative<deploy::answer>(ask(loop, client, deploy::greeting{"9"})));
    }
    CHECK(log.has("of kind 2 of 4294967295 octets"));
    CHECK(log.has("that is invalid"));
    CHECK(log.has("sent a request before the answer to the previous one"));
    CHECK(log.has("of kind 77, which is unknown"));
  }
}

TEST_CASE("files come over one connection at a time, and all arrive", "[control]") {
  io::loop loop;
  control::system host{{}};
  auto opened = control::server::open(host, loop, "127.0.0.1", 0, echo);
  std::vector<std::unique_ptr<control::client>> clients;
  std::size_t answered = 0;
  for (char letter = 'a'; letter < 'e'; ++letter) {
    deploy::offer big;
    big.what.toml = std::string(std::size_t{5} << 20, letter);
    auto& client = *clients.emplace_back(std::make_unique<control::client>(
        host, loop, "127.0.0.1", std::get<control::server>(opened).port()));
    client.ask(big, 30s, [&answered, letter](const reply& found) {
      const auto& said = std::get<deploy::verdict>(std::get<deploy::answer>(found)).problems.at(0);
      answered += said == description(std::string(std::size_t{5} << 20, letter)) ? 1 : 0;
    });
  }
  CHECK(comes_true(
      loop, [&] { return answered == clients.size(); }, 30s));
}

TEST_CASE("a new certificate is taken while it runs, a bad one is not", "[control]") {
  const certified ours({"kitchen", "me"});
  const auto files = ours.of("kitchen");
  io::loop loop;
  journal log;
  control::system host{files};
  auto opened = control::server::open(host, loop, "127.0.0.1", 0, echo,
                                      [&](const std::string& line) { log.lines.push_back(line); });
  auto& server = std::get<control::server>(opened);
  control::system coordinator{ours.of("me")};
  control::client client(coordinator, loop, "127.0.0.1", server.port());
  const auto is_answered = [&] {
    return std::holds_alternative<deploy::answer>(ask(loop, client, deploy::greeting{"9"}));
  };
  CHECK(is_answered());
  std::filesystem::rename(files.certificate, files.certificate + ".kept");
  std::ofstream(files.certificate) << "";
  server.renew();
  CHECK(log.has("keeps its certificate, since the new one is invalid"));
  CHECK(is_answered());
  control::client newcomer(coordinator, loop, "127.0.0.1", server.port());
  CHECK(std::holds_alternative<deploy::answer>(ask(loop, newcomer, deploy::greeting{"9"})));
  std::filesystem::rename(files.certificate + ".kept", files.certificate);
  control::client next(coordinator, loop, "127.0.0.1", server.port());
  CHECK(std::holds_alternative<deploy::answer>(ask(loop, next, deploy::greeting{"9"})));
  CHECK(log.has("uses the certificate that "));
  CHECK((is_answered() || is_answered())); // its connection was closed: it has to come again
}

TEST_CASE("a file of certificates that is not there is told at once", "[control]") {
  CHECK_THROWS_AS(control::system({"/nowhere/a.crt", "/nowhere/a.key", "/nowhere/ca.crt"}),
                  std::runtime_error);
}
