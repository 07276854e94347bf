// Groups of SMEPP Light in the modelled radio, from a file to the report (A24).
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "actors/run/run.hpp"
#include "config/checks/warnings.hpp"
#include "core/bytes.hpp"
#include "ecology/ecology_files.hpp"
#include "ecology/faults/recorded.hpp"
#include "explain/print/text.hpp"
#include "explain/print/words.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/seeds.hpp"
#include "support/text.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

namespace fs = std::filesystem;

constexpr const char* network_key = "000102030405060708090a0b0c0d0e0f";
constexpr const char* master_key = "f0e1d2c3b4a5968778695a4b3c2d1e0f";

/// A line of motes, of which the last has a transducer and the first is next to a gateway.
std::string flat(const std::string& smepp, const std::string& more = {}) {
  return R"(
    ecology = { name = "care", duration = "15min" }
    radio = { range = "25m" }
    [mote_type.watch]
    type = 700
    transducers = { temperature = { model = "sine", mean = 21, amplitude = 4, period = "5min", resolution = 0.1 } }
    [[island]]
    id = 1
    name = "flat"
    mote = [
      { id = 2, name = "collector", type = "watch", position_m = [20, 0], apps = [
        { app = "member", group = "care", creates = true, subscribes = [{ event = "fever", rate = 0.2, channel = 7 }] }] },
      { id = 3, name = "relay", type = "watch", position_m = [40, 0], apps = [{ app = "member", group = "care" }] },
      { id = 4, name = "wrist", type = "watch", position_m = [60, 0], apps = [
        { app = "member", group = "care", raises = [{ event = "fever", transducer = "temperature" }] }] },
    ]
    [[peer]]
    id = 30
    name = "robot"
    apps = [{ app = "proxy_manager" }]
    [[proxy]]
    name = "watch"
    types = [700]
    field = [{ name = "fever", channel = 7, encoding = "i16", scale = 0.1, unit = "C" }]
    [[smepp.group]]
    name = "care"
    closed = true
    private = true
    period = "1s"
    master_key = ")" +
         std::string(master_key) + "\"\n[smepp]\n" + smepp + '\n' + more;
}

report::run_report run_text(const std::string& toml, std::uint64_t seed = 1) {
  return run(describe(toml), seed);
}

} // namespace

TEST_CASE("network keys change in the middle of a run", "[smepp][SMP-02][ACT-10]") {
  const std::string change = "[[change]]\nat = \"7min\"\nkind = \"network_keys\"\nnetwork_key = "
                             "\"5e1f0a77c3d92b4486aa03f1d7e0b95c\"\n";
  const auto before = run_text(flat("")).islands.at(0).smepp;
  REQUIRE(before.events_received > 100);
  const auto all = run_text(flat("", change));
  CHECK(all.violations.empty());
  const auto& smepp = all.islands.at(0).smepp;
  CHECK(smepp.members == 3);
  CHECK(smepp.events_received * 100 >= before.events_received * 97);
  const auto noted = std::ranges::count_if(all.event_log, [](const report::logged_event& x) {
    return x.what == "network keys changed on 3 motes";
  });
  CHECK(noted == 1);

  // The wrist keeps the old ones: a little later nobody understands it.
  const auto left = run_text(flat("", change + "motes = [\"flat/collector\", \"flat/relay\"]\n"));
  CHECK(left.islands.at(0).smepp.events_received * 10 < before.events_received * 8);

  // A mote that is off has them when it starts.
  const auto later = run_text(flat("", change + "[[fault]]\nat = \"6min50s\"\nkind = \"crash\"\n"
                                                "mote = \"flat/relay\"\nfor = \"1min\"\n"));
  CHECK(later.islands.at(0).smepp.members == 3);
  CHECK(later.islands.at(0).smepp.events_received * 10 >= before.events_received * 7);
}

TEST_CASE("the experiment's line of motes is a group that sleeps", "[smepp][SMP-29][SMP-23]") {
  const auto report = run(example("smepp-line.toml"));
  CHECK(report.violations.empty());
  const auto& line = report.islands.at(0);
  CHECK(line.smepp.programs == 4);
  CHECK(line.smepp.members == 4);
  CHECK(line.smepp.events_raised > 200);
  CHECK(line.smepp.events_received + line.smepp.events_open >= line.smepp.events_raised * 99 / 100);
  CHECK(line.smepp.events_missing() == 0);
  duration active{};
  for (const auto& mote : line.motes) {
    INFO(mote.name);
    CHECK(mote.energy.radio_off > mote.energy.elapsed / 2);
    active += mote.energy.mcu_active;
  }
  // Handshakes of three that join, 7 times X25519 each, are most of what the processors do.
  const auto agreements = line.smepp.counters.at("groups.agreements");
  CHECK(agreements >= 21);
  const auto computed = 2s * static_cast<std::int64_t>(agreements);
  CHECK(active > computed);
  CHECK(active < computed + 60s);
}

TEST_CASE("without the energy module the same happens, and radios are on", "[smepp][SMP-27]") {
  auto what = example("smepp-line.toml");
  const auto with = run(what);
  what.smepp.saves_energy = false;
  const auto without = run(what);
  CHECK(without.violations.empty());
  CHECK(without.islands.at(0).smepp.members == with.islands.at(0).smepp.members);
  const auto& x = without.islands.at(0).smepp;
  CHECK(x.events_received + x.events_open >= x.events_raised * 99 / 100);
  CHECK(x.events_raised > with.islands.at(0).smepp.events_raised * 9 / 10);
  for (const auto& mote : without.islands.at(0).motes)
    CHECK(mote.energy.radio_off == 0s);
}

TEST_CASE("a robot uses a group's events", "[smepp][SMP-19][SMP-20]") {
  ecology home(flat(""));
  home.run_for(5min);
  const auto first = home.tuple("robot", "flat.collector.fever");
  REQUIRE(first);
  home.run_for(1min);
  CHECK(home.tuple("robot", "flat.collector.fever") != first);
  const auto report = home.finish();
  CHECK(report.violations.empty());
  const auto& groups = report.islands.at(0).smepp;
  CHECK(groups.events_raised > 150);
  CHECK(groups.counters.at("member.forwarded") == groups.events_received);
  CHECK(report.islands.at(0).messages.reliable_acked + report.islands.at(0).messages.reliable_open +
            report.islands.at(0).messages.refused.at("not_joined") >=
        groups.events_received);
}

TEST_CASE("members that lose their power are members again", "[smepp][SMP-18][SMP-22]") {
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    INFO("seed " << seed);
    ecology home(flat(""), {.seed = seed});
    home.run_for(3min);
    for (const char* who : {"relay", "wrist", "collector"}) {
      home.inject(std::string("kind = 'crash'\nmote = 'flat/") + who + "'\nfor = '20s'");
      home.run_for(3min);
    }
    const auto report = home.finish();
    CHECK(report.violations.empty());
    const auto& groups = report.islands.at(0).smepp;
    CHECK(groups.members == 3);
    CHECK(groups.programs == 3);
    CHECK(groups.joins == 6);                                       // each once more
    CHECK(groups.events_received >= groups.events_raised * 8 / 10); // some 30 s without each
  }
}

TEST_CASE("a private group is not found without its key", "[smepp][SMP-05][SMP-06]") {
  auto what = describe(flat("network_key = \"" + std::string(network_key) + '"'));
  const auto all = run(what);
  CHECK(all.islands.at(0).smepp.members == 3);
  // The wrist looks for a group that only others than those around it have the key of.
  auto odd = describe(flat("", R"(
    [[smepp.group]]
    name = "cure"
    closed = true
    private = true
    period = "1s"
    master_key = "00000000000000000000000000000001"
  )"));
  std::get<config::member_app>(odd.islands.at(0).motes.at(2).apps.edit().at(0)).group = "cure";
  const auto report = run(odd);
  CHECK(report.islands.at(0).smepp.members == 2);
  CHECK(report.islands.at(0).smepp.joins_failed > 3);
  CHECK(report.islands.at(0).smepp.events_raised == 0);
}

TEST_CASE("an event may prove who has raised it", "[smepp][SMP-19]") {
  const auto report = run_text(flat("authenticate = \"sender\""));
  CHECK(report.violations.empty());
  const auto& groups = report.islands.at(0).smepp;
  CHECK(groups.events_received > 150);
  const auto plain = run_text(flat(""));
  const auto octets = [](const report::smepp_report& x) {
    return static_cast<double>(x.octets) / static_cast<double>(x.frames);
  };
  CHECK(octets(groups) > octets(plain.islands.at(0).smepp)); // a proof is 8 octets of an event
}

TEST_CASE("no key is in anything that a run writes", "[smepp][SMP-13]") {
  scratch_folder folder;
  const auto text = flat("network_key = \"" + std::string(network_key) + '"');
  run_options options;
  options.debug_folder = folder.file("log");
  options.pcap_folder = folder.file("pcap");
  options.record_file = folder.file("record");
  options.length = 3min;
  const auto report = run_ecology(describe(text), options);
  CHECK(report.islands.at(0).smepp.members == 3);
  std::ofstream(folder.file("report")) << report::to_text(report) << report::to_json(report);
  std::vector<std::string> searched;
  for (const auto& each : fs::recursive_directory_iterator(folder.path)) {
    if (!each.is_regular_file())
      continue;
    searched.push_back(each.path().filename());
    const auto content = text_of(each.path());
    for (const char* key : {network_key, master_key}) {
      INFO(each.path());
      std::string upper(key);
      std::ranges::transform(upper, upper.begin(), [](unsigned char c) { return std::toupper(c); });
      const auto octets = *from_hex(key);
      CHECK(content.find(key) == std::string::npos);
      CHECK(content.find(upper) == std::string::npos);
      CHECK(content.find(std::string(octets.begin(), octets.end())) == std::string::npos);
    }
  }
  CHECK(searched.size() > 3);
}

TEST_CASE("a bad key is not repeated in the complaint", "[smepp][config]") {
  try {
    static_cast<void>(describe(flat("network_key = \"0001020304050607\"")));
    FAIL("it was taken");
  } catch (const bad_description& x) {
    const std::string what = x.what();
    CHECK(what.find("`network_key` must be a key of 32 hexadecimal digits") != std::string::npos);
    CHECK(what.find("0001020304050607") == std::string::npos);
  }
}

TEST_CASE("a file that asks for what cannot be is refused", "[smepp][config]") {
  const auto problem = [](const std::string& from, const std::string& to) {
    auto text = flat("");
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
    try {
      static_cast<void>(describe(text));
    } catch (const bad_description& x) {
      return std::string(x.what());
    }
    return std::string();
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  CHECK(has(problem("group = \"care\" }] },\n", "group = \"cure\" }] },\n"),
            "there is no [[smepp.group]] \"cure\""));
  CHECK(has(problem("transducer = \"temperature\"", "transducer = \"light\""),
            "the mote has no transducer `light`"));
  CHECK(has(problem("period = \"1s\"", "period = \"66s\""), "`period` must be"));
  CHECK(has(problem("rate = 0.2", "rate = 51"), "`rate` must be"));
  CHECK(has(
      problem("name = \"care\"\n    closed", "name = \"a name of more than twenty\"\n    closed"),
      "`name` must be"));
  CHECK(has(problem("{ event = \"fever\", rate = 0.2, channel = 7 }",
                    "{ event = \"fever\" }, { event = \"fever\" }"),
            "event `fever` is already listed"));
}

TEST_CASE("an event is explained from its producer to the robot", "[smepp][explain]") {
  auto what = describe(flat(""));
  what.length = 5min;
  const auto x = run_recorded(what);
  const auto all = explain::follow(x.content);
  std::size_t events = 0;
  for (const auto& each : all.messages) {
    if (!explain::is_event(each))
      continue;
    ++events;
    CHECK(each.source == mote_address{island_id{1}, mote_id{4}});
    CHECK(each.destination == mote_address{island_id{1}, mote_id{2}});
  }
  CHECK(events == x.report.islands.at(0).smepp.events_raised);
  const auto found = explain::find(all, "flat/collector#10"); // what the tenth has led to
  REQUIRE(std::holds_alternative<explain::message_found>(found));
  const auto& last = all.messages.at(std::get<explain::message_found>(found).index);
  REQUIRE(last.root != explain::no_node);
  const auto hop = all.nodes.at(last.root).parent;
  REQUIRE(hop != explain::no_node);
  CHECK(explain::where(all, all.nodes.at(hop)) == "flat/relay → collector");
}

TEST_CASE("a group that nobody creates has a warning", "[smepp][config]") {
  auto what = describe(flat(""));
  const auto warnings = [&what] {
    config::warning_list out;
    config::warn_of_proxies(what, {}, out);
    return out;
  };
  CHECK(std::ranges::none_of(warnings(), [](const config::warning& x) {
    return x.second.find("creates") != std::string::npos;
  }));
  std::get<config::member_app>(what.islands.at(0).motes.at(0).apps.edit().at(0)).creates = false;
  REQUIRE(warnings().size() == 1);
  CHECK(warnings().at(0).second == "no member of group `care` in island flat has `creates = true`");
}

TEST_CASE("a run with groups is the same on any number of threads", "[smepp][threads]") {
  const auto what = describe(flat(""));
  run_options options;
  const auto one = run_ecology(what, options);
  options.threads = 2;
  const auto two = run_ecology(what, options);
  CHECK(one.trace_hash == two.trace_hash);
}
