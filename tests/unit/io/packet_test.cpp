// Packet sockets, as Bluetooth has them, on pairs of local sockets.
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sys/socket.h>
#include <sys/un.h>

#include "io/bluetooth/bluetooth_adapter.hpp"
#include "io/bluetooth/packet_connect.hpp"
#include "io/bluetooth/packet_listener.hpp"
#include "io/bluetooth/packet_stream.hpp"
#include "support/catch.hpp"
#include "unit/io/run.hpp"

using namespace rubicon;
using test::run;

namespace {

constexpr std::size_t much = 1'000'000;

std::pair<io::descriptor, io::descriptor> packet_pair(int type = SOCK_SEQPACKET) {
  std::array<int, 2> ends{};
  REQUIRE(::socketpair(AF_UNIX, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends.data()) == 0);
  const int small = 8192; // the system doubles it
  REQUIRE(::setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &small, sizeof small) == 0);
  return {io::descriptor(ends[0]), io::descriptor(ends[1])};
}

/// One end, and what has happened there.
struct packet_end {
  io::packet_stream stream;
  std::vector<bytes> packets;
  std::size_t sent = 0;
  std::optional<std::string> closed;

  packet_end(io::loop& loop, io::descriptor x, std::size_t room = much)
      : stream(loop, std::move(x), room) {
    stream.start({[this](byte_view y) { packets.push_back(to_bytes(y)); },
                  [this](std::size_t n) { sent += n; },
                  [this](const std::string& why) { closed = why; }});
  }
};

struct packet_ends {
  io::loop loop;
  std::pair<io::descriptor, io::descriptor> both = packet_pair();
  packet_end a{loop, std::move(both.first)};
  packet_end b{loop, std::move(both.second)};
};

} // namespace

TEST_CASE("packets stay apart, and arrive in order", "[io][LNK-01]") {
  packet_ends x;
  CHECK(x.a.stream.send(to_bytes("one")));
  CHECK(x.a.stream.send(to_bytes("two")));
  CHECK(x.b.stream.send(to_bytes("back")));
  CHECK(x.a.stream.unsent() == 6);
  run(x.loop, [&] { return x.b.packets.size() == 2 && x.a.packets.size() == 1; });
  CHECK(x.b.packets == std::vector<bytes>{to_bytes("one"), to_bytes("two")});
  CHECK(x.a.packets[0] == to_bytes("back"));
  CHECK(x.a.sent == 6);
  CHECK(x.a.stream.unsent() == 0);
}

TEST_CASE("what the system has no room for waits, up to a bound", "[io][LNK-01][P2P-03]") {
  io::loop loop;
  auto both = packet_pair();
  packet_end a(loop, std::move(both.first), 100'000);
  packet_end b(loop, std::move(both.second));
  b.stream.read(false);
  for (std::uint8_t i = 0; i < 100; ++i)
    CHECK(a.stream.send(bytes(1000, i)));
  CHECK_FALSE(a.stream.send(bytes(1, 0)));
  run(loop, [&] { return a.sent > 0; });
  CHECK(a.stream.unsent() == 100'000 - a.sent);
  CHECK(a.stream.unsent() > 0);
  CHECK(b.packets.empty());
  b.stream.read(true);
  run(loop, [&] { return b.packets.size() == 100; });
  for (std::uint8_t i = 0; i < 100; ++i)
    CHECK(b.packets[i] == bytes(1000, i));
  CHECK(a.sent == 100'000);
}

TEST_CASE("a packet that leaves in parts arrives as a whole stream", "[io][LNK-01]") {
  io::loop loop;
  auto both = packet_pair(SOCK_STREAM);
  packet_end a(loop, std::move(both.first));
  packet_end b(loop, std::move(both.second));
  bytes all;
  for (std::size_t i = 0; i < 200'000; ++i)
    all.push_back(static_cast<std::uint8_t>(i * i / 7));
  CHECK(a.stream.send(all));
  bytes got;
  run(loop, [&] {
    for (const auto& each : std::exchange(b.packets, {}))
      got.insert(got.end(), each.begin(), each.end());
    return got.size() == all.size();
  });
  CHECK(got == all);
}

TEST_CASE("the other side's end is noticed after what it has sent", "[io][LNK-01]") {
  packet_ends x;
  CHECK(x.a.stream.send(to_bytes("last")));
  bool done = false;
  x.a.stream.close([&] { done = true; });
  run(x.loop, [&] { return done && x.b.closed; });
  CHECK(x.b.packets == std::vector<bytes>{to_bytes("last")});
  CHECK(*x.b.closed == "closed by the other side");
  CHECK_FALSE(x.a.closed);
  CHECK(x.b.stream.send(to_bytes("nobody"))); // goes nowhere
}

TEST_CASE("an oversize packet ends the connection", "[io][LNK-01][GEN-06]") {
  io::loop loop;
  auto both = packet_pair();
  packet_end b(loop, std::move(both.second));
  const bytes full(io::packet_stream::packet_max, 1);
  const bytes more(io::packet_stream::packet_max + 1, 1);
  REQUIRE(::send(both.first.get(), full.data(), full.size(), 0) == 2048);
  REQUIRE(::send(both.first.get(), more.data(), more.size(), 0) == 2049);
  run(loop, [&] { return b.closed.has_value(); });
  CHECK(b.packets == std::vector<bytes>{full});
  CHECK(*b.closed == "a packet of more than 2048 octets arrived");
}

TEST_CASE("a stream that is destroyed in its own callback says nothing more", "[io][LNK-01]") {
  io::loop loop;
  auto both = packet_pair();
  packet_end a(loop, std::move(both.first));
  std::optional<io::packet_stream> b(std::in_place, loop, std::move(both.second), much);
  int calls = 0;
  b->start({[&](byte_view) {
              ++calls;
              b.reset();
            },
            [](std::size_t) {}, [&](const std::string&) { ++calls; }});
  CHECK(a.stream.send(to_bytes("one")));
  CHECK(a.stream.send(to_bytes("two")));
  run(loop, [&] { return a.closed.has_value(); });
  CHECK(calls == 1);
}

TEST_CASE("packet sockets connect, and are refused, without waiting", "[io][LNK-07]") {
  io::loop loop;
  sockaddr_un here{};
  here.sun_family = AF_UNIX;
  const auto bare = sizeof here.sun_family; // the system chooses a name
  io::descriptor listening(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  REQUIRE(::bind(listening.get(), reinterpret_cast<sockaddr*>(&here), bare) == 0);
  REQUIRE(::listen(listening.get(), 1) == 0);
  socklen_t size = sizeof here;
  REQUIRE(::getsockname(listening.get(), reinterpret_cast<sockaddr*>(&here), &size) == 0);
  std::optional<packet_end> server;
  std::optional<io::packet_listener> listener(
      std::in_place, loop, std::move(listening),
      [&](io::descriptor x) { server.emplace(loop, std::move(x)); });
  io::descriptor calling(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  REQUIRE(::connect(calling.get(), reinterpret_cast<sockaddr*>(&here), size) == 0);
  std::optional<packet_end> client;
  const io::packet_connect attempt(loop, std::move(calling), 5s, [&](auto x) {
    client.emplace(loop, std::move(std::get<io::descriptor>(x)));
  });
  run(loop, [&] { return server && client; });
  CHECK(client->stream.send(to_bytes("hello")));
  run(loop, [&] { return server->packets.size() == 1; });

  auto both = packet_pair();
  both.second.close();
  const bytes filling(1, 0);
  std::optional<std::string> why;
  auto full = packet_pair();
  while (::send(full.first.get(), filling.data(), 1, MSG_DONTWAIT | MSG_NOSIGNAL) == 1)
    ;
  const io::packet_connect late(loop, std::move(full.first), 20ms, [&](auto x) {
    if (const auto* text = std::get_if<std::string>(&x))
      why = *text;
  });
  run(loop, [&] { return why.has_value(); });
  CHECK(why->find("timed out") != std::string::npos);
}

TEST_CASE("an adapter that cannot be used is reported in clear words", "[io][BT-01][GEN-06]") {
  using std::errc;
  const auto why = [](errc x) { return io::why_no_adapter("hci0", std::make_error_code(x)); };
  CHECK(why(errc::no_such_device) == "cannot open Bluetooth adapter hci0: no such device");
  CHECK(why(errc::network_down) ==
        "cannot open Bluetooth adapter hci0: it is switched off; run `bluetoothctl power on`");
  for (const auto x : {errc::address_family_not_supported, errc::protocol_not_supported})
    CHECK(why(x).starts_with("cannot open Bluetooth adapter hci0: this system has no Bluetooth ("));
  CHECK(why(errc::operation_not_permitted) ==
        "cannot open Bluetooth adapter hci0: Operation not permitted");
  for (const auto* name : {"hci65000", "hci65536", "hci", "eth0"}) {
    const auto x = io::open_bluetooth_adapter(name); // with or without Bluetooth here
    REQUIRE(std::holds_alternative<std::string>(x));
    CHECK(std::get<std::string>(x).starts_with("cannot open Bluetooth adapter " +
                                               std::string(name) + ": "));
  }
}
