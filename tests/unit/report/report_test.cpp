#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include "report/expect/expectations.hpp"
#include "report/print/report_text.hpp"
#include "report/print/text_layout.hpp"
#include "report/report.hpp"
#include "support/catch.hpp"
#include "support/text.hpp"
#include "unit/report/sample.hpp"

using namespace rubicon;
using namespace rubicon::report;
using nlohmann::json;
using rubicon::test::contains;
using rubicon::test::large_report;
using rubicon::test::lines_of;
using rubicon::test::sample_report;

namespace {

/// Keys whose objects are counted by cause or named by the ecology's author.
bool holds_free_keys(const std::string& key) {
  return key == "lost" || key == "mac_failed" || key == "failed" || key == "values" ||
         key == "refused";
}

void collect_keys(const json& x, std::set<std::string>& keys) {
  if (x.is_object()) {
    for (const auto& [key, value] : x.items()) {
      keys.insert(key);
      if (!holds_free_keys(key))
        collect_keys(value, keys);
    }
  } else if (x.is_array()) {
    for (const auto& element : x)
      collect_keys(element, keys);
  }
}

run_report with_violation() {
  auto x = sample_report();
  x.violations = {{instant{} + 10min, "radio copies balance", "kitchen: sent 1, delivered 0"}};
  return x;
}

} // namespace

TEST_CASE("equal failures of actors are one line of the text", "[report]") {
  auto x = sample_report();
  x.actors.failures = {"mote/a/b: no", "peer/c: no", "mote/a/b: no"};
  const auto text = to_text(x, 200, false);
  CHECK(contains(text, "  mote/a/b: no; 2 times\n"));
  CHECK(contains(text, "  peer/c: no\n"));
  x.actors.failures.assign(100, "mote/a/b: no"); // as many as a report has
  CHECK(contains(to_text(x, 200, false), "  mote/a/b: no; 100 of the first 100 failures\n"));
}

TEST_CASE("totals are sums over islands and peers", "[report]") {
  const auto x = sample_report();
  CHECK(x.motes_configured() == 5);
  CHECK(x.motes_joined() == 4);
  CHECK(x.motes_left() == 1);
  CHECK(x.motes_alive() == 4);
  CHECK(x.radio().sent == 13'300);
  CHECK(x.radio().lost ==
        cause_counts{{"collision", 12}, {"duplicate", 9}, {"filtered", 3'991}, {"loss", 67}});
  CHECK(x.serial().octets == 133'332);
  CHECK(x.messages().reliable_acked == 1'430);
  CHECK(x.peis().peers == 2);
  CHECK(x.peis().tuples == 48);
  CHECK(x.peis().packages == 6'133);
  CHECK(x.used_mah() == Approx(13.869));
  CHECK(total(x.radio().lost) == 4'079);
}

TEST_CASE("adding reports adds every field and every cause", "[report]") {
  radio_report radio{1, 2, {{"a", 3}}, 4, 5, {{"b", 6}}, 7, 8};
  radio += radio_report{10, 20, {{"a", 30}, {"c", 1}}, 40, 50, {}, 70, 80};
  CHECK(radio.sent == 11);
  CHECK(radio.delivered == 22);
  CHECK(radio.lost == cause_counts{{"a", 33}, {"c", 1}});
  CHECK(radio.requests == 44);
  CHECK(radio.mac_sent == 55);
  CHECK(radio.mac_failed == cause_counts{{"b", 6}});
  CHECK(radio.mac_open == 77);
  CHECK(radio.transmissions == 88);

  message_report messages{.reliable_sent = 1,
                          .reliable_acked = 2,
                          .reliable_failed = 3,
                          .reliable_open = 4,
                          .unreliable_sent = 5,
                          .received = 6,
                          .duplicates = 7};
  messages += messages;
  CHECK(messages.reliable_sent == 2);
  CHECK(messages.reliable_acked == 4);
  CHECK(messages.reliable_failed == 6);
  CHECK(messages.reliable_open == 8);
  CHECK(messages.unreliable_sent == 10);
  CHECK(messages.received == 12);
  CHECK(messages.duplicates == 14);

  serial_report serial{2, 1, 1, 2, 3, {{"crc", 4}}};
  serial += serial_report{20, 10, 5, 20, 30, {{"crc", 40}}};
  CHECK(serial.octets_written == 22);
  CHECK(serial.octets_up == 6);
  CHECK(serial.octets == 11);
  CHECK(serial.frames_sent == 22);
  CHECK(serial.frames_received == 33);
  CHECK(serial.lost == cause_counts{{"crc", 44}});
}

TEST_CASE("the JSON of a report is one object with the run's figures", "[report]") {
  const auto text = to_json(with_violation());
  const auto x = json::parse(text);
  CHECK(text.back() == '\n');
  CHECK(x.at("ecology") == "two rooms");
  CHECK(x.at("seed") == 42);
  CHECK(x.at("mode") == "virtual");
  CHECK(x.at("simulated_s") == 600.0);
  CHECK(x.at("trace_hash") == "0123456789abcdef");
  CHECK(x.at("interrupted") == false);
  CHECK(x.at("motes") ==
        json({{"configured", 5}, {"joined", 4}, {"left", 1}, {"alive", 4}, {"measuring", 0}}));
  CHECK(x.at("radio").at("lost").at("loss") == 67);
  CHECK(x.at("radio").at("requests") == 2'550);
  CHECK(x.at("messages").at("reliable_acked") == 1'430);
  CHECK(x.at("energy").at("motes").at(2).at("mote") == "3/9");
  CHECK(x.at("energy").at("motes").at(2).at("radio_listen_s") == 597.0);
  CHECK(x.at("energy").at("motes").at(2).at("elapsed_s") == 600.0);
  CHECK(x.at("flows").at(0) == json({{"from", "20/2"},
                                     {"to", "20/1"},
                                     {"from_name", "lab/node-2"},
                                     {"to_name", "lab/sink"},
                                     {"sent", 1'000},
                                     {"delivered", 900},
                                     {"pdr", 0.9},
                                     {"goodput_bps", 1'440.0},
                                     {"delay_mean_ms", 12.5},
                                     {"delay_p50_ms", 10.0},
                                     {"delay_p95_ms", 30.0},
                                     {"tx_per_packet", 1.25},
                                     {"lost", {{"channel_access_failure", 20}, {"no_ack", 79}}},
                                     {"open", 1}}));
  CHECK(x.at("flows").at(1).at("to") == "20/65535");
  CHECK(x.at("flows").at(1).at("pdr").is_null()); // of several receivers
  CHECK(x.at("islands").at(1).at("motes").at(1).at("joined") == false);
  CHECK(x.at("peers").at(0).at("lost").at("queue_full") == 2);
  CHECK(x.at("proxies").at(0).at("values").at("temperature") == "22.3 C");
  const auto& actuations = x.at("proxies").at(1).at("actuations");
  CHECK(actuations.at("failed").at("timeout") == 1);
  CHECK(actuations.at("latency_p50_s").get<double>() == Approx(0.02).epsilon(0.01));
  CHECK(actuations.at("latency_p99_s").get<double>() == Approx(0.12).epsilon(0.01));
  CHECK(x.at("event_log").at(0).at("at_s") == 2.00416);
  CHECK(x.at("violations").at(0).at("invariant") == "radio copies balance");
}

TEST_CASE("equal reports give equal JSON, also an empty one", "[report][GEN-07]") {
  CHECK(to_json(sample_report()) == to_json(sample_report()));
  const auto empty = json::parse(to_json(run_report{}));
  CHECK(empty.at("violations") == json::array());
  CHECK(empty.at("radio").at("lost") == json::object());
}

TEST_CASE("JSON stays valid when a value from outside is not UTF-8", "[report]") {
  auto x = sample_report();
  x.proxies[0].values[0].second = "\xff\x00\n";
  x.wall_s = std::numeric_limits<double>::quiet_NaN();
  CHECK_NOTHROW(json::parse(to_json(x)));
}

TEST_CASE("every key of the JSON is documented", "[report][ACT-13]") {
  std::ifstream stream(RUBICON_REPORT_DOCUMENT);
  const std::string document{std::istreambuf_iterator<char>(stream),
                             std::istreambuf_iterator<char>()};
  REQUIRE(!document.empty());
  std::set<std::string> keys;
  collect_keys(json::parse(to_json(with_violation())), keys);
  for (const auto& key : keys) {
    CAPTURE(key);
    CHECK(contains(document, "`" + key + "`"));
  }
}

TEST_CASE("no line of the text is wider than the terminal", "[report]") {
  const auto width = GENERATE(std::size_t{60}, std::size_t{80}, std::size_t{100}, std::size_t{200});
  for (const auto& x : {sample_report(), with_violation(), large_report(), run_report{}})
    for (const auto& line : lines_of(to_text(x, width))) {
      CAPTURE(line);
      CHECK(display_width(line) <= width);
    }
  CHECK(to_text(sample_report(), 1) == to_text(sample_report(), 60));
}

TEST_CASE("the text tells how fast it was, who lived and what the proxies say", "[report]") {
  const auto text = to_text(sample_report());
  CHECK(contains(text, "10 min of virtual time in 0.84 s (714 × real time)"));
  CHECK(contains(text, "left: battery"));
  CHECK(contains(text, "never joined: blinds-3"));
  CHECK(contains(text, "of 12,400 copies in range: loss 67, collision 12\n"));
  CHECK(!contains(text, "filtered"));     // addressed to another radio is no loss
  CHECK(!contains(text, "duplicate 9"));  // nor is a repeat of what was received
  CHECK(contains(text, "2,100   99.8%")); // 2095 of 2100 - 1 that were still open
  CHECK(contains(text, "99.8%"));         // 1230 of 1234 - 1 that were still open
  CHECK(contains(text, "temperature  22.3"));
  CHECK(contains(text, "✗ battery"));
  CHECK(contains(text, "timeout 1"));
}

TEST_CASE("a report says what the seed has drawn of the file", "[report][ACT-04]") {
  const config::variation varied{{{"loss", "0.2"}}, {"crash"}};
  CHECK(!json::parse(to_json(sample_report())).contains("varied"));
  CHECK(json::parse(to_json(sample_report(), {}, varied)).at("varied") ==
        json{{"drawn", {{"loss", "0.2"}}}, {"left_out", {"crash"}}});
  CHECK(contains(to_text(sample_report(), {.varied = varied}), " (loss=0.2, without crash)"));
}

TEST_CASE("motes that only measure are counted apart", "[report]") {
  const auto x = test::lab_report();
  CHECK(x.motes_configured() == 5);
  CHECK(x.motes_measuring() == 1);
  CHECK(x.motes_joined() == 4);
  CHECK(x.motes_left() == 1);
  CHECK(x.motes_alive() == 5);
  const auto text = to_text(x);
  CHECK(contains(text, "  1 measuring mote\n"));
  CHECK(!contains(text, "never joined: node-2"));
  CHECK(contains(text, "lab          20      1       –      1"));
  CHECK(!contains(to_text(sample_report()), "measuring"));
  const auto mote = json::parse(to_json(x)).at("islands").at(2).at("motes").at(0);
  CHECK(mote.at("joins") == false);
}

TEST_CASE("flows are told a row each, and together", "[report][traffic]") {
  CHECK(contains(to_text(sample_report(), 120),
                 "  from        to         sent  arrived  bit/s  delay ms   95%  tx each  lost\n"
                 "  lab/node-2  lab/sink  1,000    90.0%  1,440      12.5  30.0     1.25  no_ack "
                 "79, channel_access_failure 20, open 1\n"
                 "  lab/node-2  lab/*     1,000    3,000  1,440      12.5  30.0     1.25\n"
                 "  all                   2,000    90.0%  2,880      12.5           1.25  no_ack "
                 "79, channel_access_failure 20, open 1\n"));
  const auto text = to_text(large_report(), 120);
  CHECK(contains(text, "  lab/node-21"));
  CHECK(!contains(text, "lab/node-22"));
  CHECK(contains(text, "  20 more                20,000    90.0%  28,800"));
  CHECK(contains(text, "  all                    40,000    90.0%  57,600"));
  run_report alone;
  alone.flows.resize(1);
  CHECK(!contains(to_text(alone), "  all "));
  CHECK(!contains(to_text(run_report{}), "Flows"));
}

TEST_CASE("neighbours in the event log that tell the same are told as one", "[report]") {
  run_report x;
  for (int i = 1; i <= 3; ++i)
    x.event_log.push_back({instant{i * 1s}, "lab/a", "joined"});
  CHECK(!contains(to_text(x), "others"));
  x.event_log.push_back({instant{4s}, "lab/b", "joined"});
  x.event_log.push_back({instant{5s}, "lab/b", "left: silence"});
  const auto text = to_text(x);
  CHECK(contains(text, "0:01.000  lab/a and 1 other  joined, 4 times, the last at 0:04.000"));
  CHECK(contains(text, "left: silence"));
  x.event_log[3].who = "lab/a";
  CHECK(contains(to_text(x), "0:01.000  lab/a  joined, 4 times, the last at 0:04.000"));
  for (int i = 0; i < 4; ++i)
    x.event_log[static_cast<std::size_t>(i)].who = "lab/m" + std::to_string(i);
  CHECK(contains(to_text(x), "0:01.000  lab/m0 and 3 others  joined, the last at 0:04.000"));
}

TEST_CASE("the text tells what became of the messages of each mote", "[report]") {
  const auto text = to_text(sample_report());
  CHECK(contains(text, "kitchen/climate-7       111    97.3%  climate-8     2  -71"));
  CHECK(contains(text, "gave_up 2, crowded 1"));
  CHECK(contains(text, "messages refused: crowded 2"));
  CHECK(contains(text, "7  kitchen/climate-7  robot       600   585    97.7%       14         2"));
}

TEST_CASE("the text tells what was expected, and the command that explains", "[report]") {
  auto x = sample_report();
  CHECK(contains(to_text(x), "✓  joined within 20 s  5 motes"));
  x.expectations[0].outcome = expectation_report::verdict::unmet;
  x.expectations[0].at = instant{} + 20s;
  x.expectations[0].command =
      "rubicon run a.toml --record run.rec && rubicon explain run.rec --lost";
  const auto text = to_text(x);
  CHECK(contains(text, "✗  joined within 20 s  5 motes"));
  CHECK(contains(text, "joined within 20 s, at 0:20.000, is explained by\n"
                       "    rubicon run a.toml --record run.rec &&\n"
                       "    rubicon explain run.rec --lost\n"));
  x.violations.push_back(violation_of(x.expectations[0]));
  const auto whole = to_text(x, 400, false); // wide enough for all of it
  CHECK(contains(whole, "expected: joined within 20 s"));
  // Not in the verdict again; a violation that stands alone has it.
  CHECK(whole.find("--record") != std::string::npos);
  CHECK(whole.find("--record") == whole.rfind("--record"));
  CHECK(contains(x.violations[0].detail, "rubicon explain"));
  const auto told = json::parse(to_json(x))["expectations"][0];
  CHECK(told["met"] == false);
  CHECK(told["at_s"] == 20.0);
  x.expectations[0].outcome = expectation_report::verdict::unjudged;
  CHECK(json::parse(to_json(x))["expectations"][0]["met"].is_null());
}

TEST_CASE("the verdict comes last", "[report]") {
  CHECK(to_text(sample_report()).ends_with("  ✓ no violations\n"));
  CHECK(to_text(with_violation())
            .ends_with("  ✗ 1 violation\n"
                       "       time  invariant             detail\n"
                       "  10:00.000  radio copies balance  kitchen: sent 1, delivered 0\n"));
}

TEST_CASE("a large run is told in two hundred lines and says what it leaves out", "[report]") {
  const auto text = to_text(large_report());
  CHECK(lines_of(text).size() < 200);
  CHECK(contains(text, "… 360 lines omitted"));
  CHECK(contains(text, "… and 600 more"));
  CHECK(contains(text, "… and 30 more"));
  CHECK(contains(text, "median 302.7"));
  CHECK(contains(text, "house-50/climate-21"));
}

TEST_CASE("with all rows nothing of a large run is left out", "[report]") {
  const auto text = to_text(large_report(), {.full = true});
  CHECK(contains(text, "line 399"));
  CHECK(contains(text, "line 200\n"));
  CHECK(contains(text, "house-50/climate-21"));
  CHECK(contains(text, "house-1/climate-2 "));
  CHECK(contains(text, "lab/node-41"));
  CHECK(!contains(text, "--full"));
  CHECK(lines_of(text).size() > 1'600);
  CHECK(contains(text, "600 more are not in the report")); // not even then
}

TEST_CASE("of many islands with groups some are shown, and all if asked for", "[report][smepp]") {
  auto x = large_report();
  for (auto& island : x.islands)
    island.smepp.programs = 1;
  const auto part_of = [](const std::string& text) {
    const auto begin = text.find("Groups ");
    return text.substr(begin, text.find("\n── ", begin) - begin);
  };
  const auto some = part_of(to_text(x));
  CHECK(contains(some, "house-20 "));
  CHECK_FALSE(contains(some, "house-21 "));
  CHECK(contains(some, "… and 30 more; --full shows all"));
  CHECK(contains(part_of(to_text(x, {.full = true})), "house-50 "));
}

TEST_CASE("the lines of a long event log that are shown are of the whole run", "[report]") {
  const auto text = to_text(large_report());
  CHECK(contains(text, "  line 0\n"));
  CHECK(contains(text, "  line 399\n"));
  int shown = 0;
  for (int i = 100; i < 300; ++i)
    shown += contains(text, "  line " + std::to_string(i) + '\n') ? 1 : 0;
  CHECK(shown >= 15);
  CHECK(shown <= 25);
}

TEST_CASE("in a file no text is cut", "[report]") {
  auto x = with_violation();
  x.violations[0].detail = std::string(500, 'v');
  x.proxies[0].values[0].second = std::string(300, 'w');
  CHECK(contains(to_text(x, 60), "…"));
  const auto text = to_text(x, {.width = 60, .cuts = false});
  CHECK(!contains(text, "…"));
  CHECK(contains(text, std::string(500, 'v')));
  CHECK(contains(text, std::string(300, 'w')));
}

TEST_CASE("times are those of a clock, however long the run is", "[report]") {
  auto x = with_violation();
  CHECK(contains(to_text(x), "  0:02.004  kitchen/climate-7"));
  x.simulated = 26h;
  x.event_log[2].at = instant{} + 25h + 61s;
  const auto text = to_text(x);
  CHECK(contains(text, "  0:02.004  kitchen/climate-7"));
  CHECK(contains(text, "  25:01:01.000  kitchen/lamp-9"));
  CHECK(contains(text, "  10:00.000  radio copies balance"));
}

TEST_CASE("energy begins with the mote that has least left", "[report]") {
  auto x = sample_report();
  x.islands[0].motes[0].energy.used_mah = 20; // of much more than the others
  x.islands[0].motes[0].energy.battery_mah = 100'000;
  x.islands[0].motes[1].energy.used_mah = 5;
  x.islands[0].motes[1].energy.battery_mah = 10;
  const auto text = to_text(x);
  const auto energy = text.substr(text.find("── Energy"));
  const auto least = energy.find("kitchen/climate-8");
  const auto most = energy.find("kitchen/climate-7");
  REQUIRE(least != std::string::npos);
  REQUIRE(most != std::string::npos);
  CHECK(least < energy.find("living-room/climate-2"));
  CHECK(energy.find("living-room/climate-2") < most);
  CHECK(contains(energy, "50.0%"));
}

TEST_CASE("an interrupted run says so", "[report][ACT-11]") {
  auto x = sample_report();
  x.interrupted = true;
  CHECK(contains(to_text(x), "interrupted early"));
}

TEST_CASE("a run that a flat battery has ended says whose", "[report][NRG-05]") {
  auto x = sample_report();
  CHECK(!contains(to_text(x), "flat battery"));
  CHECK(json::parse(to_json(x)).at("ended_by") == "");
  x.ended_by = "kitchen/climate-7";
  CHECK(contains(to_text(x), "ended by the flat battery of kitchen/climate-7"));
  CHECK(json::parse(to_json(x)).at("ended_by") == "kitchen/climate-7");
}

TEST_CASE("only a terminal gets escapes, and never one from a tuple", "[report]") {
  auto x = sample_report();
  x.event_log[0].what = "joined\033[2J";
  x.ecology = "two\nrooms";
  CHECK(!contains(to_text(x), "\033"));
  CHECK(contains(to_text(x, 100, true), "\033[32m"));
  CHECK(!contains(to_text(x, 100, true), "\033[2J"));
  CHECK(lines_of(to_text(x))[0] == R"(two\nrooms)");
}

TEST_CASE("the report tells which of several gateways has led", "[report][GW-14]") {
  run_report x;
  x.islands.emplace_back();
  x.islands[0].name = "kitchen";
  CHECK(to_json(x).find("gateways") == std::string::npos);
  CHECK(to_text(x).find("led by") == std::string::npos);
  gateway_report first{peer_id{20}, "kitchen-pc", {1, 60s, false}};
  first.lead += {1, 30s, true};
  x.islands[0].gateways = {first, {peer_id{21}, "attic-pc", {0, 0s, false}}};
  CHECK(to_text(x).find("led by kitchen-pc: 2 times, 1 min 30 s, at the end; attic-pc: 0 times") !=
        std::string::npos);
  const auto written = to_json(x);
  CHECK(written.find("\"leading_s\": 90.0") != std::string::npos);
  CHECK(written.find("\"led\": 2") != std::string::npos);
}

TEST_CASE("equal violations are one line with a count", "[report]") {
  run_report x;
  x.simulated = 10min;
  for (int i = 1; i <= 48; ++i) {
    x.violations.push_back({instant{i * 10s}, "clocks keep their bound", "lab: 3 ms off"});
    if (i == 2)
      x.violations.push_back({instant{i * 10s}, "clocks keep their bound", "lab: 4 ms off"});
  }
  const auto text = to_text(x, 120);
  CHECK(contains(text, "✗ 49 violations"));
  CHECK(contains(text, "  0:10.000  clocks keep their bound  lab: 3 ms off; 48 times, the last at "
                       "8:00.000\n  0:20.000  clocks keep their bound  lab: 4 ms off\n"));
  CHECK(!contains(text, "0:30.000"));
}

TEST_CASE("a median is not above the slowest", "[report]") {
  actuation_report x;
  for (const auto each : {9'999'999ns, 10'000'001ns, 1'234'567ns}) {
    actuation_report one;
    one.latency.add(each);
    one.slowest.value = each;
    CHECK(latency_s(one, 0.5) <= seconds(each));
    CHECK(latency_s(one, 0.99) == Approx(seconds(each)).epsilon(0.01));
    x += one;
  }
  CHECK(latency_s(x, 0.99) <= seconds(x.slowest));
}

TEST_CASE("each part of the text says what it is for", "[report]") {
  const auto text = to_text(sample_report(), 100);
  CHECK(contains(text, "── Islands ─"));
  CHECK(contains(text, "─ what became of messages and radio frames ──\n"));
  for (const std::size_t width : {60U, 100U})
    for (const auto& line : lines_of(to_text(sample_report(), width)))
      CHECK(display_width(line) <= width);
  auto x = sample_report();
  x.islands[0].network.beacons = 1; // else it has no part of its own
  const auto narrow = to_text(x, 60);
  CHECK(contains(narrow, "─\n  how packets reach the sink, and how exact clocks are\n"));
}

TEST_CASE("a brief text has the title, the expectations and the verdict", "[report]") {
  auto x = with_violation();
  expectation_report unmet;
  unmet.text = "delivery >= 90%";
  unmet.outcome = expectation_report::verdict::unmet;
  unmet.command = "rubicon run home.toml --record run.rec && rubicon explain run.rec --lost";
  x.expectations = {unmet};
  const auto text = to_text(x, {.brief = true});
  CHECK(contains(text, "── Expectations "));
  CHECK(contains(text, "── Verdict "));
  CHECK(contains(text, "rubicon explain run.rec --lost"));
  CHECK(contains(text, "radio copies balance"));
  CHECK(!contains(text, "── Islands "));
  CHECK(!contains(text, "── Event log "));
  CHECK(lines_of(text).size() < 20);
}

TEST_CASE("labels are shown beside names, and are in the JSON", "[report]") {
  using kind = rubicon::config::label_table::kind;
  const auto x = sample_report();
  REQUIRE(!x.islands.empty());
  REQUIRE(!x.islands[0].motes.empty());
  REQUIRE(!x.peers.empty());
  REQUIRE(!x.proxies.empty());
  const auto mote = x.islands[0].name + '/' + x.islands[0].motes[0].name;
  rubicon::config::label_table labels;
  labels.add(kind::island, x.islands[0].name, "Küche");
  labels.add(kind::mote, mote, "Küche / Fenster links");
  labels.add(kind::peer, x.peers[0].name, "PC im Flur");
  labels.add(kind::proxy, x.proxies[0].proxy_class, "Klima\x1b[2J");
  const auto text = to_text(x, {.width = 200, .labels = labels});
  CHECK(contains(text, x.islands[0].name + " (Küche)"));
  CHECK(contains(text, mote + " (Küche / Fenster links)"));
  CHECK(contains(text, x.peers[0].name + " (PC im Flur)"));
  CHECK(contains(text, x.proxies[0].name + " (Klima\\x1b[2J)"));
  const auto all = json::parse(to_json(x, labels));
  CHECK(all["islands"][0]["label"] == "Küche");
  CHECK(all["islands"][0]["motes"][0]["label"] == "Küche / Fenster links");
  CHECK(all["peers"][0]["label"] == "PC im Flur");
  CHECK(all["proxies"][0]["label"] == "Klima\x1b[2J");
  CHECK(to_json(x).find("\"label\"") == std::string::npos); // without any there is no key
}

TEST_CASE("a battery that is exactly flat has nothing left", "[report][NRG-05]") {
  auto x = sample_report();
  auto& energy = x.islands[0].motes[0].energy;
  energy.battery_mah = 2000;
  energy.used_mah = 2000.0000001; // sums are not exact
  CHECK(!contains(to_text(x), "-0.0%"));
  CHECK(contains(to_text(x), " 0.0% "));
}
