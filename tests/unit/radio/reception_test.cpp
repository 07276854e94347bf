#include <cmath>
#include <limits>

#include "radio/medium/power.hpp"
#include "radio/medium/reception.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

/// The standard's sum, with libm and long double.
long double standard_bit_error_rate(double sinr) {
  long double sum = 0;
  long double choose = 16;
  for (int k = 2; k <= 16; ++k) {
    choose = choose * (17 - k) / k;
    sum += (k % 2 == 0 ? 1 : -1) * choose * std::exp(20.0L * sinr * (1.0L / k - 1));
  }
  return sum * 8 / 15 / 16;
}

double survival(const error_model& model, double snr_db, double bits) {
  return std::exp(-model.damage(from_db(snr_db)) * model.weight(bits, bits, false));
}

} // namespace

TEST_CASE("bit errors follow the standard's formula", "[radio][reception]") {
  CHECK(bit_error_rate(0) == Approx(0.5));
  CHECK(bit_error_rate(std::numeric_limits<double>::infinity()) == 0);
  CHECK(bit_error_rate(1) == Approx(1.615266879e-04));
  for (double db = -40; db < 10; db += 0.1) {
    const auto exact = static_cast<double>(standard_bit_error_rate(from_db(db)));
    CHECK(std::abs(bit_error_rate(from_db(db)) - exact) <= 1e-9 * exact + 1e-12);
  }
}

TEST_CASE("frames survive as often as their bits do", "[radio][reception]") {
  const error_model model;
  double worst = 0;
  for (double db = -25; db < 12; db += 0.01) {
    const auto ok = 1 - static_cast<double>(standard_bit_error_rate(from_db(db)));
    for (const int octets : {1, 6, 11, 20, 26, 47, 80, 127, 133})
      worst = std::max(worst, std::abs(survival(model, db, 8 * octets) - std::pow(ok, 8 * octets)));
  }
  CHECK(worst < 1e-4);
}

TEST_CASE("damage never grows with the signal, and ends", "[radio][reception]") {
  for (const auto curve : {error_curve::oqpsk, error_curve::tossim}) {
    const error_model model(curve);
    auto last = model.damage(0);
    CHECK(last > 0.69);
    CHECK(last <= 1e4);
    for (double sinr = 0; sinr < 10; sinr += 0.001) {
      CHECK(model.damage(sinr) <= last);
      last = model.damage(sinr);
    }
    CHECK(model.damage(9) == 0);
    CHECK(model.damage(1e300) == 0);
    CHECK(model.damage(std::numeric_limits<double>::infinity()) == 0);
  }
  const error_model oqpsk;
  CHECK(oqpsk.damage(0) == Approx(std::log(2.0)));
  CHECK(oqpsk.damage(2.99) > 0); // the table ends where it may
  CHECK(oqpsk.damage(2.99) * 1016 < 1e-9);
  CHECK(error_model(error_curve::tossim).damage(8.49) < 1e-9);
}

TEST_CASE("TOSSIM's curve has the values it is known by", "[radio][reception]") {
  CHECK(tossim_reception_rate(4) == Approx(0.068).margin(0.0005)); // tinyos.md 7.2
  CHECK(tossim_reception_rate(4.5) == Approx(0.411).margin(0.0005));
  CHECK(tossim_reception_rate(5) == Approx(0.786).margin(0.0005));
  CHECK(tossim_reception_rate(5.5) == Approx(0.949).margin(0.0005));
  CHECK(tossim_reception_rate(6) == Approx(0.991).margin(0.0005));
  CHECK(tossim_reception_rate(7) == Approx(0.9999).margin(0.00005));
  CHECK(tossim_reception_rate(-50) == 0);
  CHECK(tossim_reception_rate(50) == 1);
  for (double db = -10; db < 12; db += 0.1) {
    const auto exact = std::pow(1 - 0.5 * std::erfc(0.9794 * (db - 2.3851) / std::sqrt(2.0)), 46);
    CHECK(std::abs(tossim_reception_rate(db) - exact) < 1e-12);
  }
}

TEST_CASE("TOSSIM draws twice for a frame of any length and once for an ack",
          "[radio][reception]") {
  const error_model model(error_curve::tossim);
  for (double db = -10; db < 12; db += 0.01) {
    const auto rate = tossim_reception_rate(db);
    CHECK(std::abs(survival(model, db, 100) - rate * rate) < 1e-4);
    CHECK(survival(model, db, 100) == survival(model, db, 1000));
    const auto ack = std::exp(-model.damage(from_db(db)) * model.weight(88, 88, true));
    CHECK(std::abs(ack - rate) < 1e-4);
  }
  CHECK(model.weight(25, 100, false) == 0.5);
  CHECK(error_model().weight(25, 100, false) == 25);
  CHECK(error_model().weight(25, 100, true) == 25);
}
