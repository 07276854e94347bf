// `rubicon explain` as a user meets it.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "support/catch.hpp"
#include "support/mcap_file.hpp"
#include "support/scratch_folder.hpp"
#include "support/shell.hpp"
#include "support/trace_event_file.hpp"

using rubicon::test::outcome;
using rubicon::test::shell;

namespace {

const std::string binary = RUBICON_BINARY;

/// Half a minute of the home, recorded once.
const std::string& home_record() {
  static const struct scratch {
    std::string path = (std::filesystem::temp_directory_path() /
                        ("rubicon-explain-cli-" + std::to_string(getpid())))
                           .string();
    scratch() {
      const auto x =
          shell('"' + binary + "\" run '" RUBICON_CONFIG_DIR "/home.toml' --for 35s --record " +
                path + " 2>&1");
      REQUIRE(x.status == 0);
    }
    ~scratch() { std::filesystem::remove(path); }
  } file;
  return file.path;
}

outcome explain(const std::string& words) {
  return shell('"' + binary + "\" explain " + home_record() + ' ' + words + " 2>/dev/null");
}

std::string complaint(const std::string& words) {
  const auto x = shell('"' + binary + "\" explain " + words + " 2>&1 >/dev/null");
  CHECK(x.status == 2);
  return x.out;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The commands of docs/data.md that export a record.
std::string shown_commands() {
  const auto page = text_of(RUBICON_CONFIG_DIR "/../docs/data.md");
  const auto there = page.find("--mcap");
  REQUIRE(there != std::string::npos);
  const auto begin = page.rfind("```sh\n", there) + 6;
  return page.substr(begin, page.find("```", there) - begin);
}

} // namespace

TEST_CASE("explain tells the way of a message", "[cli][explain]") {
  const auto x = explain("kitchen/button#1");
  CHECK(x.status == 0);
  CHECK(contains(x.out, "sends 6 octets (\"dinner\")"));
  CHECK(contains(x.out, "kitchen-gateway → bedroom-gateway"));
  CHECK(contains(x.out, "\ndelivered after "));
}

TEST_CASE("explain tells a tuple, its value at a time, and all its values", "[cli][explain]") {
  CHECK(
      contains(explain("kitchen.climate-7.temperature").out, "care-pc/rules-1 received it after"));
  const auto early = explain("kitchen.climate-7.temperature --at 5s");
  CHECK(early.status == 0);
  CHECK(early.out != explain("kitchen.climate-7.temperature").out);
  CHECK(contains(explain("kitchen.climate-7.temperature --all").out, " values"));
  CHECK(contains(explain("devices.2.output.1@kitchen-gateway").out, "kitchen/presence-2"));
}

TEST_CASE("explain lists what can be asked", "[cli][explain]") {
  const auto x = explain("--limit 0");
  CHECK(x.status == 0);
  CHECK(contains(x.out, "kitchen/button#1"));
  CHECK(contains(x.out, "kitchen.climate-7.temperature"));
  const auto from = explain("--from kitchen/button");
  CHECK(contains(from.out, "1 message from kitchen/button, 1 delivered"));
  CHECK_FALSE(contains(from.out, "climate"));
  CHECK(contains(explain("--limit 2").out, "before (--limit 0 shows all)"));
}

TEST_CASE("explain tells the same as JSON", "[cli][explain]") {
  const auto list = nlohmann::json::parse(explain("--json --limit 0").out);
  CHECK(list["ecology"] == "home");
  CHECK(list["messages"].size() > 20);
  const auto message = nlohmann::json::parse(explain("kitchen/button#1 --json").out);
  CHECK(message["outcome"] == "delivered");
  CHECK(message["path"]["step"] == "sends");
  CHECK(message["path"]["then"][0]["medium"] == "air");
  const auto tuple = nlohmann::json::parse(explain("kitchen.climate-7.temperature --json").out);
  CHECK(tuple["heard_by"].size() == 2);
  CHECK(tuple["caused_by"].size() > 4);
  const auto values =
      nlohmann::json::parse(explain("kitchen.climate-7.temperature --all --json").out);
  CHECK(values.size() > 3);
}

TEST_CASE("explain answers a mistake by what is near", "[cli][explain]") {
  const auto& file = home_record();
  CHECK(complaint(file + " kitchen.climate-7.temperatur") ==
        file + ": no tuple `kitchen.climate-7.temperatur`: did you mean "
               "`kitchen.climate-7.temperature`?\n");
  CHECK(contains(complaint(file + " kitchen/button#9"),
                 "no message `kitchen/button#9`: did you mean `kitchen/button#1`?"));
  CHECK(contains(complaint(file + " devices.2.output.1"),
                 "several peers have `devices.2.output.1`: say "
                 "devices.2.output.1@bedroom-gateway or devices.2.output.1@kitchen-gateway"));
  CHECK(contains(complaint(file + " kitchen.climate-7.temperature --at 1ms"),
                 "had no value yet at that time"));
}

TEST_CASE("explain refuses what is no record, with its position", "[cli][explain]") {
  const std::string how = "; `rubicon run FILE --record RECORD` writes a record\n";
  CHECK(complaint("/nowhere/x.rec") ==
        "/nowhere/x.rec: cannot be read: No such file or directory" + how);
  const std::string file = RUBICON_CONFIG_DIR "/home.toml";
  CHECK(complaint('\'' + file + '\'') ==
        file + ":1: this is not a record: the first line is not a JSON object" + how);
  CHECK(complaint("/dev/null") == "/dev/null:1: this is not a record: it is empty" + how);
}

TEST_CASE("a record that was cut off is explained as far as it goes", "[cli][explain]") {
  const auto half = home_record() + "-half";
  std::filesystem::copy_file(home_record(), half);
  std::filesystem::resize_file(half, std::filesystem::file_size(half) - 7);
  const auto x = shell('"' + binary + "\" explain " + half + " 2>/dev/null");
  std::filesystem::remove(half);
  CHECK(x.status == 0);
  CHECK(contains(x.out, "The record ends in the middle of a line"));
}

namespace {

/// Three motes of which the barn connects the others; at 1 min one of them, drawn, is flat.
constexpr const char* yard = R"([ecology]
name = "yard"
duration = "5min"
[radio]
range = "24m"
[[island]]
id = 1
name = "yard"
[[island.mote]]
id = 2
name = "gate"
type = 101
position_m = [1, 3]
[[island.mote]]
id = 3
name = "barn"
type = 101
position_m = [15, 5]
[[island.mote]]
id = 4
name = "well"
type = 101
position_m = [30, 7]
[[fault]]
at = "1min"
kind = "battery_end"
mote = "*"
)";

/// A mote behind a bad link, of whose messages nine in ten are to arrive.
constexpr const char* room = R"([ecology]
name = "room"
duration = "1min"
[parameters]
loss = 0
[radio]
loss = "${loss}"
retries = 0
[[island]]
id = 1
name = "room"
[[island.mote]]
id = 2
name = "meter"
type = 101
position_m = [5, 0]
transducers.temperature = { model = "sine", mean = 20, amplitude = 3 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "2s" }]
[[expect]]
kind = "delivery"
at_least = "90%"
)";

struct recorded_run : rubicon::test::scratch_folder {
  recorded_run(const char* text, const std::string& options) {
    std::ofstream(file("run.toml")) << text;
    CHECK(rubicon("run run.toml --record run.rec " + options).status == 1);
  }
  [[nodiscard]] outcome rubicon(const std::string& words) const {
    return shell("cd '" + path.string() + "' && '" + binary + "' " + words + " 2>&1");
  }
};

} // namespace

TEST_CASE("explain finds since when a violation was inevitable", "[cli][explain]") {
  const recorded_run here(yard, "--seed 4");
  const auto x = here.rubicon("explain --when run.rec yard/well --within 1ms --json");
  INFO(x.out);
  REQUIRE(x.status == 0);
  const auto found = nlohmann::json::parse(x.out);
  const auto detail = found.at("violation").at("detail").get<std::string>();
  CHECK(contains(detail, "yard/well: left: silence"));
  CHECK(found.at("certain_from_s") == 60); // when the mote was drawn
  const auto& before = found.at("before");
  CHECK(before.at("at_s").get<double>() == Approx(59.999));
  CHECK(before.at("of") == 20);
  const auto with = before.at("with").get<int>(); // one mote of three
  CHECK((with > 0 && with < 20));
  CHECK(found.at("start").at("with").get<int>() < 20);
  REQUIRE(found.at("events").size() == 2); // the last before it, and what came of it
  CHECK(found.at("events").at(0).at("what") == "joined");
  CHECK(found.at("events").at(1).at("who") == "yard/barn");
  CHECK(found.at("events").at(1).at("what") == "battery flat");
  const auto other = found.at("other_future").get<std::string>();
  REQUIRE(other.starts_with("rubicon run run.toml --seed 4 --for 5min --reseed 59999ms:"));
  CHECK(!contains(here.rubicon(other.substr(8)).out, "left: silence"));
}

TEST_CASE("explain shows how likely a violation was before", "[cli][explain]") {
  const recorded_run here(room, "--seed 3 --set loss=0.6");
  const auto x =
      here.rubicon("explain --when run.rec delivery --json --futures 40 --within 1s --jobs 2");
  INFO(x.out);
  REQUIRE(x.status == 0);
  const auto found = nlohmann::json::parse(x.out);
  CHECK(found.at("violation").at("invariant") == "expected: delivery >= 90%");
  CHECK(found.at("futures") == 40);
  CHECK(found.at("start").at("of") == 40);
  const auto with = found.at("start").at("with").get<int>();
  CHECK((with > 0 && with < 40));
  CHECK(found.at("before").at("with").get<int>() < 40);
  CHECK(contains(found.at("other_future").get<std::string>(), "--set loss=0.6"));
}

TEST_CASE("explain refuses to repeat what cannot be repeated", "[cli][explain]") {
  const recorded_run here(room, "--seed 3 --set loss=0.6");
  const auto unknown = here.rubicon("explain --when run.rec frogs");
  CHECK(unknown.status == 2);
  CHECK(
      contains(unknown.out, "no violation has `frogs` in its text; there is: expected: delivery"));
  CHECK(here.rubicon("run run.toml --for 20s --record short.rec").status == 0);
  CHECK(contains(here.rubicon("explain --when short.rec").out, "its run has no violation"));
  CHECK(here.rubicon("run run.toml --for 20s --reseed 1s:1 --record again.rec").status == 0);
  CHECK(contains(here.rubicon("explain --when again.rec").out, "a run with --reseed"));
  CHECK(contains(here.rubicon("run run.toml --mode wall --reseed 1s:1").out,
                 "only virtual runs are reproducible"));
  std::ofstream(here.file("run.toml"), std::ios::app) << "[peis]\n";
  const auto changed = here.rubicon("explain --when run.rec");
  CHECK(changed.status == 2);
  CHECK(contains(changed.out, "run.toml has changed since run.rec was written"));
}

TEST_CASE("a recorded home is exported for other programs, as docs/data.md shows",
          "[cli][explain]") {
  const rubicon::test::scratch_folder folder;
  const auto at = folder.path.string();
  std::filesystem::create_symlink(RUBICON_CONFIG_DIR, folder.path / "config");
  std::filesystem::create_symlink(binary, folder.path / "rubicon");
  REQUIRE(shell("cd '" + at + "' && export PATH='" + at + "':\"$PATH\" && set -e\n(" +
                shown_commands() + ") >/dev/null 2>&1")
              .status == 0);
  const auto listed =
      nlohmann::json::parse(
          shell('"' + binary + "\" explain '" + at + "/home.rec' --json --limit 0").out)
          .at("messages");

  const auto mcap_text = text_of(folder.path / "home.mcap");
  const rubicon::test::mcap_file mcap(mcap_text);
  CHECK(mcap.problems == std::vector<std::string>{});
  const auto messages = mcap.of("/messages");
  CHECK(messages.size() == listed.size());
  std::map<std::string, std::string> outcomes;
  for (const auto& each : messages) {
    const auto x = nlohmann::json::parse(each.data);
    outcomes[x.at("message").get<std::string>()] = x.at("outcome").get<std::string>();
  }
  CHECK(outcomes.size() == listed.size());
  for (const auto& each : listed)
    CHECK(outcomes[each.at("message").get<std::string>()] == each.at("outcome").get<std::string>());
  for (const auto* const topic : {"/tuples", "/events", "/places", "/links", "/scene"})
    CHECK(mcap.of(topic).size() >= 20);
  CHECK(nlohmann::json::parse(mcap.of("/places")[0].data).at("motes").size() == 15);

  const rubicon::test::trace_event_file trace(text_of(folder.path / "home.json"));
  CHECK(trace.problems == std::vector<std::string>{});
  CHECK(trace.flows >= listed.size());
  for (const auto& each : listed)
    CHECK(trace.slices.contains(each.at("message").get<std::string>()));
  std::set<std::string> processes;
  for (const auto& each : trace.processes)
    processes.insert(each.second);
  CHECK(processes.size() == trace.processes.size());
  for (const auto* const name : {"kitchen/fan", "kitchen/sink", "bedroom/pager", "care-pc"})
    CHECK(processes.contains(name));
}

TEST_CASE("an export that cannot be made is refused", "[cli][explain]") {
  const rubicon::test::scratch_folder folder;
  const auto file = folder.file("x");
  for (const auto* const option : {"--perfetto", "--mcap"}) {
    const auto words = ' ' + std::string(option) + ' ';
    CHECK(contains(complaint(home_record() + words + "/nonexistent/x"),
                   "/nonexistent/x: cannot be written"));
    for (const auto* const other : {" kitchen/button#1", " --json", " --lost", " --from kitchen"})
      CHECK(contains(complaint(home_record() + words + file + other), "the whole record"));
  }
  CHECK_FALSE(std::filesystem::exists(file));
}
