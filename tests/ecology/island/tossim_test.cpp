// Ecologies whose links and noise come from TOSSIM's files; those in data/ are made up.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <unistd.h>

#include "config/load.hpp"
#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

const std::string data = RUBICON_TEST_DATA "/";
const std::string shipped = RUBICON_CONFIG_DIR "/tossim-grid.toml";

constexpr const char* nine_motes = R"(
  ecology = { name = "nine", duration = "100s" }
  [radio]
  curve = "tossim"
  sensitivity = "-110dBm"
  cca_threshold = "-72dBm"
  sensing = "energy"
  cutoff = "-120dBm"
  propagation = { model = "gains", first_mote = 1 }
  noise = { model = "trace" }
  mac.micaz = "cc2420"
  [[island]]
  id = 1
  name = "grid"
  stack = "mac"
  sink = { id = 1, apps = [{ app = "receiver" }] }
  [[island.group]]
  count = 8
  first = 2
  type = 1
  apps = [{ app = "sender", to = "sink", payload = 30, every = "500ms", ack = false }]
)";

config::overrides files(const std::string& topology, const std::string& noise) {
  config::overrides x;
  x.topology = topology;
  x.noise_trace = noise;
  return x;
}

config::loaded load(const std::string& topology, const std::string& noise) {
  return config::load_text(nine_motes, "nine.toml", files(topology, noise), config::read_file);
}

/// All problems of a file, one a line.
std::string text(const config::loaded& x) {
  std::string all;
  for (const auto& problem : x.problems)
    all += config::to_string(problem) + "\n";
  return all;
}

int made = 0; ///< scratch files, each with a name of its own

/// A file that is gone at the end.
class scratch_file {
public:
  scratch_file(const std::string& name, const std::string& content)
      : path_((std::filesystem::temp_directory_path() /
               ("rubicon-tossim-" + std::to_string(getpid()) + "-" + std::to_string(++made) + "-" +
                name))
                  .string()) {
    std::ofstream(path_, std::ios::binary) << content;
  }
  ~scratch_file() { std::filesystem::remove(path_); }
  scratch_file(const scratch_file&) = delete;
  scratch_file& operator=(const scratch_file&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

private:
  std::string path_;
};

const report::flow_report& flow_from(const report::run_report& x, std::uint16_t node) {
  for (const auto& flow : x.flows) {
    if (flow.from.mote == mote_id{static_cast<std::uint16_t>(node + 1)})
      return flow;
  }
  throw std::runtime_error("no flow from node " + std::to_string(node));
}

} // namespace

TEST_CASE("motes are heard as TOSSIM's gains and noise let them", "[ecology][radio]") {
  const auto loaded = load(data + "nine-nodes.txt", data + "noise.txt");
  CHECK(text(loaded).empty());
  REQUIRE(loaded.ecology);
  const auto report = run(*loaded.ecology);
  CHECK(report.violations.empty());
  REQUIRE(report.flows.size() == 8);
  for (const auto& flow : report.flows) {
    INFO(flow.from_name);
    CHECK(flow.sent == Approx(200).margin(2));
    CHECK(flow.sent == flow.delivered + report::total(flow.lost) + flow.open);
  }
  // Nodes 1 and 3 are heard well above any noise, 2 above the quiet noise only, 5 below all noise,
  // and 7 and 8 have no link to the sink at all. A link back does not matter: 3 has none.
  CHECK(flow_from(report, 1).pdr > 0.9);
  CHECK(flow_from(report, 3).pdr > 0.9);
  CHECK(flow_from(report, 2).pdr > 0.4);
  CHECK(flow_from(report, 2).pdr < 0.97);
  CHECK(flow_from(report, 5).delivered == 0);
  CHECK(flow_from(report, 5).lost.at("weak") > 0);
  for (const auto node : {std::uint16_t{7}, std::uint16_t{8}}) {
    INFO("node " << node);
    CHECK(flow_from(report, node).delivered == 0);
    CHECK(flow_from(report, node).lost.at("out_of_reach") == flow_from(report, node).sent);
  }
  const auto radio = report.radio();
  CHECK(radio.sent == radio.delivered + report::total(radio.lost));
  CHECK(radio.requests == radio.mac_sent + report::total(radio.mac_failed) + radio.mac_open);
}

TEST_CASE("noise from a trace is the same in equal runs", "[ecology][GEN-07]") {
  auto loaded = load(data + "nine-nodes.txt", data + "noise.txt");
  REQUIRE(loaded.ecology);
  loaded.ecology->length = 10s;
  const auto hash = run(*loaded.ecology, 1).trace_hash;
  CHECK(run(*loaded.ecology, 1).trace_hash == hash);
  CHECK(run(*loaded.ecology, 2).trace_hash != hash);
}

TEST_CASE("an acknowledgement needs the route back", "[ecology][radio]") {
  auto toml = std::string(nine_motes);
  toml.replace(toml.find("ack = false"), 11, "ack = true");
  const auto loaded = config::load_text(
      toml, "nine.toml", files(data + "nine-nodes.txt", data + "noise.txt"), config::read_file);
  REQUIRE(loaded.ecology);
  const auto report = run(*loaded.ecology);
  CHECK(report.violations.empty());
  // The sink hears node 3, which never hears an acknowledgement.
  const auto& one_way = flow_from(report, 3);
  CHECK(one_way.pdr > 0.9);
  const auto& failed = report.islands.at(0).radio.mac_failed;
  REQUIRE(failed.contains("no_ack"));
  CHECK(failed.at("no_ack") >= one_way.delivered);
}

TEST_CASE("the shipped TOSSIM grid needs its two files and takes them", "[ecology][GEN-06]") {
  const auto without = config::load_file(shipped);
  CHECK_FALSE(without.ecology);
  CHECK(text(without).find("topology") != std::string::npos);
  CHECK(text(without).find("noise") != std::string::npos);

  // Too small for it: motes 10 to 225 are no nodes.
  const auto small = config::load_file(shipped, files(data + "nine-nodes.txt", data + "noise.txt"));
  CHECK_FALSE(small.ecology);
  CHECK_FALSE(small.problems.empty());

  std::string grid;
  for (int node = 0; node < 225; ++node) {
    const auto link = [&](int to) {
      grid += "gain " + std::to_string(node) + " " + std::to_string(to) + " -70\n" + "gain " +
              std::to_string(to) + " " + std::to_string(node) + " -70\n";
    };
    if (node % 15 < 14)
      link(node + 1);
    if (node < 210)
      link(node + 15);
  }
  const scratch_file topology("grid.txt", grid);
  auto whole = config::load_file(shipped, files(topology.path(), data + "noise.txt"));
  CHECK(text(whole).empty());
  REQUIRE(whole.ecology);
  whole.ecology->length = 60s;
  const auto report = run(*whole.ecology);
  CHECK(report.violations.empty());
  // Every mote broadcasts to its two to four neighbours.
  REQUIRE(report.flows.size() == 225);
  for (const auto& flow : report.flows) {
    INFO(flow.from_name);
    CHECK(flow.sent == Approx(6).margin(1));
    const auto node = flow.from.mote.value - 1;
    const auto column = node % 15;
    const auto neighbours = (column > 0) + (column < 14) + (node >= 15) + (node < 210);
    CHECK(flow.pdr <= neighbours);
    CHECK(flow.pdr > 0.5 * neighbours);
  }
}

TEST_CASE("broken TOSSIM files are refused with file and line", "[ecology][GEN-06]") {
  const auto topology = data + "nine-nodes.txt";
  const auto noise = data + "noise.txt";

  const scratch_file word("word.txt", "gain 0 1 -60\n\n# fine\nloss 1 0 -60\n");
  CHECK(text(load(word.path(), noise)).find(word.path() + ":4: ") != std::string::npos);
  const scratch_file missing("missing.txt", "gain 0 1\n");
  CHECK(text(load(missing.path(), noise)).find(missing.path() + ":1: ") != std::string::npos);
  const scratch_file empty("empty.txt", "");
  CHECK(text(load(empty.path(), noise)).find(empty.path() + ": ") != std::string::npos);

  const scratch_file letters("letters.txt", "-98\n-97\nquiet\n");
  CHECK(text(load(topology, letters.path())).find(letters.path() + ":3: ") != std::string::npos);
  const scratch_file brief("brief.txt", "-98\n-97\n");
  CHECK(text(load(topology, brief.path())).find(brief.path() + ": ") != std::string::npos);

  // Both are told at once, and neither hides what is missing.
  const auto both = text(load(word.path(), letters.path()));
  CHECK(both.find(word.path()) != std::string::npos);
  CHECK(both.find(letters.path()) != std::string::npos);
  const auto gone = text(load(data + "not-there.txt", noise));
  CHECK(gone.find("not-there.txt: ") != std::string::npos);
  CHECK(gone.find("No such file") != std::string::npos);

  // No problem is a crash, whatever the file holds.
  const scratch_file binary("binary.txt", std::string("\0\x1b\xff gain \0", 10));
  const auto strange = load(binary.path(), binary.path());
  CHECK_FALSE(strange.ecology);
  CHECK(text(strange).find('\x1b') == std::string::npos);
}
