#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/codec.hpp"
#include "core/hash.hpp"
#include "support/catch.hpp"
#include "unit/radio/fixture.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::radio_fixture;

namespace {

constexpr std::uint16_t motes = 7; ///< in each of two islands

struct scenario {
  bool power_faults = true;
  int steps = 600;
  bool any_channel = true; ///< else a unit disk whose overlaps are collisions
};

/// One mote in three is so slow that its receive slots run out.
const platform* kind_of(std::uint32_t radio) {
  static const auto slow = [] {
    auto x = platforms()[2];
    x.service_time = 40ms;
    return x;
  }();
  return radio % 3 == 2 ? &slow : &platforms()[radio % 3];
}

position somewhere(random_stream& rng) {
  return {rng.unit() * 60, rng.unit() * 60, 0};
}

propagation any_propagation(random_stream& rng) {
  switch (rng.below(4)) {
  case 0:
    return unit_disk{20 + 20 * rng.unit()};
  case 1:
    return log_distance{2 + 2 * rng.unit(), 40, 6 * rng.unit(), 3 * rng.unit()};
  case 2:
    return friis{};
  default:
    break;
  }
  std::vector<gain_table::gain> gains;
  for (std::uint16_t from = 1; from <= motes; ++from)
    for (std::uint16_t to = 1; to <= motes; ++to)
      if (from != to && rng.chance(0.8))
        gains.push_back({from, to, static_cast<float>(-50 - 50 * rng.unit())});
  return test::links_of(std::move(gains));
}

noise_model any_noise(random_stream& rng) {
  switch (rng.below(3)) {
  case 0:
    return no_noise{};
  case 1:
    return constant_noise{-100 + 15 * rng.unit()};
  default:
    break;
  }
  std::vector<std::int8_t> readings;
  for (int i = 0; i < 300; ++i)
    readings.push_back(
        static_cast<std::int8_t>(rng.chance(0.1) ? -75 : static_cast<int>(rng.below(8)) - 100));
  return traced_noise{std::make_shared<const noise_trace>(std::move(readings))};
}

template <class T, std::size_t N>
T one_of(const std::array<T, N>& all, random_stream& rng) {
  return all[rng.below(N)];
}

/// Everything that a file may say about a channel, at random.
channel_config any_channel(random_stream& rng) {
  channel_config x;
  x.propagation = any_propagation(rng);
  x.noise = any_noise(rng);
  x.curve = one_of(std::array{error_curve::oqpsk, error_curve::tossim}, rng);
  x.collisions = one_of(std::array{collision_rule::sinr, collision_rule::strict}, rng);
  x.capture = rng.chance(0.5);
  x.sensing =
      one_of(std::array{sensing::energy, sensing::carrier, sensing::energy_or_carrier}, rng);
  x.window = one_of(std::array{sensing_window::whole, sensing_window::end}, rng);
  if (rng.chance(0.3))
    x.cca_dbm = -90 + 30 * rng.unit();
  if (rng.chance(0.3))
    x.sensitivity_dbm = -100 + 20 * rng.unit();
  for (const auto& kind : platforms())
    if (rng.chance(0.7))
      x.macs.emplace_back(std::string(kind.name), mac_names()[rng.below(mac_names().size())]);
  for (auto count = rng.below(6); count > 0; --count) {
    const auto any = [&rng] {
      return mote_address{island_id{static_cast<std::uint32_t>(1 + rng.below(2))},
                          mote_id{static_cast<std::uint16_t>(1 + rng.below(motes))}};
    };
    link_override link{any(), any(), {}, {}};
    if (rng.chance(0.5))
      link.loss = rng.unit();
    if (rng.chance(0.5))
      link.gain_db = -40 - 80 * rng.unit();
    x.links.push_back(link);
  }
  return x;
}

/// Radios of the second island, in one run of three: most of them listen at low power.
listening_config listening_of(std::uint16_t i, std::uint64_t seed) {
  listening_config x;
  if (seed % 3 != 1 || i < motes)
    return x;
  x.interval = 60ms;
  x.awake = 20ms;
  x.checks = i % 4 != 0;
  return x;
}

/// Two islands in one place; sends, power faults, moves and link losses at random.
class random_run {
public:
  random_run(std::uint64_t seed, const scenario& what)
      : world(config_of(seed, what), seed), rng_(seed + 1000), what_(what) {
    world.channel.watch();
    for (std::uint16_t i = 0; i < 2 * motes; ++i) {
      radio_config x;
      x.address = mote_id{static_cast<std::uint16_t>(1 + i % motes)};
      x.pan = static_cast<std::uint16_t>(1 + i / motes);
      x.place = somewhere(rng_);
      x.kind = kind_of(i);
      x.transmit_dbm = -20 + 20 * rng_.unit();
      x.listening = listening_of(i, seed);
      transmit_dbm.push_back(*x.transmit_dbm);
      world.channel.add(x, world.now);
    }
  }

  void go() {
    for (int i = 0; i < what_.steps; ++i) {
      step();
      if (!world.channel.counts().balanced())
        FAIL("radio_counters do not balance at " << to_text(world.now));
    }
    world.run_for(5s); // everything comes to its end, unless a channel is never clear
  }

  [[nodiscard]] std::uint64_t requests() const { return requests_; }

  radio_fixture world;
  std::vector<double> transmit_dbm;

  /// When to stop and look, and for how long each radio had been sending in all by then.
  std::set<instant> stops;
  std::map<instant, std::vector<duration>> sent_for;

private:
  static channel_config config_of(std::uint64_t seed, const scenario& what) {
    random_stream rng(seed + 2000);
    channel_config x;
    x.propagation = unit_disk{20 + 20 * rng.unit()};
    if (what.any_channel)
      x = any_channel(rng);
    x.loss = rng.chance(0.5) ? 0.3 * rng.unit() : 0;
    x.queue = 1 + rng.below(8);
    x.retries_max = static_cast<unsigned>(rng.below(5));
    return x;
  }

  radio_index any() { return radio_index{static_cast<std::uint32_t>(rng_.below(2 * motes))}; }

  void step() {
    const auto kind = rng_.below(100);
    if (kind < 80) {
      const auto to = rng_.chance(0.2) ? broadcast_mote.value
                                       : static_cast<std::uint16_t>(1 + rng_.below(motes));
      bytes octets(8 + rng_.below(100));
      for (std::size_t i = 0; i < 8; ++i)
        octets[i] = static_cast<std::uint8_t>(requests_ >> (8 * i));
      world.note(world.channel.send(
          any(), {requests_++, mote_id{to}, 6, std::move(octets), rng_.chance(0.8)}, world.now));
    } else if (kind < 90 && what_.power_faults) {
      world.set_power(any(), rng_.chance(0.5) ? power::off : power::on);
    } else if (kind == 90 && what_.power_faults) {
      world.set_power(any(), power::flat);
    } else if (kind < 95) {
      world.channel.move(any(), somewhere(rng_));
    } else {
      world.channel.set_loss(any(), any(), rng_.unit());
    }
    run_for(rng_.chance(0.5) ? rng_.between(0ms, 1ms) : rng_.between(0ms, 15ms));
  }

  void run_for(duration length) {
    const auto end = world.now + length;
    for (auto stop = stops.upper_bound(world.now); stop != stops.end() && *stop <= end; ++stop) {
      world.run_until(*stop);
      auto& now = sent_for[world.now];
      now.clear();
      for (std::uint32_t i = 0; i < 2 * motes; ++i)
        now.push_back(world.channel.energy(radio_index{i}, world.now).times.radio_transmit);
    }
    world.run_until(end);
  }

  random_stream rng_;
  scenario what_;
  std::uint64_t requests_ = 0;
};

std::vector<std::pair<instant, delivered>> deliveries(const radio_fixture& x) {
  std::vector<std::pair<instant, delivered>> all;
  for (const auto& [at, what] : x.log)
    if (const auto* got = std::get_if<delivered>(&what))
      all.emplace_back(at, *got);
  return all;
}

std::uint64_t hash_of(const radio_fixture& x) {
  fold64 fold;
  for (const auto& [at, what] : x.log) {
    fold.add(static_cast<std::uint64_t>(at.time_since_epoch().count()));
    if (const auto* got = std::get_if<delivered>(&what))
      fold.add(got->to.value).add(got->psdu.view());
    else if (const auto* end = std::get_if<done>(&what))
      fold.add(end->radio.value).add(end->token).add(to_string(end->status));
    else if (const auto* seen = std::get_if<overheard>(&what))
      fold.add(seen->psdu.view()).add(std::uint64_t{seen->received});
  }
  return fold.value();
}

} // namespace

TEST_CASE("both radio_counters balance at every moment of a random run",
          "[radio][random][RTG-06]") {
  copy_counters all;
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    INFO("seed " << seed);
    const bool any = seed >= 20;
    random_run run(seed, {.any_channel = any});
    run.go();
    const auto radio_counters = run.world.channel.counts().by_all();
    CHECK(run.world.channel.counts().balanced());
    CHECK(radio_counters.requests.requests == run.requests());
    CHECK(run.world.all<done>().size() + radio_counters.requests.open == run.requests());
    CHECK(run.world.all<delivered>().size() ==
          radio_counters.copies.of(copy_outcome::delivered) - radio_counters.acks_received);
    CHECK(run.world.all<overheard>().size() == radio_counters.transmissions);
    auto parts = run.world.channel.counts().in_pan(1);
    parts += run.world.channel.counts().in_pan(2);
    CHECK(parts == radio_counters);
    all += radio_counters.copies;
  }
  // Every line of the counters has been in use.
  for (std::size_t i = 0; i < copy_outcomes; ++i) {
    INFO(to_string(static_cast<copy_outcome>(i)));
    CHECK(all.ended[i] > 0);
  }
}

TEST_CASE("the simple channel brings every request to its end", "[radio][random]") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    random_run run(seed, {.any_channel = false});
    run.go();
    CHECK(run.world.channel.counts().by_all().requests.open == 0);
  }
}

TEST_CASE("every request ends once, and its outcome is true", "[radio][random]") {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    INFO("seed " << seed);
    random_run run(seed, {.power_faults = false, .any_channel = seed % 4 != 0});
    run.go();
    const bool forgetful = seed % 4 != 0;
    std::set<std::uint64_t> ended;
    std::set<std::pair<std::uint64_t, radio_index>> received;
    std::map<std::uint64_t, int> takers;
    for (const auto& x : run.world.all<delivered>()) {
      const auto token = byte_reader(x.content.payload).little<std::uint64_t>();
      // At most once, unless the receiver's memory of sources is short.
      CHECK((received.emplace(token, x.to).second || forgetful));
      CHECK(x.content.pan == 1 + x.to.value / motes);
      ++takers[token];
    }
    for (const auto& x : run.world.all<done>()) {
      CHECK(ended.insert(x.token).second);
      if (x.transmissions == 0) // what never left the radio reached nobody
        CHECK(takers.count(x.token) == 0);
      if (x.status == send_status::sent)
        CHECK(x.transmissions > 0);
      if (x.status == send_status::queue_full)
        CHECK(x.transmissions == 0);
      if (x.arrived)
        CHECK(takers.count(x.token) == 1);
    }
    CHECK(ended.size() + run.world.channel.counts().by_all().requests.open == run.requests());
  }
}

TEST_CASE("the same seed gives the same run, another seed another", "[radio][random][GEN-07]") {
  std::set<std::uint64_t> hashes;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    random_run first(seed, {});
    random_run second(seed, {});
    first.go();
    second.go();
    CHECK(hash_of(first.world) == hash_of(second.world));
    hashes.insert(hash_of(first.world));
  }
  CHECK(hashes.size() == 8);
}

TEST_CASE("times of every radio add up in a random run", "[radio][random][NRG-05]") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    random_run run(seed, {});
    run.go();
    for (std::uint32_t i = 0; i < 2 * motes; ++i) {
      const radio_index radio{i};
      const auto use = run.world.channel.energy(radio, run.world.now);
      const auto& t = use.times;
      const bool flat = run.world.channel.power_of(radio) == power::flat;
      const auto lived = (flat ? use.empty_at : run.world.now).time_since_epoch();
      CHECK(t.radio_off + t.radio_listen + t.radio_receive + t.radio_transmit == lived);
      CHECK(t.mcu_active + t.mcu_sleep == lived);
      CHECK(t.mcu_sleep >= 0ns);
      CHECK(use.used_mah ==
            Approx(used_mah(t, *kind_of(i), kind_of(i)->transmit_ma(run.transmit_dbm[i])))
                .epsilon(1e-3));
    }
  }
}

TEST_CASE("no radio receives while it sends, nor more than the air can carry", "[radio][random]") {
  std::size_t received = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    INFO("seed " << seed);
    const scenario what{.power_faults = seed % 2 == 0};
    random_run blind(seed, what);
    blind.go();
    random_run run(seed, what); // the same again, stopping where frames begin and end
    for (const auto& [at, got] : deliveries(blind.world))
      run.stops.insert({at - air_time(got.psdu.size()), at});
    run.go();
    CHECK(hash_of(run.world) == hash_of(blind.world));
    std::map<radio_index, duration> on_air;
    std::map<radio_index, std::uint64_t> octets;
    for (const auto& [at, got] : deliveries(run.world)) {
      const auto length = air_time(got.psdu.size());
      on_air[got.to] += length;
      octets[got.to] += got.psdu.size();
      const auto begin = run.sent_for.find(at - length);
      const auto end = run.sent_for.find(at);
      if (begin == run.sent_for.end() || end == run.sent_for.end())
        continue; // it came in the last seconds, when nobody looked
      ++received;
      if (begin->second[got.to.value] != end->second[got.to.value])
        FAIL("radio " << got.to.value << " sent during a frame that it received");
    }
    for (const auto& [radio, length] : on_air) {
      const auto times = run.world.channel.energy(radio, run.world.now).times;
      CHECK(length <= times.radio_receive);
      CHECK(8 * static_cast<double>(octets[radio]) < 250e3 * seconds(times.radio_receive));
    }
  }
  CHECK(received > 1000);
}

TEST_CASE("frames of one island never come out in another", "[radio][random][RTG-06][GEN-11]") {
  for (std::uint64_t seed = 100; seed < 120; ++seed) {
    random_run run(seed, {});
    run.go();
    for (const auto& x : run.world.all<delivered>())
      if (x.content.pan != 1 + x.to.value / motes)
        FAIL("seed " << seed);
  }
}

TEST_CASE("a deadline comes no later than the next output", "[radio][random]") {
  constexpr auto grain = 100us;
  for (std::uint64_t seed = 200; seed < 210; ++seed) {
    INFO("seed " << seed);
    random_run asked(seed, {.steps = 100});
    asked.go();
    random_run restless(seed, {.steps = 100});
    for (instant at; at < asked.world.now; at += grain)
      restless.stops.insert(at);
    restless.go();
    REQUIRE(asked.world.log.size() == restless.world.log.size());
    for (std::size_t i = 0; i < asked.world.log.size(); ++i) {
      const auto& a = asked.world.log[i];
      const auto& b = restless.world.log[i];
      if (a.what.index() != b.what.index() || a.at != b.at)
        FAIL("output " << i << " at " << to_text(a.at) << " or " << to_text(b.at));
    }
    CHECK(asked.world.channel.counts().by_all() == restless.world.channel.counts().by_all());
  }
}
