// Whole ecologies, recorded, and what the record tells.
#include <fstream>
#include <string>
#include <vector>

#include "ecology/faults/recorded.hpp"
#include "ecology_files.hpp"
#include "explain/outcome.hpp"
#include "explain/print/text.hpp"
#include "explain/print/words.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

using explain::step;

struct told_run {
  report::run_report report;
  explain::traces all;
};

told_run record_of(config::ecology_description what, duration length) {
  what.length = length;
  auto x = run_recorded(what);
  return {std::move(x.report), explain::follow(x.content)};
}

explain::node_index message_called(const explain::traces& all, const std::string& name) {
  const auto found = explain::find(all, name);
  REQUIRE(std::holds_alternative<explain::message_found>(found));
  return static_cast<explain::node_index>(std::get<explain::message_found>(found).index);
}

/// From the first step that led to this one: who, and for hops to whom.
std::vector<std::string> way_to(const explain::traces& all, explain::node_index n) {
  std::vector<std::string> way;
  for (; n != explain::no_node; n = all.nodes[n].parent)
    way.insert(way.begin(), explain::where(all, all.nodes[n]));
  return way;
}

/// The step of a message or tuple, if it is there.
explain::node_index step_of(const explain::traces& all,
                            const std::vector<explain::node_index>& nodes, step what,
                            const std::string& who) {
  for (const auto n : nodes)
    if (all.nodes[n].what == what && explain::names::of(all.nodes[n].from) == who)
      return n;
  FAIL("no such step of " << who);
  return explain::no_node;
}

std::size_t value_of(const explain::traces& all, const std::string& key, std::size_t which) {
  const auto found = explain::find(all, key);
  REQUIRE(std::holds_alternative<explain::tuples_found>(found));
  return std::get<explain::tuples_found>(found).indices.at(which);
}

using words = std::vector<std::string>;

/// Two islands, and what a button of one has for a pager of the other. @param radio keys of [radio]
std::string button_and_pager(const std::string& apps, const std::string& radio = {}) {
  return R"(
[ecology]
name = "two-islands"
[radio]
)" + radio +
         R"(
[[island]]
id = 1
name = "kitchen"
gateway.links = ["inproc://bedroom-gateway"]
sink.position_m = [0, 0]
[[island.mote]]
id = 2
name = "button"
type = 1
position_m = [5, 0]
apps = [)" +
         apps + R"(]
[[island]]
id = 2
name = "bedroom"
sink.position_m = [0, 0]
[[island.mote]]
id = 2
name = "pager"
type = 2
position_m = [5, 0]
apps = [{ app = "listener" }]
)";
}

} // namespace

TEST_CASE("a recorded run is the run without a record", "[ecology][explain][GEN-07]") {
  auto home = example("home.toml");
  const auto with = record_of(home, 40s);
  home.length = 40s;
  const auto without = run_ecology(home, {});
  CHECK(with.report.trace_hash == without.trace_hash);
  CHECK(with.report.events == without.events);
}

TEST_CASE("a message to another island passes exactly the hops it must",
          "[ecology][explain][RTG-02]") {
  const auto all = record_of(example("home.toml"), 40s).all;
  const auto& m = all.messages[message_called(all, "kitchen/button#1")];
  const auto end = step_of(all, m.nodes, step::receives, "bedroom/pager/listener-10");
  CHECK(way_to(all, end) == words{"kitchen/button", "kitchen/button → sink",
                                  "kitchen/sink → gateway", "kitchen-gateway → bedroom-gateway",
                                  "bedroom/gateway → sink", "bedroom/sink → pager",
                                  "bedroom/pager/listener-10"});
  CHECK(explain::outcome_of(all, m).status == explain::message_status::delivered);
  CHECK(m.acknowledged.has_value());
}

TEST_CASE("a message to another island is these octets on each of its hops",
          "[ecology][explain][RTG-02][WIR-01][WIR-02]") {
  constexpr std::string_view text = "dinner";
  auto what = describe(button_and_pager(
      R"({ app = "messenger", to = "bedroom/pager", text = "dinner", reliable = false })"));
  what.length = 40s;
  const auto x = run_recorded(what);
  words hops;
  for (const auto& each : x.content.records) {
    const auto found = std::ranges::search(each.octets, text, std::ranges::equal_to{},
                                           [](auto y) { return static_cast<char>(y); });
    if (!found.empty())
      hops.push_back(std::string(to_string(each.what)) + ' ' + each.from + ' ' + each.to + ' ' +
                     to_hex(each.octets));
  }
  words golden;
  std::ifstream file(RUBICON_TEST_DATA "/island-to-island.txt");
  for (std::string line; std::getline(file, line);)
    if (!line.empty() && line.front() != '#')
      golden.push_back(line);
  CHECK(hops == golden);
}

TEST_CASE("every message that arrives in the report arrives in the record", "[ecology][explain]") {
  const auto* file = GENERATE("home.toml", "operators.toml"); // there a mote sends to itself
  CAPTURE(file);
  const auto x = record_of(example(file), 3min);
  std::size_t sent = 0;
  std::size_t delivered = 0;
  for (const auto& m : x.all.messages) {
    if (m.is_on_channel || m.is_in_tunnel)
      continue;
    ++sent;
    delivered += m.delivered ? 1 : 0;
  }
  const auto counted = x.report.messages();
  CHECK(delivered == counted.received);
  CHECK(sent == counted.reliable_sent + counted.unreliable_sent);
}

TEST_CASE("equal messages of one moment each arrive once", "[ecology][explain]") {
  const std::string twin =
      R"({ app = "messenger", to = "bedroom/pager", text = "dinner", every = "2s",)"
      " reliable = false }";
  const auto x = record_of(describe(button_and_pager(twin + ", " + twin, "loss = 0.4")), 3min);
  std::size_t received = 0;
  for (const auto& m : x.all.messages) {
    if (m.program.find("messenger") == std::string::npos)
      continue;
    const auto times = std::ranges::count_if(
        m.nodes, [&](auto n) { return x.all.nodes[n].what == step::receives; });
    CHECK(times == (m.delivered ? 1 : 0));
    CHECK(m.sends == 1); // of one message no frame is told in the way of the other
    received += static_cast<std::size_t>(times);
  }
  CHECK(received > 100);
}

TEST_CASE("a proxy's value comes from its mote, and goes to who listens", "[ecology][explain]") {
  const auto all = record_of(example("home.toml"), 20s).all;
  const auto& value = all.tuples[value_of(all, "kitchen.climate-7.temperature", 0)];
  CHECK(way_to(all, step_of(all, value.nodes, step::notified, "care-pc/rules-1")) ==
        words{"kitchen/climate-7", "kitchen/climate-7 → sink", "kitchen/sink → gateway",
              "kitchen/gateway", "kitchen-gateway → kitchen-pc", "proxy kitchen.climate-7",
              "proxy kitchen.climate-7", "kitchen-pc → care-pc", "care-pc/rules-1"});
  const auto heard = explain::audience_of(all, value);
  REQUIRE(heard.size() == 2);
  for (const auto& who : heard)
    CHECK(who.after.has_value());
}

TEST_CASE("an actuation is followed from the rules to the relay, and its outcome back",
          "[ecology][explain]") {
  const auto all = record_of(example("home.toml"), 20s).all;
  const auto& told = all.tuples[value_of(all, "devices.4.input.2", 0)];
  const auto way = way_to(all, told.at_owner);
  REQUIRE(way.size() > 6);
  CHECK(way.front() == "kitchen/climate-7"); // whose first reading was below the limit
  CHECK(words(way.end() - 6, way.end()) ==
        words{"care-pc → kitchen-pc", "kitchen-pc", "proxy kitchen.fan", "proxy kitchen.fan",
              "kitchen-pc → kitchen-gateway", "kitchen-gateway"});
  const auto& outcome = all.tuples[value_of(all, "kitchen.fan.switch.outcome", 0)];
  const auto back = way_to(all, outcome.root);
  CHECK(std::ranges::search(back, words{"kitchen/sink → fan", "kitchen/fan → sink",
                                        "kitchen/sink → gateway", "kitchen/gateway"})
            .size() == 4);
}

TEST_CASE("what an unplugged cable keeps back is lost there", "[ecology][explain][GW-16]") {
  auto home = example("home.toml");
  home.faults.insert(home.faults.begin(), {25s, config::unplug_fault{island_id{1}, 40s}});
  const auto all = record_of(home, 60s).all;
  const auto index = message_called(all, "kitchen/button#1"); // at 31 s
  const auto& m = all.messages[index];
  const auto y = explain::outcome_of(all, m);
  CHECK(y.status == explain::message_status::lost);
  CHECK(y.where == "kitchen/sink → gateway");
  CHECK(y.why == "cable unplugged");
  REQUIRE(m.failed);
  const auto text = explain::message_text(all, index, {200, false});
  CHECK(text.find("greets bedroom/pager first, 5 times: no answer") != std::string::npos);
  CHECK(text.find("serial cable unplugged") != std::string::npos);
  CHECK(text.find("reported failed to the sender") != std::string::npos);
}

TEST_CASE("messages are followed while gateways end and start again", "[ecology][explain]") {
  auto home = example("home.toml");
  home.faults.insert(home.faults.begin(), {25s, config::kill_fault{peer_id{2}, 20s}});
  const auto all = record_of(home, 100s).all;
  const auto& lost = all.messages[message_called(all, "kitchen/button#1")]; // at 31 s
  CHECK(explain::outcome_of(all, lost).status == explain::message_status::lost);
  const auto& there = all.messages[message_called(all, "kitchen/button#2")]; // at 61 s
  CHECK(explain::outcome_of(all, there).status == explain::message_status::delivered);
}

TEST_CASE("a record that cannot be written is an error", "[ecology][explain]") {
  run_options options;
  options.record_file = "/proc/rubicon/record";
  CHECK_THROWS_AS(run_ecology(example("home.toml"), options), std::runtime_error);
}
