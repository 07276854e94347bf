#include <algorithm>
#include <utility>

#include "mote/duty_cycle.hpp"
#include "network/am.hpp"
#include "network/clock/clock_sync.hpp"
#include "support/catch.hpp"

namespace rubicon::mote {

namespace {

using std::chrono::microseconds;

constexpr network::channel_id stream{mote_id{9}, 1};
constexpr mote_id before{9};
constexpr mote_id behind{2};

duty_config sleeping() {
  duty_config x;
  x.enabled = true;
  x.settling = 0s;
  return x;
}

/// A member with a channel through it, whose packets come each second. Its clock is the island's.
struct sleeper {
  network::clock_sync clock;
  network::time_search search;
  duty_cycle duty{sleeping(), false};
  instant due; ///< of one packet, not in a common window
  std::uint64_t token = 0;

  sleeper() {
    network::clock_sync_config config;
    config.is_root = true;
    clock = network::clock_sync(config, instant{});
    clock.on_time(instant(10s));
    const auto first = island_time(microseconds(500ms));
    duty.reserve({stream, {first, 1s, 20}, before});
    due = clock.time().when(first + 10s);
    duty.set_member(true);
    update(due - 100ms);
  }

  duty_outputs update(instant now) { return duty.update(now, clock.time(), search); }

  [[nodiscard]] static bytes packet() {
    return encode(network::channel_message{stream, network::data_message{7, bytes(20)}});
  }

  void receive(instant now) {
    duty.on_frame(network::am::channel, packet(), now);
    update(now);
  }

  /// The packet, to the next mote.
  void hand_on(instant now) {
    network::frame_out x;
    x.token = ++token;
    x.next_hop = behind;
    x.am_type = network::am::channel;
    x.payload = packet();
    duty.submit(std::move(x));
    update(now);
  }

  void end_of_frame(instant now) {
    duty.on_sent(token);
    update(now);
  }

  /// When the radio goes off, if nothing else happens from `now` on.
  [[nodiscard]] instant off_at(instant now) {
    REQUIRE(duty.is_on());
    while (duty.is_on()) {
      REQUIRE(duty.deadline());
      REQUIRE(*duty.deadline() > now);
      now = *duty.deadline();
      update(now);
    }
    return now;
  }
};

constexpr duration rounding = 3us;

} // namespace

TEST_CASE("the radio waits for a packet, and for repeats after it", "[mote][NRG-02]") {
  const duty_config config;
  sleeper x;
  CHECK_FALSE(x.duty.is_on());
  x.update(x.due - 1ms);
  CHECK(x.duty.is_on());
  SECTION("none comes") {
    const auto off = x.off_at(x.due - 1ms);
    CHECK(off - x.due >= config.after);
    CHECK(off - x.due <= config.after + 1ms);
  }
  SECTION("it ends here") {
    x.receive(x.due + 3ms);
    x.duty.on_received(stream);
    x.update(x.due + 3ms);
    const auto off = x.off_at(x.due + 3ms);
    CHECK(off - (x.due + 3ms) >= config.linger);
    CHECK(off - (x.due + 3ms) <= config.linger + rounding);
  }
  SECTION("it comes again and again: acknowledgements are lost") {
    x.receive(x.due + 3ms);
    x.duty.on_received(stream);
    x.update(x.due + 3ms);
    x.receive(x.due + 10ms);
    x.receive(x.due + 18ms);
    CHECK(x.off_at(x.due + 18ms) - (x.due + 18ms) >= config.linger);
  }
  SECTION("it is for others") {
    x.duty.on_frame(network::am::channel,
                    encode(network::channel_message{{mote_id{9}, 2}, network::data_message{}}),
                    x.due + 3ms);
    x.duty.on_frame(network::am::channel, bytes(3), x.due + 3ms);
    CHECK(x.off_at(x.due + 3ms) - x.due >= config.after);
  }
}

TEST_CASE("a relay that hands on a late packet at once waits for its repeats", "[mote][NRG-02]") {
  const duty_config config;
  sleeper x;
  x.update(x.due - 1ms);
  const auto came = x.due + 20ms;
  x.receive(came);
  x.hand_on(came);
  x.end_of_frame(came + 4ms);
  const auto off = x.off_at(came + 4ms);
  CHECK(off - came >= config.linger);
  CHECK(off - came <= config.linger + rounding);
}

TEST_CASE("a relay that hands on a packet in its turn is off when it has gone", "[mote][NRG-02]") {
  sleeper x;
  x.update(x.due - 1ms);
  x.receive(x.due);
  x.hand_on(x.due);
  const auto turn = x.due + network::channel_slot;
  REQUIRE(x.duty.deadline());
  CHECK(*x.duty.deadline() <= turn + rounding);
  x.update(turn + rounding);
  x.end_of_frame(turn + 4ms);
  CHECK_FALSE(x.duty.is_on());
}

} // namespace rubicon::mote
