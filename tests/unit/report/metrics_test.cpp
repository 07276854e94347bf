#include <map>
#include <set>
#include <sstream>
#include <string>

#include "report/print/exposition.hpp"
#include "report/print/metrics.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::report;
using namespace std::chrono_literals;

namespace {

run_report two_islands() {
  run_report x;
  x.ecology = "home";
  x.mode = "wall";
  x.seed = 7;
  x.simulated = 90s;
  for (const auto* name : {"kitchen", "living \"room\"\\\n"}) {
    island_report island;
    island.name = name;
    island.radio.acks = 12;
    island.radio.lost["collision"] = 3;
    island.serial.octets_up = 512;
    island.serial.lost["crc"] = 2;
    island.serial.lost["crc_octets"] = 40;
    island.messages.in_transit = 1;
    island.clock.error_max = 1500us;
    mote_report mote;
    mote.name = "climate-7";
    mote.joined = mote.alive = true;
    mote.energy.used_mah = 10;
    mote.energy.battery_mah = 40;
    mote.energy.radio_listen = 2s;
    island.motes.push_back(mote);
    x.islands.push_back(std::move(island));
  }
  stream_report stream;
  stream.stream = 3;
  stream.read = 5;
  x.streams.push_back(stream);
  return x;
}

} // namespace

TEST_CASE("metrics are named by their fields, with units at the end", "[report]") {
  const auto text = to_metrics(two_islands());
  for (const auto* line : {
           "rubicon_run_info{ecology=\"home\",mode=\"wall\",seed=\"7\"} 1\n",
           "rubicon_run_simulated_seconds_total 90\n",
           "# TYPE rubicon_radio_acks_total counter\n",
           "rubicon_radio_acks_total{island=\"kitchen\"} 12\n",
           "rubicon_radio_lost_total{island=\"kitchen\",cause=\"collision\"} 3\n",
           "rubicon_serial_up_bytes_total{island=\"kitchen\"} 512\n",
           "rubicon_serial_lost_total{island=\"kitchen\",cause=\"crc\"} 2\n",
           "rubicon_serial_lost_bytes_total{island=\"kitchen\",cause=\"crc\"} 40\n",
           "# TYPE rubicon_messages_in_transit gauge\n",
           "rubicon_messages_in_transit{island=\"kitchen\"} 1\n",
           "rubicon_clock_error_max_seconds{island=\"kitchen\"} 0.0015\n",
           "rubicon_energy_used_coulombs_total{island=\"kitchen\"} 36\n",
           "rubicon_energy_radio_listen_seconds_total{island=\"kitchen\"} 2\n",
           "rubicon_battery_left_min_ratio{island=\"kitchen\"} 0.75\n",
           "rubicon_motes{island=\"kitchen\",state=\"listed\"} 1\n",
           "rubicon_stream_read_total{number=\"3\",from=\"\",to=\"\"} 5\n",
       }) {
    CAPTURE(line);
    CHECK(text.find(line) != std::string::npos);
  }
  CHECK(text.find("mote=\"climate-7\"") == std::string::npos);
  CHECK(to_metrics(two_islands(), {.motes = true}).find("mote=\"climate-7\"") != std::string::npos);
}

TEST_CASE("metrics say when they were collected, and what that cost", "[report]") {
  CHECK(to_metrics(collection{1'764'431'999'250'000, 338ms}) ==
        "# HELP rubicon_report_timestamp_seconds When the report was collected that these figures "
        "are from, in Unix time\n"
        "# TYPE rubicon_report_timestamp_seconds gauge\n"
        "rubicon_report_timestamp_seconds 1764431999.25\n"
        "# HELP rubicon_report_duration_seconds How long the run was busy with that report\n"
        "# TYPE rubicon_report_duration_seconds gauge\n"
        "rubicon_report_duration_seconds 0.338\n");
  CHECK(to_metrics(collection{1'764'431'999'250'000}).find("duration") == std::string::npos);
}

TEST_CASE("names with quotes, backslashes and newlines stay within their label", "[report]") {
  const auto text = to_metrics(two_islands());
  CHECK(text.find("rubicon_radio_acks_total{island=\"living \\\"room\\\"\\\\\\\\n\"} 12\n") !=
        std::string::npos);
}

TEST_CASE("each family has one help, one type, and its samples together", "[report]") {
  std::istringstream text(to_metrics(two_islands(), {.motes = true}));
  std::set<std::string> seen;
  std::string family;
  std::map<std::string, int> samples;
  for (std::string line; std::getline(text, line);) {
    CAPTURE(line);
    if (line.starts_with("# HELP ")) {
      family = line.substr(7, line.find(' ', 7) - 7);
      CHECK(seen.insert(family).second);
    } else if (line.starts_with("# TYPE ")) {
      CHECK(line.substr(7, family.size() + 1) == family + ' ');
      CHECK(line.ends_with(family.ends_with("_total") ? " counter" : " gauge"));
    } else {
      CHECK(line.substr(0, line.find_first_of("{ ")) == family);
      CHECK(++samples[line.substr(0, line.rfind(' '))] == 1); // no sample twice
    }
  }
  CHECK(seen.size() > 100);
}

TEST_CASE("numbers that are none are written as the format has them", "[report]") {
  exposition out;
  out.add("x", metric_kind::gauge, "two\nlines", {}, 0.0 / 0.0 * -1);
  out.add("y", metric_kind::gauge, "", {}, 1.0 / 0.0);
  const auto text = out.finish();
  CHECK(text == "# HELP x two\\nlines\n# TYPE x gauge\nx NaN\n# HELP y \n# TYPE y gauge\ny +Inf\n");
}
