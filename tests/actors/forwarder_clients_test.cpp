// Programs of TinyOS at our serial forwarder, well-behaved and not.
#include <chrono>
#include <functional>
#include <list>
#include <string>
#include <variant>

#include "actors/serial/forwarder_clients.hpp"
#include "io/tcp/tcp_connect.hpp"
#include "serial/packet.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

/// Runs the loop until something is so; far too long a wait is a failure.
void run(io::loop& loop, const std::function<bool()>& done) {
  const auto end = std::chrono::steady_clock::now() + 30s;
  while (!done() && std::chrono::steady_clock::now() < end)
    loop.wait_until(std::chrono::steady_clock::now() + 10ms);
  REQUIRE(done());
}

bytes packet(std::uint16_t number, std::size_t payload_octets = 10) {
  serial::am_packet x;
  x.source = number;
  x.payload = bytes(payload_octets, 0x7e);
  return serial::encode(x);
}

struct tool {
  io::tcp_stream stream;
  serial::forwarder_decoder decoder;
  std::vector<bytes> packets;
  bool closed = false;
};

struct forwarder_fixture {
  explicit forwarder_fixture(const std::vector<ipv4_network>& networks = {}) {
    for (std::uint16_t tries = 0; !clients && tries < 50; ++tries) {
      port = static_cast<std::uint16_t>(port + 7);
      auto x = forwarder_clients::open(loop, "127.0.0.1", port,
                                       {[this](std::uint64_t from, bytes octets) {
                                          senders.push_back(from);
                                          for_sink.push_back(std::move(octets));
                                        },
                                        [this](std::string what) { told.push_back(what); }},
                                       networks);
      if (std::holds_alternative<std::unique_ptr<forwarder_clients>>(x))
        clients = std::get<std::unique_ptr<forwarder_clients>>(std::move(x));
    }
    REQUIRE(clients);
  }

  tool& connect(const bytes& first = serial::forwarder_greeting()) {
    auto& to = tools.emplace_back();
    bool there = false;
    const io::tcp_connect attempt(loop, "127.0.0.1", port, 10s, [&](auto x) {
      if (auto* stream = std::get_if<io::tcp_stream>(&x))
        to.stream = std::move(*stream);
      there = true;
    });
    run(loop, [&] { return there; });
    to.stream.start({[&to](byte_view octets) {
                       for (auto& each : to.decoder.on_octets(octets))
                         to.packets.push_back(std::move(each));
                     },
                     [](std::size_t) {}, [&to](const std::string&) { to.closed = true; }});
    to.stream.send(first);
    run(loop, [&] { return to.decoder.greeted() || to.closed; });
    return to;
  }

  /// One that is certain to be heard of.
  void exchange(tool& with) {
    const auto before = for_sink.size();
    with.stream.send(serial::encode_forwarded(packet(1)));
    run(loop, [&] { return for_sink.size() > before; });
    clients->done(senders.back());
  }

  io::loop loop;
  std::uint16_t port = 29002;
  std::unique_ptr<forwarder_clients> clients;
  std::list<tool> tools;
  std::vector<std::uint64_t> senders;
  std::vector<bytes> for_sink;
  std::vector<std::string> told;
};

} // namespace

TEST_CASE("each program gets each packet of the sink, and none of another program's",
          "[actors][serial][GW-17]") {
  forwarder_fixture x;
  auto& first = x.connect();
  auto& second = x.connect();
  x.exchange(first);
  x.exchange(second);
  x.clients->forward(packet(5));
  run(x.loop, [&] { return !first.packets.empty() && !second.packets.empty(); });
  CHECK(first.packets == std::vector<bytes>{packet(5)});
  CHECK(second.packets == std::vector<bytes>{packet(5)});
}

TEST_CASE("of a program one packet is on its way to the sink, whatever it sends, and of others too",
          "[actors][serial][GW-17]") {
  forwarder_fixture x;
  auto& hasty = x.connect();
  bytes all;
  for (std::uint16_t i = 0; i < 50; ++i) {
    const auto each = serial::encode_forwarded(packet(i));
    all.insert(all.end(), each.begin(), each.end());
  }
  hasty.stream.send(all);
  run(x.loop, [&] { return x.for_sink.size() == 1; });
  auto& other = x.connect();
  other.stream.send(serial::encode_forwarded(packet(99)));
  run(x.loop, [&] { return x.for_sink.size() == 2; });
  CHECK(x.for_sink[1] == packet(99));
  for (std::uint16_t i = 1; i < 50; ++i) {
    x.clients->done(x.senders[0]);
    run(x.loop, [&] { return x.for_sink.size() == std::size_t{2} + i; });
    CHECK(x.for_sink.back() == packet(i));
  }
}

TEST_CASE("a program of none of the listed networks is closed at once",
          "[actors][serial][security]") {
  const bool is_listed = GENERATE(false, true);
  forwarder_fixture x({{{10, 0, 0, 0}, 8}, {{127, 0, 0, 1}, static_cast<std::uint8_t>(32)}});
  forwarder_fixture closed(std::vector<ipv4_network>{{{10, 0, 0, 0}, 8}});
  auto& used = is_listed ? x : closed;
  CHECK(used.connect().closed != is_listed);
  CHECK(used.clients->counters().foreign == (is_listed ? 0 : 1));
}

TEST_CASE("what a program has sent before it closed is delivered", "[actors][serial][GW-17]") {
  forwarder_fixture x;
  auto& brief = x.connect();
  auto two = serial::encode_forwarded(packet(1));
  const auto second = serial::encode_forwarded(packet(2));
  two.insert(two.end(), second.begin(), second.end());
  brief.stream.send(two);
  brief.stream.close();
  run(x.loop, [&] { return x.for_sink.size() == 1; });
  x.clients->done(x.senders[0]);
  run(x.loop, [&] { return x.for_sink.size() == 2; });
  x.clients->done(x.senders[0]);
  run(x.loop, [&] { return x.clients->count() == 0; });
}

TEST_CASE("a program that does not read is closed, and others get all that there is",
          "[actors][serial][GW-17]") {
  forwarder_fixture x;
  auto& good = x.connect();
  auto& stalled = x.connect();
  x.exchange(good);
  x.exchange(stalled);
  stalled.stream.read(false);
  std::size_t sent = 0;
  constexpr std::size_t enough = 1'000'000; // of octets that the system may hold
  while (x.clients->counters().slow == 0 && sent < enough) {
    for (int i = 0; i < 50; ++i, ++sent)
      x.clients->forward(packet(5, 114));
    const auto wanted = sent;
    run(x.loop, [&] { return good.packets.size() == wanted; });
  }
  CHECK(x.clients->counters().slow == 1);
  CHECK(x.clients->count() == 1);
  CHECK(!good.closed);
  REQUIRE(x.told.size() == 1);
  CHECK(x.told[0].find("it does not read") != std::string::npos);
}

TEST_CASE("programs that speak another protocol, or too many, are closed",
          "[actors][serial][GW-17]") {
  forwarder_fixture x;
  auto& other = x.connect(to_bytes("GET / HTTP/1.0\r\n\r\n"));
  run(x.loop, [&] { return other.closed; });
  CHECK(x.clients->counters().bad_input == 1);
  CHECK(x.told.at(0).find("does not use the serial forwarder's protocol") != std::string::npos);
  for (std::size_t i = 0; i < forwarder_clients::clients_max; ++i)
    CHECK(!x.connect().closed);
  CHECK(x.clients->count() == forwarder_clients::clients_max);
  auto& late = x.connect();
  run(x.loop, [&] { return late.closed; });
  CHECK(x.clients->counters().refused == 1);
}
