// Both ends of the control plane, in one process over loopback.
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "control/client.hpp"
#include "control/server.hpp"
#include "io/tcp_listener.hpp"
#include "io/tcp_stream.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

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
