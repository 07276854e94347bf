// An ecology whose parts are processes of their own, as on PCs of their own.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "control/server.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/shell.hpp"
#include "support/text.hpp"

using namespace rubicon;
using rubicon::test::shell;

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using rubicon::test::text_of;

const std::string binary = RUBICON_BINARY;

/// A folder with the house on ports that nobody else has, gone with the test.
class house {
public:
  house() {
    auto toml = text_of(fs::path(RUBICON_CONFIG_DIR) / "house.toml");
    for (std::size_t at = 0; (at = toml.find("control_port = 42", at)) != std::string::npos;)
      toml.replace(at, 17, "control_port = 47");
    file("house.toml", toml);
  }

  /// Of a shell in the folder, in which
  /// `part HOST LENGTH NAME` runs a part, and leaves its report in NAME.json, what it says in
  /// NAME.err, and its exit status in NAME.status;
  /// `host NAME [OPTION...]` is the service of a host, at its control port, with its certificate
  /// of `certs NAME...`, and `me` the options of whoever deploys with that of `me`;
  /// `hosts` begins all three, whose numbers are $kitchen, $bedroom and $care, until `end`.
  void run(const std::string& script) const {
    const std::string functions =
        "export XDG_STATE_HOME=$PWD/state TMPDIR=$PWD; rubicon() { '" + binary +
        "' \"$@\"; }; start() { exec '" + binary +
        "' \"$@\"; }; "
        "part() { rubicon run house.toml --host $1 --for $2 --json --starts $1.starts "
        "> $3.json 2> $3.err; echo $? > $3.status; }; "
        "certs() { rubicon certs init > certs.log; "
        "for name in \"$@\"; do rubicon certs add $name "
        "$([ $name = me ] && echo --coordinator || echo --host) >> certs.log; done; }; "
        "tls() { echo --tls-cert certs/$1.crt --tls-key certs/$1.key --tls-ca certs/ca.crt; }; "
        "host() { name=$1; port=$2; shift 2; exec '" +
        binary +
        "' host --name $name --listen 127.0.0.1:$port --state hosts $(tls $name) \"$@\" "
        ">> $name.log 2>&1; }; "
        "hosts() { certs kitchen bedroom care me; host kitchen 4750 & kitchen=$!; "
        "host bedroom 4760 & bedroom=$!; host care 4770 & care=$!; me=$(tls me); }; "
        "end() { kill $kitchen $bedroom $care; wait; }; ";
    static_cast<void>(
        shell("cd '" + folder_.path.string() + "' && { " + functions + script + "; } 2>/dev/null"));
  }

  [[nodiscard]] json report(const std::string& name) const {
    INFO(name + ": " + text(name + ".err"));
    auto found = json::parse(text(name + ".json"), nullptr, false);
    REQUIRE_FALSE(found.is_discarded());
    return found;
  }
  [[nodiscard]] std::string text(const std::string& file) const {
    return text_of(folder_.path / file);
  }
  void file(const std::string& name, const std::string& content) const {
    std::ofstream(folder_.path / name) << content;
  }

private:
  const test::scratch_folder folder_;
};

/// What was noted of each, in order, without times.
std::map<std::string, std::vector<std::string>> events_of(const std::vector<json>& reports,
                                                          const std::string& part) {
  std::map<std::string, std::vector<std::string>> found;
  for (const auto& report : reports)
    for (const auto& event : report["event_log"]) {
      const std::string what = event["what"];
      if (what.find(part) != std::string::npos)
        found[event["who"]].push_back(what);
    }
  return found;
}

void check_good(const json& report) {
  CHECK(report["complete"] == true);
  CHECK(report["violations"].dump() == "[]");
}

const json& element(const json& all, const std::string& key, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& x) { return x[key] == name; });
  REQUIRE(found != all.end());
  return *found;
}

} // namespace

TEST_CASE("three processes do what one does", "[hosts][GEN-05]") {
  const house in;
  in.run("part kitchen 25s kitchen & part bedroom 25s bedroom & part care 25s care & wait");
  const std::vector<json> parts{in.report("kitchen"), in.report("bedroom"), in.report("care")};
  for (const auto& part : parts)
    check_good(part);
  CHECK(element(parts[2]["proxies"], "proxy", "kitchen.stove")["values"]["temperature"] ==
        "28.0 C");
  CHECK(element(parts[2]["proxies"], "proxy", "bedroom.window")["status"] == "active");

  const auto whole = shell(
      '"' + binary + "\" run \"" RUBICON_CONFIG_DIR "/house.toml\" --for 25s --json 2>/dev/null");
  REQUIRE(whole.status == 0);
  const std::vector<json> one{json::parse(whole.out)};
  for (const auto* what : {"joined", "writes ", "switch "})
    CHECK(events_of(parts, what) == events_of(one, what));
  const auto acknowledged = [](const json& report) {
    return element(report["islands"], "name", "kitchen")["messages"]["reliable_failed"];
  };
  CHECK(acknowledged(parts[0]) == 0); // the button's go to the other island, on another host
  CHECK(element(element(parts[0]["islands"], "name", "kitchen")["motes"], "name",
                "button")["messages"]["reliable_acked"]
            .get<int>() >= 3);
}

TEST_CASE("a part that was killed begins a later life, and all go on", "[hosts][NFR-08]") {
  const house in;
  in.run("part bedroom 28s bedroom & part care 28s care & "
         "'" +
         binary +
         "' run house.toml --host kitchen --json --starts kitchen.starts "
         "> gone.json 2> gone.err & victim=$!; "
         "sleep 6; kill -9 $victim; sleep 1; part kitchen 21s again; wait");
  CHECK(in.text("gone.json").empty());
  CHECK(in.text("kitchen.starts") == "2\n");
  const auto again = in.report("again");
  check_good(again);
  for (const auto& mote : element(again["islands"], "name", "kitchen")["motes"])
    CHECK(mote["incarnations"] == 2);
  CHECK(element(again["islands"], "name", "kitchen")["messages"]["reliable_failed"] == 0);
  const auto care = in.report("care");
  check_good(care);
  CHECK(element(care["proxies"], "proxy", "kitchen.fan")["status"] == "active");
  check_good(in.report("bedroom"));
  // The stove is warm 15 s after the kitchen began anew.
  CHECK(events_of({again}, "switch on").at("kitchen/fan").size() == 1);
}

TEST_CASE("what is in the way of a part is said before anything starts", "[hosts]") {
  const house in;
  const auto refused = [&in](const std::string& arguments) {
    in.run("'" + binary + "' run house.toml " + arguments + " 2> err; echo $? > status");
    CHECK(in.text("status") == "2\n");
    return in.text("err");
  };
  CHECK(refused("--host hall").find("there is no [[host]] named `hall`") != std::string::npos);
  CHECK(refused("--host care --mode virtual").find("in wall time only") != std::string::npos);
  CHECK(refused("--starts x").find("--host") != std::string::npos);
  in.run("echo oops > care.starts; part care 1s care");
  CHECK(in.text("care.status") == "2\n");
  CHECK(in.text("care.err").find("care.starts contains no number") != std::string::npos);
}

TEST_CASE("two processes of one part: the second is told that the port is taken", "[hosts]") {
  const house in;
  in.run("part care 4s first & sleep 1; "
         "'" +
         binary +
         "' run house.toml --host care --for 2s --json --starts other.starts "
         "> second.json 2> second.err; wait");
  check_good(in.report("first"));
  const auto second = in.report("second");
  CHECK(second["complete"] == false);
  CHECK(second["reason"].get<std::string>().find("cannot listen") != std::string::npos);
}

TEST_CASE("a deployment starts again what was killed, and makes one report", "[hosts][NFR-08]") {
  const house in;
  in.run("'" + binary +
         "' deploy house.toml --local --for 28s --json > all.json 2> all.err & "
         "sleep 12; pkill -9 -f \"^rubicon run $PWD/.*--bundled --host kitchen\"; wait");
  const auto report = in.report("all");
  check_good(report);
  CHECK(in.text("all.err").find("kitchen  has ended with signal 9 after ") != std::string::npos);
  CHECK(report["islands"].size() == 2);
  for (const auto& mote : element(report["islands"], "name", "kitchen")["motes"]) {
    CHECK(mote["joined"] == true);
    CHECK(mote["incarnations"] == 2);
  }
  const auto& button =
      element(element(report["islands"], "name", "kitchen")["motes"], "name", "button")["messages"];
  CHECK(button["reliable_sent"].get<int>() == button["reliable_acked"].get<int>() +
                                                  button["reliable_failed"].get<int>() +
                                                  button["reliable_open"].get<int>());
  CHECK(element(report["proxies"], "proxy", "bedroom.window")["status"] == "active");
  CHECK(events_of({report}, "last contact").size() == 1);
}

TEST_CASE("Ctrl-C ends a deployment with what it has", "[hosts][ACT-11]") {
  const house in;
  in.run("'" + binary +
         "' deploy house.toml --local --json --report all.html > all.json 2> all.err & "
         "whole=$!; sleep 4; kill -INT $whole; wait $whole; echo $? > status");
  CHECK(in.text("status") == "130\n");
  const auto report = in.report("all");
  CHECK(report["interrupted"] == true);
  CHECK(report["islands"].size() == 2);
  CHECK(report["simulated_s"].get<double>() < 20);
  const auto page = in.text("all.html");
  CHECK(page.find("rubicon deploy house.toml --local --seed ") != std::string::npos);
  CHECK(page.find("kitchen/stove") != std::string::npos);
  CHECK(page.ends_with("</html>\n"));
}

TEST_CASE("a deployment tells what would run where, or why it cannot", "[hosts]") {
  const house in;
  in.run("'" + binary +
         "' deploy house.toml --local --dry-run > plan; "
         "sed 's/control_port = 4760/control_port = 4751/' house.toml > clash.toml; "
         "'" +
         binary +
         "' deploy clash.toml --dry-run 2> clash; echo $? > status; "
         "'" +
         binary + "' deploy house.toml --dry-run > nobody");
  CHECK(in.text("plan") ==
        "kitchen  127.0.0.1  control port 4750, PEIS port 4751\n  islands  kitchen\n"
        "  peers    nothing\n"
        "bedroom  127.0.0.1  control port 4760, PEIS port 4761\n  islands  bedroom\n"
        "  peers    robot\n"
        "care  127.0.0.1  control port 4770, PEIS port 4771\n  islands  nothing\n"
        "  peers    care-pc\n");
  CHECK(in.text("nobody").find("kitchen  cannot be reached: 127.0.0.1:4750: Connection refused\n"
                               "kitchen  start there: rubicon host --name kitchen --listen "
                               "127.0.0.1:4750\n") != std::string::npos);
  CHECK(in.text("status") == "2\n");
  CHECK(in.text("clash") == "clash.toml: hosts `kitchen` and `bedroom` both have port 4751 of "
                            "127.0.0.1: give one of them another `control_port` or `peis_port`\n");
  in.run("'" + binary +
         "' deploy '" RUBICON_CONFIG_DIR "/home.toml' --local 2> err; echo $? > status");
  CHECK(in.text("status") == "2\n");
  CHECK(in.text("err").find("it has no [[host]]") != std::string::npos);
}

TEST_CASE("hosts run what is deployed to them, and heal without who has deployed it",
          "[hosts][NFR-08][ACT-11]") {
  const house in;
  in.run("hosts; sleep 1; "
         "start deploy house.toml $me --for 90s --json > first.json 2> first.err & first=$!; "
         "sleep 7; rubicon status > running; rubicon fault 'kill peer robot for 2s' > "
         "done; echo $? > fault; rubicon fault 'crsh mote kitchen/stove' 2> typo; "
         "rubicon hosts --json > network; rubicon fault 'crash mote kitchen/nobody' 2> no-fault; "
         "kill -9 $first; wait $first; kill -9 $kitchen; wait $kitchen; sleep 2; "
         "rubicon status --json > one-gone; host kitchen 4750 & kitchen=$!; sleep 1; "
         "rubicon deploy house.toml $me --attach --json > all.json 2> all.err & all=$!; sleep 8; "
         "rubicon stop; echo $? > stop; wait $all; echo $? > status; end");
  CHECK(in.text("first.json").empty());
  CHECK(in.text("running").find("kitchen  127.0.0.1:4750  running") != std::string::npos);
  CHECK(in.text("fault") == "0\n");
  CHECK(in.text("done").starts_with("done by "));
  CHECK(in.text("done").find(": kill peer robot for 2s\n") != std::string::npos);
  const auto typo = in.text("typo"); // once, not once a host
  CHECK(typo.ends_with("did you mean \"crash\"?\n"));
  CHECK(typo.find('\n') == typo.size() - 1);
  CHECK(in.text("network").find("care-pc") != std::string::npos); // found without its name
  CHECK(in.text("no-fault").find("no mote of island `kitchen` is named `nobody`") !=
        std::string::npos);
  const auto one_gone = json::parse(in.text("one-gone"));
  CHECK(one_gone["hosts"][0].contains("trouble"));
  CHECK(one_gone["hosts"][1]["state"] == "running");
  CHECK(in.text("stop") == "0\n");
  CHECK(in.text("status") == "130\n");
  const auto report = in.report("all");
  CHECK(report["interrupted"] == true);
  CHECK(report["violations"].dump() == "[]");
  CHECK(report["islands"].size() == 2);
  for (const auto& mote : element(report["islands"], "name", "kitchen")["motes"])
    CHECK(mote["joined"] == true);
  CHECK(events_of({report}, "killed for 2 s").contains("robot"));
  // What the first life of kitchen's part has counted was kept in its state folder.
  CHECK(events_of({report}, "last contact").contains("kitchen"));
}

TEST_CASE("a host listens to nobody without a certificate of its own authority", "[hosts]") {
  const house in;
  in.run("hosts; sleep 1; mkdir other; (cd other; certs me); "
         "rubicon deploy house.toml --dry-run > bare; echo $? > bare.status; "
         "(cd other; rubicon deploy ../house.toml $me --dry-run > ../foreign); "
         "rubicon deploy house.toml $me --dry-run > own; echo $? > own.status; "
         "sed '0,/^host = \"kitchen\"$/s||&\\nserial = { device = \"/dev/ttyUSB77\" }|' house.toml "
         "> real.toml; "
         "rubicon deploy real.toml $me --dry-run > real; echo $? > real.status; end; "
         "rubicon host --name x --listen 0.0.0.0:4790 2> anybody; echo $? > anybody.status; "
         "rubicon host --name x --listen 127.0.0.1:4790 --allow-commands 2> commands");
  CHECK(in.text("bare.status") == "1\n");
  CHECK(in.text("bare").find("does not answer as a rubicon host") != std::string::npos);
  CHECK(in.text("foreign").find("rejected our certificate") != std::string::npos);
  CHECK(in.text("own.status") == "0\n");
  CHECK(in.text("own").find("care  can run it") != std::string::npos);
  CHECK(in.text("real.status") == "1\n");
  CHECK(in.text("real").find("the sink of island `kitchen` is at /dev/ttyUSB77: No such file") !=
        std::string::npos);
  CHECK(in.text("anybody.status") == "2\n");
  CHECK(in.text("anybody").find("give it certificates") != std::string::npos);
  CHECK(in.text("commands").find("let every user of this computer") != std::string::npos);
}

TEST_CASE("a host says what keeps it from its part, and nothing begins", "[hosts]") {
  const house in;
  in.run("certs kitchen bedroom care me; me=$(tls me); host kitchen 4750 & kitchen=$!; "
         "host bedroom 4760 & bedroom=$!; host care 4770 & care=$!; "
         "start run house.toml --host kitchen --for 20s --starts kitchen.starts > taken.json & "
         "taken=$!; sleep 1; "
         "rubicon deploy house.toml $me --for 3s 2> taken.deploy; echo $? > taken.deploy.status; "
         "kill $taken; wait $taken; "
         "sed 's/id = 40/id = 40\\nhost_name = \"care\"/' house.toml > commands.toml; "
         "printf '[[peer]]\\nid = 41\\nname = \"init\"\\nhost = \"care\"\\n"
         "apps = [{ app = \"init\", components = [{ name = \"tool\", command = \"true\" }] }]\\n'"
         " >> commands.toml; "
         "rubicon deploy commands.toml $me --for 3s 2> commands; "
         "rubicon status 2> nothing; end");
  CHECK(in.text("taken.deploy.status") == "2\n");
  CHECK(in.text("taken.deploy").find("kitchen  ") != std::string::npos);
  CHECK(in.text("taken.deploy").find("4751") != std::string::npos);
  CHECK(in.text("bedroom.log").find("begins") == std::string::npos);
  INFO(in.text("commands"));
  CHECK(in.text("nothing").find("none of your deployments is running") != std::string::npos);
}

TEST_CASE("two processes that claim one host are both told, and one leaves",
          "[hosts][RTE-08][IF-12]") {
  const house in;
  in.run("part kitchen 24s kitchen & part bedroom 24s bedroom & part care 24s care & sleep 2; "
         "sed 's/control_port = 4770/control_port = 4780/' house.toml > copied.toml; "
         "rubicon run copied.toml --host care --for 21s --json --starts other.starts > other.json "
         "2> other.err; wait");
  const std::vector<json> all{in.report("kitchen"), in.report("bedroom"), in.report("care"),
                              in.report("other")};
  const auto told = events_of({all[2]}, "its id is used by care@");
  const auto other_told = events_of({all[3]}, "its id is used by care@");
  CHECK(told.contains("care"));
  CHECK(other_told.contains("care"));
  // One of the two, which comes back after 15 s and leaves again if the run is still going on.
  const auto leaves = [&all](std::size_t i) {
    return !events_of({all[i]}, "leaves its id to care@").empty();
  };
  CHECK(leaves(2) != leaves(3));
  for (std::size_t i = 0; i < 2; ++i)
    for (const auto& island : all[i]["islands"])
      CHECK(island["messages"]["reliable_failed"] == 0);
}

TEST_CASE("a swarm over hosts finds what one computer finds, also if one of them dies",
          "[hosts][NFR-08]") {
  const house in;
  in.run("hosts; sleep 1; "
         "words='swarm house.toml --seeds 1..80 --for 20min --json'; "
         "rubicon $words > one.json; "
         "rubicon $words --hosts kitchen,127.0.0.1:4760,care $me > three.json 2> three.err & "
         "swarm=$!; sleep 1.5; kill -9 $kitchen; kill -STOP $care; wait $swarm; kill -CONT $care; "
         "rubicon $words --hosts hall $me 2> nobody; end");
  auto one = json::parse(in.text("one.json"));
  auto three = json::parse(in.text("three.json"));
  CHECK(three["runs"] == 80);
  for (const auto* own : {"jobs", "wall_s", "slowest_seed", "slowest_s"}) {
    one.erase(own);
    three.erase(own);
  }
  CHECK(one.dump() == three.dump());
  INFO(in.text("three.err"));
  const auto said = in.text("three.err"); // it dies while it is asked, or just after
  CHECK((said.find("kitchen  cannot be reached") != std::string::npos ||
         said.find("kitchen  closed the connection") != std::string::npos));
  CHECK(in.text("nobody").find("`hall` is neither a [[host]] of the file") != std::string::npos);
}

TEST_CASE("every shipped file can be spread over hosts, or says why not", "[hosts][GEN-05]") {
  const house in;
  in.run("cp -r '" RUBICON_CONFIG_DIR "' config");
  for (const auto& each : fs::directory_iterator(RUBICON_CONFIG_DIR)) {
    if (each.path().extension() != ".toml")
      continue;
    INFO(each.path().string());
    std::istringstream lines(text_of(each.path()));
    std::string toml;
    int number = 0;
    for (std::string line; std::getline(lines, line);)
      if (!line.starts_with("host = "))
        toml += line +
                (line == "[[island]]" || line == "[[peer]]"
                     ? "\nhost = \"" + std::string(number++ % 2 == 0 ? "one" : "two") + '"'
                     : "") +
                '\n';
    if (toml.find("[[host]]") == std::string::npos)
      toml += "\n[[host]]\nname = \"one\"\naddress = \"127.0.0.1\"\ncontrol_port = 4700\n"
              "[[host]]\nname = \"two\"\naddress = \"127.0.0.1\"\ncontrol_port = 4710\n";
    else
      continue; // the house: all other tests deploy it
    in.file("config/spread.toml", toml);
    in.run("rubicon deploy config/spread.toml --local --for 5s --json --log off > spread.json "
           "2> spread.err; echo $? > status");
    if (in.text("status") == "2\n") {
      const auto why = in.text("spread.err");
      INFO(why);
      CHECK((why.find("different hosts") != std::string::npos ||
             why.find("name the file there") != std::string::npos)); // it needs options of `run`
      continue;
    }
    const auto report = in.report("spread");
    INFO(report["reason"].dump() + ' ' + in.text("spread.err"));
    CHECK(report["complete"] == true);
    CHECK(in.text("spread.err").find("has ended with") == std::string::npos);
  }
}

TEST_CASE("a host of another version is told apart before anything begins", "[hosts]") {
  const house in;
  io::loop loop;
  control::system actors{{}};
  const auto opened = control::server::open(
      actors, loop, "127.0.0.1", 4750,
      [](const deploy::question&) -> deploy::answer { return deploy::greeting{"99.0"}; });
  REQUIRE(std::holds_alternative<control::server>(opened));
  std::atomic<bool> over = false;
  std::thread host([&] {
    while (!over)
      loop.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(20));
  });
  in.run("rubicon deploy house.toml 2> err; echo $? > status");
  over = true;
  host.join();
  CHECK(in.text("status") == "2\n");
  CHECK(in.text("err").find("kitchen  runs rubicon 99.0, this is ") != std::string::npos);
}

TEST_CASE("doctor looks at this computer and asks the hosts of a file", "[hosts]") {
  const house in;
  in.run("hosts; sleep 1; kill $care; wait $care; "
         "rubicon doctor --json > here; rubicon doctor house.toml $me > all; echo $? > status; "
         "end");
  const auto here = json::parse(in.text("here"));
  CHECK(std::any_of(here.begin(), here.end(), [](const auto& x) { return x["what"] == "clock"; }));
  CHECK(in.text("status") == "1\n");
  CHECK(in.text("all").find("can run its part") != std::string::npos);
  const auto all = in.text("all");
  const auto care = all.find("host care");
  REQUIRE(care != std::string::npos);
  CHECK(all.substr(all.rfind('\n', care) + 1, 5) == "fault");
  CHECK(all.find("; start rubicon host --name care there", care) < all.find('\n', care));
  CHECK(all.find("multicast     not needed") != std::string::npos);
}
