#include "report/merge.hpp"

#include <string>
#include <vector>

#include "report/expect/expectations.hpp"
#include "report/invariants.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::report;

namespace {

constexpr mote_address house_fan{island_id(1), mote_id(2)};
constexpr mote_address pager{island_id(2), mote_id(3)};

part_report part_with(const mote_address& mote, const std::string& name) {
  part_report x;
  x.report.ecology = "house";
  x.report.complete = true;
  x.report.simulated = 60s;
  x.report.events = 100;
  x.report.trace_hash = "00000000000000ff";
  island_report island;
  island.id = mote.island;
  island.name = name;
  island.radio.sent = 10;
  mote_report member;
  member.address = mote;
  island.motes.push_back(member);
  x.report.islands.push_back(island);
  return x;
}

config::ecology_description house() {
  config::ecology_description x;
  x.name = "house";
  x.length = 60s;
  return x;
}

run_report merged_of(std::vector<host_report> parts) {
  return merged(house(), parts);
}

const mote_report& only_mote(const run_report& x, std::size_t island) {
  return x.islands.at(island).motes.at(0);
}

} // namespace

TEST_CASE("parts of two hosts are one report", "[report][GEN-05]") {
  auto kitchen = part_with(house_fan, "kitchen");
  auto bedroom = part_with(pager, "bedroom");
  kitchen.report.event_log = {{instant(2s), "kitchen/fan", "joined"}};
  bedroom.report.event_log = {{instant(1s), "bedroom/pager", "joined"}};
  const auto x = merged_of({{"b", {{0s, bedroom, true}}}, {"a", {{0s, kitchen, true}}}});
  CHECK(x.complete);
  CHECK(x.violations.empty());
  CHECK(x.events == 200);
  CHECK(x.trace_hash == "00000000000001fe");
  REQUIRE(x.islands.size() == 2);
  CHECK(x.islands[0].name == "kitchen"); // ascending by id
  REQUIRE(x.event_log.size() == 2);
  CHECK(x.event_log[0].who == "bedroom/pager");
}

TEST_CASE("a message from one host to another has arrived", "[report][GEN-05]") {
  auto kitchen = part_with(house_fan, "kitchen");
  auto bedroom = part_with(pager, "bedroom");
  auto& sent = kitchen.counters.messages[house_fan];
  sent.offered = sent.unreliable_sent = 5;
  auto& account = kitchen.counters.accounts[{house_fan, "message"}];
  account.sent = account.handed_over = 5;
  account.handed_lately = 1;
  bedroom.counters.accounts[{house_fan, "message"}].came_over = 4;
  const auto x = merged_of({{"a", {{0s, kitchen, true}}}, {"b", {{0s, bedroom, true}}}});
  CHECK(only_mote(x, 0).messages.arrived == 4);
  CHECK(only_mote(x, 0).messages.lost.empty());
  CHECK(only_mote(x, 0).messages.in_transit == 1);
  CHECK(x.violations.empty());
}

TEST_CASE("what did not arrive on another host is lost, unless it may be on its way",
          "[report][GEN-05]") {
  auto kitchen = part_with(house_fan, "kitchen");
  auto bedroom = part_with(pager, "bedroom");
  auto& sent = kitchen.counters.messages[house_fan];
  sent.offered = sent.unreliable_sent = 60;
  auto& account = kitchen.counters.accounts[{house_fan, "message"}];
  account.sent = 60;
  account.arrived = 5; // in the own island
  account.lost["gave_up"] = 3;
  account.handed_over = 51; // and one is still in transit here
  account.handed_lately = 6;
  const auto outcome = [&](std::uint64_t came_over, bool all_reported) {
    bedroom.counters.accounts[{house_fan, "message"}].came_over = came_over;
    return merged_of({{"a", {{0s, kitchen, true}}}, {"b", {{0s, bedroom, all_reported}}}});
  };
  for (const std::uint64_t came_over : {0, 20, 44, 45, 46, 50, 51, 99}) {
    CAPTURE(came_over);
    const auto x = outcome(came_over, true);
    const auto messages = only_mote(x, 0).messages;
    const auto arrived = std::min<std::uint64_t>(came_over, 51);
    const auto on_their_way = std::min<std::uint64_t>(51 - arrived, 6);
    const auto lost = 51 - arrived - on_their_way;
    CHECK(messages.arrived == 5 + arrived);
    CHECK(messages.in_transit == 1 + on_their_way);
    CHECK(messages.lost.contains("other_host") == (lost > 0));
    CHECK(total(messages.lost) == 3 + lost);
    std::uint64_t placed = 0;
    for (const auto& each : x.losses)
      placed += each.cause == "other_host" ? each.count : 0;
    CHECK(placed == lost);
  }
  const auto x = outcome(20, false); // what the other host has received since is not known
  CHECK(only_mote(x, 0).messages.in_transit == 1 + 31);
  CHECK(only_mote(x, 0).messages.lost == cause_counts{{"gave_up", 3}});
}

TEST_CASE("a message is on its way when its life has ended for as long as others last",
          "[report][GEN-05]") {
  auto before = part_with(house_fan, "kitchen");
  before.counters.messages[house_fan].offered = 5;
  auto& account = before.counters.accounts[{house_fan, "message"}];
  account.sent = account.handed_over = account.handed_lately = 5;
  const auto after = part_with(house_fan, "kitchen");
  const auto bedroom = part_with(pager, "bedroom");
  const auto x =
      merged_of({{"a", {{0s, before, false}, {100s, after, true}}}, {"b", {{0s, bedroom, true}}}});
  CHECK(only_mote(x, 0).messages.lost == cause_counts{{"other_host", 5}});
  CHECK(only_mote(x, 0).messages.in_transit == 0);
}

TEST_CASE("a stream from one host to another is whole", "[report][GEN-05]") {
  auto kitchen = part_with(house_fan, "kitchen");
  auto bedroom = part_with(pager, "bedroom");
  const unsettled_counters::stream_key key("bedroom/pager", 7);
  auto& written = kitchen.counters.streams[key];
  written.sum.stream = 7;
  written.sum.from = "kitchen/fan";
  written.sum.to = "bedroom/pager";
  written.sum.produced = written.sum.written = 10;
  written.writer.is_known = true;
  auto& read = bedroom.counters.streams[key];
  read.sum.stream = 7;
  read.sum.to = "bedroom/pager";
  read.sum.read = 9;
  read.reader.is_known = true;
  const auto x = merged_of({{"a", {{0s, kitchen, true}}}, {"b", {{0s, bedroom, true}}}});
  REQUIRE(x.streams.size() == 1);
  CHECK(x.streams[0].from == "kitchen/fan");
  CHECK(x.streams[0].produced == 10);
  CHECK(x.streams[0].read == 9);
  CHECK(x.streams[0].missing == 1);
}

TEST_CASE("lives of a part add up, and what was open in one that was killed has failed",
          "[report][GEN-05]") {
  auto before = part_with(house_fan, "kitchen");
  auto& killed = before.counters.messages[house_fan];
  killed.offered = killed.reliable_sent = 3;
  killed.reliable_acked = 2;
  killed.reliable_open = 1;
  before.counters.accounts[{house_fan, "message"}] = {3, 2, 0, 0, {}};
  before.report.complete = false;
  before.report.simulated = 20s;
  auto after = part_with(house_fan, "kitchen");
  auto& sent = after.counters.messages[house_fan];
  sent.offered = sent.reliable_sent = sent.reliable_acked = 4;
  after.counters.accounts[{house_fan, "message"}] = {4, 4, 0, 0, {}};
  after.report.simulated = 35s;
  after.report.event_log = {{instant(1s), "kitchen/fan", "joined"}};
  const auto x = merged_of({{"a", {{0s, before, false}, {25s, after, true}}}});
  CHECK(x.complete);
  CHECK(x.simulated == 60s);
  REQUIRE(x.islands.size() == 1);
  CHECK(x.islands[0].radio.sent == 20);
  const auto& messages = only_mote(x, 0).messages;
  CHECK(messages.reliable_sent == 7);
  CHECK(messages.reliable_acked == 6);
  CHECK(messages.reliable_failed == 1);
  CHECK(messages.reliable_open == 0);
  CHECK(messages.arrived == 6);
  CHECK(messages.lost == cause_counts{{"node_stopped", 1}});
  CHECK(x.violations.empty()); // they balance
  REQUIRE(x.event_log.size() == 2);
  CHECK(x.event_log[0].at == instant(20s));
  CHECK(x.event_log[0].what.starts_with("last contact"));
  CHECK(x.event_log[1].at == instant(26s));
}

TEST_CASE("what nobody can know any more is said, and the whole is not complete",
          "[report][GEN-05]") {
  auto before = part_with(house_fan, "kitchen");
  before.report.complete = false;
  before.report.simulated = 20s;
  const auto after = part_with(house_fan, "kitchen");
  const auto merged_after = [&](duration ended) { // its host was away for half an hour
    return merged_of({{"a", {{0s, before, false, ended}, {30min, after, true}}}});
  };
  const auto seen = merged_after(24s); // it has left reports until 4 s before its end
  CHECK(seen.complete);
  CHECK(seen.event_log.at(0).what == "last contact: its part's counts until 0:24 are unknown");
  for (const auto& x : {merged_after(31s), merged_after(0s)}) {
    CHECK(!x.complete);
    CHECK(x.reason.starts_with("host a: its part's counts from 0:20 to "));
    REQUIRE(x.violations.size() == 1);
    CHECK(x.violations[0].invariant == run_is_complete);
    CHECK(x.violations[0].at == instant(20s));
  }
}

TEST_CASE("members are those of a part's last life, and its events those of all",
          "[report][smepp]") {
  auto first = part_with(house_fan, "kitchen");
  auto& groups = first.report.islands[0].smepp;
  groups.programs = groups.members = 3;
  groups.events_raised = 10;
  groups.events_received = 8;
  groups.events_open = 2;
  const auto second = first;
  const auto x = merged_of({{"a", {{0s, first, false}, {30s, second, true}}}});
  const auto& all = x.islands.at(0).smepp;
  CHECK(all.programs == 3);
  CHECK(all.members == 3);
  CHECK(all.events_raised == 20);
  CHECK(all.events_open == 2);
  CHECK(all.events_lost.at("power_lost") == 2);
  CHECK(all.events_missing() == 0);
}

TEST_CASE("a host without a last word is a violation", "[report][GEN-05]") {
  const auto gone = merged_of({{"a", {{0s, part_with(house_fan, "kitchen"), false}}}, {"b", {{}}}});
  CHECK_FALSE(gone.complete);
  REQUIRE(gone.violations.size() == 2);
  CHECK(gone.violations[0].detail == "host a: its part sent no final report");
  auto early = part_with(house_fan, "kitchen");
  early.report.complete = false;
  early.report.reason = "out of memory";
  const auto x = merged_of({{"a", {{0s, early, true}}}});
  CHECK_FALSE(x.complete);
  CHECK(x.reason == "host a: out of memory");
}

TEST_CASE("what parts have judged is judged, the rest is found in the whole", "[report]") {
  auto description = house();
  description.expectations = {
      config::joined_expectation{{}, 10s}, config::delivery_expectation{},
      config::tuple_expectation{},
      config::sometimes_expectation{"lit", {}, config::tuple_condition{"a.b", {"on"}, {}, {}}, {}}};
  auto part = part_with(house_fan, "kitchen");
  part.report.islands[0].motes[0].name = "fan";
  auto& sent = part.counters.messages[house_fan];
  sent.offered = sent.reliable_sent = sent.reliable_acked = 4;
  part.counters.accounts[{house_fan, "message"}] = {4, 4, 0, 0, {}};
  using verdict = expectation_report::verdict;
  part.report.expectations = {
      {to_text(description.expectations[0]), verdict::unmet, "1 late", instant(10s)}};
  const auto x = merged(description, {{"a", {{0s, part, true}}}});
  REQUIRE(x.expectations.size() == 4);
  CHECK(x.expectations[0].outcome == verdict::unmet);
  CHECK(x.expectations[1].outcome == verdict::met);
  CHECK(x.expectations[2].outcome == verdict::unjudged);
  CHECK(x.expectations[3].measured.starts_with("not checked"));
  REQUIRE(x.violations.size() == 1);
  CHECK(x.violations[0].invariant.starts_with("expected: joined"));
}
