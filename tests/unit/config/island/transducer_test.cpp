#include <map>
#include <string>

#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// Files that exist only here.
const std::map<std::string, std::string> trace_files{
    {"lab/room.csv", "time,light,temperature\n0,100,20\n60,200,21\n"},
    {"lab/data.txt", "2004-02-28 00:59:16 3 2 19.9 37 45 2.7\n"
                     "2004-02-28 01:00:16 11 3 19.3 38 4000 2.7\n"
                     "2004-02-28 01:00:17 11 3\n"},
    {"lab/broken.csv", "time,light\n0,100\n60,dark\n"},
};

int files_read = 0;

file_text count_and_read(const std::string& path, std::size_t /*octets_max*/) {
  ++files_read;
  return text_in(trace_files, path);
}

loaded load_traced(const std::string& toml) {
  return load_text(toml, "lab/x.toml", {}, count_and_read);
}

/// What is wrong with a mote whose keys, from line 19, are `keys`.
std::string problem_with(const std::string& keys) {
  return problems_of(load_traced(mote_head + keys));
}

std::string light(const std::string& keys) {
  return "transducers.light = { " + keys + " }\n";
}

/// The light of the first mote.
template <class Model>
Model model_of(const std::string& keys) {
  const auto x = load_traced(mote_head + light(keys));
  CAPTURE(problems_of(x));
  REQUIRE(x.ecology);
  return std::get<Model>(x.ecology->islands[0].motes[0].transducers.at(1).model);
}

const std::string lab_columns =
    "columns = [\"date\", \"time\", \"epoch\", \"mote\", \"temperature\", \"humidity\", \"light\", "
    "\"voltage\"], date_column = \"date\"";

const std::string lab_trace =
    "transducers.light = { model = \"trace\", file = \"data.txt\", resolution = 1, mote_column = "
    "\"mote\", " +
    lab_columns + " }\n";

} // namespace

TEST_CASE("a random walk arrives with its keys", "[config][STR-21]") {
  const auto x = model_of<device::random_walk_model>(
      "model = \"random_walk\", start = 20, step = 0.5, min = -1, max = 40");
  CHECK(x.start == 20);
  CHECK(x.step == 0.5);
  CHECK(x.min == -1);
  CHECK(x.max == 40);
}

TEST_CASE("a field arrives with its sources", "[config][STR-21]") {
  const auto x = model_of<device::field_model>(
      "model = \"field\", base = 18, gradient = [0.5, -1], sources = ["
      "{ position_m = [1, 2, 3], strength = -4 }, "
      "{ position_m = [0, 0], strength = 100, radius = \"50cm\", falloff = \"disk\", "
      "schedule = [[\"0s\", 0], [\"1h\", 1]], period = \"1d\" }]");
  CHECK(x.base == 18);
  CHECK(x.gradient_per_m == std::array<double, 3>{0.5, -1, 0});
  REQUIRE(x.sources.size() == 2);
  CHECK(x.sources[0].place == position{1, 2, 3});
  CHECK(x.sources[0].strength == -4);
  CHECK(x.sources[0].radius_m == 1);
  CHECK(x.sources[0].shape == device::falloff::inverse_square);
  CHECK(x.sources[0].schedule.empty());
  CHECK(x.sources[1].radius_m == 0.5);
  CHECK(x.sources[1].shape == device::falloff::disk);
  CHECK(x.sources[1].schedule == device::time_series{{0s, 0}, {1h, 1}});
  CHECK(x.sources[1].period == 24h);
}

TEST_CASE("a trace comes from the file that is named, beside the TOML file", "[config][STR-21]") {
  const auto x = model_of<device::trace_model>("model = \"trace\", file = \"room.csv\"");
  REQUIRE(x.table);
  CHECK(x.table->of_mote.at(0) == device::time_series{{0s, 100}, {60s, 200}});
  CHECK(x.mote == 0U);
  CHECK_FALSE(x.repeats);
  CHECK_FALSE(x.straight);
  const auto y = model_of<device::trace_model>(
      "model = \"trace\", file = \"room.csv\", column = \"temperature\", start = \"10\", "
      "repeat = true, interpolation = \"linear\", scale = 2, offset = -1, separator = \"comma\", "
      "min = -5, max = 20.5");
  CHECK(y.table->of_mote.at(0) == device::time_series{{-10s, 20}});
  CHECK(y.repeats);
  CHECK(y.straight);
  CHECK(y.scale == 2);
  CHECK(y.offset == -1);
}

TEST_CASE("each mote replays its own readings of a trace, or those of the one named",
          "[config][STR-21]") {
  const std::string toml = "[ecology]\nname = \"t\"\n[mote_type.c]\ntype = 7\n" + lab_trace +
                           "[[island]]\nname = \"k\"\nid = 1\n"
                           "[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\n"
                           "[[island.group]]\ncount = 1\nfirst = 3\ntype = \"c\"\n"
                           "layout = \"grid\"\nspacing = \"1m\"\n"
                           "[[island.mote]]\nid = 4\ntype = \"c\"\nposition_m = [1, 2]\n";
  files_read = 0;
  const auto x = load_traced(
      toml +
      "transducers.light = { model = \"trace\", file = \"data.txt\", resolution = 1, mote = "
      "3, mote_column = \"mote\", " +
      lab_columns + " }\n");
  CAPTURE(problems_of(x));
  REQUIRE(x.ecology);
  CHECK(files_read == 1);
  const auto& motes = x.ecology->islands[0].motes;
  REQUIRE(motes.size() == 3);
  const auto trace = [&](std::size_t i) {
    return std::get<device::trace_model>(motes[i].transducers.at(0).model);
  };
  CHECK(trace(0).mote == 2U);
  CHECK(trace(1).mote == 3U);
  CHECK(trace(2).mote == 3U);
  CHECK(trace(0).table == trace(2).table);
  CHECK(trace(0).table->skipped == 1);
  CHECK(trace(1).table->of_mote.at(3) == device::time_series{{60s, 4000}});
  CHECK(problems_of(load_traced(toml)) ==
        "lab/x.toml:20:6: the trace of `light` has no readings of "
        "mote 4: choose one of its motes with `mote`");
  CHECK(problems_of(load_traced(toml.substr(0, toml.find("[[island.mote]]")) +
                                "[[island.group]]\ncount = 3\nfirst = 2\ntype = \"c\"\n"
                                "layout = \"grid\"\nspacing = \"1m\"\n")) ==
        "lab/x.toml:11:9: the trace of `light` has no readings of mote 4: choose one of its motes "
        "with `mote`");
}

TEST_CASE("mistakes in a trace are told once, with their place in it", "[config][GEN-06]") {
  const auto broken = light("model = \"trace\", file = \"broken.csv\"");
  CHECK(problem_with(broken) == "lab/broken.csv:3: a value is a number up to 1e15, not \"dark\"");
  CHECK(problem_with(broken + "[[island.mote]]\nid = 3\ntype = \"c\"\nposition_m = [1, 3]\n" +
                     broken) == "lab/broken.csv:3: a value is a number up to 1e15, not \"dark\"");
  CHECK(problem_with(light("model = \"trace\", file = \"none.csv\"")) ==
        "lab/x.toml:19:47: \"lab/none.csv\" cannot be opened: No such file or directory");
  CHECK(problem_with(light("model = \"trace\", file = \"room.csv\", column = \"lux\"")) ==
        "lab/room.csv:1: there is no column \"lux\", which `column` can change; there is \"time\", "
        "\"light\", \"temperature\"");
}

TEST_CASE("keys of transducer models need their ranges", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"model = \"random_walk\", start = 1, step = 1, min = 2, max = 2",
       "19:82: `max` must be more than `min`, which is 2"},
      {"model = \"random_walk\", start = 1, step = 1, min = 2, max = 3",
       "19:54: `start` must be from `min` to `max`, from 2 to 3"},
      {"model = \"random_walk\", start = 1, step = -1, min = 0, max = 3",
       "19:64: `step` must be a number from 0 to 1000000000, not -1"},
      {"model = \"random_walk\", start = 1, step = 1, min = 0, max = 5000",
       "19:21: a value of 5000 is more than 32767 counts of `resolution` 0.1, which a message "
       "cannot carry: use a coarser one"},
      {"model = \"field\"", "19:21: `base` is missing in model = \"field\""},
      {"model = \"field\", base = 1, gradient = [1]",
       "19:61: `gradient` must be an array of at least 2, not an array of 1"},
      {"model = \"field\", base = 1, gradient = [1, \"2\"]",
       "19:65: `gradient` must be a number from -1000000 to 1000000, not \"2\""},
      {"model = \"field\", base = 1, sources = [{ position_m = [0, 0] }]",
       "19:61: `strength` is missing in sources"},
      {"model = \"field\", base = 1, sources = [{ position_m = [0, 0], strength = 1, falloff = "
       "\"square\" }]",
       "19:108: `falloff` must be \"inverse_square\", \"gaussian\", \"linear\" or \"disk\", not "
       "\"square\""},
      {"model = \"field\", base = 1, sources = [{ position_m = [0, 0], strength = 1, period = "
       "\"1h\" }]",
       "19:107: `period` has no effect without a `schedule`"},
      {"model = \"field\", base = 1, sources = [{ position_m = [0, 0], strength = 1, schedule = "
       "[[\"2h\", 1]], period = \"1h\" }]",
       "19:131: `period` must not be shorter than the `schedule`, which ends at 2 h"},
      {"model = \"field\", base = 3000, sources = [{ position_m = [0, 0], strength = -200, "
       "schedule = [[\"2h\", 2]] }]",
       "19:21: a value of 3400 is more than 32767 counts of `resolution` 0.1, which a message "
       "cannot carry: use a coarser one"},
      {"model = \"trace\"", "19:21: `file` is missing in model = \"trace\""},
      {"model = \"trace\", file = \"room.csv\", mote = 1",
       "19:66: `mote` has no effect without a `mote_column`"},
      {"model = \"trace\", file = \"room.csv\", start = \"noon\"",
       "19:67: `start` must be seconds or a date and a time of day between quotation marks, as in "
       "\"12.5\" or \"2004-02-28 00:59:16\", not \"noon\""},
      {"model = \"trace\", file = \"room.csv\", separator = \",\"",
       "19:71: `separator` must be \"comma\", \"semicolon\", \"tab\" or \"blanks\", not \",\""},
      {"model = \"trace\", file = \"room.csv\", interpolation = \"cubic\"",
       "19:75: `interpolation` must be \"hold\" or \"linear\", not \"cubic\""},
      {"model = \"trace\", file = \"room.csv\", scale = 20",
       "19:21: a value of 4000 is more than 32767 counts of `resolution` 0.1, which a message "
       "cannot carry: use a coarser one"},
      {"model = \"trace\", file = \"room.csv\", mote_column = \"temperature\", mote = 22",
       "19:95: the trace has no readings of mote 22"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_with(light(x.toml)) == std::string("lab/x.toml:") + x.problem);
}

TEST_CASE("actuators arrive with the time their way takes", "[config][DIS-02]") {
  const auto x = good(mote_head + "actuators = [{ name = \"blind\", kind = \"level\" },\n"
                                  "{ name = \"valve\", kind = \"level\", initial = 200, travel = "
                                  "\"1min\" },\n"
                                  "{ name = \"lamp\", kind = \"dimmer\", fade = \"2s\" },\n"
                                  "{ name = \"light\", kind = \"dimmer\", initial = 3 }]\n");
  const auto& all = x.islands[0].motes[0].actuators;
  REQUIRE(all.size() == 5);
  CHECK(all[0].travel == 0s);
  CHECK(all[1].kind == device::actuator_kind::level);
  CHECK(all[1].travel == 20s);
  CHECK(all[1].initial == 0);
  CHECK(all[2].travel == 1min);
  CHECK(all[2].initial == 200);
  CHECK(all[3].kind == device::actuator_kind::dimmer);
  CHECK(all[3].travel == 2s);
  CHECK(all[4].travel == 0s);
  CHECK(all[4].initial == 3);
}

TEST_CASE("keys of actuators belong to their kind", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"kind = \"relay\", travel = \"1s\"", "19:44: unknown key `travel` in kind = \"relay\": it "
                                            "is a key of kind = \"level\"; see rubicon check "
                                            "--explain travel"},
      {"kind = \"dimmer\", travel = \"1s\"", "19:45: unknown key `travel` in kind = \"dimmer\": it "
                                             "is a key of kind = \"level\"; see rubicon check "
                                             "--explain travel"},
      {"kind = \"level\", travel = \"25h\"",
       "19:53: `travel` must be a time from 0 ns to 1 d, not \"25h\""},
      {"kind = \"blind\"",
       "19:35: `kind` must be \"relay\", \"dimmer\" or \"level\", not \"blind\""},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(mote_head, "actuators = [{ name = \"x\", " + std::string(x.toml) + " }]\n") ==
        x.problem);
}
