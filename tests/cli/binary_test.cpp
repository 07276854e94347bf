#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "support/catch.hpp"
#include "support/shell.hpp"
#include "support/text.hpp"

using rubicon::test::lines_of;
using rubicon::test::outcome;
using rubicon::test::shell;

namespace {

const std::string binary = RUBICON_BINARY;

std::string fixture(const std::string& file) {
  return RUBICON_FIXTURES "/" + file;
}

outcome standard_output(const std::string& arguments) {
  return shell('"' + binary + "\" " + arguments + " 2>/dev/null");
}

outcome standard_error(const std::string& arguments) {
  return shell('"' + binary + "\" " + arguments + " 2>&1 >/dev/null");
}

} // namespace

TEST_CASE("check tells every mistake of a file with its position", "[cli][GEN-06]") {
  const auto file = fixture("three_mistakes.toml");
  const auto x = standard_error("check '" + file + '\'');
  CHECK(x.status == 2);
  const auto lines = lines_of(x.out);
  CAPTURE(x.out);
  REQUIRE(lines.size() == 4);
  CHECK(lines[0].starts_with(file + ":7:1: "));  // key nobody knows
  CHECK(lines[1].starts_with(file + ":11:6: ")); // text where a number belongs
  CHECK(lines[2].starts_with(file + ":22:6: ")); // the same id twice
  CHECK(lines[3] == file + ": 3 problems");
}

TEST_CASE("of very many mistakes the first fifty are told, and how many there are",
          "[cli][GEN-06]") {
  const auto x = shell("{ echo '[ecology]'; for i in $(seq 60); do echo \"x$i = 1\"; done; } | \"" +
                       binary + "\" check - 2>&1 >/dev/null");
  CHECK(x.status == 2);
  const auto lines = lines_of(x.out);
  REQUIRE(lines.size() == 51);
  CHECK(lines[49].starts_with("<stdin>:"));
  CHECK(lines[50] == "<stdin>: 62 problems, the first 50 are above");
}

TEST_CASE("a file may come from standard input", "[cli]") {
  const auto file = '\'' + fixture("small.toml") + '\'';
  const auto named = standard_output("run --for 5s --json " + file);
  const auto piped = shell("\"" + binary + "\" run --for 5s --json - <" + file + " 2>/dev/null");
  CHECK(piped.status == 0);
  const auto hash = [](const outcome& x) { return nlohmann::json::parse(x.out).at("trace_hash"); };
  CHECK(hash(piped) == hash(named));
}

TEST_CASE("run refuses what check refuses", "[cli][GEN-06]") {
  const auto file = '\'' + fixture("three_mistakes.toml") + '\'';
  const auto x = standard_error("run " + file);
  CHECK(x.status == 2);
  CHECK(x.out == standard_error("check " + file).out);
  CHECK(standard_output("run --json " + file).out.empty());
}

TEST_CASE("what hardly is meant is a warning, or with --strict a mistake", "[cli][GEN-06]") {
  const auto file = fixture("slips.toml");
  const std::vector<std::string> told{
      ":17:56: %a rule of pc writes `an` to `hall.lamp-2.switch`, which accepts \"on\" or \"off\"",
      ":18:41: %a rule of pc compares `hall.lamp-2.state` with 1, but its values are \"off\" or "
      "\"on\", which are not numbers"};
  const auto all = [&](const std::string& kind) {
    std::string out;
    for (auto each : told)
      out += file + each.replace(each.find('%'), 1, kind) + '\n';
    return out;
  };
  for (const std::string command : {"check ", "run "}) {
    CAPTURE(command);
    const auto warned = standard_error(command + '\'' + file + '\'');
    CHECK(warned.status == 0);
    CHECK(warned.out == all("warning: "));
    CHECK_FALSE(standard_output(command + '\'' + file + '\'').out.empty());
    const auto refused = standard_error(command + "--strict '" + file + '\'');
    CHECK(refused.status == 2);
    CHECK(refused.out == all("") + file + ": 2 problems\n");
    CHECK(standard_output(command + "--strict '" + file + '\'').out.empty());
  }
}

TEST_CASE("a file that cannot be an ecology costs one line", "[cli][GEN-06]") {
  const auto file = GENERATE(as<std::string>{}, "empty.toml", "binary.toml", "missing.toml", ".");
  for (const auto* command : {"check ", "run "}) {
    CAPTURE(file, command);
    const auto path = fixture(file);
    const auto x = standard_error(command + ('\'' + path + '\''));
    CHECK(x.status == 2);
    CHECK(lines_of(x.out).size() == 1);
    CHECK(x.out.starts_with(path + ':'));
  }
}

TEST_CASE("a bad command line ends with status 2 and an empty standard output", "[cli]") {
  const auto arguments = GENERATE(as<std::string>{}, "fly", "help fly", "run", "run --nope x.toml");
  CAPTURE(arguments);
  CHECK(standard_output(arguments).status == 2);
  CHECK(standard_output(arguments).out.empty());
  CHECK(standard_error(arguments).out.starts_with("rubicon: "));
}

TEST_CASE("help and version go to standard output", "[cli][GEN-01]") {
  CHECK(standard_output("--help").status == 0);
  CHECK(standard_output("--help").out.find("proxy manager") != std::string::npos);
  CHECK(standard_output("--version").status == 0);
  CHECK(standard_error("--version").out.empty());
}

TEST_CASE("check sums a good file up", "[cli]") {
  const auto x = standard_output("check '" + fixture("small.toml") + '\'');
  CHECK(x.status == 0);
  CHECK(x.out.find("small") != std::string::npos);
  CHECK(standard_error("check '" + fixture("small.toml") + '\'').out.empty());
}

TEST_CASE("check reads the files that a file names, and those that replace them", "[cli][GEN-06]") {
  const auto file = '\'' + fixture("gains.toml") + '\'';
  const auto named = standard_output("check " + file);
  CHECK(named.status == 0);
  CHECK(named.out.find("2 gains of a topology") != std::string::npos);
  const auto replaced =
      standard_output("check --topology '" + fixture("three_gains.txt") + "' " + file);
  CHECK(replaced.status == 0);
  CHECK(replaced.out.find("3 gains of a topology") != std::string::npos);
  const auto broken =
      standard_error("check --topology '" + fixture("broken_gains.txt") + "' " + file);
  CHECK(broken.status == 2);
  CHECK(lines_of(broken.out).size() == 1);
  CHECK(broken.out.starts_with(fixture("broken_gains.txt") + ":2: "));
  const auto missing = standard_error("run --topology /nowhere/x.txt " + file);
  CHECK(missing.status == 2);
  CHECK(missing.out == "/nowhere/x.txt: cannot be opened: No such file or directory\n");
  CHECK(standard_error("run --noise-trace x.txt " + file).out ==
        fixture("gains.toml") + ": --noise-trace needs [radio.noise] with model = \"trace\"\n");
}

TEST_CASE("with --json standard output is one object and nothing else", "[cli]") {
  const auto x =
      standard_output("run --json --log trace --for 20s --seed 5 '" + fixture("small.toml") + '\'');
  CHECK(x.status == 0);
  const auto report = nlohmann::json::parse(x.out); // throws on anything before or after
  CHECK(report.at("ecology") == "small");
  CHECK(report.at("seed") == 5);
  CHECK(report.at("simulated_s") == 20.0);
  CHECK(report.at("motes").at("configured") == 2);
  CHECK(report.at("trace_hash").get<std::string>().size() == 16);
  CHECK(report.at("violations").empty());
}

TEST_CASE("two runs of one file and seed give the same report", "[cli][GEN-07]") {
  const auto arguments = "run --json --for 20s '" + fixture("small.toml") + '\'';
  auto first = nlohmann::json::parse(standard_output(arguments).out);
  auto second = nlohmann::json::parse(standard_output(arguments).out);
  first.erase("wall_s");
  second.erase("wall_s");
  CHECK(first == second);
}

TEST_CASE("the determinism check prints both hashes", "[cli][ACT-05]") {
  const auto x =
      standard_output("run --check-determinism --for 20s '" + fixture("small.toml") + '\'');
  CHECK(x.status == 0);
  const auto lines = lines_of(x.out);
  REQUIRE(lines.size() == 3);
  CHECK(lines[0].starts_with("first run "));
  CHECK(lines[1].starts_with("second run "));
  CHECK(lines[0].substr(12) == lines[1].substr(12));
  CHECK(lines[2] == "equal");
}

TEST_CASE("a report for a pipe holds no escapes", "[cli]") {
  const auto x = standard_output("run --for 20s '" + fixture("small.toml") + '\'');
  CHECK(x.status == 0);
  CHECK(x.out.find('\033') == std::string::npos);
  CHECK(x.out.find("no violations") != std::string::npos);
}

TEST_CASE("output that cannot be written is not passed over", "[cli]") {
  const auto file = '\'' + fixture("small.toml") + '\'';
  CHECK(shell('"' + binary + "\" run --json --for 1s " + file + " >/dev/full 2>/dev/null").status ==
        2);
  CHECK(shell('"' + binary + "\" check " + file + " >/dev/full 2>/dev/null").status == 2);
  const auto why = shell('"' + binary + "\" run --json --for 1s " + file + " 2>&1 >/dev/full");
  CHECK(why.out.find("rubicon: standard output cannot be written: No space left on device\n") !=
        std::string::npos);
}

TEST_CASE("doctor looks at the Bluetooth adapter that a file uses", "[cli][BT-01]") {
  const auto x =
      shell("folder=$(mktemp -d) && cd \"$folder\" && printf '%s\\n' '[ecology]' 'name = \"a\"' "
            "'mode = \"wall\"' '[[peer]]' 'id = 7' 'name = \"pc\"' "
            "'bluetooth = { adapter = \"hci97\" }' > a.toml && \"" +
            binary + "\" doctor a.toml; status=$?; rm -r \"$folder\"; exit $status");
  CAPTURE(x.out);
  CHECK(x.status == 1);
  const auto found = x.out.find("cannot open Bluetooth adapter hci97: ");
  REQUIRE(found != std::string::npos);
  CHECK(x.out.find("; plug it in and switch it on", found) < x.out.find('\n', found));
  CHECK(x.out.find("fault    bluetooth ") != std::string::npos);
  CHECK(x.out.find("ok       multicast ") != std::string::npos); // no peer has `lan`
}

TEST_CASE("any number of columns is fine", "[cli]") {
  const auto file = '\'' + fixture("small.toml") + '\'';
  for (const auto* columns : {"1", "20", "4294967296", "18446744073709551615"}) {
    const auto x = shell("COLUMNS=" + std::string(columns) + " \"" + binary + "\" run --for 1s " +
                         file + " 2>/dev/null");
    CHECK(x.status == 0);
    CHECK(x.out.size() > 200);
    CHECK(x.out.size() < 200'000);
  }
}

TEST_CASE("the log of a run shows that its init ends last", "[cli][SVC-01]") {
  const auto file = fixture("../../../config/scenarios/peis/components.toml");
  const auto x = standard_error("run --for 5s --log info '" + file + '\'');
  CHECK(x.status == 0);
  const auto place_of = [&x](const std::string& what) {
    CAPTURE(what, x.out);
    const auto at = x.out.find(what);
    CHECK(at != std::string::npos);
    return at;
  };
  const auto last = place_of(R"(who=peis_peer/care-init what="ended")");
  for (const std::string component : {"care-rules", "care-logger", "care-planner"})
    CHECK(place_of("who=peis_peer/" + component + R"( what="ended")") < last);
  CHECK(place_of("all components are off") < last);
}

TEST_CASE("an interrupted run stops its components first", "[cli][ACT-11][SVC-01][SVC-05]") {
  const auto folder = std::filesystem::temp_directory_path() /
                      ("rubicon-interrupted-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const auto file = folder / "worker.toml";
  std::ofstream(file) << R"(
[ecology]
name = "worker"
mode = "wall"
duration = "1h"

[[peer]]
id = 1
name = "pc"

[[peer.apps]]
app = "init"
lock = "lock"
components = [{ name = "worker", command = "trap '' INT; while :; do sleep 1000; done", id = 2 }]
)";
  const std::string script =
      "pid=$(mktemp); "
      "{ echo $BASHPID >\"$pid\"; exec \"$0\" run --log info \"$1\" 2>&1 >/dev/null; } "
      "| { grep -m 1 \"worker on\"; kill -INT \"$(cat \"$pid\")\"; rm \"$pid\"; cat; }";
  const auto x = shell("bash -o pipefail -c '" + script + "' '" + binary + "' '" + file.string() +
                       "' 2>/dev/null");
  std::filesystem::remove_all(folder);
  CAPTURE(x.out);
  CHECK(x.status == 130);
  const auto off = x.out.find("worker off");
  const auto last = x.out.find(R"(who=peis_peer/pc what="ended")");
  REQUIRE(off != std::string::npos);
  REQUIRE(last != std::string::npos);
  CHECK(off < last);
}

TEST_CASE("a swarm of good runs says so", "[cli][GEN-07]") {
  const auto x =
      standard_output("swarm --seeds 3..6 --jobs 2 --for 20s '" + fixture("small.toml") + '\'');
  CHECK(x.status == 0);
  CHECK(x.out.starts_with("4 runs in "));
  CHECK(x.out.find("no violations") != std::string::npos);
}

TEST_CASE("a swarm finds the seeds whose runs end with violations", "[cli]") {
  const auto file = '\'' + fixture("far.toml") + '\'';
  std::vector<int> bad;
  for (int seed = 1; seed <= 6; ++seed) {
    if (standard_output("run --seed " + std::to_string(seed) + ' ' + file).status != 0)
      bad.push_back(seed);
  }
  REQUIRE(!bad.empty());
  REQUIRE(bad.size() < 6);

  const auto json = standard_output("swarm --json --seeds 1..6 --jobs 3 " + file);
  CHECK(json.status == 1);
  const auto object = nlohmann::json::parse(json.out);
  CHECK(object.at("runs") == 6);
  CHECK(object.at("failed_seeds") == bad);
  CHECK(object.at("interrupted") == false);
  CHECK(object.at("events") > 0);
  const auto& first = object.at("violations").at(0);
  CHECK(first.at("seed") == bad[0]);
  CHECK(first.at("invariant") == "every mote is joined");

  // Text: the lines come in the order of seeds, and the last words of a line are a command.
  const auto text = standard_output("swarm --seeds 1..6 --jobs 2 " + file);
  CHECK(text.status == 1);
  const auto line = lines_of(text.out).at(0);
  CHECK(line.starts_with("seed " + std::to_string(bad[0]) + "  every mote is joined  room/far: "));
  const std::string mark = "  replay: rubicon ";
  const auto at = line.find(mark);
  REQUIRE(at != std::string::npos);
  CHECK(standard_output(line.substr(at + mark.size())).status == 1);
}

TEST_CASE("a run that does not end is a violation of its seed", "[cli]") {
  // Ten years cannot be done in a tenth of a second.
  const auto x = standard_output("swarm --seeds 1..2 --for 3650d --timeout 100ms '" +
                                 fixture("small.toml") + '\'');
  CHECK(x.status == 1);
  const auto lines = lines_of(x.out);
  REQUIRE(lines.size() >= 2);
  CHECK(lines[0].starts_with("seed 1  no end  the run had not ended after 100 ms  replay: "));
  CHECK(lines[1].starts_with("seed 2  no end  "));
}

TEST_CASE("an interrupted swarm ends with what it knows", "[cli][ACT-11]") {
  // Its first line says that it is in flight; then it is interrupted, and the rest is kept.
  const std::string script =
      "pid=$(mktemp); "
      "{ echo $BASHPID >\"$pid\"; exec \"$0\" swarm --seeds 1..1000000 \"$1\"; } "
      "| { read -r line; kill -INT \"$(cat \"$pid\")\"; rm \"$pid\"; cat; }";
  const auto x = shell("bash -o pipefail -c '" + script + "' '" + binary + "' '" +
                       fixture("far.toml") + "' 2>/dev/null");
  CHECK(x.status == 130);
  const auto lines = lines_of(x.out);
  REQUIRE(!lines.empty());
  CHECK(lines.back().starts_with("interrupted: 999,"));
  CHECK(lines.back().ends_with(" runs missing"));
}

TEST_CASE("a swarm refuses what a run refuses", "[cli][GEN-06]") {
  const auto file = '\'' + fixture("three_mistakes.toml") + '\'';
  const auto x = standard_error("swarm --seeds 1..3 " + file);
  CHECK(x.status == 2);
  CHECK(x.out == standard_error("check " + file).out);
  CHECK(shell('"' + binary + "\" swarm --seeds 1..2 --for 1s '" + fixture("small.toml") +
              "' >/dev/full 2>/dev/null")
            .status == 2);
}

TEST_CASE("a build without Bluetooth says so where it is asked for, and runs the rest as ever",
          "[cli][peis][LNK-04]") {
  const std::string without = RUBICON_WITHOUT_BLUETOOTH;
  const auto small = '\'' + fixture("small.toml") + '\'';
  const auto hash = [&](const std::string& of) {
    const auto x = shell('"' + of + "\" run --for 5s --json " + small + " 2>/dev/null");
    return nlohmann::json::parse(x.out).at("trace_hash");
  };
  CHECK(hash(without) == hash(binary));

  constexpr const char* robot = "[ecology]\nname = \"robots\"\n[[peer]]\nid = 1\nname = \"robot\"\n"
                                "bluetooth = [\"hci0\"]\nposition_m = [0, 0]\n";
  const auto check = [&](const std::string& with) {
    return shell("printf '%s' '" + std::string(robot) + "' | \"" + with + "\" check - 2>&1");
  };
  CHECK(check(binary).status == 0);
  const auto refused = check(without);
  CHECK(refused.status == 2);
  CHECK(refused.out == "<stdin>:6:13: this rubicon was built without Bluetooth; "
                       "build it with -DRUBICON_BLUETOOTH=ON\n");
}
