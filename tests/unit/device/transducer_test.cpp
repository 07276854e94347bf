#include <limits>
#include <memory>

#include "core/numbers/random.hpp"
#include "device/random_walk.hpp"
#include "device/transducer.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::device;

namespace {

double value_at(const transducer_model& model, duration t, const reader& who = {}) {
  random_stream rng(1);
  return value_of({quantity::temperature, model, 0, 0.1}, instant{t}, rng, who);
}

double value_at(const field_source& source, double x_m, duration t = 0s) {
  return value_at(field_model{0, {}, {source}}, t, {{x_m, 0, 0}, 0});
}

trace_model trace_of(time_series series, duration turn) {
  trace_table table;
  table.of_mote[3] = std::move(series);
  table.turn = turn;
  trace_model model;
  model.table = std::make_shared<const trace_table>(std::move(table));
  model.mote = 3;
  return model;
}

} // namespace

TEST_CASE("transducer models give the value of their time", "[device][STR-21]") {
  CHECK(value_at(constant_model{21.5}, 1h) == 21.5);
  const sine_model day{20, 5, 24h, 0};
  CHECK(value_at(day, 0s) == Approx(20));
  CHECK(value_at(day, 6h) == Approx(25));
  CHECK(value_at(day, 18h) == Approx(15));
  CHECK(value_at(day, 30h) == Approx(25));
  CHECK(value_at(sine_model{20, 5, 24h, 0.25}, 0s) == Approx(25));
  const points_model cooking{{{1min, 20}, {3min, 30}, {4min, 10}}};
  CHECK(value_at(cooking, 0s) == 20);
  CHECK(value_at(cooking, 1min) == 20);
  CHECK(value_at(cooking, 2min) == Approx(25));
  CHECK(value_at(cooking, 210s) == Approx(20));
  CHECK(value_at(cooking, 4min) == 10);
  CHECK(value_at(cooking, 9h) == 10);
}

TEST_CASE("a reading is a rounded count within 16 bits", "[device]") {
  random_stream rng(1);
  const auto count = [&](double value) {
    return sample({quantity::light, constant_model{value}, 0, 0.5}, instant{}, rng);
  };
  CHECK(count(10) == 20);
  CHECK(count(10.24) == 20);
  CHECK(count(10.26) == 21);
  CHECK(count(-10.26) == -21);
  CHECK(count(1e9) == 32767);
  CHECK(count(-1e9) == -32768);
}

TEST_CASE("noise has the configured deviation and is drawn only where there is some", "[device]") {
  random_stream rng(2);
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < 10'000; ++i) {
    const auto x = value_of({quantity::light, constant_model{5}, 2, 1}, instant{}, rng) - 5;
    sum += x;
    squares += x * x;
  }
  CHECK(std::abs(sum / 10'000) < 0.1);
  CHECK(squares / 10'000 == Approx(4).epsilon(0.05));
  random_stream untouched(3);
  random_stream quiet(3);
  static_cast<void>(value_of({quantity::light, constant_model{5}, 0, 1}, instant{}, quiet));
  CHECK(quiet.next() == untouched.next());
}

TEST_CASE("quantities and actuators have names", "[device]") {
  CHECK(to_string(quantity::temperature) == "temperature");
  CHECK(to_string(quantity::sound) == "sound");
  CHECK(to_string(actuator_kind::dimmer) == "dimmer");
  CHECK(to_string(actuator_kind::level) == "level");
}

TEST_CASE("a random walk is a function of the seed, the quantity and the time",
          "[device][STR-21]") {
  const random_walk_model walk{20, 0.5, 0, 40};
  const auto at = [&](std::uint64_t seed, duration t) { return value_at(walk, t, {{}, seed}); };
  CHECK(at(7, 0s) == 20);
  CHECK(at(7, 1h) == Approx(29.512227081933844).epsilon(1e-12));
  CHECK(at(7, 24h) == Approx(28.986152349516999).epsilon(1e-12));
  CHECK(at(8, 1h) == Approx(14.083075823986109).epsilon(1e-12));
  random_stream rng(1);
  CHECK(value_of({quantity::light, walk, 0, 1}, instant{1h}, rng, {{}, 7}) != at(7, 1h));
  CHECK(rng.next() == random_stream(1).next());
  // Within a few milliseconds it moves a little, and without a step not at all.
  CHECK(std::abs(at(7, 1h + 5ms) - at(7, 1h)) < 0.5);
  CHECK(at(7, 1h + 5ms) != at(7, 1h));
  CHECK(value_at(random_walk_model{20, 0, 0, 40}, 5h, {{}, 7}) == 20);
}

TEST_CASE("the changes of a random walk have the variance of their length", "[device][STR-21]") {
  const auto length = GENERATE(duration(100ms), duration(1s), duration(7s), duration(1h));
  double sum = 0;
  double squares = 0;
  constexpr int count = 2000;
  for (int i = 0; i < count; ++i) {
    const auto change = brownian(11, length * (i + 1)) - brownian(11, length * i);
    sum += change;
    squares += change * change;
  }
  CHECK(squares / count == Approx(seconds(length)).epsilon(0.15));
  CHECK(std::abs(sum / count) < 5 * std::sqrt(seconds(length) / count));
}

TEST_CASE("a random walk that is drawn anew goes on from where it was", "[device][STR-21]") {
  constexpr auto since = 100s;
  const auto before = brownian(11, 99s);
  const auto then = brownian(11, since);
  const auto later = brownian(11, 200s);
  const reseeding anew({instant(since), 1});
  CHECK(brownian(11, 99s) == before);
  CHECK(brownian(11, since) == then);
  CHECK(std::abs(brownian(11, since + 1ms) - then) < 0.5); // 15 sigma
  CHECK(brownian(11, 200s) != later);
  double squares = 0;
  constexpr int count = 2000;
  for (int i = 0; i < count; ++i) {
    const auto change = brownian(11, since + 10s * (i + 1)) - brownian(11, since + 10s * i);
    squares += change * change;
  }
  CHECK(squares / count == Approx(10).epsilon(0.15));
}

TEST_CASE("a random walk stays within its bounds and reaches them", "[device][STR-21]") {
  const random_walk_model walk{20, 3, 15, 25};
  double least = 100;
  double most = -100;
  for (int i = 0; i < 2000; ++i) {
    const auto x = value_at(walk, i * 10s, {{}, 5});
    least = std::min(least, x);
    most = std::max(most, x);
  }
  CHECK(least >= 15);
  CHECK(most <= 25);
  CHECK(least < 15.2);
  CHECK(most > 24.8);
  CHECK(reflected(14, 15, 25) == 16);
  CHECK(reflected(26, 15, 25) == 24);
  CHECK(reflected(36, 15, 25) == 16);
  CHECK(reflected(15, 15, 25) == 15);
  CHECK(reflected(25, 15, 25) == 25);
  CHECK(reflected(-1e15, 15, 25) >= 15);
  CHECK(brownian(1, duration::max()) == brownian(1, random_walk_end));
}

TEST_CASE("a field has a base, a gradient and sources", "[device][STR-21]") {
  const field_model plain{18, {0.5, -0.25, 2}, {}};
  CHECK(value_at(plain, 5min) == 18);
  CHECK(value_at(plain, 5min, {{10, 4, 1}, 0}) == 24);
  const field_model two{
      10,
      {},
      {{{0, 0, 0}, 4, 1, falloff::disk, {}, {}}, {{3, 4, 0}, 8, 5, falloff::linear, {}, {}}}};
  CHECK(value_at(two, 0s) == 14);
  CHECK(value_at(two, 0s, {{3, 4, 0}, 0}) == 18);
  CHECK(value_at(two, 0s, {{3, 4, 2.5}, 0}) == 14);
}

TEST_CASE("what a source adds becomes less with the distance from it", "[device][STR-21]") {
  const auto of = [](falloff shape) { return field_source{{1, 0, 0}, 8, 2, shape, {}, {}}; };
  for (const auto shape :
       {falloff::inverse_square, falloff::gaussian, falloff::linear, falloff::disk})
    CHECK(value_at(of(shape), 1) == 8);
  CHECK(value_at(of(falloff::inverse_square), 3) == 4);
  CHECK(value_at(of(falloff::inverse_square), 5) == Approx(1.6));
  CHECK(value_at(of(falloff::gaussian), 3) == Approx(8 * 0.60653065971263342));
  CHECK(value_at(of(falloff::linear), 2) == 4);
  CHECK(value_at(of(falloff::linear), 3) == 0);
  CHECK(value_at(of(falloff::linear), -9) == 0);
  CHECK(value_at(of(falloff::disk), 3) == 8);
  CHECK(value_at(of(falloff::disk), 3.01) == 0);
}

TEST_CASE("a source follows its schedule", "[device][STR-21]") {
  field_source lamp{{}, 100, 1, falloff::disk, {{10s, 0}, {20s, 1}, {30s, 0.5}}, 0s};
  CHECK(value_at(lamp, 0) == 0);
  CHECK(value_at(lamp, 0, 15s) == 50);
  CHECK(value_at(lamp, 0, 25s) == 75);
  CHECK(value_at(lamp, 0, 1h) == 50);
  lamp.period = 40s;
  CHECK(value_at(lamp, 0, 35s) == 50);
  CHECK(value_at(lamp, 0, 40s) == 0);
  CHECK(value_at(lamp, 0, 400s + 15s) == 50);
}

TEST_CASE("a trace holds its readings or draws straight lines between them", "[device][STR-21]") {
  auto model = trace_of({{-5s, 1}, {5s, 2}, {15s, 4}}, 25s);
  CHECK(value_at(model, 0s) == 1);
  CHECK(value_at(model, 4999ms) == 1);
  CHECK(value_at(model, 5s) == 2);
  CHECK(value_at(model, 14s) == 2);
  CHECK(value_at(model, 1h) == 4);
  model.straight = true;
  CHECK(value_at(model, 0s) == 1.5);
  CHECK(value_at(model, 5s) == 2);
  CHECK(value_at(model, 10s) == 3);
  CHECK(value_at(model, 1h) == 4);
  model.scale = -2;
  model.offset = 10;
  CHECK(value_at(model, 10s) == 4);
}

TEST_CASE("a trace begins again when it is to repeat", "[device][STR-21]") {
  auto model = trace_of({{2s, 1}, {4s, 2}}, 6s);
  CHECK(value_at(model, 6s) == 2);
  model.repeats = true;
  CHECK(value_at(model, 5999ms) == 2);
  CHECK(value_at(model, 6s) == 1);
  CHECK(value_at(model, 60s + 4s) == 2);
  auto single = trace_of({{0s, 5}}, 0s);
  single.repeats = true;
  CHECK(value_at(single, 1h) == 5);
}
