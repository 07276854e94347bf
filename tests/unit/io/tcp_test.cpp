#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include "io/process/machine.hpp"
#include "io/tcp/tcp_connect.hpp"
#include "io/tcp/tcp_listener.hpp"
#include "support/catch.hpp"
#include "unit/io/run.hpp"

using namespace rubicon;
using test::run;

namespace {

/// One end of a connection and everything that happened to it.
struct recorded {
  io::tcp_stream stream;
  bytes received;
  std::size_t sent = 0;
  std::size_t writes = 0;
  std::optional<std::string> closed;

  void start() {
    stream.start({[this](byte_view x) { received.insert(received.end(), x.begin(), x.end()); },
                  [this](std::size_t size) {
                    sent += size;
                    ++writes;
                  },
                  [this](const std::string& why) { closed = why; }});
  }
};

struct two_ends {
  io::loop loop;
  recorded server;
  recorded client;

  explicit two_ends(bool server_reads = true) {
    std::optional<io::tcp_stream> accepted;
    std::optional<io::tcp_stream> connected;
    auto listener = std::get<io::tcp_listener>(
        io::tcp_listener::open(loop, "127.0.0.1", 0, [&](io::tcp_stream x, const ipv4_address&) {
          accepted = std::move(x);
        }));
    const io::tcp_connect attempt(loop, "127.0.0.1", listener.port(), 10s, [&](auto x) {
      if (auto* stream = std::get_if<io::tcp_stream>(&x))
        connected = std::move(*stream);
    });
    run(loop, [&] { return accepted && connected; });
    server.stream = std::move(*accepted);
    client.stream = std::move(*connected);
    if (server_reads)
      server.start();
    client.start();
  }
};

bytes pattern(std::size_t size) {
  bytes x(size);
  for (std::size_t i = 0; i < size; ++i)
    x[i] = static_cast<std::uint8_t>(i * 7 + i / 251);
  return x;
}

std::string outcome_of(io::loop& loop, const std::string& host, std::uint16_t port,
                       duration timeout = 10s) {
  std::optional<std::string> told;
  const io::tcp_connect attempt(loop, host, port, timeout, [&](auto x) {
    told = std::holds_alternative<std::string>(x) ? std::get<std::string>(x) : "connected";
  });
  CHECK(!told); // never from within the constructor
  run(loop, [&] { return told.has_value(); });
  return *told;
}

} // namespace

TEST_CASE("octets arrive whole and in order, in both directions", "[io][LNK-01][TCP-05]") {
  two_ends x;
  const auto big = pattern(10'000'000);
  for (std::size_t at = 0; at < big.size(); at += 250'000)
    x.client.stream.send(bytes(big.begin() + static_cast<std::ptrdiff_t>(at),
                               big.begin() + static_cast<std::ptrdiff_t>(at) + 250'000));
  CHECK(x.client.stream.unsent() == big.size());
  x.server.stream.send(bytes{1, 2, 3});
  run(x.loop,
      [&] { return x.server.received.size() == big.size() && x.client.sent == big.size(); });
  CHECK(x.server.received == big);
  CHECK(x.client.received == bytes{1, 2, 3});
  CHECK(x.client.stream.unsent() == 0);
  CHECK(x.server.sent == 3);
}

TEST_CASE("what one turn sends leaves in one write", "[io]") {
  two_ends x;
  for (std::uint8_t i = 0; i < 60; ++i)
    x.client.stream.send(bytes{i});
  run(x.loop, [&] { return x.server.received.size() == 60; });
  CHECK(x.client.writes == 1);
  CHECK(x.server.received.back() == 59);
}

TEST_CASE("a stream that nobody reads takes only so much, and says how much", "[io][TCP-05]") {
  two_ends x(false);
  const auto all = pattern(64 * 1024 * 1024);
  x.client.stream.send(all);
  for (int i = 0; i < 100; ++i)
    x.loop.poll();
  CHECK(x.client.sent > 0);
  CHECK(x.client.sent < all.size());
  CHECK(x.client.sent + x.client.stream.unsent() == all.size());
  x.server.start();
  run(x.loop, [&] { return x.server.received.size() == all.size(); });
  CHECK(x.client.sent == all.size());
  CHECK(x.server.received == all);
}

TEST_CASE("closing sends what is queued first", "[io]") {
  two_ends x;
  const auto big = pattern(5'000'000);
  bool done = false;
  x.client.stream.send(big);
  x.client.stream.close([&] { done = true; });
  x.client.stream = {}; // the connection lives on without its owner until all has left
  run(x.loop, [&] { return x.server.closed.has_value(); });
  CHECK(x.server.received == big);
  CHECK(*x.server.closed == "closed by the other side");
  run(x.loop, [&] { return done; });
  CHECK(!x.client.closed);
}

TEST_CASE("octets that were not read do not destroy those just sent", "[io]") {
  two_ends x;
  x.server.stream.send(bytes(100'000, 9)); // arrives while the client is closing
  x.client.stream.send(bytes{7});
  x.client.stream.close();
  run(x.loop, [&] { return x.server.closed.has_value(); });
  CHECK(x.server.received == bytes{7});
}

TEST_CASE("closing ends also when the other side never does", "[io]") {
  two_ends x;
  const int raw = ::socket(AF_INET, SOCK_STREAM, 0);
  std::optional<io::tcp_stream> accepted;
  auto listener = std::get<io::tcp_listener>(
      io::tcp_listener::open(x.loop, "127.0.0.1", 0, [&](io::tcp_stream y, const ipv4_address&) {
        accepted = std::move(y);
      }));
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(listener.port());
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::connect(raw, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0);
  run(x.loop, [&] { return accepted.has_value(); });
  bool done = false;
  accepted->close([&] { done = true; });
  run(x.loop, [&] { return done; });
  ::close(raw);
}

TEST_CASE("a dropped stream shows at the other side", "[io]") {
  two_ends x;
  x.client.stream = {};
  run(x.loop, [&] { return x.server.closed.has_value(); });
  CHECK(x.server.received.empty());
  x.server.stream.send(bytes{1}); // harmless
  x.loop.poll();
  CHECK(x.server.sent == 0);
}

TEST_CASE("a paced stream leaves in wholes, and tells what was acknowledged", "[io][P2P-05]") {
  const std::size_t whole = 1000;
  two_ends x(false);
  x.client.stream.pace();
  for (int i = 0; i < 4000; ++i)
    x.client.stream.send(pattern(whole));
  run(x.loop, [&] { return x.client.sent >= 40 * whole; }); // the other side has room for some
  CHECK(x.client.sent < 4000 * whole);
  CHECK(x.client.stream.unsent() % whole == 0);
  CHECK(x.client.stream.unsent() + x.client.sent <= 4000 * whole); // the rest is on its way
  CHECK(x.client.stream.unsent() > 0);
  x.server.start();
  run(x.loop, [&] { return x.server.received.size() == 4000 * whole; });
  run(x.loop, [&] { return x.client.sent == 4000 * whole; });
  x.client.stream.send(pattern(whole));
  x.client.stream.close();
  run(x.loop, [&] { return x.server.closed.has_value(); });
  CHECK(x.server.received.size() == 4001 * whole);
}

TEST_CASE("a reset ends a connection at once that nobody reads", "[io]") {
  two_ends x(false);
  x.client.stream.send(pattern(64 << 20));
  run(x.loop, [&] { return x.client.sent > 0; });
  x.client.stream.reset();
  x.server.start();
  run(x.loop, [&] { return x.server.closed.has_value(); });
  CHECK(*x.server.closed != "closed by the other side");
  CHECK(x.server.received.size() < 64 << 20);
  CHECK(!x.client.closed);
}

TEST_CASE("a stream may be destroyed from each of its callbacks", "[io]") {
  two_ends x(false);
  std::optional<io::tcp_stream> mine = std::move(x.server.stream);
  mine->start({[&](byte_view) { mine.reset(); }, [&](std::size_t) { mine.reset(); },
               [&](const std::string&) { mine.reset(); }});
  SECTION("octets") {
    x.client.stream.send(bytes{1});
  }
  SECTION("sent") {
    mine->send(bytes{1});
  }
  SECTION("closed") {
    x.client.stream = {};
  }
  run(x.loop, [&] { return !mine; });
}

TEST_CASE("a listener counts up to a free port", "[io][TCP-01]") {
  io::loop loop;
  const auto ignore = [](io::tcp_stream, const ipv4_address&) {};
  const auto first =
      std::get<io::tcp_listener>(io::tcp_listener::open(loop, "127.0.0.1", 0, ignore));
  const auto second =
      std::get<io::tcp_listener>(io::tcp_listener::open(loop, "127.0.0.1", first.port(), ignore));
  CHECK(second.port() > first.port());
  const auto third =
      std::get<io::tcp_listener>(io::tcp_listener::open(loop, "0.0.0.0", first.port(), ignore));
  CHECK(third.port() > second.port());
}

TEST_CASE("a listener that rests accepts nobody, and then all who wait", "[io]") {
  io::loop loop;
  std::vector<io::tcp_stream> accepted;
  std::optional<io::tcp_listener> listener;
  listener.emplace(std::get<io::tcp_listener>(
      io::tcp_listener::open(loop, "127.0.0.1", 0, [&](io::tcp_stream x, const ipv4_address&) {
        accepted.push_back(std::move(x));
        listener->rest(accepted.size() == 1 ? duration(300ms) : duration{});
      })));
  const auto begun = std::chrono::steady_clock::now();
  CHECK(outcome_of(loop, "127.0.0.1", listener->port()) == "connected");
  CHECK(outcome_of(loop, "127.0.0.1", listener->port()) == "connected");
  CHECK(outcome_of(loop, "127.0.0.1", listener->port()) == "connected");
  run(loop, [&] { return accepted.size() == 3; });
  CHECK(std::chrono::steady_clock::now() - begun >= 300ms);
}

TEST_CASE("a listener gets its port back at once", "[io][TCP-01]") {
  io::loop loop;
  std::vector<io::tcp_stream> accepted;
  const auto keep = [&](io::tcp_stream x, const ipv4_address&) {
    accepted.push_back(std::move(x));
  };
  std::uint16_t port = 0;
  {
    const auto first =
        std::get<io::tcp_listener>(io::tcp_listener::open(loop, "127.0.0.1", 0, keep));
    port = first.port();
    CHECK(outcome_of(loop, "127.0.0.1", port) == "connected");
    accepted.clear(); // this side closes first: its end waits
  }
  const auto again =
      std::get<io::tcp_listener>(io::tcp_listener::open(loop, "127.0.0.1", port, keep));
  CHECK(again.port() == port);
}

TEST_CASE("an address that is not ours is refused with its reason", "[io]") {
  io::loop loop;
  const auto ignore = [](io::tcp_stream, const ipv4_address&) {};
  for (const auto* address : {"here", "", "192.0.2.1"}) {
    CAPTURE(address);
    const auto x = io::tcp_listener::open(loop, address, 8000, ignore);
    REQUIRE(std::holds_alternative<std::string>(x));
    CHECK(std::get<std::string>(x).starts_with("cannot listen on " + std::string(address) +
                                               ":8000: "));
  }
}

TEST_CASE("a connection nobody takes fails with its reason", "[io][LNK-07]") {
  io::loop loop;
  std::uint16_t port = 0;
  {
    const auto gone = std::get<io::tcp_listener>(
        io::tcp_listener::open(loop, "127.0.0.1", 0, [](io::tcp_stream, const ipv4_address&) {}));
    port = gone.port();
  }
  const auto target = "127.0.0.1:" + std::to_string(port);
  CHECK(outcome_of(loop, "127.0.0.1", port) == target + ": Connection refused");
  CHECK(outcome_of(loop, "no such name", 1).starts_with("no such name:1: "));
}

TEST_CASE("an attempt that was given up never calls", "[io][LNK-07]") {
  io::loop loop;
  bool called = false;
  {
    const auto listener = std::get<io::tcp_listener>(
        io::tcp_listener::open(loop, "127.0.0.1", 0, [](io::tcp_stream, const ipv4_address&) {}));
    const io::tcp_connect attempt(loop, "127.0.0.1", listener.port(), 10s,
                                  [&](auto) { called = true; });
  }
  for (int i = 0; i < 10; ++i)
    loop.poll();
  CHECK(!called);
}

TEST_CASE("an attempt times out", "[io][LNK-07]") {
  // A full backlog: the system drops what else comes, so nobody answers.
  const int raw = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof own;
  REQUIRE(::bind(raw, reinterpret_cast<const sockaddr*>(&own), size) == 0);
  REQUIRE(::listen(raw, 0) == 0);
  REQUIRE(::getsockname(raw, reinterpret_cast<sockaddr*>(&own), &size) == 0);
  io::loop loop;
  const auto port = ntohs(own.sin_port);
  std::string last;
  std::vector<io::tcp_connect> attempts;
  for (int i = 0; i < 4; ++i)
    attempts.emplace_back(loop, "127.0.0.1", port, 50ms, [&](auto x) {
      if (auto* why = std::get_if<std::string>(&x))
        last = *why;
    });
  run(loop, [&] { return !last.empty(); });
  CHECK(last == "127.0.0.1:" + std::to_string(port) + ": Connection timed out");
  ::close(raw);
}

TEST_CASE("the machine has a name and a loopback interface", "[io][LNK-03]") {
  const auto name = io::machine_name();
  CHECK(!name.empty());
  CHECK(name.find('.') == std::string::npos);
  const auto all = io::network_interfaces();
  const auto loopback = std::find_if(all.begin(), all.end(), [](const auto& x) {
    return x.ipv4 == std::array<std::uint8_t, 4>{127, 0, 0, 1};
  });
  REQUIRE(loopback != all.end());
  CHECK(loopback->loopback);
  CHECK(!loopback->device.empty());
}
