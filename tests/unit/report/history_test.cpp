#include <cmath>
#include <limits>

#include "report/event_log.hpp"
#include "report/history.hpp"
#include "report/print/csv.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::report;

namespace {

constexpr mote_address logged_fan{island_id{1}, mote_id{7}};

config::ecology_description kitchen_ecology() {
  config::island_description island;
  island.id = logged_fan.island;
  island.name = "kit\"chen";
  config::mote_description mote;
  mote.id = logged_fan.mote;
  mote.name = "fan";
  island.motes = {mote};
  config::ecology_description x;
  x.islands = {island};
  return x;
}

logged_event line_at(duration at) {
  return {instant{at}, "kitchen/fan", "line"};
}

/// A mote that lives, with a battery of 2500 mAh.
mote_sample used(const mote_address& who, double mah) {
  mote_sample x;
  x.address = who;
  x.alive = true;
  x.used_mah = mah;
  x.battery_mah = 2500;
  return x;
}

} // namespace

TEST_CASE("fields of CSV are quoted where they must be", "[report][csv]") {
  CHECK(csv_field("plain text") == "plain text");
  CHECK(csv_field("a,b") == "\"a,b\"");
  CHECK(csv_field("say \"on\"") == "\"say \"\"on\"\"\"");
  CHECK(csv_field("a\nb") == "\"a\nb\"");
  CHECK(csv_field("a\rb") == "\"a\rb\"");
  CHECK(csv_field("").empty());
  CHECK(csv_line({"a", "", "b,c"}) == "a,,\"b,c\"\n");
}

TEST_CASE("samples become rows, a thing each", "[report][csv]") {
  const csv_tables tables(kitchen_ecology());
  run_sample x;
  x.at = instant{12500ms};
  auto with_route = used(logged_fan, 1.25);
  with_route.parent = default_sink;
  with_route.hops = 1;
  with_route.signal_dbm = -71;
  with_route.etx = 1.5;
  auto at_a_cable = used({logged_fan.island, mote_id{8}}, 0.5);
  at_a_cable.alive = false;
  at_a_cable.battery_mah = std::numeric_limits<double>::infinity();
  x.motes = {with_route, at_a_cable};
  x.islands = {
      {logged_fan.island, {{"mac", {{"no_ack", 2}}}, {"radio", {{"collision", 3}, {"weak", 0}}}}}};
  CHECK(tables.energy(x) == "12.5,\"kit\"\"chen\",fan,1,1.25,99.95\n"
                            "12.5,\"kit\"\"chen\",8,0,0.5,100\n");
  CHECK(tables.links(x) == "12.5,\"kit\"\"chen\",fan,sink,1,-71,1.5\n"
                           "12.5,\"kit\"\"chen\",8,,,,\n");
  CHECK(tables.losses(x) == "12.5,\"kit\"\"chen\",mac,no_ack,2\n"
                            "12.5,\"kit\"\"chen\",radio,collision,3\n"
                            "12.5,\"kit\"\"chen\",radio,weak,0\n");
  CHECK(csv_tables::row(tuple_write{instant{1s}, "robot", "care-pc", "a.b", "x,y", false}) ==
        "1,robot,care-pc,a.b,\"x,y\",0\n");
  CHECK(csv_tables::row(logged_event{instant{1ms}, "kitchen/fan", "left: battery"}) ==
        "0.001,kitchen/fan,left: battery\n");
}

TEST_CASE("every table has a header with as many fields as its rows", "[report][csv]") {
  const auto commas = [](const std::string& line) {
    return std::count(line.begin(), line.end(), ',');
  };
  config::ecology_description plain = kitchen_ecology();
  plain.islands[0].name = "kitchen";
  const csv_tables tables(plain);
  run_sample x;
  x.motes.emplace_back().address = logged_fan;
  x.islands = {{logged_fan.island, {{"mac", {{"no_ack", 2}}}}}};
  using kind = csv_tables::kind;
  CHECK(commas(csv_tables::header(kind::energy)) == commas(tables.energy(x)));
  CHECK(commas(csv_tables::header(kind::links)) == commas(tables.links(x)));
  CHECK(commas(csv_tables::header(kind::losses)) == commas(tables.losses(x)));
  CHECK(commas(csv_tables::header(kind::tuples)) == commas(csv_tables::row(tuple_write{})));
  CHECK(commas(csv_tables::header(kind::events)) == commas(csv_tables::row(logged_event{})));
}

TEST_CASE("of an event log that is too long the most crowded lines go", "[report]") {
  std::vector<logged_event> log;
  std::uint64_t left_out = 0;
  for (int i = 0; i < 1000; ++i) // a thousand in a second, then one a minute
    add_event(log, left_out, line_at(i * 1ms), 20);
  for (int i = 1; i <= 15; ++i)
    add_event(log, left_out, line_at(i * 1min), 20);
  CHECK(log.size() == 20);
  CHECK(left_out == 995);
  CHECK(log.front().at == instant{});
  CHECK(log.back().at == instant{15min});
  for (int i = 1; i <= 15; ++i)
    CHECK(std::ranges::find(log, instant{i * 1min}, &logged_event::at) != log.end());
  CHECK(std::ranges::is_sorted(log, {}, &logged_event::at));
}

TEST_CASE("an event log that is not too long stays whole", "[report]") {
  std::vector<logged_event> log;
  for (int i = 0; i < 20; ++i)
    log.push_back(line_at(1s));
  CHECK(thin(log, 20) == 0);
  CHECK(log.size() == 20);
  log.push_back(line_at(2s));
  CHECK(thin(log, 20) == 1);
  CHECK(log.back().at == instant{2s});
}

TEST_CASE("curves keep a bounded number of points, spread over all", "[report]") {
  thinned_series x;
  for (int i = 0; i < 100'000; ++i)
    x.add(instant{i * 1s}, i % 1000);
  const auto points = x.points();
  CHECK(x.count() == 100'000);
  CHECK(x.least() == 0);
  CHECK(x.most() == 999);
  CHECK(points.size() <= thinned_series::points_max + 1);
  CHECK(points.size() > thinned_series::points_max / 3);
  CHECK(points.front().at == instant{});
  CHECK(points.back().at == instant{99'999s});
  CHECK(points.back().value == 999);
  for (std::size_t i = 1; i < points.size(); ++i)
    CHECK(points[i - 1].at < points[i].at);
}

TEST_CASE("a history of samples is bounded, and those who come late or go are in it", "[report]") {
  history x;
  for (int i = 1; i <= 1000; ++i) {
    run_sample sample;
    sample.at = instant{i * 1s};
    if (i <= 500)
      sample.motes.push_back(used(logged_fan, 1.0 * i));
    sample.islands = {{logged_fan.island, {{"mac", {{"no_ack", static_cast<std::uint64_t>(i)}}}}},
                      {island_id{2}, {{"mac", {{"no_ack", static_cast<std::uint64_t>(i)}}}}}};
    if (i > 100)
      sample.motes.push_back(used({logged_fan.island, mote_id{9}}, 2.0 * i));
    x.add(sample);
  }
  CHECK(x.times().size() < history::samples_max);
  CHECK(x.times().size() > history::samples_max / 3);
  for (const auto& [mote, used] : x.used_mah())
    CHECK(used.size() == x.times().size());
  CHECK(x.used_mah().at(logged_fan).back() == Approx(500).epsilon(0.05));
  CHECK(x.used_mah().at({logged_fan.island, mote_id{9}}).front() == 0);
  CHECK(x.newest()->at == instant{1000s});
  const auto& lost = x.lost().at({"mac", "no_ack"});
  REQUIRE(lost.size() == x.times().size());
  for (std::size_t i = 0; i < lost.size(); ++i)
    CHECK(lost[i] == Approx(2 * seconds(x.times()[i].time_since_epoch())));
}

TEST_CASE("numbers are found in values of tuples", "[report]") {
  CHECK(number_of("22.3") == 22.3);
  CHECK(number_of("22.3 C") == 22.3);
  CHECK(number_of("-4") == -4);
  CHECK(number_of("on") == 1);
  CHECK(number_of("off") == 0);
  CHECK_FALSE(number_of("22.3C"));
  CHECK_FALSE(number_of("milk"));
  CHECK_FALSE(number_of(""));
  CHECK_FALSE(number_of("nan"));
  CHECK_FALSE(number_of("0x12ff"));
}
