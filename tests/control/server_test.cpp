// Both ends of the control plane, in one process over loopback.
#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "control/client.hpp"
#include "control/server.hpp"
#include "io/certificates.hpp"
#include "io/tcp_listener.hpp"
#include "io/tcp_stream.hpp"
#include "io/temporary_folder.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

/// Connects, says something that is no TLS or nothing at all, and goes.
void intrude(std::uint16_t port, std::size_t octets) {
  const int stranger = ::socket(AF_INET, SOCK_STREAM, 0);
  REQUIRE(stranger != -1);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::connect(stranger, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0);
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

private:
  [[nodiscard]] std::string path() const { return (folder_.path() / "certs").string(); }

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

deploy::answer echo(deploy::question x) {
  if (auto* offered = std::get_if<deploy::offer>(&x))
    return deploy::verdict{{offered->what.toml}, true};
  if (auto* asked = std::get_if<deploy::ask_news>(&x)) {
    deploy::news out;
    out.line = asked->line + 1;
    out.lives.resize(1);
    out.lives[0].told.report.ecology = "house";
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
        big.what.toml);
  const auto told = ask(loop, client, deploy::ask_news{"id", 41, 0});
  const auto& news = std::get<deploy::news>(std::get<deploy::answer>(told));
  CHECK(news.line == 42);
  CHECK(news.lives.at(0).told.report.ecology == "house");
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

TEST_CASE("a file of certificates that is not there is told at once", "[control]") {
  CHECK_THROWS_AS(control::system({"/nowhere/a.crt", "/nowhere/a.key", "/nowhere/ca.crt"}),
                  std::runtime_error);
}
