#include <map>
#include <string>

#include "radio/medium/noise.hpp"
#include "radio/medium/tossim_files.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

radio::channel_config radio_with(const std::string& rest) {
  return good(std::string(head) + "[radio]\n" + rest).radio;
}

std::string lines_of(int count, const std::string& line) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += line;
  return text;
}

/// Files that exist only here.
const std::map<std::string, std::string> radio_files{
    {"lab/grid.txt", "gain 0 1 -60\ngain 1 0 -61.5\nnoise 0 -100 4\nnoise 1 -99 4\n"},
    {"no-floors.txt", "gain 0 1 -60\n"},
    {"broken.txt", "gain 0 1 -60\ngain 0 two -60\n"},
    {"lab/meyer.txt", lines_of(120, "-97\n")},
    {"short.txt", "-97\n"},
};

file_text from_radio_files(const std::string& path, std::size_t /*octets_max*/) {
  return text_in(radio_files, path);
}

loaded load_lab(const std::string& toml, const overrides& instead = {}) {
  return load_text(toml, "lab/x.toml", instead, from_radio_files);
}

/// A file with an island of a sink and one mote, from line 7.
std::string lab(const std::string& radio, const std::string& mote = "id = 2\n") {
  return "[ecology]\nname = \"t\"\n" + radio +
         "[[island]]\nname = \"k\"\nid = 1\nstack = \"mac\"\n[[island.mote]]\n" + mote;
}

const std::string gains = "[radio.propagation]\nmodel = \"gains\"\n";

} // namespace

TEST_CASE("every model of propagation arrives with its keys", "[config][radio]") {
  const auto disk = radio_with("[radio.propagation]\nmodel = \"unit_disk\"\nrange = \"12m\"\n");
  CHECK(std::get<radio::unit_disk>(disk.propagation).range_m == 12);
  CHECK(disk.collisions == radio::collision_rule::strict);
  const auto log =
      radio_with("[radio.propagation]\nmodel = \"log_distance\"\nexponent = 2.5\n"
                 "reference = \"46.68dB\"\nshadowing = \"4dB\"\nasymmetry = \"2dB\"\n");
  const auto& model = std::get<radio::log_distance>(log.propagation);
  CHECK(model.exponent == 2.5);
  CHECK(model.reference_db == 46.68);
  CHECK(model.shadowing_db == 4);
  CHECK(model.asymmetry_db == 2);
  CHECK(log.collisions == radio::collision_rule::sinr);
  CHECK(std::get<radio::constant_noise>(log.noise).floor_dbm == -98);
  const auto free = radio_with("[radio.propagation]\nmodel = \"friis\"\nfrequency = \"868MHz\"\n");
  CHECK(std::get<radio::friis>(free.propagation).frequency_mhz == 868);
}

TEST_CASE("reception, sensing and medium access arrive with their keys", "[config][radio]") {
  const auto x = radio_with(
      "sensitivity = \"-94dBm\"\nsensitivity_edge = \"noise\"\ncca_threshold = \"-77dBm\"\ncutoff "
      "= \"-110dBm\"\n"
      "sensing = \"energy\"\nsensing_window = \"end\"\ncollisions = \"sinr\"\ncapture = true\n"
      "curve = \"tossim\"\nretries = 2\n"
      "[radio.propagation]\nmodel = \"log_distance\"\n"
      "[radio.noise]\nmodel = \"constant\"\nfloor = \"-106.58dBm\"\n"
      "[radio.mac]\nmicaz = \"cc2420\"\niris = \"rf230\"\ntelosb = \"standard\"\n");
  CHECK(x.sensitivity_dbm == -94.0);
  CHECK(x.edge == radio::sensitivity_edge::noise);
  CHECK(x.cca_dbm == -77.0);
  CHECK(x.cutoff_dbm == -110);
  CHECK(x.sensing == radio::sensing::energy);
  CHECK(x.window == radio::sensing_window::end);
  CHECK(x.collisions == radio::collision_rule::sinr);
  CHECK(x.capture);
  CHECK(x.curve == radio::error_curve::tossim);
  CHECK(x.retries_max == 2U);
  CHECK(std::get<radio::constant_noise>(x.noise).floor_dbm == -106.58);
  CHECK(x.macs == std::vector<std::pair<std::string, std::string>>{
                      {"micaz", "cc2420"}, {"iris", "rf230"}, {"telosb", "standard"}});
  CHECK(std::holds_alternative<radio::no_noise>(
      radio_with("[radio.propagation]\nmodel = \"friis\"\n[radio.noise]\nmodel = \"none\"\n")
          .noise));
}

TEST_CASE("values of the radio need their units and ranges", "[config][GEN-06]") {
  check_mistakes(head, R"(
[radio]
sensitivity = -94
#             ^ `sensitivity` must be a power from -150 to 20 dBm with its unit, as in "-98dBm", not
#   -94

[radio]
cutoff = "-94dB"
#        ^ `cutoff` must be a power from -150 to 20 dBm with its unit, as in "-98dBm", not "-94dB"

[radio]
cca_threshold = "-151dBm"
#               ^ `cca_threshold` must be a power from -150 to 20 dBm with its unit, as in "-98dBm",
#   not "-151dBm"

[radio]
propagation = { model = "log_distance", reference = "200.1dB" }
#                                                   ^ `reference` must be a ratio from 0 to 200 dB
#   with its unit, as in "3.5dB", not "200.1dB"

[radio]
propagation = { model = "log_distance", exponent = 0.5 }
#                                                  ^ `exponent` must be a number from 1 to 10, not
#   0.5

[radio]
propagation = { model = "friis", frequency = 2480 }
#                                            ^ `frequency` must be a frequency from 100 MHz to 100
#   GHz with its unit (MHz or GHz), as in "2480MHz", not 2480

[radio]
propagation = { model = "disk" }
#                       ^ `model` must be "unit_disk", "log_distance", "friis" or "gains", not
#   "disk"

[radio]
propagation = {}
#             ^ `model` is missing in [radio.propagation]

[radio]
propagation = { model = "friis", range = "5m" }
#                                ^ unknown key `range` in [radio.propagation] model = "friis": it is
#   a key of [radio], [radio.propagation] model = "unit_disk", [peis.bluetooth], ...; see rubicon
#   check --explain range

[radio]
noise = { model = "none", floor = "-98dBm" }
#                         ^ unknown key `floor` in [radio.noise] model = "none": it is a key
#   of [radio.noise] model = "constant"; see rubicon check --explain floor

[radio]
mac = { micaz = "tinyos" }
#               ^ `micaz` must be "standard", "cc2420" or "rf230", not "tinyos"

[radio]
mac = { mica2 = "cc2420" }
#       ^ unknown key `mica2` in [radio.mac]: did you mean `micaz`?

[radio]
sensing = "both"
#         ^ `sensing` must be "energy", "carrier" or "energy_or_carrier", not "both"
)");
}

TEST_CASE("what decides nothing beside the rest of [radio] is refused", "[config][GEN-06]") {
  check_mistakes(head, R"(
[radio]
range = "9m"
#       ^ `range` belongs to model = "unit_disk": [radio.propagation] has another
propagation = { model = "friis" }

[radio]
range = "9m"
#       ^ `range` is in [radio.propagation] already (line 8, column 46)
propagation = { model = "unit_disk", range = "9m" }

[radio]
range = "9m"
propagation = { model = "unit_disk" }

[radio]
sensitivity = "-94dBm"
#             ^ `sensitivity` has no effect with model = "unit_disk": all radios within range receive

[radio]
cutoff = "-94dBm"
#        ^ `cutoff` has no effect with model = "unit_disk": all radios within range receive

[radio]
cca_threshold = "-94dBm"
#               ^ `cca_threshold` has no effect with model = "unit_disk" and collisions =
#   "strict": only overlaps lose frames

[radio]
cca_threshold = "-94dBm"
collisions = "sinr"

[radio]
cca_threshold = "-94dBm"
#               ^ `cca_threshold` has no effect with sensing = "carrier"
sensing = "carrier"
collisions = "sinr"

[radio]
noise = { model = "constant" }
#       ^ `noise` has no effect with model = "unit_disk" and collisions = "strict": only overlaps
#   lose frames

[radio]
noise = { model = "none" }

[radio]
noise = { model = "constant" }
collisions = "sinr"

[radio]
curve = "tossim"
#       ^ `curve` has no effect with collisions = "strict" and without noise

[radio]
curve = "tossim"
propagation = { model = "friis" }
collisions = "strict"

[radio]
capture = true
#         ^ `capture` has no effect with collisions = "strict": every frame that overlaps another
#   is lost

[radio]
capture = false

[radio]
capture = true
collisions = "sinr"

[radio]
noise = { model = "table" }
#       ^ noise from the topology needs [radio.propagation] with model = "gains"
propagation = { model = "friis" }
)");
}

TEST_CASE("gains and noise come from the files that are named", "[config][radio]") {
  const auto x = load_lab(lab(gains + "topology = \"grid.txt\"\n"
                                      "[radio.noise]\nmodel = \"trace\"\nfile = \"meyer.txt\"\n"));
  CAPTURE(problems_of(x));
  REQUIRE(x.ecology);
  const auto& model = std::get<radio::gain_matrix>(x.ecology->radio.propagation);
  CHECK(model.first_mote == 1);
  REQUIRE(model.table);
  CHECK(model.table->gains.size() == 2);
  const auto& noise = std::get<radio::traced_noise>(x.ecology->radio.noise);
  REQUIRE(noise.trace);
  CHECK(noise.trace->readings().size() == 120);
  CHECK(x.ecology->radio.collisions == radio::collision_rule::sinr);
}

TEST_CASE("a command line replaces the files, from its own folder", "[config][radio]") {
  const auto trace = "[radio.noise]\nmodel = \"trace\"\n";
  const auto x = load_lab(lab(gains + trace), {"no-floors.txt", "lab/meyer.txt", {}});
  CAPTURE(problems_of(x));
  REQUIRE(x.ecology);
  CHECK(std::get<radio::gain_matrix>(x.ecology->radio.propagation).table->floors.empty());
  const auto y = load_lab(lab(gains + "topology = \"missing.txt\"\n"), {"lab/grid.txt", {}, {}});
  CHECK(problems_of(y) == "none");
  CHECK(problems_of(load_lab(lab(gains), {"missing.txt", {}, {}})) ==
        "missing.txt: cannot be opened: No such file or directory");
  CHECK(problems_of(load_lab(lab(""), {"lab/grid.txt", {}, {}}))
            .ends_with("lab/x.toml: --topology needs [radio.propagation] with model = \"gains\""));
  CHECK(problems_of(load_lab(
            lab("[radio.propagation]\nmodel = \"friis\"\n", "id = 2\nposition_m = [0, 0]\n"),
            {{}, "lab/meyer.txt", {}})) ==
        "lab/x.toml: --noise-trace needs [radio.noise] with model = \"trace\"");
}

TEST_CASE("a file that is missing or wrong is told where it is", "[config][GEN-06]") {
  const auto problem = [](const std::string& radio) { return problems_of(load_lab(lab(radio))); };
  CHECK(problem(gains) == "lab/x.toml:3:1: `topology` is missing in [radio.propagation] model = "
                          "\"gains\": name the file there or with --topology");
  CHECK(problem(gains + "[radio.noise]\nmodel = \"trace\"\n")
            .find("`file` is missing in [radio.noise] model = \"trace\": name the file there or "
                  "with --noise-trace") != std::string::npos);
  CHECK(problem(gains + "topology = \"missing.txt\"\n") ==
        "lab/x.toml:5:12: \"lab/missing.txt\" cannot be opened: No such file or directory");
  CHECK(problem(gains + "topology = \"../broken.txt\"\n")
            .starts_with("lab/x.toml:5:12: \"lab/../broken.txt\" cannot be opened"));
  CHECK(problem(gains + "topology = 5\n").find("`topology` must be a text") != std::string::npos);
  const auto broken =
      load_text(lab(gains + "topology = \"broken.txt\"\n"), "x.toml", {}, from_radio_files);
  CHECK(problems_of(broken).starts_with("broken.txt:2: "));
  const auto trace = load_text(lab("[radio.propagation]\nmodel = \"friis\"\n[radio.noise]\n"
                                   "model = \"trace\"\nfile = \"short.txt\"\n",
                                   "id = 2\nposition_m = [0, 0]\n"),
                               "x.toml", {}, from_radio_files);
  CHECK(problems_of(trace).starts_with("short.txt"));
  CHECK(problem(gains + "topology = \"/no-floors.txt\"\n")
            .starts_with("lab/x.toml:5:12: \"/no-floors.txt\" cannot be opened"));
  CHECK(problems_of(load_text(lab(gains + "topology = \"grid.txt\"\n"), "x.toml")) ==
        "x.toml:5:12: \"grid.txt\" cannot be opened here");
}

TEST_CASE("every mote of a topology is one of its nodes", "[config][GEN-06]") {
  const auto problem = [](const std::string& radio, const std::string& mote) {
    return problems_of(load_lab(lab(gains + radio, mote)));
  };
  const std::string grid = "topology = \"grid.txt\"\n";
  CHECK(problem(grid, "id = 2\n") == "none");
  CHECK(problem(grid, "id = 3\n") == "lab/x.toml:11:6: mote `mote-3` with the id 3 is node 2 of "
                                     "the topology, which has no gain to or from it");
  CHECK(problem(grid + "first_mote = 2\n", "id = 3\n") ==
        "lab/x.toml:7:1: mote `sink` with the id 1 is before `first_mote` of the topology, which "
        "is 2");
  CHECK(problem(grid + "first_mote = 0\n", "id = 2\n")
            .starts_with("lab/x.toml:12:6: mote `mote-2` with the id 2 is node 2"));
  const auto floors = "[radio.noise]\nmodel = \"table\"\n";
  CHECK(problem(grid + floors, "id = 2\n") == "none");
  const auto none = load_text(lab(gains + "topology = \"no-floors.txt\"\n" + floors), "x.toml", {},
                              from_radio_files);
  CHECK(problems_of(none) == "x.toml:6:1: the topology has no `noise` lines");
}

TEST_CASE("links are listed once, within one air", "[config][GEN-06]") {
  const std::string islands = "[[island.mote]]\nid = 2\ntype = 1\nposition_m = [1, 2]\n"
                              "[[island]]\nname = \"b\"\nid = 2\n";
  const auto x = good(std::string(island_head) + islands +
                      "[[radio.link]]\nfrom = \"k/mote-2\"\nto = \"k/sink\"\nloss = \"50%\"\n"
                      "[[radio.link]]\nfrom = \"k/sink\"\nto = \"b/sink\"\ngain = \"-70.5dB\"\n"
                      "[[air]]\nname = \"a\"\nislands = [\"k\", \"b\"]\n")
                     .radio.links;
  REQUIRE(x.size() == 2);
  CHECK(x[0].from == mote_address{island_id{1}, mote_id{2}});
  CHECK(x[0].to == mote_address{island_id{1}, mote_id{1}});
  CHECK(x[0].loss == 0.5);
  CHECK_FALSE(x[0].gain_db);
  CHECK(x[1].to == mote_address{island_id{2}, mote_id{1}});
  CHECK(x[1].gain_db == -70.5);
  const auto y = GENERATE(values<row>({
      {"[[radio.link]]\nfrom = \"k/mote-2\"\nto = \"k/sink\"\n",
       "22:1: a link needs `loss`, `gain` or both"},
      {"[[radio.link]]\nfrom = \"k/sink\"\nto = \"k/sink\"\nloss = 1\n",
       "24:6: a link leads from one mote to another"},
      {"[[radio.link]]\nfrom = \"k/sink\"\nto = \"k/mote-3\"\nloss = 1\n",
       "24:6: no mote of island `k` is named `mote-3`: did you mean `mote-2`?"},
      {"[[radio.link]]\nfrom = \"sink\"\nto = \"k/mote-2\"\nloss = 1\n",
       "23:8: `from` must be the island and the name of a mote, as in \"kitchen/climate-7\" or "
       "\"kitchen/sink\", not \"sink\""},
      {"[[radio.link]]\nfrom = \"k/sink\"\nto = \"k/mote-2\"\nloss = 1\n"
       "[[radio.link]]\nfrom = \"k/sink\"\nto = \"k/mote-2\"\ngain = \"-1dB\"\n",
       "28:6: the link is already listed (line 24, column 6)"},
      {"[[radio.link]]\nfrom = \"k/sink\"\nto = \"b/sink\"\nloss = 1\n",
       "22:1: a link leads from air `k` to air `b`, which are isolated from each other"},
      {"[[radio.link]]\nfrom = \"k/sink\"\nto = \"k/mote-2\"\ngain = \"21dB\"\n",
       "25:8: `gain` must be a ratio from -200 to 20 dB with its unit, as in \"3.5dB\", not "
       "\"21dB\""},
  }));
  CAPTURE(y.toml);
  CHECK(problem_after(std::string(island_head) + islands, y.toml) == y.problem);
}
