#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "radio/medium/medium.hpp"
#include "support/catch.hpp"
#include "unit/radio/fixture.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::channel_with;
using test::links_of;
using test::radio_fixture;

namespace {

constexpr radio_index ear{0};
constexpr int trials = 4000;

channel_config by_sinr(bool capture = false) {
  return channel_with([capture](auto& c) {
    c.propagation = log_distance{};
    c.collisions = collision_rule::sinr;
    c.capture = capture;
  });
}

/// One receiver, and senders 1 to 4 that do not hear each other.
struct one_receiver {
  explicit one_receiver(const channel_config& config, std::optional<double> noise_dbm = {},
                        std::uint64_t seed = 1)
      : errors(config.curve), air(config), rng(seed) {
    if (noise_dbm)
      noise = to_units(*noise_dbm);
    for (int i = 0; i < 5; ++i) {
      transceiver_config x;
      x.sensitivity_dbm = -95;
      x.cca_dbm = -77;
      x.noise = noise;
      air.add(std::move(x), energy_meter(find_platform("micaz"), 2000, 0, instant{}), instant{});
    }
  }

  slot_index start(std::uint32_t from, double dbm, duration at, duration length) {
    hearer x;
    x.radio = ear;
    x.power = static_cast<float>(to_units(dbm));
    if (noise != 0)
      x.clean_damage =
          static_cast<float>(errors.damage(double{x.power} / static_cast<double>(noise)));
    transmission sent;
    sent.from = radio_index{from};
    sent.begin = instant(at);
    sent.length = length;
    return air.start(std::move(sent), std::make_shared<const hearers>(hearers{x}));
  }

  outcome end(slot_index slot, duration at) {
    std::optional<outcome> only;
    air.end(slot, instant(at), rng,
            [&](const transmission&, std::size_t, const hearer&, outcome y) { only = y; });
    return only.value();
  }

  power_units noise = 0;
  error_model errors;
  medium air;
  random_stream rng;
};

/// Chance that bits survive, straight from the standard's formula.
double survival(double signal_dbm, std::vector<double> disturbing_dbm, double bits) {
  double disturbance = 0;
  for (const auto x : disturbing_dbm)
    disturbance += from_db(x);
  return std::pow(1 - bit_error_rate(from_db(signal_dbm) / disturbance), bits);
}

/// Five standard deviations of a share observed in `trials`; the least is one in a thousand.
double tolerance(double chance) {
  return 5 * std::sqrt(std::max(chance * (1 - chance), 1e-3) / trials);
}

double bits_in(duration x) {
  return static_cast<double>(x / 4us);
}

/// Three radios that each hear the noise of a trace.
void add_among(const std::shared_ptr<const noise_trace>& trace, medium& air) {
  for (int i = 0; i < 3; ++i) {
    transceiver_config x;
    x.sensitivity_dbm = -95;
    x.cca_dbm = -77;
    x.traced_noise = std::make_unique<noise_source>(trace, random_stream(3));
    air.add(std::move(x), energy_meter(find_platform("micaz"), 2000, 0, instant{}), instant{});
  }
}

} // namespace

TEST_CASE("a frame 10 dB stronger survives a later one, which is captured", "[radio][sinr]") {
  one_receiver x(by_sinr());
  for (int i = 0; i < 100; ++i) {
    const auto at = i * 10ms;
    const auto first = x.start(1, -60, at, 2ms);
    const auto second = x.start(2, -70, at + 500us, 2ms);
    CHECK(x.end(first, at + 2ms) == outcome::intact);
    CHECK(x.end(second, at + 2500us) == outcome::captured);
  }
}

TEST_CASE("a frame survives an equal one as often as the bits they share do", "[radio][sinr]") {
  for (const auto overlap : {1ms, 4ms}) {
    const auto expected = survival(-60, {-60}, bits_in(overlap));
    INFO(bits_in(overlap) << " bits, expected " << expected);
    int survived = 0;
    one_receiver x(by_sinr());
    for (int i = 0; i < trials; ++i) {
      const auto at = i * 20ms;
      const auto first = x.start(1, -60, at, 5ms);
      const auto second = x.start(2, -60, at + 5ms - overlap, 5ms);
      const auto what = x.end(first, at + 5ms);
      CHECK((what == outcome::intact || what == outcome::collision));
      survived += what == outcome::intact ? 1 : 0;
      CHECK(x.end(second, at + 10ms - overlap) == outcome::captured);
    }
    CHECK(survived / double{trials} == Approx(expected).margin(tolerance(expected)));
  }
}

TEST_CASE("interference damages the bits it meets and no others", "[radio][sinr]") {
  // 600 us of a frame at 1 dB more, 400 us of one at 0.5 dB less, 100 us of both.
  const auto expected = survival(-60, {-61}, bits_in(500us)) *
                        survival(-60, {-61, -59.5}, bits_in(100us)) *
                        survival(-60, {-59.5}, bits_in(300us));
  REQUIRE(expected > 0.2);
  REQUIRE(expected < 0.8);
  int survived = 0;
  one_receiver x(by_sinr());
  for (int i = 0; i < trials; ++i) {
    const auto at = i * 20ms;
    const auto frame = x.start(1, -60, at, 4ms);
    const auto one = x.start(2, -61, at + 1ms, 600us);
    const auto other = x.start(3, -59.5, at + 1500us, 400us);
    CHECK(x.end(one, at + 1600us) == outcome::captured);
    CHECK(x.end(other, at + 1900us) == outcome::captured);
    const auto what = x.end(frame, at + 4ms);
    CHECK((what == outcome::intact || what == outcome::collision));
    survived += what == outcome::intact ? 1 : 0;
  }
  CHECK(survived / double{trials} == Approx(expected).margin(tolerance(expected)));
}

TEST_CASE("noise and interference add up, and noise alone gets the blame for what it does",
          "[radio][sinr]") {
  constexpr double noise_dbm = -90;
  constexpr double signal_dbm = -89;
  const auto by_noise = survival(signal_dbm, {noise_dbm}, bits_in(4ms));
  const auto by_both = survival(signal_dbm, {noise_dbm}, bits_in(2ms)) *
                       survival(signal_dbm, {noise_dbm, -95.5}, bits_in(2ms));
  std::array<int, 6> ends{};
  one_receiver x(by_sinr(), noise_dbm);
  for (int i = 0; i < trials; ++i) {
    const auto at = i * 20ms;
    const auto frame = x.start(1, signal_dbm, at, 4ms);
    const auto other = x.start(2, -95.5, at + 1ms, 2ms);
    CHECK(x.end(other, at + 3ms) == outcome::weak); // below the sensitivity
    ++ends[static_cast<std::size_t>(x.end(frame, at + 4ms))];
  }
  const auto share = [&ends](outcome y) {
    return ends[static_cast<std::size_t>(y)] / double{trials};
  };
  REQUIRE(by_noise - by_both > 0.05);
  CHECK(share(outcome::intact) == Approx(by_both).margin(tolerance(by_both)));
  CHECK(share(outcome::weak) == Approx(1 - by_noise).margin(tolerance(by_noise)));
  CHECK(share(outcome::collision) ==
        Approx(by_noise - by_both).margin(tolerance(by_noise - by_both)));
}

TEST_CASE("a much stronger later frame takes the receiver over if that is allowed",
          "[radio][sinr]") {
  const auto ends = [](bool capture, double later_dbm, std::optional<double> noise_dbm = {}) {
    one_receiver x(by_sinr(capture), noise_dbm);
    const auto first = x.start(1, -80, 0ms, 4ms);
    const auto second = x.start(2, later_dbm, 1ms, 4ms);
    const auto one = x.end(first, 4ms);
    return std::pair(one, x.end(second, 5ms));
  };
  CHECK(ends(true, -70) == std::pair(outcome::captured, outcome::intact));
  CHECK(ends(true, -76.9) == std::pair(outcome::captured, outcome::intact));
  CHECK(ends(true, -77.1) == std::pair(outcome::collision, outcome::captured));
  CHECK(ends(false, -70) == std::pair(outcome::collision, outcome::captured));
  // 3 dB above everything else: the first frame and the noise.
  CHECK(ends(true, -76.9, -90).second == outcome::captured);
  CHECK(ends(true, -76, -90).second == outcome::intact);
}

TEST_CASE("what a receiver was left for can be left in turn", "[radio][sinr]") {
  one_receiver x(by_sinr(true));
  const auto first = x.start(1, -80, 0ms, 5ms);
  const auto second = x.start(2, -65, 1ms, 5ms);
  const auto third = x.start(3, -50, 2ms, 5ms);
  CHECK(x.end(first, 5ms) == outcome::captured);
  CHECK(x.end(second, 6ms) == outcome::captured);
  CHECK(x.end(third, 7ms) == outcome::intact);
  CHECK(x.air.times(ear, instant(10ms)).radio_receive == 7ms);
}

TEST_CASE("strict: any overlap loses both frames, however strong one of them is", "[radio][sinr]") {
  auto config = by_sinr();
  config.collisions = collision_rule::strict;
  for (const bool capture : {false, true}) {
    config.capture = capture;
    for (const double later_dbm : {-90.0, -60.0, -30.0}) {
      one_receiver x(config);
      const auto first = x.start(1, -60, 0ms, 2ms);
      const auto second = x.start(2, later_dbm, 2ms - 1ns, 2ms);
      CHECK(x.end(first, 2ms) == outcome::collision);
      CHECK(x.end(second, 4ms) == outcome::collision);
    }
    one_receiver x(config); // also one that is too weak to be received
    const auto first = x.start(1, -60, 0ms, 2ms);
    const auto second = x.start(2, -110, 1ms, 2ms);
    CHECK(x.end(first, 2ms) == outcome::collision);
    CHECK(x.end(second, 3ms) == outcome::weak);
  }
}

TEST_CASE("a receiver locks on nothing below its sensitivity", "[radio][sinr]") {
  one_receiver x(by_sinr());
  CHECK(x.end(x.start(1, -95.01, 0ms, 1ms), 1ms) == outcome::weak);
  CHECK(x.air.times(ear, instant(1ms)).radio_receive == 0ms);
  CHECK(x.end(x.start(1, -94.99, 1ms, 1ms), 2ms) == outcome::intact);
  CHECK(x.air.times(ear, instant(2ms)).radio_receive == 1ms);
  const auto whisper = x.start(1, -96, 2ms, 10ms); // it does not keep the receiver busy
  CHECK(x.end(x.start(2, -80, 3ms, 1ms), 4ms) == outcome::intact);
  CHECK(x.end(whisper, 12ms) == outcome::weak);
}

TEST_CASE("a receiver locks on nothing that is 5 dB below the disturbance", "[radio][sinr]") {
  SECTION("noise") {
    one_receiver x(by_sinr(), -80);
    CHECK(x.end(x.start(1, -85.01, 0ms, 1ms), 1ms) == outcome::weak);
    CHECK(x.air.times(ear, instant(1ms)).radio_receive == 0ms);
    CHECK(x.end(x.start(1, -84.99, 1ms, 1ms), 2ms) == outcome::weak); // locked, but to no avail
    CHECK(x.air.times(ear, instant(2ms)).radio_receive == 1ms);
  }
  SECTION("a frame that was there before it could listen") {
    for (const auto& [dbm, locked] : {std::pair{-75.01, false}, {-74.99, true}}) {
      one_receiver x(by_sinr());
      const auto own =
          x.air.start({.from = ear, .content = {}, .psdu = {}, .begin = instant{}, .length = 1ms},
                      std::make_shared<const hearers>());
      const auto other = x.start(1, -70, 500us, 5ms);
      x.air.end(own, instant(1ms), x.rng, [](const auto&, std::size_t, const auto&, outcome) {});
      const auto later = x.start(2, dbm, 2ms, 1ms);
      CHECK(x.end(later, 3ms) == outcome::collision);
      CHECK(x.air.times(ear, instant(3ms)).radio_receive == (locked ? 1ms : 0ms));
      CHECK(x.end(other, 5500us) == outcome::half_duplex);
    }
  }
}

TEST_CASE("a lone frame arrives as often as the bit error rate lets it", "[radio][sinr][channel]") {
  // A few seeds would be too few for 1 % absolute: 20 000 frames have a deviation of 0.35 %.
  constexpr int frames = 20'000;
  constexpr double noise_dbm = -90;
  double lowest = 1;
  double highest = 0;
  for (const int size : {13, 41, 127}) {
    for (const double snr_db : {-3.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0}) {
      INFO(size << " octets at " << snr_db << " dB");
      const auto expected = survival(noise_dbm + snr_db, {noise_dbm}, 8 * (size + 6));
      one_receiver x(by_sinr(), noise_dbm, static_cast<std::uint64_t>(size));
      int received = 0;
      for (int i = 0; i < frames; ++i) {
        const auto at = i * 10ms;
        const auto length = air_time(static_cast<std::size_t>(size));
        const auto what = x.end(x.start(1, noise_dbm + snr_db, at, length), at + length);
        received += what == outcome::intact ? 1 : 0;
        if (what != outcome::intact && what != outcome::weak)
          FAIL("noise made a collision");
      }
      const auto share = received / double{frames};
      CHECK(std::abs(share - expected) < 0.01);
      lowest = std::min(lowest, share);
      highest = std::max(highest, share);
    }
  }
  CHECK(lowest < 0.02);
  CHECK(highest > 0.98);
}

TEST_CASE("the whole channel delivers by the same curve", "[radio][sinr][channel]") {
  constexpr int frames = 10'000;
  for (const double gain : {-89.5, -88.5}) {
    radio_fixture x(channel_with([gain](auto& c) {
      c.propagation = links_of({{1, 2, static_cast<float>(gain)}});
      c.collisions = collision_rule::sinr;
      c.noise = constant_noise{-89};
    }));
    const auto a = x.add(1, 0);
    const auto b = x.add(2, 10);
    for (int i = 0; i < frames; ++i) {
      x.send(a, 0, 0xffff, 28, false);
      x.run_for(10ms);
    }
    const auto expected = survival(gain, {-89}, 8 * 47);
    const auto copies = x.channel.counts().on_link(a, b);
    CHECK(copies.sent == frames);
    CHECK(copies.of(copy_outcome::delivered) + copies.of(copy_outcome::weak) == frames);
    CHECK(std::abs(static_cast<double>(copies.of(copy_outcome::delivered)) / frames - expected) <
          0.02);
  }
}

TEST_CASE("with an edge of noise 1 % is lost at the sensitivity, and more and more below",
          "[radio][sinr][channel]") {
  // PSDU of 20 octets, as IEEE 802.15.4-2006 6.1.7 defines the sensitivity: 7 of AM payload.
  const auto delivered = [](sensitivity_edge edge, double dbm, error_curve curve) {
    radio_fixture x(channel_with([&](auto& c) {
      c.propagation = links_of({{1, 2, static_cast<float>(dbm)}});
      c.noise = constant_noise{-110};
      c.collisions = collision_rule::sinr;
      c.edge = edge;
      c.curve = curve;
    }));
    const auto from = x.add(1, 0);
    const auto to = x.add(2, 1);
    for (int i = 0; i < trials; ++i) {
      x.send(from, 0, 2, 7, false);
      x.run_for(20ms);
    }
    return static_cast<double>(x.channel.counts().on_link(from, to).of(copy_outcome::delivered)) /
           trials;
  };
  constexpr double sensitivity_dbm = -95; // of a MicaZ
  for (const auto curve : {error_curve::oqpsk, error_curve::tossim}) {
    CHECK(delivered(sensitivity_edge::noise, sensitivity_dbm, curve) ==
          Approx(0.99).margin(tolerance(0.99)));
    CHECK(delivered(sensitivity_edge::noise, sensitivity_dbm + 2, curve) > 0.999);
    CHECK(delivered(sensitivity_edge::noise, sensitivity_dbm - 5, curve) == 0);
    CHECK(delivered(sensitivity_edge::sharp, sensitivity_dbm + 0.01, curve) == 1);
    CHECK(delivered(sensitivity_edge::sharp, sensitivity_dbm - 0.01, curve) == 0);
  }
  const auto noise_dbm = sensitivity_dbm - to_db(sinr_at_sensitivity(error_curve::oqpsk));
  for (const auto below : {0.5, 1.0, 1.5}) {
    const auto expected = survival(sensitivity_dbm - below, {noise_dbm}, 8 * 26);
    CHECK(expected > 0.1);
    CHECK(expected < 0.99);
    CHECK(delivered(sensitivity_edge::noise, sensitivity_dbm - below, error_curve::oqpsk) ==
          Approx(expected).margin(tolerance(expected)));
  }
}

TEST_CASE("TOSSIM's curve is drawn twice for a frame, once for an ack", "[radio][sinr]") {
  auto config = by_sinr();
  config.curve = error_curve::tossim;
  constexpr double snr_db = 4.7;
  const auto once = tossim_reception_rate(snr_db);
  REQUIRE(once > 0.3);
  REQUIRE(once < 0.8);
  for (const bool ack : {false, true}) {
    one_receiver x(config, -90);
    int received = 0;
    for (int i = 0; i < trials; ++i) {
      const auto at = i * 10ms;
      hearer y;
      y.radio = ear;
      y.power = static_cast<float>(to_units(-90 + snr_db));
      y.clean_damage =
          static_cast<float>(x.errors.damage(double{y.power} / static_cast<double>(x.noise)));
      transmission sent;
      sent.from = radio_index{1};
      sent.content.type = ack ? frame_type::ack : frame_type::data;
      sent.begin = instant(at);
      sent.length = 1ms;
      const auto slot = x.air.start(std::move(sent), std::make_shared<const hearers>(hearers{y}));
      received += x.end(slot, at + 1ms) == outcome::intact ? 1 : 0;
    }
    const auto expected = ack ? once : once * once;
    CHECK(received / double{trials} == Approx(expected).margin(tolerance(expected)));
  }
}

TEST_CASE("noise that changes during a frame damages it reading by reading", "[radio][sinr]") {
  // Readings that take turns: -90 dBm and -70 dBm, a millisecond each. A frame at -89 dBm that
  // falls into quiet milliseconds alone survives by their chance; one that meets a loud one dies.
  std::vector<std::int8_t> readings;
  for (int i = 0; i < 200; ++i)
    readings.push_back(i % 2 == 0 ? -90 : -70);
  const auto trace = std::make_shared<const noise_trace>(readings);
  auto config = by_sinr();
  config.noise = traced_noise{trace};
  medium air(config);
  add_among(trace, air);
  random_stream rng(1);
  const auto deliver = [&](double dbm, duration at, duration length) {
    hearer y;
    y.radio = ear;
    y.power = static_cast<float>(to_units(dbm));
    transmission sent;
    sent.from = radio_index{1};
    sent.begin = instant(at);
    sent.length = length;
    const auto slot = air.start(std::move(sent), std::make_shared<const hearers>(hearers{y}));
    outcome what = outcome::intact;
    air.end(slot, instant(at + length), rng,
            [&](const auto&, std::size_t, const auto&, outcome z) { what = z; });
    return what;
  };
  int quiet_lost = 0;
  int long_lost = 0;
  int strong_lost = 0;
  for (int i = 0; i < 200; ++i) {
    const auto at = i * 20ms; // always the same kind of millisecond
    quiet_lost += deliver(-80, at, 900us) == outcome::intact ? 0 : 1;
    long_lost += deliver(-80, at + 1ms, 4ms) == outcome::intact ? 0 : 1;
    strong_lost += deliver(-60, at + 6ms, 4ms) == outcome::intact ? 0 : 1;
  }
  CHECK((quiet_lost == 0 || quiet_lost == 200)); // all in quiet milliseconds, or all in loud ones
  CHECK(long_lost == 200);
  CHECK(strong_lost == 0);
}

TEST_CASE("a later frame may come at any time into changing noise", "[radio][sinr]") {
  const auto trace = std::make_shared<const noise_trace>(std::vector<std::int8_t>(100, -98));
  auto config = by_sinr(true);
  config.noise = traced_noise{trace};
  for (const double later_dbm : {-100.0, -80.0, -50.0}) {
    medium air(config);
    add_among(trace, air);
    random_stream rng(1);
    const auto start = [&](std::uint32_t from, double dbm, duration at) {
      hearer y;
      y.radio = ear;
      y.power = static_cast<float>(to_units(dbm));
      transmission sent;
      sent.from = radio_index{from};
      sent.begin = instant(at);
      sent.length = 4ms;
      return air.start(std::move(sent), std::make_shared<const hearers>(hearers{y}));
    };
    const auto end = [&](slot_index slot, duration at) {
      outcome what = outcome::intact;
      air.end(slot, instant(at), rng,
              [&](const auto&, std::size_t, const auto&, outcome z) { what = z; });
      return what;
    };
    const auto first = start(1, -65, 500us);
    const auto second = start(2, later_dbm, 3600us); // three readings later
    static_cast<void>(air.clear(ear, instant(4200us)));
    const bool taken_over = later_dbm > -60;
    CHECK(end(first, 4500us) == (taken_over ? outcome::captured : outcome::intact));
    CHECK(end(second, 7600us) == (taken_over        ? outcome::intact
                                  : later_dbm < -95 ? outcome::weak
                                                    : outcome::captured));
  }
}

// ---------------------------------------------------------------------------------------- sensing

namespace {

channel_config sensing_by(sensing what, sensing_window when = sensing_window::whole) {
  auto x = by_sinr();
  x.sensing = what;
  x.window = when;
  return x;
}

constexpr std::array all_kinds{sensing::energy, sensing::carrier, sensing::energy_or_carrier};

} // namespace

TEST_CASE("energy, a carrier, or either makes a channel busy", "[radio][sinr][sensing]") {
  struct situation {
    double dbm;
    bool energy;
    bool carrier;
  };
  for (const auto& [dbm, energy, carrier] :
       {situation{-60, true, true}, situation{-76.99, true, true}, situation{-77.01, false, true},
        situation{-90, false, true}, situation{-94.99, false, true},
        situation{-95.01, false, false}}) {
    INFO(dbm << " dBm");
    for (const auto kind : all_kinds) {
      one_receiver x(sensing_by(kind));
      CHECK(x.air.clear(ear, instant(1ms)));
      const auto slot = x.start(1, dbm, 1ms, 2ms);
      const bool busy = kind == sensing::energy    ? energy
                        : kind == sensing::carrier ? carrier
                                                   : energy || carrier;
      CHECK(x.air.clear(ear, instant(2ms)) == !busy);
      x.end(slot, 3ms);
      CHECK(x.air.clear(ear, instant(3050us)) == !busy); // still within the window
      CHECK(x.air.clear(ear, instant(3128us)));
    }
  }
}

TEST_CASE("a frame that ended 50 us ago keeps only a whole window busy", "[radio][sinr][sensing]") {
  for (const auto kind : all_kinds) {
    for (const auto window : {sensing_window::whole, sensing_window::end}) {
      one_receiver x(sensing_by(kind, window));
      const auto slot = x.start(1, -60, 1ms, 2ms);
      CHECK_FALSE(x.air.clear(ear, instant(2ms))); // while it lasts, by either
      x.end(slot, 3ms);
      CHECK(x.air.clear(ear, instant(3050us)) == (window == sensing_window::end));
      CHECK(x.air.clear(ear, instant(3128us - 1ns)) == (window == sensing_window::end));
      CHECK(x.air.clear(ear, instant(3128us)));
    }
  }
}

TEST_CASE("two frames below the threshold can be above it together", "[radio][sinr][sensing]") {
  for (const auto kind : {sensing::energy, sensing::energy_or_carrier}) {
    auto config = sensing_by(kind);
    config.collisions = collision_rule::sinr;
    one_receiver x(config);
    // The receiver was sending when they began: it has no carrier.
    const auto own =
        x.air.start({.from = ear, .content = {}, .psdu = {}, .begin = instant{}, .length = 1ms},
                    std::make_shared<const hearers>());
    const auto one = x.start(1, -79, 500us, 4ms);
    const auto other = x.start(2, -79, 600us, 3ms);
    x.air.end(own, instant(1ms), x.rng, [](const auto&, std::size_t, const auto&, outcome) {});
    CHECK_FALSE(x.air.clear(ear, instant(2ms))); // -76 dBm
    x.end(other, 3600us);
    CHECK_FALSE(x.air.clear(ear, instant(3700us))); // within the window
    CHECK(x.air.clear(ear, instant(3800us)));       // -79 dBm
    x.end(one, 4500us);
    CHECK(x.air.clear(ear, instant(4600us)));
  }
  one_receiver x(sensing_by(sensing::carrier)); // nothing is being received
  const auto own =
      x.air.start({.from = ear, .content = {}, .psdu = {}, .begin = instant{}, .length = 1ms},
                  std::make_shared<const hearers>());
  const auto one = x.start(1, -50, 500us, 4ms);
  x.air.end(own, instant(1ms), x.rng, [](const auto&, std::size_t, const auto&, outcome) {});
  CHECK(x.air.clear(ear, instant(2ms)));
  x.end(one, 4500us);
}

TEST_CASE("noise counts as energy", "[radio][sinr][sensing]") {
  one_receiver loud(sensing_by(sensing::energy), -76);
  CHECK_FALSE(loud.air.clear(ear, instant(1ms)));
  one_receiver deaf(sensing_by(sensing::carrier), -76);
  CHECK(deaf.air.clear(ear, instant(1ms)));
  one_receiver quiet(sensing_by(sensing::energy), -80);
  CHECK(quiet.air.clear(ear, instant(1ms)));
  const auto slot = quiet.start(1, -79.5, 1ms, 1ms); // -76.7 dBm together
  CHECK_FALSE(quiet.air.clear(ear, instant(1500us)));
  quiet.end(slot, 2ms);
  const auto weaker = quiet.start(1, -81, 3ms, 1ms); // -77.5 dBm
  CHECK(quiet.air.clear(ear, instant(3500us)));
  quiet.end(weaker, 4ms);
}

TEST_CASE("by default the threshold is the platform's, and a file may say another",
          "[radio][sinr][sensing][channel]") {
  const auto starts_at_once = [](std::optional<double> cca_dbm, float gain) {
    radio_fixture x(channel_with([&](auto& c) {
      c.propagation = links_of({{1, 2, gain}, {2, 1, gain}});
      c.sensing = sensing::energy;
      c.cca_dbm = cca_dbm;
      c.collisions = collision_rule::sinr;
    }));
    const auto a = x.add(1, 0);
    const auto b = x.add(2, 1);
    // Frames that do not hold each other off overlap nearly always.
    x.saturate({a, b}, 0xffff, 100, false, 10s);
    const auto copies = x.channel.counts().on_link(a, b);
    const auto overlapping = static_cast<double>(copies.of(copy_outcome::half_duplex)) /
                             static_cast<double>(copies.sent);
    CHECK((overlapping < 0.25 || overlapping > 0.75));
    return overlapping > 0.75;
  };
  CHECK_FALSE(starts_at_once({}, -76.5F));
  CHECK(starts_at_once({}, -77.5F));
  CHECK_FALSE(starts_at_once(-80, -77.5F));
  CHECK(starts_at_once(-70, -76.5F));
}
