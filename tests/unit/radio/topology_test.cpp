#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/numbers/random.hpp"
#include "radio/medium/topology.hpp"
#include "radio/medium/tossim_files.hpp"
#include "radio/parameters.hpp"
#include "support/catch.hpp"
#include "unit/radio/samples.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::disk;
using test::mote;

namespace {

/// Adds a radio with the next id, from 1.
radio_index add(topology& x, position place, double transmit_dbm = 0) {
  return x.add({mote(static_cast<unsigned>(x.size()) + 1), place, transmit_dbm});
}

std::string names(const hearers& list) {
  std::string all;
  for (const auto& x : list)
    all += to_string(x.radio) + ' ';
  return all;
}

channel_config by_law(propagation law, double cutoff_dbm) {
  channel_config x;
  x.propagation = std::move(law);
  x.cutoff_dbm = cutoff_dbm;
  return x;
}

/// Radio 1 hears radio 0 at a distance.
hearer heard_at(double distance_m, const channel_config& config, double transmit_dbm = 0) {
  topology x(config, 1);
  const auto a = add(x, {0, 0, 0}, transmit_dbm);
  add(x, {0, distance_m, 0});
  REQUIRE(x.around(a)->size() == 1);
  return x.around(a)->front();
}

double dbm(const hearer& x) {
  return to_dbm(static_cast<power_units>(x.power));
}

std::vector<site> scattered(unsigned count, double side_m, std::uint64_t seed) {
  random_stream rng(seed);
  const auto at = [&] { return (rng.unit() - 0.5) * side_m; }; // negative places too
  std::vector<site> all;
  for (unsigned i = 0; i < count; ++i) {
    site x{mote(100 + i), {}, -static_cast<double>(rng.below(5))};
    x.place.x_m = at();
    x.place.y_m = at();
    x.place.z_m = at() / 4;
    all.push_back(x);
  }
  return all;
}

topology built(const channel_config& config, const std::vector<site>& sites) {
  topology x(config, 7);
  for (const auto& each : sites)
    static_cast<void>(x.add(each));
  return x;
}

/// Several laws that draw, prune and reach differently, some with overrides.
std::vector<channel_config> laws() {
  std::vector<channel_config> all{
      disk(25),
      disk(0.5),
      by_law(log_distance{3, 40, 0, 0}, -82),
      by_law(log_distance{3, 40, 4, 2}, -82),
      by_law(log_distance{2.5, 45, 0, 3}, -80),
      by_law(log_distance{4, 40, 6, 0}, -85),
      by_law(friis{2480}, -68),
  };
  auto overridden = by_law(log_distance{3, 40, 4, 2}, -80);
  auto disk_overridden = disk(20);
  for (auto* x : {&overridden, &disk_overridden}) {
    x->noise = constant_noise{-85};
    for (unsigned i = 0; i < 10; ++i) {
      x->links.push_back({mote(100 + i), mote(130 - i), {}, -60.0 - i});
      x->links.push_back({mote(110 + i), mote(110 - i * 7 % 10), 0.25, {}});
      x->links.push_back({mote(120 + i), mote(120 + (i + 1) % 10), 0.5, -200.0});
    }
    all.push_back(*x);
  }
  return all;
}

double distance_m(const position& a, const position& b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
}

/// All links by address, whatever the numbers of the radios.
std::map<std::pair<mote_address, mote_address>, hearer> by_address(const topology& x,
                                                                   const std::vector<site>& sites) {
  std::map<std::pair<mote_address, mote_address>, hearer> all;
  for (std::uint32_t i = 0; i < sites.size(); ++i) {
    for (auto each : *x.around(radio_index{i})) {
      const auto to = sites[each.radio.value].mote;
      each.radio = {};
      all[{sites[i].mote, to}] = each;
    }
  }
  return all;
}

channel_config matrix(std::string_view text) {
  channel_config x;
  x.propagation =
      gain_matrix{std::make_shared<gain_table>(std::get<gain_table>(read_topology(text))), 1};
  return x;
}

} // namespace

TEST_CASE("a radio is heard exactly within the range", "[radio][topology][NET-15]") {
  topology x(disk(30, 0.2), 1);
  const auto a = add(x, {0, 0, 0});
  const auto b = add(x, {30, 0, 0});
  const auto c = add(x, {30.001, 0, 0});
  const auto d = add(x, {0, 18, 24}); // 30 m away in space
  CHECK(names(*x.around(a)) == "1 3 ");
  CHECK(names(*x.around(b)) == "0 2 ");
  CHECK(names(*x.around(c)) == "1 ");
  CHECK(names(*x.around(d)) == "0 ");
  CHECK(x.around(a)->front().loss == 13107); // a fifth of 65535
  CHECK(x.size() == 4);
}

TEST_CASE("a unit disk knows neither power nor cutoff", "[radio][topology][NET-15]") {
  auto config = disk(30);
  config.cutoff_dbm = -50;
  topology x(config, 1);
  const auto a = add(x, {0, 0, 0}, -25);
  const auto b = add(x, {29, 0, 0}, 3);
  const auto c = add(x, {31, 0, 0}, 30);
  CHECK(names(*x.around(a)) == "1 ");
  CHECK(names(*x.around(b)) == "0 2 ");
  CHECK(names(*x.around(c)) == "1 ");
}

TEST_CASE("moving a radio renews its lists and its neighbours'", "[radio][topology]") {
  topology x(disk(30), 1);
  const auto a = add(x, {0, 0, 0});
  const auto b = add(x, {100, 0, 0});
  const auto c = add(x, {10, 0, 0});
  x.set_loss(a, b, 1);
  const auto before = x.around(a);
  x.move(b, {5, 0, 0});
  CHECK(names(*before) == "2 "); // whoever holds a list keeps it
  CHECK(names(*x.around(a)) == "1 2 ");
  CHECK(names(*x.around(b)) == "0 2 ");
  CHECK(names(*x.around(c)) == "0 1 ");
  CHECK(x.around(a)->front().loss == 65535); // said before they met
  CHECK(x.around(b)->front().loss == 0);     // one direction only
  x.move(b, {100, 0, 0});
  CHECK(names(*x.around(a)) == "2 ");
  CHECK(x.around(b)->empty());
}

TEST_CASE("whoever holds a list keeps it as it was", "[radio][topology]") {
  topology x(disk(30), 1);
  const auto a = add(x, {0, 0, 0});
  const auto b = add(x, {1, 0, 0});
  const auto list = x.around(a);
  const auto others = x.around(b);
  const auto copy = *list;
  const auto copies = *others;
  add(x, {2, 0, 0});
  x.set_loss(a, b, 0.5);
  x.move(b, {7, 0, 0});
  x.move(a, {500, 0, 0});
  CHECK(*list == copy);
  CHECK(*others == copies);
  const topology twin = x; // shares lists until one of the two changes them
  x.set_loss(b, radio_index{2}, 1);
  CHECK(twin.around(b)->front().loss == 0);
  CHECK(x.around(b)->front().loss == 65535);
}

TEST_CASE("signals weaken with distance as documented", "[radio][topology]") {
  const auto config = disk(2000);
  const auto rssi = [&](double d) { return int{heard_at(d, config).rssi_dbm}; };
  const auto lqi = [&](double d) { return int{heard_at(d, config).lqi}; };
  CHECK(rssi(0) == -40);
  CHECK(rssi(1) == -40);
  CHECK(rssi(10) == -70);
  CHECK(rssi(30) == -85); // -84.3 rounded down
  CHECK(rssi(50) == -91);
  CHECK(rssi(1000) == -100); // below what the chips report
  CHECK(lqi(10) == 110);
  CHECK(lqi(30) == 80);
  CHECK(lqi(50) == 62);
  CHECK(lqi(1000) == 50);
  for (double d = 1; d < 200; d += 2.5)
    CHECK(rssi(d + 2.5) <= rssi(d));
  CHECK(dbm(heard_at(30, config)) == Approx(-40 - 30 * std::log10(30)));
}

TEST_CASE("each law has its loss", "[radio][topology]") {
  CHECK(dbm(heard_at(20, by_law(log_distance{2.2, 46, 0, 0}, -115))) ==
        Approx(-46 - 22 * std::log10(20)));
  const auto free_space = by_law(friis{2480}, -115);
  CHECK(dbm(heard_at(1, free_space)) == Approx(-40.34).margin(0.005));
  CHECK(dbm(heard_at(100, free_space)) == Approx(-80.34).margin(0.005));
  CHECK(dbm(heard_at(0, free_space)) == Approx(0).margin(1e-6));
  CHECK(dbm(heard_at(0.001, free_space)) == Approx(0).margin(1e-6));
  CHECK(dbm(heard_at(100, free_space, -10)) == Approx(-90.34).margin(0.005));
}

TEST_CASE("a link is in reach down to the cutoff, each direction with its own power",
          "[radio][topology]") {
  topology x(by_law(log_distance{3, 40, 0, 0}, -70), 1);
  const auto strong = add(x, {0, 0, 0}, 3);
  const auto weak = add(x, {10.1, 0, 0}, -10);
  const auto usual = add(x, {10.1, 9.9, 0}, 0);
  CHECK(names(*x.around(strong)) == "1 "); // 12.6 m
  CHECK(names(*x.around(weak)).empty());   // 4.6 m
  CHECK(names(*x.around(usual)) == "1 ");  // 10 m
  x.move(usual, {10, 0, 0});
  CHECK(names(*x.around(usual)) == "0 1 "); // -70 dBm exactly
  x.move(usual, {10.001, 0, 0});
  CHECK(names(*x.around(usual)) == "1 ");
}

TEST_CASE("lists are the same as without a grid", "[radio][topology]") {
  const auto sites = scattered(120, 120, 1);
  for (const auto& config : laws()) {
    if (!config.links.empty())
      continue;
    auto everybody = config; // all in reach, and the cutoff taken afterwards
    everybody.cutoff_dbm = -1000;
    const auto* disk_law = std::get_if<unit_disk>(&config.propagation);
    if (disk_law != nullptr)
      everybody.propagation = unit_disk{10000};
    const auto x = built(config, sites);
    const auto all = built(everybody, sites);
    std::size_t links = 0;
    for (std::uint32_t i = 0; i < sites.size(); ++i) {
      REQUIRE(all.around(radio_index{i})->size() == sites.size() - 1);
      hearers expected;
      for (const auto& each : *all.around(radio_index{i})) {
        const auto d = distance_m(sites[i].place, sites[each.radio.value].place);
        if (disk_law != nullptr ? d <= disk_law->range_m : dbm(each) >= config.cutoff_dbm)
          expected.push_back(each);
      }
      CHECK(*x.around(radio_index{i}) == expected);
      links += expected.size();
    }
    CAPTURE(config.propagation.index(), config.cutoff_dbm);
    CHECK(links < sites.size() * (sites.size() - 1)); // some out of reach
    if (disk_law == nullptr || disk_law->range_m > 1)
      CHECK(links > 200);
  }
}

TEST_CASE("links depend on their two ends alone", "[radio][topology]") {
  const auto sites = scattered(40, 60, 2);
  for (const auto& config : laws()) {
    const auto all = by_address(built(config, sites), sites);
    std::map<std::pair<mote_address, mote_address>, hearer> pairs;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      for (std::size_t j = i + 1; j < sites.size(); ++j) {
        const std::vector<site> two{sites[j], sites[i]};
        pairs.merge(by_address(built(config, two), two));
      }
    }
    CHECK(all == pairs);
  }
}

TEST_CASE("the order of adding does not matter", "[radio][topology]") {
  auto sites = scattered(60, 80, 3);
  random_stream rng(4);
  for (const auto& config : laws()) {
    const auto once = by_address(built(config, sites), sites);
    for (std::size_t i = sites.size(); i > 1; --i)
      std::swap(sites[i - 1], sites[rng.below(i)]);
    CHECK(by_address(built(config, sites), sites) == once);
  }
}

TEST_CASE("radios that have moved are as if they had been there from the start",
          "[radio][topology]") {
  for (const auto& config : laws()) {
    auto sites = scattered(60, 80, 5);
    auto x = built(config, sites);
    random_stream rng(6);
    for (int step = 0; step < 100; ++step) {
      const auto i = rng.below(sites.size());
      auto& place = sites[i].place;
      const auto far = rng.chance(0.2) ? 100.0 : 4.0;
      place.x_m += (rng.unit() - 0.5) * far;
      place.y_m += (rng.unit() - 0.5) * far;
      x.move(radio_index{static_cast<std::uint32_t>(i)}, place);
    }
    const auto fresh = built(config, sites);
    for (std::uint32_t i = 0; i < sites.size(); ++i)
      CHECK(*x.around(radio_index{i}) == *fresh.around(radio_index{i}));
  }
}

TEST_CASE("stronger radios added later reach as far as they should", "[radio][topology]") {
  topology x(by_law(log_distance{3, 40, 0, 0}, -70), 1);
  for (int i = 0; i < 40; ++i)
    add(x, {5.0 * i, 0, 0}, -20 + i);
  for (std::uint32_t i = 0; i < 40; ++i) {
    std::string expected;
    for (std::uint32_t j = 0; j < 40; ++j) {
      const auto d = std::max(5.0 * std::abs(static_cast<double>(i) - j), 1.0);
      if (i != j && -20.0 + i - 40 - 30 * std::log10(d) >= -70)
        expected += std::to_string(j) + ' ';
    }
    CHECK(names(*x.around(radio_index{i})) == expected);
  }
}

TEST_CASE("places far out and far apart are no harm", "[radio][topology]") {
  for (const auto& config : {disk(30), by_law(log_distance{}, -90), by_law(friis{}, -90),
                             by_law(log_distance{0, 40, 0, 0}, -90)}) {
    topology x(config, 1);
    const auto a = add(x, {1e300, -1e300, 0});
    add(x, {0, 0, 0});
    const auto c = add(x, {1e300, -1e300, 5});
    CHECK(names(*x.around(a)) == "2 ");
    x.move(c, {-1e300, 1e9, 1e15});
    CHECK(x.around(a)->empty());
  }
}

TEST_CASE("shadowing has its deviations, cut off at three", "[radio][topology]") {
  constexpr unsigned count = 150;
  topology x(by_law(log_distance{3, 40, 4, 2}, -1000), 9);
  for (unsigned i = 0; i < count; ++i)
    add(x, {0, 0, 0}); // -40 dBm but for what is drawn
  std::vector<std::vector<double>> deviation(count, std::vector<double>(count, 0));
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const auto& each : *x.around(radio_index{i}))
      deviation[i][each.radio.value] = dbm(each) + 40;
  }
  double sum = 0;
  double square = 0;
  double both = 0;
  double neighbours = 0;
  double most = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint32_t j = 0; j < count; ++j) {
      if (i == j)
        continue;
      sum += deviation[i][j];
      square += deviation[i][j] * deviation[i][j];
      both += deviation[i][j] * deviation[j][i];
      neighbours += deviation[i][j] * deviation[i][(j + 1) % count];
      most = std::max(most, std::abs(deviation[i][j]));
    }
  }
  const double links = count * (count - 1);
  CHECK(std::abs(sum / links) < 0.15);
  CHECK(square / links == Approx(20).epsilon(0.05)); // 4^2 + 2^2, less some 3 % cut off
  CHECK(both / links == Approx(16).epsilon(0.06));   // what directions share
  CHECK(std::abs(neighbours / links) < 0.5);
  CHECK(most > 12); // more than each alone
  CHECK(most <= 18);
}

TEST_CASE("without asymmetry both directions are alike", "[radio][topology]") {
  topology x(by_law(log_distance{3, 40, 4, 0}, -1000), 9);
  const auto a = add(x, {0, 0, 0});
  const auto b = add(x, {3, 0, 0});
  CHECK(x.around(a)->front().power == x.around(b)->front().power);
}

TEST_CASE("another seed, other rng", "[radio][topology]") {
  const auto config = by_law(log_distance{3, 40, 4, 2}, -1000);
  topology one(config, 1);
  topology other(config, 2);
  for (auto* x : {&one, &other}) {
    add(*x, {0, 0, 0});
    add(*x, {3, 0, 0});
  }
  CHECK(one.around(radio_index{0})->front() != other.around(radio_index{0})->front());
}

TEST_CASE("links of a seed never change", "[radio][topology][GEN-07]") {
  topology x(by_law(log_distance{3, 40, 4, 2}, -1000), 1);
  const auto a = add(x, {0, 0, 0});
  const auto b = add(x, {20, 0, 0});
  CHECK(x.around(a)->front().power == 697109952.0F);
  CHECK(x.around(b)->front().power == 2130741504.0F);
}

TEST_CASE("a gain table gives each direction its gain", "[radio][topology][tossim]") {
  auto config = matrix("gain 0 1 -60\ngain 1 0 -70\ngain 1 2 -80\ngain 2 0 -116\ngain 5 0 -50\n");
  config.cutoff_dbm = -115;
  topology x(config, 1);
  const auto c = x.add({mote(3), {}, 0});
  const auto a = x.add({mote(1), {}, 0});
  const auto stranger = x.add({mote(77), {}, 0});
  const auto b = x.add({mote(2), {}, -5});
  CHECK(names(*x.around(a)) == "3 ");
  CHECK(names(*x.around(b)) == "0 1 ");
  CHECK(x.around(c)->empty()); // its only link is below the cutoff
  CHECK(x.around(stranger)->empty());
  CHECK(dbm(x.around(a)->front()) == Approx(-60));
  CHECK(dbm(x.around(b)->at(0)) == Approx(-85)); // sent with -5 dBm
  CHECK(dbm(x.around(b)->at(1)) == Approx(-75));
  const auto before = x.around(b);
  x.move(b, {1000, 0, 0}); // places mean nothing
  CHECK(*x.around(b) == *before);
}

TEST_CASE("the first mote of a gain table can be chosen", "[radio][topology][tossim]") {
  auto config = matrix("gain 0 1 -60\n");
  std::get<gain_matrix>(config.propagation).first_mote = 10;
  topology x(config, 1);
  const auto before = x.add({mote(9), {}, 0});
  const auto a = x.add({mote(10), {}, 0});
  const auto b = x.add({mote(11), {}, 0});
  CHECK(x.around(before)->empty());
  CHECK(names(*x.around(a)) == "2 ");
  CHECK(x.around(b)->empty());
}

TEST_CASE("a gain above all is 0 dBm received, so that sums fit", "[radio][topology][tossim]") {
  topology x(matrix("gain 0 1 50\n"), 1);
  const auto a = x.add({mote(1), {}, 20});
  static_cast<void>(x.add({mote(2), {}, 0}));
  CHECK(dbm(x.around(a)->front()) == Approx(0).margin(1e-6));
  CHECK(x.around(a)->front().rssi_dbm == 0);
}

TEST_CASE("a link's own loss and gain take precedence", "[radio][topology]") {
  auto config = disk(30, 0.2);
  config.links = {
      {mote(1), mote(2), 1.0, {}},  {mote(2), mote(1), {}, -90.0}, {mote(1), mote(3), {}, -80.0},
      {mote(3), mote(2), 0.0, -50}, {mote(2), mote(3), {}, -116},  {mote(3), mote(1), 0.4, {}},
  };
  topology x(config, 1);
  const auto a = add(x, {0, 0, 0});
  const auto b = add(x, {10, 0, 0}, -3);
  const auto c = add(x, {35, 0, 0}); // b hears c, a does not
  REQUIRE(names(*x.around(a)) == "1 2 ");
  REQUIRE(names(*x.around(b)) == "0 "); // its gain to c is below the cutoff
  REQUIRE(names(*x.around(c)) == "1 "); // a loss alone makes no link
  CHECK(x.around(a)->at(0).loss == 65535);
  CHECK(x.around(a)->at(0).rssi_dbm == -70);
  CHECK(x.around(a)->at(1).loss == 13107);
  CHECK(x.around(a)->at(1).rssi_dbm == -80);
  CHECK(x.around(b)->at(0).rssi_dbm == -93);
  CHECK(x.around(c)->at(0).loss == 0);
  CHECK(x.around(c)->at(0).rssi_dbm == -50);
  x.move(c, {5000, 0, 0});
  CHECK(names(*x.around(a)) == "1 2 ");
  CHECK(names(*x.around(c)) == "1 ");
  x.set_loss(a, b, 0); // said later than the file
  CHECK(x.around(a)->at(0).loss == 0);
}

TEST_CASE("of two overrides for a link the later one counts", "[radio][topology]") {
  auto config = disk(30);
  config.links = {{mote(1), mote(2), 0.4, -60.0}, {mote(1), mote(2), {}, -65.0}};
  topology x(config, 1);
  const auto a = add(x, {0, 0, 0});
  add(x, {10, 0, 0});
  CHECK(x.around(a)->front().loss == 26214);
  CHECK(x.around(a)->front().rssi_dbm == -65);
}

TEST_CASE("overrides hold for gain tables, too", "[radio][topology][tossim]") {
  auto config = matrix("gain 0 1 -60\ngain 1 0 -70\n");
  config.links = {{mote(1), mote(2), {}, -200.0}, {mote(2), mote(9), 0.2, -55.0}};
  topology x(config, 1);
  const auto a = x.add({mote(1), {}, 0});
  const auto b = x.add({mote(2), {}, 0});
  static_cast<void>(x.add({mote(9), {}, 0}));
  CHECK(x.around(a)->empty());
  CHECK(names(*x.around(b)) == "0 2 ");
  CHECK(x.around(b)->at(1).loss == 13107);
}

TEST_CASE("a loss is kept to a 65535th", "[radio][topology]") {
  topology x(disk(30), 1);
  const auto a = add(x, {0, 0, 0});
  const auto b = add(x, {10, 0, 0});
  for (const double loss : {0.0, 1.0, 0.5, 0.123456, 1e-9}) {
    x.set_loss(a, b, loss);
    CHECK(std::abs(x.around(a)->front().loss / 65535.0 - loss) <= 0.5 / 65535);
    CHECK(x.around(b)->front().loss == 0);
  }
}

TEST_CASE("constant noise tells the damage of a signal alone", "[radio][topology]") {
  for (const auto curve : {error_curve::oqpsk, error_curve::tossim}) {
    auto config = disk(100);
    config.curve = curve;
    CHECK(heard_at(70, config).clean_damage == 0);
    config.noise = constant_noise{-95};
    const auto x = heard_at(70, config); // -95.35 dBm
    const auto sinr = static_cast<double>(x.power) / static_cast<double>(to_units(-95));
    CHECK(x.clean_damage == Approx(error_model(curve).damage(sinr)));
    CHECK(x.clean_damage > 0);
    CHECK(heard_at(10, config).clean_damage == 0);
    config.noise = traced_noise{};
    CHECK(heard_at(70, config).clean_damage == 0);
  }
}

TEST_CASE("noise is what the description says", "[radio][topology][tossim]") {
  const auto noise = [](const channel_config& config, unsigned id) {
    topology x(config, 1);
    return x.noise(x.add({mote(id), {}, 0}));
  };
  auto config = disk(30);
  CHECK(noise(config, 1) == 0);
  config.noise = constant_noise{};
  CHECK(noise(config, 1) == to_units(-98));
  config.noise = constant_noise{50};
  CHECK(noise(config, 1) == to_units(30)); // the most there is
  config.noise = traced_noise{};
  CHECK(noise(config, 1) == 0);
  config = matrix("gain 0 1 -60\nnoise 1 -101.5 3\nnoise 4 -90 3\n");
  config.noise = table_noise{};
  CHECK(noise(config, 1) == 0); // the table gives none
  CHECK(noise(config, 2) == to_units(-101.5));
  CHECK(noise(config, 5) == to_units(-90));
  CHECK(noise(config, 6) == 0);
  config.noise = no_noise{};
  CHECK(noise(config, 2) == 0);
}

TEST_CASE("each end's own noise decides its damage", "[radio][topology][tossim]") {
  auto config = matrix("gain 0 1 -90\ngain 1 0 -90\nnoise 0 -90 1\nnoise 1 -105 1\n");
  config.noise = table_noise{};
  topology x(config, 1);
  const auto a = x.add({mote(1), {}, 0});
  const auto b = x.add({mote(2), {}, 0});
  CHECK(x.around(a)->front().clean_damage == 0);
  CHECK(x.around(b)->front().clean_damage == Approx(error_model().damage(1)).epsilon(1e-4));
}

TEST_CASE("a default topology is a unit disk of 30 m", "[radio][topology]") {
  topology x;
  CHECK(x.size() == 0);
  const auto a = add(x, {0, 0, 0});
  add(x, {30, 0, 0});
  add(x, {0, 31, 0});
  CHECK(names(*x.around(a)) == "1 ");
}

TEST_CASE("the three platforms are known by name", "[radio][platform]") {
  for (const auto& x : platforms()) {
    CHECK(find_platform(x.name) == &x);
    CHECK(x.mcu_active_ma > x.mcu_sleep_ma);
    CHECK(x.radio_listen_ma > x.radio_off_ma);
    for (const auto& level : x.transmit)
      CHECK(level.current_ma > x.radio_off_ma);
    CHECK(x.receive_slots == 3);
    CHECK(x.service_time >= 1ms);
    CHECK(x.service_time <= 3ms);
  }
  CHECK(find_platform("micaz")->serial_baud == 57600);
  CHECK(find_platform("iris")->serial_baud == 57600);
  CHECK(find_platform("telosb")->serial_baud == 115200);
  CHECK(find_platform("telosb")->mcu_active_ma == 1.8);
  CHECK(find_platform("iris")->transmit.back().current_ma == 16.5);
  CHECK(find_platform("mica2") == nullptr);
  CHECK(find_platform("") == nullptr);
}

TEST_CASE("a link may change while frames are on the air", "[radio][topology][ACT-10]") {
  topology x(disk(30), 1);
  const auto a = add(x, {0, 0, 0});
  const auto b = add(x, {10, 0, 0});
  const auto c = add(x, {500, 0, 0});
  const auto before = x.around(a);
  x.change({mote(1), mote(2), 0.4, {}});
  CHECK(before->front().loss == 0); // whoever holds a list keeps it
  CHECK(x.around(a)->front().loss == 26214);
  CHECK(x.around(b)->front().loss == 0);    // one direction only
  x.change({mote(1), mote(3), 0.2, -60.0}); // it was out of reach
  CHECK(names(*x.around(a)) == "1 2 ");
  CHECK(x.around(a)->at(1).rssi_dbm == -60);
  CHECK(x.around(a)->at(1).loss == 13107);
  CHECK(x.around(c)->empty());
  x.change({mote(1), mote(3), 1.0, {}}); // its gain stays
  CHECK(x.around(a)->at(1).rssi_dbm == -60);
  CHECK(x.around(a)->at(1).loss == 65535);
  x.move(a, {501, 0, 0});
  CHECK(names(*x.around(a)) == "2 ");
  CHECK(x.around(a)->front().rssi_dbm == -60);
  x.change({mote(1), mote(3), {}, -200.0});
  CHECK(x.around(a)->empty());
  add(x, {5, 0, 0}); // radios that come later have given gains too
  x.change({mote(4), mote(2), {}, -50.0});
  CHECK(x.around(radio_index{3})->front().rssi_dbm == -50);
  x.change({mote(9), mote(2), 0.5, {}}); // nobody's
}
