#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "radio/mac.hpp"
#include "radio/medium/receiver.hpp"
#include "support/catch.hpp"
#include "unit/radio/fixture.hpp"
#include "unit/radio/mac_steps.hpp"
#include "unit/radio/samples.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::channel_with;
using test::frame_of;
using test::micaz;
using test::radio_fixture;
using test::step;

namespace {

constexpr duration micaz_tick = 34722ns; // 28 800 Hz
constexpr duration telosb_tick = 30518ns;

const platform& iris = *find_platform("iris");
const platform& telosb = *find_platform("telosb");

/// How long it took to each of `count` assessments, all of them busy, for one frame.
std::vector<duration> busy_delays(const mac_rules* rules, std::size_t count, std::uint64_t seed) {
  random_stream rng(seed);
  mac x(rules, 8, 3);
  instant now;
  x.submit(frame_of(0, true), now, rng);
  std::vector<duration> all;
  while (all.size() < count && x.deadline()) {
    const auto before = now;
    static_cast<void>(step(x, now, false, rng));
    all.push_back(now - before);
  }
  return all;
}

/// A uniform choice of `count` steps of `step` from `first` on.
void check_window(const std::vector<duration>& all, duration first, duration step, int count) {
  duration sum{};
  std::set<duration> seen;
  for (const auto x : all) {
    if ((x - first).count() % step.count() != 0)
      FAIL("not a whole number of steps");
    sum += x;
    seen.insert(x);
  }
  const auto span = seconds(step) * count;
  CHECK(*seen.begin() >= first);
  CHECK(*seen.begin() < first + step * std::max(1, count / 50));
  CHECK(*seen.rbegin() <= first + step * (count - 1));
  CHECK(*seen.rbegin() > first + step * (count - 1 - std::max(1, count / 50)));
  const auto n = static_cast<double>(all.size());
  const auto expected = seconds(first) + seconds(step) * (count - 1) / 2;
  CHECK(std::abs(seconds(sum) / n - expected) < 5 * span / std::sqrt(12 * n));
}

channel_config with_mac(const std::string& name, std::optional<unsigned> retries = {}) {
  return channel_with([&](auto& c) {
    for (const auto& kind : platforms())
      c.macs.emplace_back(std::string(kind.name), name);
    c.retries_max = retries;
  });
}

/// A platform whose receive slots never run out.
platform quick(const platform& kind) {
  auto x = kind;
  x.service_time = 10us;
  return x;
}

frame frame_from(std::uint16_t source, std::uint8_t dsn) {
  frame x;
  x.source = mote_id{source};
  x.destination = mote_id{7};
  x.dsn = dsn;
  return x;
}

struct inbox {
  inbox(const char* rules, unsigned retries) {
    const auto* found = find_mac(rules, telosb);
    in = receiver(found, 1000, found->repeats_for(retries));
  }

  verdict hear(std::uint16_t source, std::uint8_t dsn, duration at) {
    return in.on_frame(frame_from(source, dsn), true, 1us, mcu, instant(at));
  }

  receiver in;
  energy_meter mcu{&telosb, 2000, 0, instant{}};
};

} // namespace

TEST_CASE("every name has rules on every platform", "[radio][mac_rules]") {
  CHECK(mac_names() == std::vector<std::string>{"standard", "cc2420", "rf230"});
  for (const auto& kind : platforms()) {
    for (const auto& name : mac_names()) {
      const auto* rules = find_mac(name, kind);
      REQUIRE(rules != nullptr);
      CHECK(rules->name == name);
    }
    CHECK(find_mac("csma", kind) == nullptr);
    CHECK(find_mac("", kind) == nullptr);
  }
}

TEST_CASE("the CC2420 stack's windows are 11 to 320 and 11 to 80 ticks", "[radio][mac_rules]") {
  for (const auto& [kind, tick] : {std::pair{&micaz, micaz_tick}, {&telosb, telosb_tick}}) {
    const auto* rules = find_mac("cc2420", *kind);
    std::vector<duration> initial;
    std::vector<duration> congestion;
    for (std::uint64_t seed = 0; seed < 4000; ++seed) {
      const auto all = busy_delays(rules, 5, seed);
      initial.push_back(all[0]);
      congestion.insert(congestion.end(), all.begin() + 1, all.end());
    }
    check_window(initial, 11 * tick, tick, 310);
    check_window(congestion, 11 * tick, tick, 70);
  }
}

TEST_CASE("the CC2420 stack never gives up a busy channel", "[radio][mac_rules]") {
  CHECK(busy_delays(find_mac("cc2420", telosb), 10'000, 1).size() == 10'000);
}

TEST_CASE("the CC2420 stack looks twice, 7 ticks apart", "[radio][mac_rules]") {
  for (const auto& [kind, tick] : {std::pair{&micaz, micaz_tick}, {&telosb, telosb_tick}}) {
    random_stream rng(1);
    mac x(find_mac("cc2420", *kind), 8, 0);
    instant now;
    x.submit(frame_of(0, false), now, rng);
    for (int busy = 0; busy < 3; ++busy) { // a second look that fails costs a congestion back-off
      static_cast<void>(step(x, now, true, rng));
      CHECK(x.now_in() == mac::state::looking_again);
      CHECK(x.assesses());
      CHECK(x.deadline() == now + 7 * tick);
      static_cast<void>(step(x, now, false, rng));
      CHECK(x.now_in() == mac::state::backing_off);
      CHECK(*x.deadline() - now >= 11 * tick);
      CHECK(*x.deadline() - now <= 80 * tick);
    }
    static_cast<void>(step(x, now, true, rng));
    static_cast<void>(step(x, now, true, rng));
    CHECK(x.now_in() == mac::state::turning);
    CHECK_FALSE(x.assesses());
    CHECK(x.deadline() == now + 192us);
    CHECK(step(x, now, true, rng).transmit);
  }
}

TEST_CASE("the RF230 stack tries 5 times 2 assessments in its two windows", "[radio][mac_rules]") {
  const auto* rules = find_mac("rf230", iris);
  std::vector<duration> initial;
  std::vector<duration> congestion;
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    const auto all = busy_delays(rules, 100, seed);
    REQUIRE(all.size() == 10);
    for (std::size_t i = 0; i < all.size(); ++i)
      (i % 2 == 0 ? initial : congestion).push_back(all[i]);
  }
  check_window(initial, 320us, 1us, 4960);
  check_window(congestion, 320us, 1us, 2240);
}

TEST_CASE("a request that finds the channel busy too often fails", "[radio][mac_rules]") {
  for (const auto& [name, assessments] : {std::pair{"standard", 5}, {"rf230", 10}}) {
    random_stream rng(1);
    mac x(find_mac(name, iris), 8, 3);
    instant now;
    x.submit(frame_of(0, true), now, rng);
    for (int i = 1; i <= assessments; ++i) {
      const auto end = step(x, now, false, rng).ended;
      REQUIRE(end.has_value() == (i == assessments));
      if (end)
        CHECK(end->status == send_status::channel_access_failure);
    }
  }
}

TEST_CASE("a sender repeats for as long as its rules take at most", "[radio][mac_rules]") {
  const auto standard = (7 + 15 + 31 + 31 + 31) * 320us + 5 * 128us + 192us + 4256us + 864us;
  CHECK(find_mac("standard", micaz)->repeats_for(0) == standard);
  CHECK(find_mac("standard", micaz)->repeats_for(3) == 4 * standard);
  CHECK(find_mac("rf230", iris)->repeats_for(1) ==
        2 * (5 * (5279us + 2559us) + 192us + 4256us + 1000us));
  CHECK(find_mac("cc2420", micaz)->repeats_for(0) > 24h * 365);
}

TEST_CASE("an exchange takes each stack's time to the nanosecond", "[radio][mac_rules]") {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    for (const auto& [kind, tick] : {std::pair{&micaz, micaz_tick}, {&telosb, telosb_tick}}) {
      radio_fixture x(with_mac("cc2420"), seed);
      x.channel.watch();
      x.add(1, 0, 1, kind);
      x.add(2, 10, 1, kind);
      x.send(radio_index{0}, 1, 2, 28);
      x.run_for(1s);
      REQUIRE(x.all<overheard>().size() == 2);
      const auto begin = x.all<overheard>()[0].begin;
      const auto waited = begin - instant{} - 7 * tick - 192us;
      CHECK(waited.count() % tick.count() == 0);
      CHECK(waited >= 11 * tick);
      CHECK(waited <= 320 * tick);
      CHECK(x.times_of<delivered>().front() == begin + 1504us);
      CHECK(x.all<overheard>()[1].begin == begin + 1504us + 1ms);
      CHECK(x.times_of<done>().front() == begin + 1504us + 1ms + 352us);
      CHECK(x.all<done>().front().status == send_status::sent);
    }
    radio_fixture x(with_mac("rf230"), seed);
    x.channel.watch();
    x.add(1, 0, 1, &iris);
    x.add(2, 10, 1, &iris);
    x.send(radio_index{0}, 1, 2, 28);
    x.run_for(1s);
    REQUIRE(x.all<overheard>().size() == 2);
    const auto begin = x.all<overheard>()[0].begin;
    const auto waited = begin - instant{} - 192us;
    CHECK(waited >= 320us);
    CHECK(waited <= 5279us);
    CHECK(x.times_of<delivered>().front() == begin + 1504us);
    CHECK(x.all<overheard>()[1].begin == begin + 1504us + 300us);
    CHECK(x.times_of<done>().front() == begin + 1504us + 300us + 352us);
    CHECK(x.all<done>().front().status == send_status::sent);
  }
}

TEST_CASE("TinyOS waits its time for an ack and repeats only if told to", "[radio][mac_rules]") {
  struct wait {
    const char* mac;
    const platform* kind;
    duration length;
  };
  for (const auto& [name, kind, length] :
       {wait{"cc2420", &micaz, 256 * micaz_tick}, wait{"cc2420", &telosb, 256 * telosb_tick},
        wait{"rf230", &iris, 1ms}, wait{"standard", &iris, 864us}}) {
    INFO(name << " on " << kind->name);
    for (const auto& retries : {std::optional<unsigned>{}, std::optional<unsigned>{2}}) {
      radio_fixture x(with_mac(name, retries));
      x.channel.watch();
      x.add(1, 0, 1, kind);
      x.add(2, 10, 1, kind);
      x.send(radio_index{0}, 1, 3, 28);
      x.run_for(1s);
      const auto own = std::string(name) == "standard" ? 3U : 0U;
      REQUIRE(x.all<overheard>().size() == 1 + retries.value_or(own));
      CHECK(x.all<done>().front().status == send_status::no_ack);
      CHECK(x.all<done>().front().transmissions == 1 + retries.value_or(own));
      CHECK(x.times_of<done>().front() == x.all<overheard>().back().begin + 1504us + length);
    }
  }
}

TEST_CASE("each platform has the rules that the file names for it", "[radio][mac_rules]") {
  radio_fixture x(channel_with([](auto& c) {
    c.macs = {{"telosb", "cc2420"}, {"iris", "rf230"}};
    c.loss = 1;
  }));
  const auto a = x.add(1, 0, 1, &micaz); // the standard's
  const auto b = x.add(2, 1, 1, &telosb);
  const auto c = x.add(3, 2, 1, &iris);
  for (const auto radio : {a, b, c})
    x.send(radio, radio.value, 9, 4);
  x.run_for(1s);
  for (const auto& ended : x.all<done>())
    CHECK(ended.transmissions == (ended.radio == a ? 4U : 1U));
}

TEST_CASE("sequence numbers begin at 16 times the address in the RF230 stack",
          "[radio][mac_rules]") {
  radio_fixture x(with_mac("rf230"));
  x.add(1, 0);
  for (const auto id : {2, 15, 16, 35}) {
    const auto address = static_cast<std::uint16_t>(id);
    const auto radio = x.add(address, 1);
    for (int i = 0; i < 2; ++i) {
      x.send(radio, 0, 0xffff, 4);
      x.run_for(100ms);
      CHECK(x.all<delivered>().back().content.dsn == static_cast<std::uint8_t>(16 * address + i));
    }
  }
  std::set<std::uint8_t> others; // elsewhere they begin anywhere
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    radio_fixture y(with_mac("cc2420"), seed);
    const auto a = y.add(1, 0);
    y.add(2, 1);
    y.send(a, 0, 0xffff, 4);
    y.run_for(100ms);
    others.insert(y.all<delivered>().back().content.dsn);
  }
  CHECK(others.size() > 10);
}

TEST_CASE("after a frame that wants an ack the RF230 stack keeps quiet for 864 us",
          "[radio][mac_rules]") {
  // Mote 1 sends now and then, mote 2 always: how soon after an end of the former's frames?
  const auto shortest_gap = [](bool ack) {
    radio_fixture x(with_mac("rf230"));
    x.channel.watch();
    const auto a = x.add(1, 0);
    const auto b = x.add(2, 10);
    random_stream rng(1);
    x.send(b, 0, 0xffff, 28, false);
    auto gap = duration(1h);
    std::optional<instant> last_end;
    instant last_end_of_b;
    instant next_of_a;
    std::size_t seen = 0;
    while (x.now < instant(100s)) {
      if (x.now >= next_of_a) {
        x.send(a, 1, 9, 28, ack);
        next_of_a = x.now + rng.between(10ms, 20ms);
      }
      x.run_until(x.channel.deadline().value());
      for (; seen < x.log.size(); ++seen) {
        const auto what = x.log[seen].what;
        if (const auto* ended = std::get_if<done>(&what); ended && ended->radio == b)
          x.send(b, 0, 0xffff, 28, false);
        const auto* frame = std::get_if<overheard>(&what);
        if (frame == nullptr)
          continue;
        if (decode(frame->psdu.view())->source == mote_id{1}) {
          last_end.reset();
          if (last_end_of_b <= frame->begin) // else mote 2 has missed it
            last_end = x.now;
          continue;
        }
        last_end_of_b = x.now;
        if (last_end && frame->begin >= *last_end)
          gap = std::min(gap, frame->begin - *last_end);
        last_end.reset();
      }
    }
    return gap;
  };
  const auto guarded = shortest_gap(true);
  CHECK(guarded >= 864us + 192us);
  CHECK(guarded < 900us + 192us);
  const auto free = shortest_gap(false);
  CHECK(free >= 128us + 192us); // the assessment's window
  CHECK(free < 200us + 192us);
}

TEST_CASE("the CC2420 stack knows 4 sources by the sum of their octets", "[radio][mac_rules]") {
  inbox x("cc2420", 0);
  CHECK(x.hear(0x0102, 5, 0ms) == verdict::accepted);
  CHECK(x.hear(0x0102, 5, 1ms) == verdict::duplicate);
  CHECK(x.hear(0x0201, 5, 2ms) == verdict::duplicate); // not the same mote
  CHECK(x.hear(0x0003, 5, 3ms) == verdict::duplicate);
  CHECK(x.hear(0x0201, 6, 4ms) == verdict::accepted);
  CHECK(x.hear(0x0102, 5, 5ms) == verdict::accepted);  // the other's frame has taken its place
  CHECK(x.hear(0x0102, 5, 24h) == verdict::duplicate); // for ever
  for (std::uint16_t source = 10; source < 13; ++source)
    CHECK(x.hear(source, 1, 25h) == verdict::accepted);
  CHECK(x.hear(0x0102, 5, 26h) == verdict::duplicate); // four sources fit
  CHECK(x.hear(20, 1, 27h) == verdict::accepted);      // the fifth drives the oldest out
  CHECK(x.hear(12, 1, 28h) == verdict::duplicate);
  CHECK(x.hear(0x0102, 5, 28h) == verdict::accepted);
}

TEST_CASE("the RF230 stack knows 5 sources, the standard all of them", "[radio][mac_rules]") {
  inbox five("rf230", 3);
  CHECK(five.hear(0x0102, 5, 0ms) == verdict::accepted);
  CHECK(five.hear(0x0201, 5, 0ms) == verdict::accepted); // another source
  for (std::uint16_t source = 10; source < 13; ++source)
    CHECK(five.hear(source, 1, 1ms) == verdict::accepted);
  CHECK(five.hear(0x0102, 5, 2ms) == verdict::duplicate);
  CHECK(five.hear(13, 1, 3ms) == verdict::accepted);
  CHECK(five.hear(0x0102, 5, 4ms) == verdict::accepted); // was driven out
  inbox all("standard", 3);
  for (std::uint16_t source = 1; source < 500; ++source)
    CHECK(all.hear(source, 1, 0ms) == verdict::accepted);
  for (std::uint16_t source = 1; source < 500; ++source)
    CHECK(all.hear(source, 1, 1ms) == verdict::duplicate);
}

TEST_CASE("a saturated sender reaches each stack's arithmetic", "[radio][mac_rules]") {
  struct rate {
    const char* mac;
    const platform* kind;
    double period_us;
  };
  // docs/radio.md, Medium access: mean back-off, looks and turnaround, a frame of 28 octets; no ack
  for (const auto& [name, kind, period_us] :
       {rate{"standard", &telosb, 1120 + 128 + 192 + 1504 + 640},
        rate{"cc2420", &telosb, 165.5 * 30.518 + 7 * 30.518 + 192 + 1504},
        rate{"cc2420", &micaz, 165.5 * 34.722 + 7 * 34.722 + 192 + 1504},
        rate{"rf230", &iris, 320 + 2479.5 + 192 + 1504}}) {
    INFO(name << " on " << kind->name);
    radio_fixture x(with_mac(name));
    const auto fast = quick(*kind);
    const auto a = x.add(1, 0, 1, &fast);
    x.add(2, 10, 1, &fast);
    const auto sent = x.saturate({a}, 2, 28, false, 60s);
    CHECK(60e6 / static_cast<double>(sent) == Approx(period_us).epsilon(0.02));
    CHECK(x.channel.counts().by_all().copies.of(copy_outcome::delivered) >= sent);
  }
}

TEST_CASE("a saturated acked sender has the standard's goodput", "[radio][mac_rules][NET-15]") {
  for (const int mac_payload : {20, 100}) {
    const auto am_payload = static_cast<std::size_t>(mac_payload - 2); // network octet, AM type
    const auto frame_us = 32.0 * (6 + 11 + mac_payload);
    const auto period_us = 3.5 * 320 + 128 + 192 + frame_us + 192 + 352 + 640;
    radio_fixture x(with_mac("standard"));
    const auto fast = quick(micaz);
    const auto a = x.add(1, 0, 1, &fast);
    const auto b = x.add(2, 10, 1, &fast);
    constexpr double length_s = 120;
    x.saturate({a}, 2, am_payload, true, 120s);
    const auto goodput = 8 * mac_payload * static_cast<double>(x.delivered_to(b)) / length_s;
    CHECK(goodput == Approx(8 * mac_payload / (period_us * 1e-6)).epsilon(0.01));
    CHECK(goodput < 250e3);
  }
}
