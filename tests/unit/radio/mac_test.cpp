#include <algorithm>
#include <vector>

#include "radio/mac.hpp"
#include "support/catch.hpp"
#include "unit/radio/mac_steps.hpp"
#include "unit/radio/samples.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::frame_of;
using test::psdu_size;
using test::standard;
using test::step;

namespace {

/// From back-off to the last octet, the channel clear.
void put_on_air(mac& x, instant& now, random_stream& rng) {
  CHECK_FALSE(step(x, now, true, rng).transmit);
  CHECK(x.now_in() == mac::state::turning);
  CHECK(step(x, now, true, rng).transmit);
  CHECK(x.now_in() == mac::state::sending);
  CHECK_FALSE(x.deadline());
  now += air_time(psdu_size);
}

} // namespace

TEST_CASE("a frame goes out after back-off, assessment and turnaround", "[radio][mac][NET-15]") {
  random_stream rng(1);
  auto same = rng;
  mac x(standard, 8, 3);
  instant now = instant{} + 5ms;
  x.submit(frame_of(1, false), now, rng);
  const auto units = static_cast<int>(same.below(8));
  CHECK(x.deadline() == now + units * 320us + 128us);
  CHECK_FALSE(x.on_time(now, true, rng).transmit); // too early: nothing happens
  step(x, now, true, rng);
  CHECK(x.deadline() == now + 192us);
  CHECK(step(x, now, true, rng).transmit);
  const auto end = x.on_sent(now + air_time(psdu_size), rng).ended;
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
    random_stream rng(seed);
    mac x(standard, 8, 3);
    instant now;
    x.submit(frame_of(1, true), now, rng);
    for (std::size_t attempt = 0; attempt < 5; ++attempt) {
      CHECK(x.now_in() == mac::state::backing_off);
      const auto begun = now;
      const auto end = step(x, now, false, rng).ended;
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
  random_stream rng(1);
  auto same = rng;
  mac x(standard, 8, 3);
  instant now = instant{} + 5ms;
  auto frame = frame_of(1, true);
  frame.in_slot = true;
  x.submit(frame, now, rng);
  CHECK(x.deadline() == now + 128us);
  CHECK(x.earliest_output() == now + 128us); // of a busy channel
  put_on_air(x, now, rng);
  CHECK_FALSE(x.on_sent(now, rng).ended);
  const auto unheard = step(x, now, true, rng).ended; // no ack
  REQUIRE(unheard);
  CHECK(unheard->status == send_status::no_ack);
  CHECK(unheard->transmissions == 1);

  x.submit(frame, now, rng);
  const auto busy = step(x, now, false, rng).ended;
  REQUIRE(busy);
  CHECK(busy->status == send_status::channel_access_failure);
  CHECK(busy->transmissions == 0);
  CHECK(rng.next() == same.next()); // none was thrown
}

TEST_CASE("a frame without ack is repeated, with a fresh back-off, until its attempts are used up",
          "[radio][mac]") {
  for (const unsigned retries : {0U, 1U, 3U, 7U}) {
    random_stream rng(retries);
    mac x(standard, 8, retries);
    instant now;
    x.submit(frame_of(9, true), now, rng);
    for (unsigned attempt = 0; attempt <= retries; ++attempt) {
      put_on_air(x, now, rng);
      CHECK_FALSE(x.on_sent(now, rng).ended);
      CHECK(x.awaits(9));
      CHECK_FALSE(x.awaits(8));
      CHECK(x.deadline() == now + 864us);
      const auto end = step(x, now, true, rng).ended;
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
      random_stream rng(seed);
      mac x(standard, 8, 3);
      instant now;
      x.submit(frame_of(1, true, size), now, rng);
      x.submit(frame_of(2, true, size), now, rng);
      put_on_air(x, now, rng);
      static_cast<void>(x.on_sent(now, rng));
      now += 544us;
      auto same = rng;
      const auto end = x.on_ack(now, rng).ended;
      REQUIRE(end);
      CHECK(end->token == 1);
      CHECK(end->status == send_status::sent);
      CHECK(x.current().token == 2);
      CHECK(x.deadline() == now + gap + static_cast<int>(same.below(8)) * 320us + 128us);
    }
  }
}

TEST_CASE("the interframe space also holds for a frame submitted later", "[radio][mac]") {
  random_stream rng(1);
  mac x(standard, 8, 3);
  instant now;
  x.submit(frame_of(1, false), now, rng);
  put_on_air(x, now, rng);
  static_cast<void>(x.on_sent(now, rng));
  auto same = rng;
  x.submit(frame_of(2, false), now + 100us, rng);
  CHECK(x.deadline() == now + 640us + static_cast<int>(same.below(8)) * 320us + 128us);
}

TEST_CASE("CSMA begins when the transceiver receives again after its own ack",
          "[radio][mac][NET-15]") {
  random_stream rng(GENERATE(range(std::uint64_t{1}, std::uint64_t{9})));
  const instant until = instant{} + 7ms;
  const auto begins_after = [&](const mac& x) {
    const auto waits = x.deadline().value() - until - 192us - 128us;
    CHECK(waits >= 0us);
    CHECK(waits <= 7 * 320us);
    CHECK(waits % duration(320us) == 0us);
  };
  mac idle(standard, 8, 3);
  idle.on_own_ack(until, rng);
  CHECK_FALSE(idle.deadline());
  idle.submit(frame_of(1, true), instant{} + 6500us, rng);
  begins_after(idle);

  mac busy(standard, 8, 3); // what was sensed of the frame that is acked does not count
  instant now = instant{} + 1ms;
  busy.submit(frame_of(1, true), now, rng);
  for (int i = 0; i < 4; ++i)
    CHECK_FALSE(step(busy, now, false, rng).ended);
  busy.on_own_ack(until, rng);
  begins_after(busy);
  for (int i = 0; i < 4; ++i)
    CHECK_FALSE(step(busy, now, false, rng).ended);
  CHECK(step(busy, now, false, rng).ended);

  mac slotted(find_mac("cc2420", platforms()[0]), 8, 3); // its assessment looks back
  auto frame = frame_of(1, true);
  frame.in_slot = true;
  slotted.submit(frame, instant{} + 6900us, rng);
  slotted.on_own_ack(until, rng);
  CHECK(slotted.deadline() == until + 192us + 128us);

  mac turned(standard, 8, 3); // it had found the channel clear before
  now = instant{} + 1ms;
  turned.submit(frame_of(1, true), now, rng);
  CHECK_FALSE(step(turned, now, true, rng).transmit);
  turned.on_own_ack(until, rng);
  CHECK(step(turned, now, true, rng).transmit);
}

TEST_CASE("the assessment of a frame in its slot does not look back at the exchange before it",
          "[radio][mac][SYN-16]") {
  for (const auto* name : {"standard", "cc2420", "rf230"}) {
    for (const bool ack : {false, true}) {
      INFO(name << " ack " << ack);
      random_stream rng(1);
      const auto* rules = find_mac(name, platforms()[0]);
      mac x(rules, 8, 3);
      auto next = frame_of(2, true);
      next.in_slot = true;
      auto first = frame_of(1, ack);
      first.in_slot = true;
      instant now = instant{} + 5ms;
      x.submit(first, now, rng);
      while (!step(x, now, true, rng).transmit)
        CHECK(x.assesses() == (x.now_in() != mac::state::turning));
      now += air_time(psdu_size);
      static_cast<void>(x.on_sent(now, rng));
      auto silent = now + 192us; // the receiver is deaf until then
      if (ack) {
        now += 1ms;
        static_cast<void>(x.on_ack(now, rng));
        silent = now;
      }
      x.submit(next, now, rng);
      REQUIRE(x.deadline());
      CHECK(*x.deadline() - 128us >= silent);
      CHECK(*x.deadline() - 128us <= silent + 640us); // nor does it wait for more than a LIFS
    }
  }
}

TEST_CASE("a transmit queue is full at its size and aborts in order", "[radio][mac]") {
  random_stream rng(1);
  mac x(standard, 3, 3);
  instant now;
  for (std::uint64_t i = 0; i < 3; ++i) {
    CHECK_FALSE(x.full());
    x.submit(frame_of(i, true), now, rng);
  }
  CHECK(x.full());
  CHECK(x.open() == 3);
  put_on_air(x, now, rng);
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
  x.submit(frame_of(7, true), now, rng);
  CHECK(x.now_in() == mac::state::backing_off);
}

TEST_CASE("a send status has the report's name", "[radio][mac]") {
  CHECK(to_string(send_status::sent) == "sent");
  CHECK(to_string(send_status::no_ack) == "no_ack");
  CHECK(to_string(send_status::channel_access_failure) == "channel_access_failure");
  CHECK(to_string(send_status::queue_full) == "queue_full");
  CHECK(to_string(send_status::aborted) == "aborted");
}
