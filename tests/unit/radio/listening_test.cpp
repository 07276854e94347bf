// Low-power listening: BoX-MAC-2 (Moss and Levis, SING-08-00; TinyOS TEP 105).
#include <algorithm>
#include <utility>
#include <vector>

#include "radio/listener.hpp"
#include "support/catch.hpp"
#include "unit/radio/fixture.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using namespace rubicon::test;

namespace {

constexpr std::uint16_t broadcast = broadcast_mote.value;
constexpr std::size_t size = 20; // octets of payload: a PSDU of 33, 1248 us on the air

listening_config every(duration interval) {
  listening_config x;
  x.interval = interval;
  return x;
}

radio_config sleeper(std::uint16_t address, double x_m, const listening_config& listening) {
  radio_config x;
  x.address = mote_id{address};
  x.pan = 1;
  x.place = {x_m, 0, 0};
  x.kind = find_platform("micaz");
  x.listening = listening;
  return x;
}

/// The same, always on: fed by a cable.
radio_config sink(double x_m, const listening_config& listening) {
  auto x = sleeper(1, x_m, listening);
  x.listening.checks = false;
  return x;
}

duration radio_on(const channel& x, radio_index radio, instant now) {
  return x.energy(radio, now).elapsed - x.energy(radio, now).times.radio_off;
}

/// What two channels with the same input must agree in.
std::vector<std::pair<instant, std::size_t>> times_of(const radio_fixture& x) {
  std::vector<std::pair<instant, std::size_t>> all;
  for (const auto& each : x.log)
    all.emplace_back(each.at, each.what.index());
  return all;
}

} // namespace

TEST_CASE("a listener checks at equal gaps and sleeps between", "[radio][listening][NRG-02]") {
  listener x(every(512ms), instant(30ms), instant(0s));
  CHECK(x.is_on()); // at first it is awake
  CHECK(x.deadline() == instant(100ms));
  x.on_time(instant(100ms), false, false);
  CHECK_FALSE(x.is_on());
  for (int check = 1; check < 20; ++check) {
    const auto begin = instant(30ms) + check * 512ms;
    REQUIRE(x.deadline() == begin);
    x.on_time(begin - 1ns, false, false); // too early: nothing happens
    CHECK_FALSE(x.is_on());
    x.on_time(begin, false, false);
    CHECK(x.now_in() == listener::state::checking);
    CHECK(x.checked_from() == begin);
    REQUIRE(x.deadline() == begin + 11ms);
    x.on_time(begin + 11ms, false, false);
    CHECK(x.now_in() == listener::state::asleep);
  }
}

TEST_CASE("what a listener hears keeps it awake until it has been quiet for 100 ms",
          "[radio][listening][NRG-02]") {
  listener x(every(512ms), instant(600ms), instant(0s));
  x.on_time(instant(100ms), false, false);
  x.on_time(instant(600ms), false, false);
  x.on_time(instant(611ms), true, false);
  CHECK(x.now_in() == listener::state::awake);
  CHECK(x.deadline() == instant(711ms));
  CHECK_FALSE(x.stay_awake(instant(700ms))); // a frame
  CHECK(x.deadline() == instant(711ms));     // where it finds
  x.on_time(instant(711ms), false, false);
  CHECK(x.deadline() == instant(800ms)); // that it is to go on
  x.on_time(instant(800ms), false, true);
  CHECK(x.is_on()); // in the middle of a frame
  CHECK(x.deadline() == instant(800ms) + air_time(psdu_max));
  x.on_time(x.deadline(), false, false);
  CHECK_FALSE(x.is_on());
  CHECK(x.deadline() == instant(600ms) + 512ms); // checks go on as if nothing had been
  CHECK(x.stay_awake(instant(1s)));              // a frame to be sent
  CHECK(x.deadline() == instant(1100ms));
  x.on_time(instant(1100ms), false, false);
  CHECK(x.deadline() == instant(1112ms));
  x.on_time(instant(1112ms), false, false);
  CHECK_FALSE(x.stay_awake(instant(1115ms))); // within the check
  CHECK(x.now_in() == listener::state::awake);
  CHECK(x.deadline() == instant(1215ms));
}

TEST_CASE("an idle radio is on for its checks alone, and draws that",
          "[radio][listening][energy][NRG-02][NRG-05]") {
  for (const auto interval : {128ms, 512ms, 2000ms}) {
    INFO("every " << interval.count() << " ms");
    radio_fixture f;
    const auto mote = f.add(sleeper(2, 0, every(interval)));
    const auto length = duration(1h);
    f.run_for(length);
    const auto use = f.channel.energy(mote, f.now);
    const auto share = seconds(11ms) / seconds(interval);
    CHECK(seconds(radio_on(f.channel, mote, f.now)) ==
          Approx(share * seconds(length)).epsilon(0.01));
    const auto& micaz = *find_platform("micaz");
    const auto expected_ma = share * (micaz.radio_listen_ma + micaz.mcu_active_ma) +
                             (1 - share) * (micaz.radio_off_ma + micaz.mcu_sleep_ma);
    CHECK(use.used_mah == Approx(expected_ma).epsilon(0.05)); // of an hour
    CHECK(use.times.radio_off + use.times.radio_listen == length);
  }
}

TEST_CASE("copies go on until an ack ends them, and the receiver reports one",
          "[radio][listening][NRG-02]") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    INFO("seed " << seed);
    radio_fixture f({}, seed);
    const auto from = f.add(sink(0, every(512ms)));
    const auto to = f.add(sleeper(2, 10, every(512ms)));
    f.run_for(1s + 37ms * static_cast<int>(seed));
    const auto asked = f.now;
    f.send(from, 7, 2, size);
    f.run_for(700ms);
    const auto ends = f.all<done>();
    REQUIRE(ends.size() == 1);
    CHECK(ends[0].status == send_status::sent);
    CHECK(ends[0].transmissions == 1); // a train
    CHECK(ends[0].arrived);
    CHECK(f.delivered_to(to) == 1);
    const auto took = f.times_of<done>()[0] - asked;
    CHECK(took < 512ms + 11ms + 10ms); // a check and a copy
    // A copy each 2 to 6 ms; 1 ack.
    const auto counted = f.channel.counts().by_all();
    CHECK(counted.acks == 1);
    CHECK(counted.transmissions - 1 <= static_cast<std::uint64_t>(took / 2ms + 2));
    CHECK(counted.transmissions - 1 >= static_cast<std::uint64_t>(took / 6ms));
    CHECK(counted.copies.of(copy_outcome::off) + 12 >= counted.transmissions); // but a check's
    CHECK(f.channel.counts().balanced());
  }
}

TEST_CASE("a frame to a radio that is on takes one copy", "[radio][listening][NRG-02]") {
  radio_fixture f;
  const auto on = f.add(sink(0, every(2s)));
  const auto from = f.add(sleeper(2, 10, every(2s)));
  f.run_for(1s);
  f.send(from, 1, 1, size);
  f.run_for(100ms);
  REQUIRE(f.all<done>().size() == 1);
  CHECK(f.all<done>()[0].status == send_status::sent);
  CHECK(f.channel.counts().by(from).transmissions == 1);
  CHECK(f.delivered_to(on) == 1);
}

TEST_CASE("without an ack copies end after the interval and a margin",
          "[radio][listening][NRG-02]") {
  radio_fixture f;
  const auto from = f.add(sink(0, every(512ms)));
  f.add(sleeper(2, 100, every(512ms))); // out of reach
  f.send(from, 1, 2, size);
  f.send(from, 2, 2, size);
  f.run_for(2s);
  const auto ends = f.all<done>();
  REQUIRE(ends.size() == 2);
  CHECK(ends[0].status == send_status::no_ack);
  CHECK(ends[1].status == send_status::no_ack);
  const auto first = f.times_of<done>()[0] - instant();
  CHECK(first >= 532ms);
  CHECK(first <= 532ms + 10ms);
  CHECK(f.times_of<done>()[1] - f.times_of<done>()[0] >= 532ms);
}

TEST_CASE("a broadcast is repeated for the whole interval, and each radio reports it once",
          "[radio][listening][NRG-02]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    INFO("seed " << seed);
    radio_fixture f({}, seed);
    const auto from = f.add(sleeper(9, 0, every(512ms)));
    std::vector<radio_index> others;
    for (std::uint16_t i = 0; i < 8; ++i)
      others.push_back(f.add(sleeper(static_cast<std::uint16_t>(10 + i), i, every(512ms))));
    others.push_back(f.add(sink(5, every(512ms))));
    f.run_for(3s);
    const auto asked = f.now;
    f.send(from, 1, broadcast, size);
    f.run_for(2s);
    REQUIRE(f.all<done>().size() == 1);
    CHECK(f.all<done>()[0].status == send_status::sent);
    const auto took = f.times_of<done>()[0] - asked;
    CHECK(took >= 532ms);
    CHECK(took <= 545ms);
    CHECK(f.channel.counts().by_all().acks == 0);
    for (const auto each : others)
      CHECK(f.delivered_to(each) == 1);
    CHECK(f.channel.counts().by_all().copies.of(copy_outcome::delivered) == others.size());
    f.send(from, 2, broadcast, size); // the next one is another
    f.run_for(2s);
    for (const auto each : others)
      CHECK(f.delivered_to(each) == 2);
    CHECK(f.channel.counts().balanced());
  }
}

TEST_CASE("lost copies do not lose a frame", "[radio][listening][NRG-02]") {
  const auto config = channel_with([](channel_config& x) { x.loss = 0.3; });
  std::size_t delivered_count = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    radio_fixture f(config, seed);
    const auto from = f.add(sleeper(2, 0, every(512ms)));
    const auto to = f.add(sleeper(3, 10, every(512ms)));
    f.run_for(1s + 29ms * static_cast<int>(seed));
    f.send(from, 1, 3, size);
    f.run_for(2s);
    delivered_count += f.delivered_to(to);
    CHECK(f.delivered_to(to) <= 1);
    CHECK(f.channel.counts().balanced());
  }
  CHECK(delivered_count == 40);
}

TEST_CASE("two trains in reach of each other both arrive", "[radio][listening][NRG-02]") {
  std::size_t delivered_count = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    radio_fixture f({}, seed);
    const auto a = f.add(sleeper(2, 0, every(512ms)));
    const auto b = f.add(sleeper(3, 5, every(512ms)));
    const auto c = f.add(sleeper(4, 10, every(512ms)));
    const auto d = f.add(sleeper(5, 15, every(512ms)));
    f.run_for(1s + 41ms * static_cast<int>(seed));
    f.send(a, 1, 4, size);
    f.send(b, 2, 5, 50);
    f.run_for(3s);
    delivered_count += f.delivered_to(c) + f.delivered_to(d);
  }
  CHECK(delivered_count == 60);
}

TEST_CASE("energy of a train follows from its length",
          "[radio][listening][energy][NRG-02][NRG-05]") {
  radio_fixture f;
  const auto from = f.add(sleeper(2, 0, every(2s)));
  f.add(sleeper(3, 100, every(2s))); // never answers
  f.run_for(10s);
  const auto before = f.channel.energy(from, f.now).times;
  f.send(from, 1, 3, size);
  f.run_for(10s);
  const auto after = f.channel.energy(from, f.now).times;
  const auto copies = f.channel.counts().by(from).transmissions;
  CHECK(after.radio_transmit - before.radio_transmit ==
        static_cast<duration::rep>(copies) * air_time(overhead + size));
  // A copy is 1248 us; until the next 864 us for an ack, 320 to 1280 us, 128 and 192 us.
  const auto period = seconds(1248us + 864us + 800us + 128us + 192us);
  CHECK(static_cast<double>(copies) == Approx(2.02 / period).epsilon(0.05));
  const auto on = (after.radio_listen - before.radio_listen) + after.radio_transmit -
                  before.radio_transmit + after.radio_receive - before.radio_receive;
  // The train, 100 ms, and the checks of the other 8 s.
  CHECK(seconds(on) == Approx(2.02 + 0.1 + 4 * 0.011).epsilon(0.05));
}

TEST_CASE("a mote that is switched off listens no more, and anew when it is on again",
          "[radio][listening][NRG-02]") {
  radio_fixture f;
  const auto from = f.add(sink(0, every(512ms)));
  const auto to = f.add(sleeper(2, 10, every(512ms)));
  f.run_for(5s);
  f.send(from, 1, 2, size);
  f.set_power(to, power::off);
  const auto on = radio_on(f.channel, to, f.now);
  f.run_for(5s);
  CHECK(radio_on(f.channel, to, f.now) == on);
  CHECK(f.delivered_to(to) == 0);
  CHECK(f.all<done>()[0].status == send_status::no_ack);
  f.set_power(to, power::on);
  f.send(from, 2, 2, size);
  f.run_for(5s);
  CHECK(f.delivered_to(to) == 1);
  f.set_power(to, power::flat);
  f.run_for(5s);
  f.send(to, 3, 1, size);
  CHECK(f.all<done>().back().status == send_status::aborted);
}

TEST_CASE("what wakes a radio need not be a frame for it", "[radio][listening][NRG-02]") {
  radio_fixture f;
  const auto from = f.add(sink(0, every(512ms)));
  f.add(sleeper(2, 100, every(512ms)));
  const auto other = f.add(sleeper(3, 10, every(512ms)));
  f.run_for(5s);
  const auto before = radio_on(f.channel, other, f.now);
  f.send(from, 1, 2, size); // whom it does not reach
  f.run_for(700ms);
  CHECK(radio_on(f.channel, other, f.now) - before >= 100ms);
  CHECK(f.delivered_to(other) == 0);
}

TEST_CASE("when a channel is asked does not matter to radios that listen at low power",
          "[radio][listening][NRG-02][GEN-03]") {
  // Once at each deadline, once every millisecond: the same frames at the same times.
  const auto run = [](bool often) {
    radio_fixture f(channel_with([](channel_config& x) { x.loss = 0.1; }), 5);
    std::vector<radio_index> all;
    for (std::uint16_t i = 0; i < 6; ++i)
      all.push_back(f.add(sleeper(static_cast<std::uint16_t>(2 + i), 12.0 * i, every(128ms))));
    for (int round = 0; round < 40; ++round) {
      const auto i = static_cast<std::size_t>(round) % all.size();
      f.send(all[i], static_cast<std::uint64_t>(round),
             round % 5 == 0 ? broadcast : static_cast<std::uint16_t>(2 + (i + 1) % all.size()),
             size);
      for (int ms = 0; often && ms < 97; ++ms)
        f.run_for(1ms);
      if (!often)
        f.run_for(97ms);
    }
    f.run_for(2s);
    CHECK(f.channel.counts().balanced());
    return times_of(f);
  };
  CHECK(run(false) == run(true));
}

TEST_CASE("events of radios that only listen do not pile up", "[radio][listening][GEN-03]") {
  radio_fixture f;
  f.add(sleeper(2, 0, every(20ms)));
  const auto before = f.channel.deadline();
  f.run_for(1s);
  CHECK(f.channel.deadline() == before); // its battery's: a check has no output
}

TEST_CASE("gaps between copies are shorter than a check, by every medium access",
          "[radio][listening][mac][NRG-02]") {
  for (const auto& kind : platforms())
    for (const auto& name : mac_names()) {
      INFO(kind.name << ' ' << name);
      CHECK(find_mac(name, kind)->longest_gap() < listening_config{}.check);
    }
}
