#include <algorithm>
#include <vector>

#include "radio/mac.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

constexpr std::size_t psdu_size = 41; // 28 octets of payload: followed by a LIFS

const mac_rules* const standard = find_mac("standard", platforms()[0]);

outgoing frame_of(std::uint64_t token, bool ack, std::size_t size = psdu_size) {
  outgoing x;
  x.token = token;
  x.psdu = bytes(size);
  x.content.ack_request = ack;
  x.content.dsn = static_cast<std::uint8_t>(token);
  return x;
}

/// Steps a mac to its next deadline.
mac_action step(mac& x, instant& now, bool clear, random_stream& dice) {
  now = x.deadline().value();
  return x.on_time(now, clear, dice);
}

/// From back-off to the last octet, the channel clear.
void put_on_air(mac& x, instant& now, random_stream& dice) {
  CHECK_FALSE(step(x, now, true, dice).transmit);
  CHECK(x.now_in() == mac::state::turning);
  CHECK(step(x, now, true, dice).transmit);
  CHECK(x.now_in() == mac::state::sending);
  CHECK_FALSE(x.deadline());
  now += air_time(psdu_size);
}

} // namespace

TEST_CASE("a frame goes out after back-off, assessment and turnaround", "[radio][mac][NET-15]") {
  random_stream dice(1);
  auto same = dice;
  mac x(standard, 8, 3);
  instant now = instant{} + 5ms;
  x.submit(frame_of(1, false), now, dice);
  const auto units = static_cast<int>(same.below(8));
  CHECK(x.deadline() == now + units * 320us + 128us);
  CHECK_FALSE(x.on_time(now, true, dice).transmit); // too early: nothing happens
  step(x, now, true, dice);
  CHECK(x.deadline() == now + 192us);
  CHECK(step(x, now, true, dice).transmit);
  const auto end = x.on_sent(now + air_time(psdu_size), dice).ended;
  REQUIRE(end);
  CHECK(end->token == 1);
  CHECK(end->status == send_status::sent);
  CHECK(end->transmissions == 1);
  CHECK(x.now_in() == mac::state::idle);
}

TEST_CASE("the back-off window doubles from 8 to 32 units and the fifth busy assessment fails",
          "[radio][mac][NET-15]") {
  std::vector<duration> longest(5);
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    random_stream dice(seed);
    mac x(standard, 8, 3);
    instant now;
    x.submit(frame_of(1, true), now, dice);
    for (std::size_t attempt = 0; attempt < 5; ++attempt) {
      CHECK(x.now_in() == mac::state::backing_off);
      const auto begun = now;
      const auto end = step(x, now, false, dice).ended;
      longest[attempt] = std::max(longest[attempt], now - begun - 128us);
      CHECK((now - begun - 128us).count() % (320us).count() == 0);
      REQUIRE(end.has_value() == (attempt == 4));
      if (end) {
        CHECK(end->status == send_status::channel_access_failure);
        CHECK(end->transmissions == 0);
      }
    }
    CHECK(x.now_in() == mac::state::idle);
  }
  CHECK(longest ==
        std::vector<duration>{7 * 320us, 15 * 320us, 31 * 320us, 31 * 320us, 31 * 320us});
}

TEST_CASE("a frame in its slot has no back-off and one attempt", "[radio][mac][SYN-16]") {
  random_stream dice(1);
  auto same = dice;
  mac x(standard, 8, 3);
  instant now = instant{} + 5ms;
  auto frame = frame_of(1, true);
  frame.in_slot = true;
  x.submit(frame, now, dice);
  CHECK(x.deadline() == now + 128us);
  CHECK(x.told_at() == now + 128us); // of a busy channel
  put_on_air(x, now, dice);
  CHECK_FALSE(x.on_sent(now, dice).ended);
  const auto unheard = step(x, now, true, dice).ended; // no ack
  REQUIRE(unheard);
  CHECK(unheard->status == send_status::no_ack);
  CHECK(unheard->transmissions == 1);

  x.submit(frame, now, dice);
  const auto busy = step(x, now, false, dice).ended;
  REQUIRE(busy);
  CHECK(busy->status == send_status::channel_access_failure);
  CHECK(busy->transmissions == 0);
  CHECK(dice.next() == same.next()); // none was thrown
}

TEST_CASE("a frame without ack is repeated, with a fresh back-off, until its attempts are used up",
          "[radio][mac]") {
  for (const unsigned retries : {0U, 1U, 3U, 7U}) {
    random_stream dice(retries);
    mac x(standard, 8, retries);
    instant now;
    x.submit(frame_of(9, true), now, dice);
    for (unsigned attempt = 0; attempt <= retries; ++attempt) {
      put_on_air(x, now, dice);
      CHECK_FALSE(x.on_sent(now, dice).ended);
      CHECK(x.awaits(9));
      CHECK_FALSE(x.awaits(8));
      CHECK(x.deadline() == now + 864us);
      const auto end = step(x, now, true, dice).ended;
      CHECK_FALSE(x.awaits(9));
      REQUIRE(end.has_value() == (attempt == retries));
      if (end) {
        CHECK(end->status == send_status::no_ack);
        CHECK(end->transmissions == retries + 1);
      } else {
        CHECK(*x.deadline() - now <= 7 * 320us + 128us);
      }
    }
  }
}

TEST_CASE("an ack ends the request and the next frame keeps its distance", "[radio][mac]") {
  struct spacing {
    std::size_t psdu;
    duration gap;
  };
  for (const auto& [size, gap] : {spacing{18, 192us}, spacing{19, 640us}}) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      random_stream dice(seed);
      mac x(standard, 8, 3);
      instant now;
      x.submit(frame_of(1, true, size), now, dice);
      x.submit(frame_of(2, true, size), now, dice);
      put_on_air(x, now, dice);
      static_cast<void>(x.on_sent(now, dice));
      now += 544us;
      auto same = dice;
      const auto end = x.on_ack(now, dice).ended;
      REQUIRE(end);
      CHECK(end->token == 1);
      CHECK(end->status == send_status::sent);
      CHECK(x.current().token == 2);
      CHECK(x.deadline() == now + gap + static_cast<int>(same.below(8)) * 320us + 128us);
    }
  }
}

TEST_CASE("the interframe space also holds for a frame submitted later", "[radio][mac]") {
  random_stream dice(1);
  mac x(standard, 8, 3);
  instant now;
  x.submit(frame_of(1, false), now, dice);
  put_on_air(x, now, dice);
  static_cast<void>(x.on_sent(now, dice));
  auto same = dice;
  x.submit(frame_of(2, false), now + 100us, dice);
  CHECK(x.deadline() == now + 640us + static_cast<int>(same.below(8)) * 320us + 128us);
}

TEST_CASE("CSMA begins after the transceiver's own ack", "[radio][mac][NET-15]") {
  random_stream dice(GENERATE(range(std::uint64_t{1}, std::uint64_t{9})));
  const instant until = instant{} + 7ms;
  const auto begins_after = [&](const mac& x) {
    const auto waits = x.deadline().value() - until - 128us;
    CHECK(waits >= 0us);
    CHECK(waits <= 7 * 320us);
    CHECK(waits % duration(320us) == 0us);
  };
  mac idle(standard, 8, 3);
  idle.on_own_ack(until, dice);
  CHECK_FALSE(idle.deadline());
  idle.submit(frame_of(1, true), instant{} + 6500us, dice);
  begins_after(idle);

  mac busy(standard, 8, 3); // what was sensed of the frame that is acked does not count
  instant now = instant{} + 1ms;
  busy.submit(frame_of(1, true), now, dice);
  for (int i = 0; i < 4; ++i)
    CHECK_FALSE(step(busy, now, false, dice).ended);
  busy.on_own_ack(until, dice);
  begins_after(busy);
  for (int i = 0; i < 4; ++i)
    CHECK_FALSE(step(busy, now, false, dice).ended);
  CHECK(step(busy, now, false, dice).ended);

  mac slotted(find_mac("cc2420", platforms()[0]), 8, 3); // its assessment looks back
  auto frame = frame_of(1, true);
  frame.in_slot = true;
  slotted.submit(frame, instant{} + 6900us, dice);
  slotted.on_own_ack(until, dice);
  CHECK(slotted.deadline() == until + 128us);

  mac turned(standard, 8, 3); // it had found the channel clear before
  now = instant{} + 1ms;
  turned.submit(frame_of(1, true), now, dice);
  CHECK_FALSE(step(turned, now, true, dice).transmit);
  turned.on_own_ack(until, dice);
  CHECK(step(turned, now, true, dice).transmit);
}

TEST_CASE("a transmit queue is full at its size and aborts in order", "[radio][mac]") {
  random_stream dice(1);
  mac x(standard, 3, 3);
  instant now;
  for (std::uint64_t i = 0; i < 3; ++i) {
    CHECK_FALSE(x.full());
    x.submit(frame_of(i, true), now, dice);
  }
  CHECK(x.full());
  CHECK(x.open() == 3);
  put_on_air(x, now, dice);
  const auto all = x.abort();
  REQUIRE(all.size() == 3);
  for (std::uint64_t i = 0; i < 3; ++i) {
    CHECK(all[i].token == i);
    CHECK(all[i].status == send_status::aborted);
    CHECK(all[i].transmissions == (i == 0 ? 1U : 0U));
  }
  CHECK(x.open() == 0);
  CHECK_FALSE(x.deadline());
  CHECK(x.now_in() == mac::state::idle);
  x.submit(frame_of(7, true), now, dice);
  CHECK(x.now_in() == mac::state::backing_off);
}

TEST_CASE("a send status has the report's name", "[radio][mac]") {
  CHECK(to_string(send_status::sent) == "sent");
  CHECK(to_string(send_status::no_ack) == "no_ack");
  CHECK(to_string(send_status::channel_access_failure) == "channel_access_failure");
  CHECK(to_string(send_status::queue_full) == "queue_full");
  CHECK(to_string(send_status::aborted) == "aborted");
}
