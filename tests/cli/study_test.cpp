// `rubicon sweep` and `rubicon query` as a user meets them.
#include <fstream>
#include <string>

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
