#include <limits>

#include "support/catch.hpp"
#include "unit/radio/fixture.hpp"
#include "unit/radio/samples.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::channel_with;
using test::radio_fixture;
using test::radio_sum;

namespace {

/// Lets time pass until a radio is sending.
void run_until_on_air(radio_fixture& x, radio_index radio) {
  while (x.channel.energy(radio, x.now).times.radio_transmit == 0ns)
    x.run_for(32us);
}

} // namespace

TEST_CASE("switching a sender off aborts all it had and cuts its frame off", "[radio][power]") {
  radio_fixture x;
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  for (std::uint64_t i = 0; i < 3; ++i)
    x.send(a, i, 2, 100);
  run_until_on_air(x, a);
  x.run_for(320us);
  x.set_power(a, power::off);
  CHECK(x.channel.power_of(a) == power::off);
  const auto ended = x.all<done>();
  REQUIRE(ended.size() == 3);
  for (std::uint64_t i = 0; i < 3; ++i) {
    CHECK(ended[i].token == i);
    CHECK(ended[i].status == send_status::aborted);
    CHECK(ended[i].transmissions == (i == 0 ? 1U : 0U));
  }
  CHECK(x.channel.counts().by(a).requests ==
        request_counters{.requests = 3, .failed = {.aborted = 3}});
  CHECK(x.channel.counts().by(b).copies.of(copy_outcome::off) == 1);
  CHECK(x.channel.counts().balanced());
  const auto sent_for = x.channel.energy(a, x.now).times.radio_transmit;
  x.run_for(1s);
  CHECK(x.log.size() == 3); // nothing came later
  CHECK(x.channel.energy(a, x.now).times.radio_transmit == sent_for);
  CHECK(x.channel.energy(b, x.now).times.radio_receive == sent_for);
  x.send(a, 9, 2, 4);
  CHECK(x.all<done>().back().status == send_status::aborted); // at once
  x.set_power(a, power::on);
  x.send(a, 10, 2, 4);
  x.run_for(1s);
  CHECK(x.all<done>().back().status == send_status::sent);
  CHECK(x.delivered_to(b) == 1);
  CHECK(x.channel.counts().balanced());
}

TEST_CASE("a receiver that is off, or was for a moment, gets nothing", "[radio][power]") {
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 0; }));
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  x.send(a, 1, 2, 100);
  run_until_on_air(x, a);
  x.set_power(b, power::off);
  x.run_for(64us);
  x.set_power(b, power::on);
  x.run_for(100ms);
  CHECK(x.all<delivered>().empty());
  CHECK(x.channel.counts().by(b).copies.of(copy_outcome::off) == 1);
  x.set_power(b, power::off);
  x.send(a, 2, 2, 100);
  x.run_for(100ms);
  CHECK(x.channel.counts().by(b).copies.of(copy_outcome::off) == 2);
  CHECK(x.channel.counts().by_all().requests.failed.no_ack == 2);
}

TEST_CASE("a receiver switched off before its ack leaves does not ack", "[radio][power]") {
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 0; }));
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  x.send(a, 1, 2, 4);
  while (x.delivered_to(b) == 0)
    x.run_until(x.channel.deadline().value());
  x.run_for(100us);
  x.set_power(b, power::off);
  x.set_power(b, power::on);
  x.run_for(100ms);
  CHECK(x.channel.counts().by(b).acks == 0);
  CHECK(x.all<done>().front().status == send_status::no_ack);
}

TEST_CASE("a restart empties the receive slots", "[radio][power]") {
  auto slow = *find_platform("micaz");
  slow.service_time = 10s;
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 0; }));
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10, 1, &slow);
  for (std::uint64_t i = 0; i < 4; ++i)
    x.send(a, i, 2, 4);
  x.run_for(1s);
  CHECK(x.delivered_to(b) == 3);
  x.set_power(b, power::off);
  const auto worked = x.channel.energy(b, x.now).times.mcu_active;
  CHECK(worked <= 1s);
  x.run_for(1s);
  CHECK(x.channel.energy(b, x.now).times.mcu_active == worked); // the rest is dropped
  x.set_power(b, power::on);
  x.send(a, 4, 2, 4);
  x.run_for(1s);
  CHECK(x.delivered_to(b) == 4);
}

TEST_CASE("switching to the present state does nothing", "[radio][power]") {
  radio_fixture x;
  const auto a = x.add(1, 0);
  x.add(2, 10);
  x.send(a, 1, 2, 4);
  x.set_power(a, power::on);
  x.run_for(1s);
  CHECK(x.all<done>().front().status == send_status::sent);
  x.set_power(a, power::off);
  x.set_power(a, power::off);
  CHECK(x.log.size() == 2);
}

TEST_CASE("a flat battery is final and draws nothing", "[radio][power][NRG-05]") {
  radio_fixture x;
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  x.send(a, 1, 2, 4);
  x.run_for(1h);
  x.set_power(a, power::flat);
  const auto before = x.channel.energy(a, x.now);
  CHECK(radio_sum(before.times) == 1h);
  CHECK(before.times.mcu_active + before.times.mcu_sleep == 1h);
  x.set_power(a, power::on);
  CHECK(x.channel.power_of(a) == power::flat);
  x.send(a, 2, 2, 4);
  CHECK(x.all<done>().back().status == send_status::aborted);
  x.send(b, 3, 1, 4);
  x.run_for(1h);
  const auto after = x.channel.energy(a, x.now);
  CHECK(after.times == before.times);
  CHECK(after.used_mah == before.used_mah);
  CHECK(after.empty_at == instant(1h));
  CHECK(x.all<exhausted>().empty()); // the owner knew
}

TEST_CASE("an off radio and its sleeping MCU keep drawing their little", "[radio][power][NRG-05]") {
  radio_fixture x;
  const auto a = x.add(1, 0);
  x.set_power(a, power::off);
  x.run_for(100h);
  const auto use = x.channel.energy(a, x.now);
  CHECK(use.times.radio_off == 100h);
  CHECK(use.times.mcu_sleep == 100h);
  CHECK(use.used_mah == Approx(100 * (0.001 + 0.015)));
}

TEST_CASE("a battery that ends switches its radio off and says so once", "[radio][power][NRG-05]") {
  for (const auto& kind : platforms()) {
    INFO(kind.name);
    radio_fixture x(channel_with([](auto& c) { c.retries_max = 0; }));
    radio_config config;
    config.address = mote_id{1};
    config.pan = 1;
    config.kind = &kind;
    config.battery_mah = 0.5;
    const auto a = x.channel.add(config, x.now);
    const auto b = x.add(2, 10);
    x.run_for(10s);
    x.send(b, 0, 1, 20);
    x.run_for(10s);
    CHECK(x.delivered_to(a) == 1);
    const auto foretold = x.channel.energy(a, x.now).empty_at;
    x.send(a, 1, 0xffff, 4); // makes the end come a little sooner
    x.run_until(instant(1h));
    REQUIRE(x.all<exhausted>().size() == 1);
    CHECK(x.all<exhausted>().front().radio == a);
    const auto end = x.times_of<exhausted>().front();
    REQUIRE(x.times_of<running_low>().size() == 1);
    const auto warned = seconds(x.times_of<running_low>().front().time_since_epoch());
    CHECK(warned == Approx((1 - battery_reserve) * seconds(end.time_since_epoch())).epsilon(0.02));
    CHECK(end <= foretold + 10ms);
    CHECK(end >= foretold - 10ms);
    const auto use = x.channel.energy(a, x.now);
    CHECK(use.used_mah >= 0.5);
    CHECK(use.used_mah < 0.5 + 10e-3 * 30 / 3600);
    CHECK(radio_sum(use.times) == end.time_since_epoch());
    CHECK(use.times.mcu_active + use.times.mcu_sleep == end.time_since_epoch());
    CHECK(use.used_mah ==
          Approx(used_mah(use.times, kind, kind.transmit_ma(kind.transmit_dbm_max()))));
    CHECK(use.empty_at == end);
    CHECK(x.channel.power_of(a) == power::flat);
    x.send(b, 2, 1, 4);
    x.run_for(1s);
    CHECK(x.all<done>().back().status == send_status::no_ack);
    CHECK(x.channel.counts().balanced());
  }
}

TEST_CASE("a battery that ends while off is reported too", "[radio][power][NRG-05]") {
  radio_fixture x;
  radio_config config;
  config.address = mote_id{1};
  config.kind = find_platform("micaz");
  config.battery_mah = 0.016;
  const auto a = x.channel.add(config, x.now);
  x.set_power(a, power::off);
  x.run_for(2h);
  REQUIRE(x.times_of<exhausted>().size() == 1);
  const auto end = x.times_of<exhausted>().front();
  CHECK(end >= instant(1h));
  CHECK(end <= instant(1h + 10ms));
}

TEST_CASE("a radio that sends more weakly draws less", "[radio][power][NRG-05]") {
  radio_fixture x;
  const auto* kind = find_platform("micaz");
  std::vector<radio_index> senders;
  for (const auto& [address, dbm] : {std::pair{std::uint16_t{1}, -25.0}, {std::uint16_t{2}, 0.0}}) {
    radio_config config;
    config.address = mote_id{address};
    config.kind = kind;
    config.place = {1000.0 * address, 0, 0};
    config.transmit_dbm = dbm;
    senders.push_back(x.add(config));
    x.send(senders.back(), address, 0xffff, 100, false);
  }
  x.run_for(1s);
  const auto weak = x.channel.energy(senders[0], x.now);
  const auto strong = x.channel.energy(senders[1], x.now);
  CHECK(weak.times == strong.times);
  CHECK(strong.used_mah - weak.used_mah ==
        Approx((17.4 - 8.5) * seconds(air_time(113)) / 3600).epsilon(1e-6));
}

TEST_CASE("a radio on a cable sets no alarm", "[radio][power]") {
  radio_fixture x;
  radio_config config;
  config.kind = find_platform("micaz");
  config.battery_mah = std::numeric_limits<double>::infinity();
  const auto a = x.channel.add(config, x.now);
  CHECK_FALSE(x.channel.deadline());
  x.send(a, 1, 2, 4);
  CHECK(x.channel.deadline());
  x.set_power(a, power::off); // what it had set is void
  x.note(x.channel.on_time(x.now));
  CHECK_FALSE(x.channel.deadline());
}

TEST_CASE("no battery is flat before the channel says that one may be", "[radio][power][NRG-05]") {
  radio_fixture x;
  CHECK(x.channel.batteries_last_until() == instant::max());
  radio_config config;
  config.kind = find_platform("micaz");
  config.battery_mah = std::numeric_limits<double>::infinity();
  static_cast<void>(x.add(config));
  CHECK(x.channel.batteries_last_until() == instant::max());
  std::vector<radio_index> all;
  for (const auto mah : {0.3, 0.2, 0.25}) {
    config.address = mote_id{static_cast<std::uint16_t>(mah * 1000)};
    config.battery_mah = mah;
    all.push_back(x.add(config));
  }
  x.set_power(all[2], power::off);
  std::size_t looks = 0;
  const auto run_to_end = [&](std::size_t which) {
    while (x.all<exhausted>().size() < which) {
      const auto until = x.channel.batteries_last_until();
      if (until > x.now)
        x.run_until(until - 1ns);
      REQUIRE(x.all<exhausted>().size() < which);
      x.run_until(std::max(until, x.now + 1ms));
      REQUIRE(++looks < 1000);
    }
  };
  run_to_end(1);
  run_to_end(2);
  CHECK(x.all<exhausted>().front().radio == all[1]);
  CHECK(x.channel.batteries_last_until() > x.now);
  x.set_power(all[2], power::on); // so it lasts shorter than it would have
  run_to_end(3);
  CHECK(x.channel.batteries_last_until() == instant::max());
}
