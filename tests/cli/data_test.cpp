// Pages to send, tables over time, and text of any width.
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/shell.hpp"
#include "support/text.hpp"

using rubicon::test::contains;
using rubicon::test::lines_of;
using rubicon::test::outcome;
using rubicon::test::scratch_folder;
using rubicon::test::shell;
using rubicon::test::text_of;

namespace {

const std::string binary = RUBICON_BINARY;
const std::string home = "'" RUBICON_CONFIG_DIR "/home.toml'";

outcome run(const std::string& words, const std::string& before = "") {
  return shell(before + '"' + binary + "\" run " + words + " 2>&1");
}

std::string trace_of(const std::string& words) {
  const auto x = shell('"' + binary + "\" run --json " + words + " 2>/dev/null");
  return nlohmann::json::parse(x.out).at("trace_hash");
}

/// Without quoted fields.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line)
    if (c == ',')
      fields.emplace_back();
    else
      fields.back() += c;
  return fields;
}

} // namespace

TEST_CASE("a run is written as one page, and runs the same", "[cli]") {
  const scratch_folder folder;
  const auto file = folder.file("home.html");
  const auto hash =
      trace_of(home + " --for 70s --report " + file + " --csv " + folder.file("data"));
  CHECK(hash == trace_of(home + " --for 70s"));
  const auto html = text_of(file);
  CHECK(html.starts_with("<!doctype html>"));
  CHECK(html.ends_with("</html>\n"));
  CHECK(contains(html, "<h1>home</h1>"));
  CHECK(contains(html, "trace " + hash));
  CHECK(contains(html, "/home.toml --seed 1 --for 70s</pre>"));
  for (const auto* id : {"map", "time", "losses", "motes", "energy", "tuples", "proxies", "peers"})
    CHECK(contains(html, std::string("<section id='") + id + "'>"));
  for (const auto* word : {"<script", "://", "src=", "href=", "url("})
    CHECK_FALSE(contains(html, word));
}

TEST_CASE("tables over time say what the report says at the end", "[cli]") {
  const scratch_folder folder;
  const auto x = shell('"' + binary + "\" run --json " + home + " --csv " + folder.file("data") +
                       " --csv-every 2min 2>/dev/null");
  REQUIRE(x.status == 0);
  const auto report = nlohmann::json::parse(x.out);
  std::map<std::string, std::vector<std::string>> tables;
  for (const std::string name : {"energy", "links", "losses", "tuples", "events"}) {
    CAPTURE(name);
    tables[name] = lines_of(text_of(folder.file("data/" + name + ".csv")));
    REQUIRE(tables[name].size() > 10);
    CHECK(tables[name].front().starts_with("time_s,"));
  }
  std::map<std::string, std::string> used;
  for (const auto& line : tables["energy"]) {
    const auto fields = fields_of(line);
    REQUIRE(fields.size() == 6);
    used[fields[1] + '/' + fields[2]] = fields[4];
  }
  CHECK(tables["energy"].size() == 1 + 6 * 13);
  const auto& motes = report.at("energy").at("motes");
  double sum = 0;
  for (const auto& [mote, mah] : used)
    if (mote != "island/mote")
      sum += std::stod(mah);
  CHECK(motes.size() == used.size() - 1);
  CHECK(sum == Approx(report.at("energy").at("used_mah").get<double>()).epsilon(1e-6));
  CHECK(tables["events"].size() == 1 + report.at("event_log").size());
  std::map<std::string, std::uint64_t> collisions;
  for (const auto& line : tables["losses"]) {
    const auto fields = fields_of(line);
    if (fields.at(2) == "radio" && fields.at(3) == "collision")
      collisions[fields[1]] = std::stoull(fields.at(4));
  }
  for (const auto& island : report.at("islands"))
    CHECK(collisions[island.at("name")] == island.at("radio").at("lost").at("collision"));
}

TEST_CASE("what cannot be written refuses a run, or is told at its end", "[cli]") {
  CHECK(run(home + " --for 1s --report /nowhere/x.html").status == 2);
  CHECK(contains(run(home + " --for 1s --report /nowhere/x.html").out, "/nowhere/x.html"));
  CHECK(run(home + " --for 1s --csv /proc/nowhere").status == 2);
  CHECK(run(home + " --for 1s --csv-every 5s").status == 2); // without --csv
  CHECK(run(home + " --for 1s --report x.html --check-determinism").status == 2);
  const auto full = run(home + " --for 1s --report /dev/full");
  CHECK(full.status == 1);
  CHECK(contains(full.out, "/dev/full is not complete"));
}

TEST_CASE("the text is as wide as COLUMNS says, and in a file nothing is cut", "[cli]") {
  const auto wide = run(home + " --for 20s");
  for (const auto& line : lines_of(wide.out))
    CHECK((!contains(line, "…") || line.starts_with("  … "))); // rows that are left out
  const auto narrow = run(home + " --for 20s", "COLUMNS=62 ");
  for (const auto& line : lines_of(narrow.out)) {
    std::size_t characters = 0;
    for (const char c : line)
      characters += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0;
    CAPTURE(line);
    CHECK(characters <= 62);
  }
  CHECK(contains(narrow.out, "… too narrow for "));
}

TEST_CASE("--full shows every row", "[cli]") {
  const std::string lab = "'" RUBICON_CONFIG_DIR "/intel-lab.toml' --for 2min";
  const auto brief = run(lab);
  const auto full = run(lab + " --full");
  CHECK(contains(brief.out, "more; --full shows all"));
  CHECK_FALSE(contains(full.out, "--full"));
  CHECK(lines_of(full.out).size() > lines_of(brief.out).size() + 80);
  CHECK(run(home + " --full --json").status == 2);
}

TEST_CASE("times of a long run are those of a clock", "[cli]") {
  const auto x = run("'" RUBICON_CONFIG_DIR "/intel-lab.toml' --for 61min");
  CHECK(contains(x.out, "\n      time  who"));
  CHECK(contains(x.out, "  0:0"));
}

TEST_CASE("a swarm has a page too", "[cli]") {
  const scratch_folder folder;
  const auto file = folder.file("swarm.html");
  const auto x = shell('"' + binary + "\" swarm " + home + " --seeds 1..4 --for 20s --report " +
                       file + " 2>&1");
  CHECK(x.status == 0);
  const auto html = text_of(file);
  CHECK(contains(html, "--seeds 1..4 --for 20s</pre>"));
  CHECK(contains(html, "messages arrived, %"));
  CHECK(html.ends_with("</html>\n"));
  CHECK_FALSE(contains(html, "<script"));
  CHECK(shell('"' + binary + "\" swarm " + home +
              " --seeds 1..1 --report /nowhere/x.html >/dev/null 2>&1")
            .status == 2);
}

TEST_CASE("a run in wall time tells its events as they happen, and tables have them too", "[cli]") {
  const scratch_folder folder;
  const auto wall = '"' + binary + "\" run " + home + " --mode wall --speed 20 --for 20s";
  const auto error = folder.file("error");
  const auto x = shell(wall + " --json --csv " + folder.file("data") + " 2>" + error);
  CHECK(x.status == 0);
  const auto report = nlohmann::json::parse(x.out); // nothing else is there
  const auto told = lines_of(text_of(error));
  const auto written = lines_of(text_of(folder.file("data") + "/events.csv"));
  CHECK(told.size() == report.at("event_log").size());
  CHECK(told.size() + 1 == written.size());
  REQUIRE(told.size() > 10);
  bool joined = false;
  for (const auto& line : told) {
    CHECK(line.starts_with(" 0:"));
    CHECK_FALSE(contains(line, "\033"));
    joined = joined || line.ends_with("  kitchen/fan  joined");
  }
  CHECK(joined);
  const auto quiet = shell(wall + " --json --log off 2>&1 >/dev/null");
  CHECK(quiet.out.empty());
}
