// Hostile octets on the cable between a sink and its gateway, in both directions.
#include <algorithm>
#include <cstdlib>
#include <set>

#include <malloc.h>

#include "gateway/gateway.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "network/sink_event.hpp"
#include "serial/frame.hpp"
#include "serial/host_port.hpp"
#include "serial/mote_port.hpp"
#include "serial/packet.hpp"
#include "support/catch.hpp"
#include "support/island_fixture.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using test::island_fixture;

namespace {

constexpr int side = 2;
constexpr std::size_t motes = side * side - 1;
constexpr duration octet_time = 174us; // 57 600 baud
constexpr auto recovery_max = 150s;

/// A sink with its motes, its gateway, and a cable that somebody else can write to at either end.
class bridge {
public:
  explicit bridge(std::uint64_t seed)
      : island({.width = side, .height = side, .seed = seed}), rng_(seed) {
    gateway::gateway_config config;
    config.island = island_id{1};
    pc = gateway::gateway(config, random_stream(seed));
    perform(pc.start(island.now()));
  }

  void run_for(duration length) {
    for (const auto end = island.now() + length; island.now() < end;) {
      island.run_for(5ms);
      carry_up();
      perform(port.on_time(island.now()));
      perform(uart.on_time(island.now()));
      perform(pc.on_time(island.now()));
    }
  }

  void to_pc(byte_view octets) { perform(uart.on_bytes(octets, island.now())); }
  void to_mote(byte_view octets) { perform(port.on_bytes(octets, island.now())); }

  /// Somebody writes to each mote in turn for so long. @returns how many statuses came, of how many
  std::pair<std::size_t, std::size_t> control(duration length) {
    const auto before = acked;
    std::size_t asked = 0;
    for (const auto end = island.now() + length; island.now() < end;) {
      const mote_id to{static_cast<std::uint16_t>(2 + asked % motes)};
      ++asked;
      ++written;
      perform(pc.on_input(to, 2, bytes{1}, island.now()));
      run_for(500ms);
    }
    run_for(2s);
    return {acked - before, asked};
  }

  [[nodiscard]] bool is_well() {
    if (pc.devices().size() != motes || island.root().members() != motes)
      return false;
    const auto [ended, asked] = control(10s);
    return ended == asked;
  }

  island_fixture island;
  gateway::gateway pc;
  serial::host_port uart; ///< the gateway's end
  serial::mote_port port;
  std::vector<bytes> seen; ///< frames that were written, for whoever wants to imitate them
  std::size_t written = 0;
  std::size_t acked = 0;
  std::size_t failed = 0;
  std::set<std::uint64_t> open; ///< packets that the endpoint has taken

private:
  void carry_up() {
    for (auto& x : std::exchange(island.up, {})) {
      serial::am_packet packet;
      packet.source = x.source.value;
      packet.am_type = x.am_type;
      packet.payload = std::move(x.payload);
      perform(port.send(serial::encode(packet), island.now()));
    }
  }

  void note(const bytes& frame) {
    if (seen.size() < 256)
      seen.push_back(frame);
    else
      seen[rng_.below(256)] = frame;
  }

  void perform(const serial::mote_port_outputs& todo) {
    for (const auto& x : todo) {
      if (const auto* line = std::get_if<serial::to_line>(&x)) {
        note(line->octets);
        to_pc(line->octets);
      } else if (const auto packet =
                     serial::decode_am_packet(std::get<serial::received>(x).packet)) {
        island.down(packet->am_type, packet->payload);
      }
    }
  }

  void perform(const serial::outputs& todo) {
    for (const auto& x : todo) {
      if (const auto* line = std::get_if<serial::to_line>(&x)) {
        note(line->octets);
        to_mote(line->octets);
      } else if (const auto* done = std::get_if<serial::sent>(&x)) {
        CHECK(open.erase(done->id.value) == 1);
      } else if (const auto* lost = std::get_if<serial::lost>(&x)) {
        CHECK(open.erase(lost->id.value) == 1);
      } else if (const auto packet =
                     serial::decode_am_packet(std::get<serial::received>(x).packet)) {
        perform(
            pc.on_packet(mote_id{packet->source}, packet->am_type, packet->payload, island.now()));
      }
    }
  }

  void perform(const gateway::outputs& todo) {
    for (const auto& x : todo) {
      if (const auto* down = std::get_if<gateway::to_sink>(&x)) {
        serial::am_packet packet;
        packet.am_type = down->am_type;
        packet.payload = down->payload;
        open.insert(++packets_);
        perform(uart.send(serial::packet_id{packets_}, serial::encode(packet), island.now()));
      } else if (const auto* answer = std::get_if<gateway::answer_sink>(&x)) {
        serial::am_packet packet;
        packet.am_type = network::am::sink_event;
        packet.payload = encode(answer->answer);
        perform(uart.send_urgent(serial::encode(packet), island.now()));
      } else if (const auto* tuple = std::get_if<gateway::publish>(&x)) {
        const auto text = to_string(tuple->value);
        acked += tuple->key.ends_with(".status") && text.ends_with(" acknowledged") ? 1U : 0U;
        failed += tuple->key.ends_with(".status") &&
                          (text.ends_with(" failed") || text.ends_with(" unreachable"))
                      ? 1U
                      : 0U;
      }
    }
  }

  random_stream rng_;
  std::uint64_t packets_ = 0;
};

/// What comes out of a cable that somebody has cut open.
class hostile_octets {
public:
  explicit hostile_octets(std::uint64_t seed) : rng_(seed) {}

  bytes next(const std::vector<bytes>& seen) {
    const auto any = [&] {
      return seen.empty() ? bytes{} : seen[rng_.below(static_cast<std::uint32_t>(seen.size()))];
    };
    switch (rng_.below(8)) {
    case 0:
      return random_octets(1 + rng_.below(300));
    case 1: { // half a frame
      auto x = any();
      x.resize(rng_.below(static_cast<std::uint32_t>(x.size() + 1)));
      return x;
    }
    case 2: { // a giant one
      auto x = bytes(20'000, static_cast<std::uint8_t>(rng_.below(256)));
      x.front() = serial::flag_octet;
      return x;
    }
    case 3: { // acks for everything
      bytes all;
      for (int i = 0; i < 256; ++i)
        append(all,
               encode(serial::frame{serial::frame_type::ack, static_cast<std::uint8_t>(i), {}}));
      return all;
    }
    case 4:
      return any(); // again
    case 5: {       // with other octets
      auto x = any();
      for (auto i = rng_.below(4); !x.empty() && i > 0; --i)
        x[rng_.below(static_cast<std::uint32_t>(x.size()))] =
            static_cast<std::uint8_t>(rng_.below(256));
      return x;
    }
    default:
      return forged();
    }
  }

private:
  static void append(bytes& to, const bytes& from) {
    to.insert(to.end(), from.begin(), from.end());
  }

  bytes random_octets(std::size_t count) {
    bytes x(count);
    for (auto& each : x)
      each = static_cast<std::uint8_t>(rng_.below(256));
    return x;
  }

  mote_id any_mote() {
    const auto x = rng_.chance(0.5) ? 1 + rng_.below(5) : rng_.below(0x10000);
    return mote_id{static_cast<std::uint16_t>(x)};
  }

  /// Sound frames with messages that are lies.
  bytes forged() {
    serial::am_packet x;
    x.source = any_mote().value;
    x.am_type = network::am::sink_event;
    const auto small = static_cast<std::uint32_t>(rng_.chance(0.5) ? rng_.below(3) : rng_.next());
    switch (rng_.below(10)) {
    case 0:
    case 1:
      x.payload = encode(
          network::sink_event(network::mote_joined{any_mote(), small, 9, random_octets(20)}));
      break;
    case 2:
      x.payload =
          encode(network::sink_event(network::mote_left{any_mote(), network::leave_cause::notice}));
      break;
    case 3: {
      network::roster roster;
      roster.number = static_cast<std::uint16_t>(rng_.below(0x10000));
      roster.pages = static_cast<std::uint8_t>(1 + rng_.below(255));
      for (auto i = rng_.below(18); i > 0; --i)
        roster.entries.push_back({any_mote(), small});
      x.payload = encode(network::sink_event(roster));
      break;
    }
    case 4:
      x.payload = encode(network::sink_event(network::sink_started{}));
      break;
    case 5:
      x.payload = encode(network::sink_event(network::time_answer{
          static_cast<std::uint16_t>(rng_.below(64)),
          std::chrono::microseconds(static_cast<std::int64_t>(rng_.next() >> 12)),
          std::chrono::microseconds(rng_.chance(0.5) ? 0 : rng_.below(0x100000000))}));
      break;
    case 6:
      x.payload = encode(network::sink_event(network::gateway_poll{small, small, true}));
      break;
    case 7:
      x.payload = encode(network::sink_event(network::describe{any_mote()}));
      break;
    case 8:
      x.am_type = rng_.chance(0.5) ? network::am::to_gateway : network::am::from_gateway;
      x.payload = encode(network::island_packet{
          island_id{1}, any_mote(), static_cast<std::uint16_t>(small), random_octets(30)});
      break;
    default:
      x.am_type = static_cast<std::uint8_t>(rng_.below(256));
      x.payload = random_octets(rng_.below(115));
    }
    const auto type =
        rng_.chance(0.5) ? serial::frame_type::packet : serial::frame_type::packet_with_ack;
    return encode(
        serial::frame{type, static_cast<std::uint8_t>(rng_.below(256)), serial::encode(x)});
  }

  random_stream rng_;
};

} // namespace

TEST_CASE("a sink and its gateway survive hostile octets and are well again after them",
          "[hostile][serial][gateway]") {
  const auto* text = std::getenv("RUBICON_HOSTILE_SEEDS");
  const auto seeds = text != nullptr ? std::strtoull(text, nullptr, 10) : test::seeds(3);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    CAPTURE(seed);
    bridge x(seed);
    hostile_octets enemy(seed);
    x.run_for(1min);
    const bool well = x.is_well();
    CAPTURE(x.pc.devices().size(), x.island.root().members(), x.acked, x.failed, x.written);
    REQUIRE(well);
    const auto quiet = ::mallinfo2().uordblks;
    for (const auto end = x.island.now() + 60s; x.island.now() < end;) {
      const auto octets = enemy.next(x.seen);
      const bool up = seed % 3 == 0 || (seed % 3 == 1) == (octets.size() % 2 == 0);
      x.run_for(static_cast<duration::rep>(octets.size()) * octet_time);
      if (up)
        x.to_pc(octets);
      else
        x.to_mote(octets);
      CHECK(x.pc.devices().size() <= 1000);
    }
    const auto grown = static_cast<std::ptrdiff_t>(::mallinfo2().uordblks - quiet);
    CHECK(grown < 2'000'000);
    const auto attacked = x.island.now();
    while (!x.is_well() && x.island.now() - attacked < recovery_max)
      x.run_for(1s);
    const auto took = x.island.now() - attacked;
    if (std::getenv("RUBICON_HOSTILE_TELL") != nullptr)
      WARN("seed " << seed << ": well after " << took / 1s << " s, " << grown << " octets");
    CAPTURE(x.pc.devices().size(), x.island.root().members(), x.acked, x.failed, x.written);
    CHECK(took < recovery_max);
    x.run_for(90s);
    CHECK(x.open.empty());                  // each packet has had its end,
    CHECK(x.acked + x.failed == x.written); // and each write
  }
}
