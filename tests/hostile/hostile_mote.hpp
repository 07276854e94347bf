// A mote that means ill: it hears everything, and sends what it likes in anybody's name.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "core/numbers/random.hpp"
#include "mote/join/management.hpp"
#include "network/am.hpp"
#include "network/beacon.hpp"
#include "network/router_message.hpp"
#include "network/tree/collection_packet.hpp"
#include "network/wire.hpp"
#include "support/island_fixture.hpp"

namespace rubicon::test {

/// What it does; `anything` takes turns.
enum class malice : std::uint8_t {
  anything,
  replay,   ///< frames heard before, as they were, in the name of whoever
  mutation, ///< the same with other octets and lengths
  noise,    ///< any octets, as any AM type
  beacons,  ///< of the sink and of neighbours: roots, ranks, sequences, times and ticks as it likes
  management, ///< joins, replies, goodbyes of others
};

/// Seeded; frames that it has overheard are what its own are made of.
class hostile_mote {
public:
  hostile_mote(island_fixture& world, int motes, std::uint64_t seed)
      : world_(world), motes_(motes), rng_(seed) {
    world_.on_air = [this](mote_id, const network::frame_out& x) {
      if (heard_.size() < 512)
        heard_.push_back(x);
      else
        heard_[rng_.below(512)] = x;
    };
  }
  ~hostile_mote() { world_.on_air = {}; }
  hostile_mote(const hostile_mote&) = delete;
  hostile_mote& operator=(const hostile_mote&) = delete;

  /// Frames one after the other, as fast as the channel carries them, for so long.
  void attack(malice what, duration length) {
    for (const auto end = world_.now() + length; world_.now() < end;) {
      const auto frame = make(what);
      const auto source = forged_source();
      world_.run_for(radio_time(frame.payload.size()));
      for (int to = 1; to <= motes_; ++to) {
        const mote_id target{static_cast<std::uint16_t>(to)};
        if (target != source && (frame.next_hop == broadcast_mote || frame.next_hop == target))
          world_.hear(target, source, frame);
      }
      ++sent_;
    }
  }

  [[nodiscard]] std::uint64_t sent() const { return sent_; }

private:
  /// 250 kbit/s: 32 us an octet, 19 of headers around the payload, and a turnaround.
  static duration radio_time(std::size_t payload) {
    return 32us * static_cast<duration::rep>(payload + 19) + 192us;
  }

  mote_id any_mote() {
    if (rng_.chance(0.1))
      return mote_id{static_cast<std::uint16_t>(rng_.below(0x10000))};
    return mote_id{static_cast<std::uint16_t>(1 + rng_.below(static_cast<std::uint32_t>(motes_)))};
  }

  mote_id forged_source() {
    for (;;) {
      const auto x = any_mote(); // a frame from nobody or from all is no frame
      if (x.value != 0 && x.value <= mote_id_max)
        return x;
    }
  }

  network::frame_out make(malice what) {
    if (what == malice::anything)
      what = static_cast<malice>(1 + rng_.below(5));
    network::frame_out x;
    if (!heard_.empty())
      x = heard_[rng_.below(static_cast<std::uint32_t>(heard_.size()))];
    x.next_hop = rng_.chance(0.5) ? broadcast_mote : any_mote();
    switch (what) {
    case malice::mutation:
      mutate(x.payload);
      break;
    case malice::noise:
      x.am_type = static_cast<std::uint8_t>(rng_.below(256));
      x.payload = random_octets(rng_.below(network::frame_payload_max + 1));
      break;
    case malice::beacons:
      x.am_type = network::am::beacon;
      x.next_hop = broadcast_mote;
      x.payload = beacon();
      break;
    case malice::management:
      x.am_type = network::am::component_management;
      x.payload = management();
      if (rng_.chance(0.5)) {
        x.am_type = network::am::up;
        x.payload = routed(x.payload);
      }
      break;
    case malice::anything:
    case malice::replay:
      break;
    }
    return x;
  }

  bytes random_octets(std::size_t count) {
    bytes x(count);
    for (auto& each : x)
      each = static_cast<std::uint8_t>(rng_.below(256));
    return x;
  }

  void mutate(bytes& x) {
    for (auto i = 1 + rng_.below(6); i > 0 && !x.empty(); --i)
      x[rng_.below(static_cast<std::uint32_t>(x.size()))] =
          static_cast<std::uint8_t>(rng_.below(256));
    if (rng_.chance(0.2))
      x.resize(rng_.below(network::frame_payload_max + 1));
  }

  bytes beacon() {
    network::beacon x;
    for (const auto& each : heard_) // of a real one, for what is to look real
      if (each.am_type == network::am::beacon && rng_.chance(0.1))
        if (auto real = network::decode_beacon(each.payload))
          x = *std::move(real);
    const auto word = [this] { return static_cast<std::uint16_t>(rng_.below(0x10000)); };
    const auto maybe = [this](auto& field, auto value) {
      if (rng_.chance(0.4))
        field = value;
    };
    maybe(x.sequence, word());
    maybe(x.next_quarters, static_cast<std::uint16_t>(rng_.below(65536)));
    maybe(x.gradient.root, any_mote());
    maybe(x.gradient.root_sequence, word());
    maybe(x.gradient.parent, any_mote());
    maybe(x.gradient.cost, rng_.chance(0.7) ? network::etx_cost{0} : word());
    maybe(x.gradient.hops, std::uint8_t{0});
    maybe(x.clock.root, mote_id{1});
    maybe(x.clock.sequence, word());
    maybe(x.clock.time, island_time(std::chrono::microseconds(rng_.next() >> 17)));
    maybe(x.clock.age_us, static_cast<std::uint32_t>(rng_.next()));
    maybe(x.clock.tick.first, static_cast<std::uint32_t>(rng_.next()));
    maybe(x.clock.tick.from, island_time(std::chrono::microseconds(rng_.next() >> 18)));
    maybe(x.clock.tick.period, std::chrono::milliseconds(rng_.below(1U << 13)));
    maybe(x.clock.slots_used, static_cast<std::uint8_t>(rng_.below(8)));
    if (rng_.chance(0.3))
      x.clock.network = network::network_line{
          std::chrono::microseconds(static_cast<std::int64_t>(rng_.next())), 0};
    x.heard.resize(std::min(x.heard.size(), network::beacon::heard_max(x.clock)));
    return encode(x);
  }

  bytes management() {
    const auto word = [this] { return static_cast<std::uint16_t>(rng_.below(0x10000)); };
    const auto small = static_cast<std::uint32_t>(rng_.chance(0.5) ? rng_.below(4) : rng_.next());
    switch (rng_.below(8)) {
    case 0: {
      mote::join_request x;
      x.sequence = word();
      x.incarnation = small;
      return encode(mote::management(x));
    }
    case 1: {
      mote::join_reply x;
      x.sequence = word();
      x.mote = forged_source();
      return encode(mote::management(x));
    }
    case 2:
      return encode(mote::management(mote::join_confirm{word(), small, {}}));
    case 3:
      return encode(mote::management(mote::leave_notice{}));
    case 4: {
      mote::keep_alive x;
      x.incarnation = small;
      return encode(mote::management(x));
    }
    case 5:
      return encode(mote::management(mote::slot_notice{word(), {word(), word()}}));
    case 6:
      return encode(mote::management(mote::slot_grant{{word(), word()}}));
    default:
      return encode(mote::management(mote::rejoin_prompt{}));
    }
  }

  /// On its route to the sink.
  bytes routed(const bytes& content) {
    network::user_content user;
    user.content = {network::am::component_management};
    user.content.insert(user.content.end(), content.begin(), content.end());
    network::up_packet x;
    x.origin = forged_source();
    x.parent = any_mote();
    x.sequence = static_cast<std::uint16_t>(rng_.below(0x10000));
    x.content = encode(network::router_message(user));
    return encode(x);
  }

  island_fixture& world_;
  int motes_ = 0;
  random_stream rng_;
  std::vector<network::frame_out> heard_;
  std::uint64_t sent_ = 0;
};

} // namespace rubicon::test
