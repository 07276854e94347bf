#include "actors/island/air.hpp"
#include "actors/kitchen.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::kitchen;

namespace {

constexpr radio::radio_index left_radio{0};
constexpr radio::radio_index right_radio{1};
constexpr radio::radio_index third_radio{2};
constexpr mote_id left_mote{11};
constexpr mote_id right_mote{12};

/// Three radios of one island within earshot of each other.
struct air_fixture {
  fixture world;
  fake<ecology_actor> ecology{world};
  fake<radio_user_actor> left{world};
  fake<radio_user_actor> right{world};
  fake<radio_user_actor> third{world};
  air_actor air;

  explicit air_fixture(const std::function<void(radio::channel&)>& prepare = {}, double loss = 0,
                       std::optional<double> battery_mah = {}) {
    radio::channel_config config;
    config.loss = loss;
    radio::channel channel(config, random_stream(7));
    std::vector<mote_address> addresses;
    for (const auto mote : {left_mote, right_mote, mote_id{13}}) {
      radio::radio_config x;
      x.address = mote;
      x.pan = static_cast<std::uint16_t>(kitchen.value);
      x.place.x_m = mote.value;
      x.kind = radio::find_platform("micaz");
      x.battery_mah = battery_mah;
      static_cast<void>(channel.add(x, {}));
      addresses.push_back({kitchen, mote});
    }
    if (prepare)
      prepare(channel);
    air = world.spawn(rubicon::air, std::move(channel), addresses, extra_radios{}, std::uint64_t{1},
                      ecology.handle(), frame_observer{});
    world.send(air, attach_radio{left_radio, left});
    world.send(air, attach_radio{right_radio, right});
    world.send(air, attach_radio{third_radio, third});
  }

  void send_right(bool ack, std::uint64_t token = 9) {
    world.send(air, radio_send{left_radio, token, right_mote, 0x11, bytes{1, 2, 3}, ack});
  }
};

} // namespace

TEST_CASE("a frame reaches its mote after back-off and air time, and its sender hears of it",
          "[actors][air][GEN-03][NET-15][ACT-01]") {
  air_fixture x;
  x.send_right(true);
  CHECK(x.right.size() == 0); // nothing arrives at the moment of sending
  x.world.run_for(1s);
  const auto frames = x.right.all<frame_received>();
  REQUIRE(frames.size() == 1);
  const auto frame = radio::decode(frames[0].psdu.view());
  REQUIRE(frame);
  CHECK(frame->source == left_mote);
  CHECK(frame->am_type == 0x11);
  CHECK(to_bytes(frame->payload) == bytes{1, 2, 3});

  const auto arrived = x.right.times<frame_received>()[0].time_since_epoch();
  const auto backoff = arrived - 128us - 192us - radio::air_time(radio::overhead + 3);
  CHECK(backoff >= 0us);
  CHECK(backoff <= 7 * 320us);
  CHECK(backoff % 320us == 0us);

  const auto done = x.left.all<radio_done>();
  REQUIRE(done.size() == 1);
  CHECK(done[0].token == 9);
  CHECK(done[0].status == radio::send_status::sent);
  const auto acked = x.left.times<radio_done>()[0].time_since_epoch();
  CHECK(acked == arrived + 192us + radio::air_time(radio::ack_size));
  CHECK(x.third.size() == 0); // it was not for the third
}

TEST_CASE("on an air that loses everything nothing arrives, and the sender is told",
          "[actors][air][GEN-03]") {
  air_fixture x({}, 1.0);
  x.send_right(true);
  x.world.run_for(1s);
  CHECK(x.right.size() == 0);
  REQUIRE(x.left.count<radio_done>() == 1);
  CHECK(x.left.all<radio_done>()[0].status == radio::send_status::no_ack);
}

TEST_CASE("a link that loses everything leaves the others alone", "[actors][air][GEN-03]") {
  air_fixture x([](radio::channel& c) { c.set_loss(left_radio, right_radio, 1.0); });
  for (std::uint64_t i = 0; i < 5; ++i) {
    x.world.send(x.air, radio_send{left_radio, i, broadcast_mote, 0x11, bytes{1}, false});
    x.world.run_for(100ms);
    x.world.send(x.air, radio_send{right_radio, i, left_mote, 0x11, bytes{1}, false});
    x.world.run_for(100ms);
  }
  CHECK(x.right.count<frame_received>() == 0);
  CHECK(x.third.count<frame_received>() == 5);
  CHECK(x.left.count<frame_received>() == 5);
}

TEST_CASE("a radio that is off neither hears nor sends, until it is on again",
          "[actors][air][GEN-03]") {
  air_fixture x;
  x.world.send(x.air, radio_power{right_radio, radio::power::off});
  x.send_right(true);
  x.world.run_for(1s);
  CHECK(x.right.size() == 0);
  CHECK(x.left.all<radio_done>().at(0).status == radio::send_status::no_ack);

  x.world.send(x.air, radio_send{right_radio, 4, left_mote, 0x11, bytes{1}, true});
  CHECK(x.right.all<radio_done>().at(0).status == radio::send_status::aborted);
  x.world.run_for(1s);
  CHECK(x.left.count<frame_received>() == 0);

  x.world.send(x.air, attach_radio{right_radio, x.right});
  x.send_right(true);
  x.world.run_for(1s);
  CHECK(x.right.count<frame_received>() == 1);
}

TEST_CASE("frames go to the newest owner of a radio", "[actors][air][ACT-03]") {
  air_fixture x;
  fake<radio_user_actor> heir(x.world);
  x.world.send(x.air, attach_radio{right_radio, heir});
  x.send_right(true);
  x.world.run_for(1s);
  CHECK(x.right.size() == 0);
  CHECK(heir.count<frame_received>() == 1);
}

TEST_CASE("the air reports counters that balance and the energy of every radio",
          "[actors][air][GEN-03]") {
  air_fixture x({}, 0.3);
  for (std::uint64_t i = 0; i < 200; ++i) {
    x.send_right(true, i);
    x.world.send(x.air, radio_send{third_radio, i, broadcast_mote, 0x11, bytes{1}, false});
    x.world.run_for(7ms);
  }
  x.world.send(x.air, status_request{});
  const auto statuses = x.ecology.all<radio_status>();
  REQUIRE(statuses.size() == 1);
  CHECK(statuses[0].island == kitchen);
  const auto& counters = statuses[0].radio;
  CHECK(counters.requests == 400);
  CHECK(counters.requests ==
        counters.mac_sent + report::total(counters.mac_failed) + counters.mac_open);
  CHECK(counters.sent == counters.delivered + report::total(counters.lost));
  CHECK(counters.lost.at("loss") > 0);
  CHECK(counters.delivered > 0);

  const auto energies = x.ecology.all<energy_status>();
  REQUIRE(energies.size() == 3);
  const auto elapsed = x.world.now().time_since_epoch();
  for (const auto& [mote, e] : energies) {
    CHECK(mote.island == kitchen);
    CHECK(e.used_mah > 0);
    CHECK(e.used_mah < e.battery_mah);
    CHECK(e.mcu_active + e.mcu_sleep == elapsed);
    CHECK(e.radio_off + e.radio_listen + e.radio_receive + e.radio_transmit == elapsed);
  }
  CHECK(energies[0].mote.mote == left_mote);
  CHECK(energies[0].energy.radio_transmit > energies[1].energy.radio_transmit); // which only acks
}

TEST_CASE("a battery at its end is told to the radio's owner, whose radio is silent from then on",
          "[actors][air]") {
  air_fixture x({}, 0, 0.01); // a radio that listens takes about 20 mA
  x.world.run_for(1s);
  CHECK(x.left.count<battery_flat>() == 0);
  x.world.run_for(10s);
  CHECK(x.left.count<battery_flat>() == 1);
  CHECK(x.right.count<battery_flat>() == 1);
  x.send_right(true);
  x.world.run_for(1s);
  CHECK(x.left.all<radio_done>().at(0).status == radio::send_status::aborted);
  CHECK(x.right.count<frame_received>() == 0);
}

TEST_CASE("a radio that moves away is heard no more", "[actors][air][NET-15]") {
  air_fixture x;
  x.send_right(false);
  x.world.run_for(1s);
  CHECK(x.right.count<frame_received>() == 1);
  x.world.send(x.air, move_radio{right_radio, {5000, 0, 0}});
  x.send_right(false);
  x.world.run_for(1s);
  CHECK(x.right.count<frame_received>() == 1);
  const auto ends = x.left.all<radio_done>();
  REQUIRE(ends.size() == 2);
  CHECK(ends[0].arrived);
  CHECK(ends[1].status == radio::send_status::sent); // nobody had to acknowledge it
  CHECK_FALSE(ends[1].arrived);
  CHECK(ends[1].last == radio::copy_outcome::out_of_reach);
}
