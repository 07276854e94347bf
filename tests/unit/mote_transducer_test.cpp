#include "mote/transducer.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::mote;

namespace {

double value_at(const transducer_model& model, duration t) {
  random_stream dice(1);
  return value_of({quantity::temperature, model, 0, 0.1}, instant{t}, dice);
}

} // namespace

TEST_CASE("transducer models give the value of their time", "[mote][STR-21]") {
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

TEST_CASE("a reading is a rounded count within 16 bits", "[mote]") {
  random_stream dice(1);
  const auto count = [&](double value) {
    return sample({quantity::light, constant_model{value}, 0, 0.5}, instant{}, dice);
  };
  CHECK(count(10) == 20);
  CHECK(count(10.24) == 20);
  CHECK(count(10.26) == 21);
  CHECK(count(-10.26) == -21);
  CHECK(count(1e9) == 32767);
  CHECK(count(-1e9) == -32768);
}

TEST_CASE("noise has the configured deviation and is drawn only where there is some", "[mote]") {
  random_stream dice(2);
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < 10'000; ++i) {
    const auto x = value_of({quantity::light, constant_model{5}, 2, 1}, instant{}, dice) - 5;
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

TEST_CASE("quantities and actuators have names", "[mote]") {
  CHECK(to_string(quantity::temperature) == "temperature");
  CHECK(to_string(quantity::sound) == "sound");
  CHECK(to_string(actuator_kind::dimmer) == "dimmer");
}
