// `rubicon sweep` and `rubicon query` as a user meets them.
#include <chrono>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/numbers/random.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/shell.hpp"
#include "support/text.hpp"

using rubicon::test::contains;
using rubicon::test::outcome;
using rubicon::test::scratch_folder;
using rubicon::test::shell;

namespace {

const std::string binary = RUBICON_BINARY;

struct study_folder : scratch_folder {
  study_folder() {
    std::ofstream(file("room.toml")) << R"([ecology]
name = "room"
duration = "1min"
[parameters]
loss = 0.1
[radio]
loss = "${loss}"
[[island]]
id = 1
name = "room"
[[island.mote]]
id = 2
name = "meter"
type = 101
position_m = [5, 0]
transducers.temperature = { model = "sine", mean = 20, amplitude = 3 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "10s" }]
)";
  }

  [[nodiscard]] outcome rubicon(const std::string& words, const std::string& before = "") const {
    return shell("cd '" + path.string() + "' && " + before + "'" + binary + "' " + words + " 2>&1");
  }
  [[nodiscard]] std::string answer(const std::string& sql) const {
    return rubicon("query study.db \"" + sql + "\" --csv").out;
  }
};

} // namespace

TEST_CASE("a sweep makes the runs that its database lacks", "[cli]") {
  const study_folder here;
  const auto first = here.rubicon("sweep room.toml --vary loss=0,0.5 --seeds 1..2 --out study.db");
  INFO(first.out);
  REQUIRE(first.status == 0);
  CHECK(contains(first.out, "2 variants, 4 runs, of which 0 in study.db"));
  CHECK(contains(first.out, "messages.delivery"));
  const auto more = here.rubicon("sweep room.toml --vary loss=0..0.5/0.25 --seeds 1..3 "
                                 "--out study.db --csv --of events");
  INFO(more.out);
  REQUIRE(more.status == 0);
  CHECK(contains(more.out, "3 variants, 9 runs, of which 4 in study.db"));
  CHECK(contains(more.out, "\n0.25,events,3,"));
  CHECK(here.answer("SELECT count(*) AS n FROM run") == "n\n9\n");
  CHECK(here.answer("SELECT value, count(*) AS n FROM parameter GROUP BY value ORDER BY value") ==
        "value,n\n0,3\n0.25,3\n0.5,3\n");
}

TEST_CASE("a file that has changed is run anew", "[cli]") {
  const study_folder here;
  const std::string words = "sweep room.toml --vary loss=0 --seeds 1..1 --out study.db --for 10s";
  CHECK(here.rubicon(words).status == 0);
  CHECK(contains(here.rubicon(words).out, "of which 1 in"));
  std::ofstream(here.file("room.toml"), std::ios::app) << "[peis]\n";
  CHECK(contains(here.rubicon(words).out, "of which 0 in"));
  CHECK(contains(here.rubicon(words + " --set radio.queue=3").out, "of which 0 in"));
}

TEST_CASE("what is wrong with a variant is said before any run", "[cli][GEN-06]") {
  const study_folder here;
  const auto x = here.rubicon("sweep room.toml --vary loss=0,2 --seeds 1..2 --out study.db");
  CHECK(x.status == 2);
  CHECK(contains(x.out, "`loss` must be a ratio"));
  CHECK(!std::ifstream(here.file("study.db")).is_open());
  CHECK(here.rubicon("sweep room.toml --vary loss=1..2 --seeds 1..2 --out study.db").status == 2);
  CHECK(here.rubicon("query study.db 'SELECT 1'").status == 2);
}

TEST_CASE("an interrupted sweep keeps the runs that have ended", "[cli]") {
  const study_folder here;
  const auto x =
      here.rubicon("sweep room.toml --vary loss=0 --seeds 1..10000 --out study.db --jobs 1",
                   "timeout -s INT --preserve-status 5 ");
  CHECK(x.status == 130);
  const auto kept = here.answer("SELECT count(DISTINCT run) AS n FROM scalar");
  CHECK(here.answer("SELECT count(*) AS n FROM run") == kept);
}

TEST_CASE("a sweep that is killed at any moment goes on to the same table", "[cli]") {
  const study_folder here;
  const auto sweep = [&](const std::string& database, const std::string& before = "") {
    return shell("cd '" + here.path.string() + "' && " + before + "'" + binary +
                 "' sweep room.toml --vary loss=0,0.5 --seeds 1..12 --for 20s --csv --out " +
                 database + " 2>/dev/null");
  };
  const auto begun = std::chrono::steady_clock::now();
  const auto whole = sweep("whole.db");
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  REQUIRE(whole.status == 0);
  rubicon::random_stream random(1);
  for (int i = 0; i < 10; ++i)
    static_cast<void>(sweep(
        "study.db", "timeout -s KILL " + std::to_string(0.3 * random.unit() * took.count()) + ' '));
  const auto resumed = sweep("study.db");
  CHECK(resumed.status == 0);
  CHECK(resumed.out == whole.out);
  CHECK(here.answer("SELECT count(*) AS n FROM run") == "n\n24\n");
}

TEST_CASE("a sweep until a figure is precise ends at a look", "[cli]") {
  const study_folder here;
  const std::string words = "sweep room.toml --vary loss=0 --seeds 1..40 --for 20s --out study.db "
                            "--csv --of motes.joined --until ";
  const auto precise = here.rubicon(words + "'motes.joined ci < 1%'");
  INFO(precise.out);
  CHECK(precise.status == 0);
  CHECK(contains(precise.out,
                 "1 variant of at most 40 runs in study.db; a variant ends after 8, 16, 32, 40 "
                 "runs: each interval has 98.75 %"));
  CHECK(contains(precise.out, "\n0,motes.joined,8,1,1,1,"));
  CHECK(here.answer("SELECT count(*) AS n FROM run") == "n\n8\n");
  CHECK(contains(here.rubicon(words + "'nothing ci < 1%'").out, "\n0,motes.joined,40,"));
}

TEST_CASE("a comparison finds what differs, and nothing in equal runs", "[cli]") {
  const study_folder here;
  const auto same = here.rubicon("compare '" + binary + "' '" + binary +
                                 "' --file room.toml --seeds 1..4 --for 20s");
  INFO(same.out);
  CHECK(same.status == 0);
  CHECK(contains(same.out, "4 pairs of runs, "));
  CHECK(contains(same.out, "all are equal in all pairs"));
  CHECK(here.rubicon("sweep room.toml --vary loss=0 --seeds 1..10 --out a.db").status == 0);
  CHECK(here.rubicon("sweep room.toml --vary loss=0 --set radio.loss=0.6 --seeds 1..10 --out b.db")
            .status == 0);
  const auto studies = here.rubicon("compare a.db b.db");
  INFO(studies.out);
  CHECK(studies.status == 1);
  CHECK(contains(studies.out, "10 pairs of runs"));
  CHECK(contains(studies.out, "radio.transmissions"));
  CHECK(here.rubicon("compare room.toml a.db").status == 2);
  CHECK(here.rubicon("compare '" + binary + "' '" + binary + "'").status == 2);
  CHECK(here.rubicon("compare room.toml missing.toml").status == 2);
}

TEST_CASE("two records of one seed part where their runs do", "[cli]") {
  const study_folder here;
  CHECK(here.rubicon("run room.toml --record a.rec").status == 0);
  CHECK(here.rubicon("run room.toml --record b.rec --set loss=0.6").status == 0);
  CHECK(contains(here.rubicon("compare a.rec a.rec").out, " records are equal."));
  const auto x = here.rubicon("compare a.rec b.rec");
  INFO(x.out);
  CHECK(x.status == 1);
  CHECK(contains(x.out, "They part after "));
}

TEST_CASE("a file is shrunk to what its violation needs", "[cli]") {
  const study_folder here;
  struct placed {
    const char* name;
    const char* position;
  };
  std::string yard = "[ecology]\nname = \"yard\"\nduration = \"10min\"\n[radio]\nrange = \"24m\"\n"
                     "[[island]]\nid = 1\nname = \"yard\"\n";
  int id = 2;
  for (const auto& each : std::vector<placed>{{"gate", "1, 3"},
                                              {"barn", "15, 5"}, // the only route from the well
                                              {"well", "30, 7"},
                                              {"shed", "4, 0"},
                                              {"roof", "0, 5"}})
    yard += "[[island.mote]]\nid = " + std::to_string(id++) + "\nname = \"" + each.name +
            "\"\ntype = 101\nposition_m = [" + each.position + "]\n";
  for (const auto* each : {"gate", "shed", "roof"})
    yard +=
        "[[fault]]\nat = \"2min\"\nkind = \"crash\"\nmote = \"yard/" + std::string(each) + "\"\n";
  yard += "[[fault]]\nat = \"5min\"\nkind = \"battery_end\"\nmote = \"yard/barn\"\n";
  std::ofstream(here.file("yard.toml")) << yard << "[[peer]]\nid = 50\nname = \"tablet\"\n";
  const auto x = here.rubicon("shrink yard.toml --seed 3");
  INFO(x.out);
  REQUIRE(x.status == 0);
  CHECK(contains(x.out, "violation: every mote is joined: yard/well: left: silence\n"));
  CHECK(contains(x.out, "1 of 4 faults and changes, 2 of 5 motes"));
  CHECK(contains(x.out, "0 of 1 peers"));
  CHECK(contains(x.out, "\nrubicon run yard.small.toml --seed 3"));
  CHECK(contains(here.rubicon("run yard.small.toml --seed 3").out, "yard/well: left: silence"));
  CHECK(here.rubicon("explain yard.small.rec").status == 0);
  CHECK(here.rubicon("shrink room.toml --seed 1").status == 2); // which has no violation
  CHECK(!contains(shell("ls -a '" + here.path.string() + "'").out, ".shrink-"));
}

TEST_CASE("a sweep writes a page and keeps series", "[cli]") {
  const study_folder here;
  const auto x = here.rubicon("sweep room.toml --vary loss=0,0.5 --seeds 1..2 --out study.db "
                              "--report study.html --series 20s");
  INFO(x.out);
  REQUIRE(x.status == 0);
  CHECK(here.answer("SELECT count(DISTINCT run) AS runs, count(*) AS n FROM series WHERE name = "
                    "'energy.used_mah'") == "runs,n\n4,12\n");
  std::ifstream in(here.file("study.html"));
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  CHECK(contains(page, "messages.delivery"));
  CHECK(contains(page, "2 variants · 4 runs"));
  CHECK(contains(page, "rubicon run room.toml --set loss=0"));
}

TEST_CASE("a swarm leaves out kinds of faults, and a replay the same", "[cli][ACT-04]") {
  const study_folder here;
  std::ofstream(here.file("room.toml"), std::ios::app) << R"([[fault]]
at = "30s"
kind = "crash"
mote = "room/meter"
[[expect]]
kind = "sometimes"
name = "a crash"
text = "crash"
who = "meter"
[[expect]]
kind = "sometimes"
name = "a miracle"
text = "miracle"
)";
  const auto all = here.rubicon("swarm room.toml --seeds 1..12 --vary-faults --json");
  INFO(all.out);
  CHECK(all.status == 1); // of a situation that no run came into
  const auto found = nlohmann::json::parse(all.out);
  CHECK(found.at("failures") == 0);
  REQUIRE(found.at("situations").size() == 2);
  const auto crashes = found.at("faults").at("crash").get<int>();
  CHECK((crashes > 0 && crashes < 12));
  CHECK(found.at("situations").at(0).at("runs") == crashes);
  CHECK(found.at("situations").at(1).at("first_seed") == nullptr);
  CHECK(found.at("violations").empty());
  const auto first = found.at("situations").at(0).at("first_seed").get<int>();
  const auto replay = here.rubicon("run room.toml --set ecology.vary_faults=true --json --seed " +
                                   std::to_string(first));
  CHECK(nlohmann::json::parse(replay.out).at("expectations").at(0).at("met") == true);
}

TEST_CASE("a swarm says what a violating seed has drawn, and its replay the same",
          "[cli][ACT-04]") {
  const study_folder here;
  std::ofstream(here.file("room.toml"), std::ios::app) << R"([[fault]]
at = "30s"
kind = "crash"
mote = "room/meter"
[[fault]]
at = "40s"
kind = "unplug"
island = "room"
for = "5s"
[[expect]]
kind = "delivery"
at_least = 1
)";
  const auto all = here.rubicon("swarm room.toml --seeds 1..8 --vary-faults --json "
                                "--set 'parameters.loss={ from = 0.4, to = 0.9 }'");
  INFO(all.out);
  CHECK(all.status == 1);
  const auto found = nlohmann::json::parse(all.out);
  REQUIRE(!found.at("violations").empty());
  bool leaves_out = false;
  for (const auto& each : found.at("violations")) {
    const auto& varied = each.at("varied");
    const auto loss = std::stod(varied.at("drawn").at("loss").get<std::string>());
    CHECK((loss >= 0.4 && loss <= 0.9));
    leaves_out = leaves_out || !varied.at("left_out").empty();
    const auto command = each.at("replay").get<std::string>();
    REQUIRE(command.starts_with("rubicon "));
    const auto replay = here.rubicon(command.substr(8) + " --json");
    CHECK(nlohmann::json::parse(replay.out).at("varied") == varied);
  }
  CHECK(leaves_out);
}
