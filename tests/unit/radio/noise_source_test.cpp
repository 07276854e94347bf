// What disturbs from outside: noise that is no frame, and losses that a fault plan asks for.
#include "radio/medium/medium.hpp"
#include "support/catch.hpp"
#include "unit/radio/fixture.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::channel_with;
using test::radio_fixture;

namespace {

std::shared_ptr<const hearers> heard_with(double dbm) {
  hearer x;
  x.power = static_cast<float>(to_units(dbm));
  return std::make_shared<const hearers>(hearers{x});
}

transmission frame_of(std::uint32_t from, instant begin, duration length) {
  transmission x;
  x.from = radio_index{from};
  x.begin = begin;
  x.length = length;
  return x;
}

/// How often of 500 a frame of 4 ms at -80 dBm survives what is there from its first millisecond to
/// its third.
template <class Begin, class End>
int survivors(Begin begin, End end) {
  medium air(channel_with([](auto& c) {
    c.propagation = log_distance{};
    c.collisions = collision_rule::sinr;
  }));
  random_stream rng(3);
  for (int i = 0; i < 3; ++i) {
    transceiver_config x;
    x.sensitivity_dbm = -95;
    x.cca_dbm = -77;
    air.add(std::move(x), energy_meter(find_platform("micaz"), 2000, 0, instant{}), instant{});
  }
  int good = 0;
  for (int i = 0; i < 500; ++i) {
    const auto at = instant(i * 10ms);
    const auto slot = air.start(frame_of(1, at, 4ms), heard_with(-80));
    begin(air, at + 1ms);
    end(air, at + 3ms, rng);
    air.end(slot, at + 4ms, rng, [&](const auto&, auto, const auto&, outcome y) {
      good += y == outcome::intact ? 1 : 0;
    });
  }
  return good;
}

radio_config noisy_place(double x_m) {
  radio_config x;
  x.address = no_mote;
  x.place = {x_m, 0, 0};
  x.kind = find_platform("micaz");
  x.transmit_dbm = 0;
  return x;
}

} // namespace

TEST_CASE("noise damages a frame as another frame of that strength does", "[radio][ACT-04]") {
  const auto dbm = GENERATE(-90.0, -82.0, -80.5, -79.0, -70.0);
  CAPTURE(dbm);
  slot_index other = 0;
  const auto by_frame = survivors(
      [&](medium& air, instant at) { other = air.start(frame_of(2, at, 2ms), heard_with(dbm)); },
      [&](medium& air, instant at, random_stream& rng) {
        air.end(other, at, rng, [](const auto&...) {});
      });
  const auto by_noise = survivors(
      [&](medium& air, instant at) { air.start_noise(radio_index{2}, heard_with(dbm), at); },
      [&](medium& air, instant at, random_stream&) { air.end_noise(radio_index{2}, at); });
  CHECK(by_noise == by_frame);
  CHECK((dbm < -81) == (by_noise == 500));
  CHECK((dbm > -75) == (by_noise == 0));
}

TEST_CASE("noise keeps a channel busy for who senses energy, and for its time only",
          "[radio][ACT-04]") {
  const auto how = GENERATE(sensing::energy, sensing::energy_or_carrier, sensing::carrier);
  radio_fixture w(channel_with([how](auto& c) {
    c.propagation = log_distance{};
    c.collisions = collision_rule::sinr;
    c.sensing = how;
  }));
  const auto a = w.add(1, 0);
  const auto b = w.add(2, 8);
  const auto oven = w.add(noisy_place(7));
  w.set_power(oven, power::off);
  w.note(w.channel.set_noise(oven, true, w.now));
  w.send(a, 1, 2, 20);
  w.run_for(2s);
  REQUIRE(w.all<done>().size() == 1);
  CHECK(w.all<done>()[0].status ==
        (how == sensing::carrier ? send_status::no_ack : send_status::channel_access_failure));
  CHECK(w.delivered_to(b) == 0);
  w.note(w.channel.set_noise(oven, false, w.now));
  w.send(a, 2, 2, 20);
  w.run_for(2s);
  CHECK(w.all<done>()[1].status == send_status::sent);
  CHECK(w.delivered_to(b) == 1);
  CHECK(w.channel.counts().balanced());
}

TEST_CASE("noise spoils what it overlaps on a disk too, and takes back what was hoped for",
          "[radio][ACT-04]") {
  radio_fixture w;
  const auto a = w.add(1, 0);
  const auto b = w.add(2, 8);
  const auto oven = w.add(noisy_place(9));
  w.set_power(oven, power::off);
  int arrived = 0;
  for (int i = 0; i < 50; ++i) { // it begins at any moment of a back-off, an assessment or a frame
    const auto before = w.delivered_to(b);
    w.send(a, static_cast<std::uint64_t>(i), 2, 60, false);
    w.run_for(i * 100us);
    const bool already = w.delivered_to(b) > before;
    w.note(w.channel.set_noise(oven, true, w.now));
    w.run_for(1s);
    CHECK((w.delivered_to(b) > before) == already);
    arrived += already ? 1 : 0;
    w.note(w.channel.set_noise(oven, false, w.now));
    w.run_for(1s);
  }
  CHECK(arrived > 0);
  CHECK(arrived < 50);
  CHECK(w.channel.counts().balanced());
}

TEST_CASE("losses of a fault plan hit radios of their PAN, add up as chances and end",
          "[radio][ACT-04]") {
  radio_fixture w;
  const auto a = w.add(1, 0, 1);
  const auto b = w.add(2, 5, 1);
  const auto c = w.add(3, 0, 2);
  const auto d = w.add(4, 5, 2);
  const auto arrivals = [&](radio_index from, std::uint16_t to, radio_index at) {
    const auto before = w.delivered_to(at);
    for (int i = 0; i < 400; ++i) {
      w.send(from, 1, to, 10, false);
      w.run_for(20ms);
    }
    return w.delivered_to(at) - before;
  };
  const auto all = w.channel.begin_loss(std::nullopt, 0.5);
  const auto one = w.channel.begin_loss(std::uint16_t{1}, 0.5);
  const auto in_1 = arrivals(a, 2, b);
  CHECK(in_1 > 70);
  CHECK(in_1 < 130);
  const auto in_2 = arrivals(c, 4, d);
  CHECK(in_2 > 160);
  CHECK(in_2 < 240);
  w.channel.end_loss(one);
  w.channel.end_loss(all);
  CHECK(arrivals(a, 2, b) == 400);
  CHECK(w.channel.counts().balanced());
}

TEST_CASE("a battery that comes from elsewhere goes on being used", "[radio][NRG-05][ACT-04]") {
  radio_fixture w;
  auto config = noisy_place(0);
  config.battery_mah = 10;
  const auto radio = w.add(config);
  w.set_power(radio, power::off);
  w.run_for(1h);
  w.channel.restart_energy(radio, 9.9, w.now);
  const auto use = w.channel.energy(radio, w.now);
  CHECK(use.used_mah == 9.9);
  CHECK(use.elapsed == 0s);
  CHECK(use.times.radio_off == 0s);
  w.set_power(radio, power::on);
  w.run_for(1h);
  CHECK(w.all<running_low>().size() == 1);
  REQUIRE(w.all<exhausted>().size() == 1); // 0.1 mAh last for about 19 s of listening
  CHECK(w.times_of<exhausted>()[0] < instant(1h + 30s));
}
