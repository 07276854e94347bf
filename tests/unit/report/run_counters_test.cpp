#include "report/invariants.hpp"
#include "report/run_counters.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::report;

namespace {

const mote_address kitchen_fan{island_id{3}, mote_id{4}};
const mote_address button{island_id{3}, mote_id{5}};

run_report of(const run_counters& all, duration length = {}) {
  run_report x;
  x.simulated = length;
  x.islands.emplace_back();
  x.islands[0].id = island_id{3};
  x.islands[0].name = "kitchen";
  for (const auto& who : {kitchen_fan, button}) {
    mote_report mote;
    mote.address = who;
    x.islands[0].motes.push_back(mote);
  }
  all.settle(x);
  return x;
}

stream_part writer(std::uint64_t records, std::uint64_t unwritten, std::uint32_t last_ms) {
  stream_part x;
  x.stream = 7;
  x.writes = true;
  x.writer_name = "kitchen/fan";
  x.reader_name = "robot";
  x.records = records;
  x.unwritten = unwritten;
  x.openings = 1;
  x.opens_failed = 2;
  x.open = true;
  x.started_at = instant{};
  x.last_ms = last_ms;
  x.every = 1s;
  return x;
}

stream_part reader(std::uint64_t records, std::uint32_t last_ms) {
  stream_part x;
  x.stream = 7;
  x.reader_name = "robot";
  x.records = records;
  x.openings = 1;
  x.open = true;
  x.started_at = instant{};
  x.first_at = instant{std::chrono::milliseconds(last_ms - 10'000)};
  x.last_at = instant{std::chrono::milliseconds(last_ms)};
  x.last_ms = last_ms;
  x.every = 1s;
  x.pause = 3s;
  return x;
}

program_report reader_figures(double records) {
  return {"robot",
          "stream_reader",
          {{"records", records}, {"records missing", 0}, {"delivery %", 100}}};
}

double figure(const program_report& x, const std::string& name) {
  for (const auto& [each, value] : x.figures)
    if (each == name)
      return value;
  FAIL("no figure " << name);
  return 0;
}

} // namespace

TEST_CASE("lives of a program are added up, what it measures is the last one's",
          "[report][run_counters]") {
  run_counters all;
  all.add({"kitchen/fan", "average", {{"records read", 3}, {"error", 7}}}, 1, {"error"}, {});
  all.add({"kitchen/fan", "average", {{"records read", 4}, {"error", 5}}}, 1, {"error"}, {});
  all.add({"kitchen/fan", "average", {{"records read", 9}}}, 2, {}, {});
  all.add({"robot", "goal", {{"goals", 1}}}, 0, {}, {});
  all.add({"robot", "goal", {{"goals", 2}}}, 0, {}, {});
  const auto x = of(all);
  REQUIRE(x.programs.size() == 4);
  CHECK(figure(x.programs[0], "records read") == 7);
  CHECK(figure(x.programs[0], "error") == 5);
  CHECK(figure(x.programs[1], "records read") == 9);
  CHECK(figure(x.programs[3], "goals") == 2);
}

TEST_CASE("a stream's delivery is what its writer produced, over all lives",
          "[report][run_counters]") {
  run_counters all;
  all.add({"kitchen/fan", "stream_writer", {}}, 1, {}, {writer(300, 10, 300'000)});
  all.add(reader_figures(280), 1, {"delivery %"}, {reader(280, 290'000)});
  all.add({"kitchen/fan", "stream_writer", {}}, 1, {}, {writer(100, 0, 410'000)});
  all.add(reader_figures(95), 1, {"delivery %"}, {reader(95, 408'000)});
  const auto x = of(all);
  REQUIRE(x.streams.size() == 1);
  const auto& stream = x.streams[0];
  CHECK(stream.from == "kitchen/fan");
  CHECK(stream.produced == 400);
  CHECK(stream.written == 390);
  CHECK(stream.read == 375);
  CHECK(stream.open == 2); // the newest that was read is 2 s older than the newest that was written
  CHECK(stream.missing == 23);
  CHECK(stream.openings == 2);
  CHECK(stream.opens_failed == 4);
  CHECK(stream.pause == 108s); // between the last record of one life and the first of the next
  CHECK(all.half_open(instant{} + 15min).empty());
  CHECK(*stream.delivery() == Approx(375.0 / 398));
  REQUIRE(x.programs.size() == 2);
  CHECK(figure(x.programs[1], "records") == 375);
  CHECK(figure(x.programs[1], "records missing") == 23);
  CHECK(figure(x.programs[1], "delivery %") == Approx(100 * 375.0 / 398));
}

TEST_CASE("a stream that is open at one end only is half open", "[report][run_counters]") {
  run_counters all;
  auto closed = reader(60, 69'000);
  closed.open = false;
  closed.changed_at = instant{} + 4min;
  all.add({"kitchen/fan", "stream_writer", {}}, 1, {}, {writer(100, 0, 100'000)});
  CHECK(all.half_open(instant{} + 15min).empty()); // nobody here reads it
  all.add(reader_figures(60), 1, {}, {closed});
  const auto found = all.half_open(instant{} + 15min);
  REQUIRE(found.size() == 1);
  CHECK(found[0].open_at == "kitchen/fan");
  CHECK(found[0].closed_at == "robot");
  CHECK(found[0].steady == 11min);
  CHECK(check_streams({}, found).size() == 1);
  closed.open = true;
  all.add(reader_figures(60), 1, {}, {closed});
  CHECK(all.half_open(instant{} + 15min).empty());
}

TEST_CASE("a stream's end is closed since its life ended, and as long as its lives did not open it",
          "[report][run_counters]") {
  run_counters all;
  auto open = writer(900, 0, 900'000);
  open.changed_at = instant{} + 1s;
  all.add({"kitchen/fan", "stream_writer", {}}, 1, {}, {open});
  auto killed = reader(899, 899'000);
  killed.open = false;
  killed.changed_at = instant{} + 14min + 59s; // when it was killed, not when it was opened
  all.add(reader_figures(899), 1, {}, {killed});
  const auto young = all.half_open(instant{} + 15min);
  REQUIRE(young.size() == 1);
  CHECK(young[0].steady == 1s);
  CHECK(check_streams({}, young).empty());

  auto again = reader(0, 0); // never opened by its next life
  again.open = false;
  again.started_at = again.changed_at = instant{} + 20min;
  again.first_at = again.last_at = {};
  all.add(reader_figures(899), 1, {}, {again});
  CHECK(all.half_open(instant{} + 30min).at(0).steady == 15min + 1s);

  run_counters merged; // what another process has counted, which began later
  merged.add(all.unsettled(), instant{} + 1h);
  CHECK(merged.half_open(instant{} + 90min).at(0).steady == 15min + 1s);
}

TEST_CASE("a stream's end that an earlier life never opened is closed since its last life",
          "[report][run_counters]") {
  run_counters all;
  all.add({"kitchen/fan", "stream_writer", {}}, 1, {}, {writer(700, 0, 1'199'000)});
  auto first = reader(0, 0); // killed as soon as it began
  first.open = false;
  first.first_at = first.last_at = {};
  all.add(reader_figures(0), 1, {}, {first});
  auto second = reader(700, 1'190'000);
  second.started_at = instant{} + 8min;
  second.open = false;
  second.changed_at = instant{} + 19min + 50s;
  all.add(reader_figures(700), 1, {}, {second});
  REQUIRE(all.half_open(instant{} + 20min).size() == 1);
  CHECK(all.half_open(instant{} + 20min)[0].steady == 10s);
}

TEST_CASE("a stream that opens late is seen, and one that is not read any more",
          "[report][run_counters]") {
  run_counters all;
  auto early = writer(60, 0, 900'000);
  all.add({"kitchen/fan", "stream_writer", {}}, 1, {}, {early});
  auto dead = reader(0, 0); // killed at once
  dead.first_at = dead.last_at = {};
  dead.records = 0;
  dead.pause = 0s;
  all.add(reader_figures(0), 1, {}, {dead});
  CHECK(of(all, 2min).streams.at(0).first_after == 2min); // none has come at all
  CHECK(of(all, 2min).streams.at(0).pause == 0s);
  auto late = reader(58, 860'000);
  late.started_at = instant{} + 14min;
  late.first_at = instant{} + 14min + 2s;
  late.last_at = instant{} + 15min;
  late.pause = 1s;
  all.add(reader_figures(58), 1, {}, {late});
  CHECK(of(all, 15min).streams.at(0).first_after == 14min + 2s);
  CHECK(of(all, 15min).streams.at(0).pause == 1s);
  CHECK(of(all, 25min).streams.at(0).pause == 10min); // its life has ended

  run_counters asked_late; // by an init, say: nobody has waited before
  early.started_at = instant{} + 14min;
  asked_late.add({"kitchen/fan", "stream_writer", {}}, 1, {}, {early});
  asked_late.add(reader_figures(58), 1, {}, {late});
  CHECK(of(asked_late, 15min).streams.at(0).first_after == 2s);
}

TEST_CASE("what is older than half a minute is no more in flight", "[report][run_counters]") {
  run_counters all;
  all.add({"kitchen/fan", "stream_writer", {}}, 1, {}, {writer(100, 0, 100'000)});
  all.add(reader_figures(60), 1, {}, {reader(60, 69'000)});
  CHECK(of(all).streams[0].open == 0);
  CHECK(of(all).streams[0].missing == 40);
}

TEST_CASE("what was written to a reader that has ended is in flight for half a minute",
          "[report][run_counters]") {
  run_counters all;
  all.add({"kitchen/fan", "stream_writer", {}}, 1, {}, {writer(80, 0, 86'000)}); // and gives up
  all.add(reader_figures(60), 1, {}, {reader(60, 60'000)});
  CHECK(of(all, 91s).streams[0].open == 20);
  CHECK(of(all, 91s).streams[0].missing == 0);
  CHECK(of(all, 92s).streams[0].open == 0);
  CHECK(of(all, 92s).streams[0].missing == 20);
  CHECK(*of(all, 40min).streams[0].delivery() == Approx(60.0 / 80));
}

TEST_CASE("a reader whose writer is nobody of this run goes by its own clock",
          "[report][run_counters]") {
  run_counters all;
  all.add({"robot", "stream_reader", {{"records", 5}, {"records missing", 2}}}, 1, {},
          {reader(5, 5'000)});
  const auto x = of(all);
  CHECK(figure(x.programs[0], "records missing") == 2);
  CHECK_FALSE(x.streams[0].delivery());
}

TEST_CASE("messages are added up over lives, and the account says what became of them",
          "[report][run_counters]") {
  message_report life;
  life.offered = 12;
  life.refused = {{"crowded", 2}};
  life.unreliable_sent = 10;
  run_counters all;
  all.add(kitchen_fan, false, life);
  all.add(kitchen_fan, false, life);
  all.add({island_id{30}, no_mote}, true, life);
  unsettled_counters account;
  account.accounts[{kitchen_fan, "message"}] = {20, 17, 2, 0, {{"gave_up", 1}}};
  account.accounts[{{island_id{30}, no_mote}, "message"}] = {10, 10, 0, 0, {}};
  account.losses[{"message", "gave_up", "kitchen/fan"}] = 1;
  all.add(account);
  unsettled_counters elsewhere; // another process has received one of the two that it was given
  elsewhere.accounts[{kitchen_fan, "message"}].came_over = 1;
  all.add(elsewhere);
  const auto x = of(all);
  const auto& sum = x.islands[0].motes[0].messages;
  CHECK(sum.offered == 24);
  CHECK(sum.refused.at("crowded") == 4);
  CHECK(sum.arrived == 18);
  CHECK(sum.lost == cause_counts{{"gave_up", 1}});
  CHECK(sum.in_transit == 1);
  REQUIRE(x.losses.size() == 1);
  CHECK(x.losses[0].place == "kitchen/fan");
  CHECK(*sum.delivery() == Approx(18.0 / 23));
  CHECK(x.islands[0].messages.offered == 24);
  CHECK(x.pc_messages.offered == 12);
  CHECK(x.messages().offered == 36);
  CHECK(check_messages(x).empty());
}

TEST_CASE("actuations of a proxy that is started again are kept", "[report][run_counters]") {
  run_counters all;
  proxy_report life{"kitchen.fan", "fan", "ended", {}, {3, 2, 0, 10ms, {}, {{"proxy_ended", 1}}}};
  all.add(life, true);
  CHECK(of(all).proxies.at(0).status == "ended");
  all.add({"kitchen.fan", "fan", "active", {{"switch", "on"}}, {2, 2, 0, 5ms, {}, {}}}, false);
  all.add(life, true); // told late
  const auto x = of(all);
  REQUIRE(x.proxies.size() == 1);
  CHECK(x.proxies[0].status == "active");
  CHECK(x.proxies[0].values.size() == 1);
  CHECK(x.proxies[0].actuations.requested == 8);
  CHECK(x.proxies[0].actuations.acknowledged == 6);
  CHECK(x.proxies[0].actuations.slowest == 10ms);
  CHECK(check_actuations(x).empty());
}

TEST_CASE("packets of channels belong to the island of their sender, of tunnels to the run",
          "[report][run_counters]") {
  unsettled_counters told;
  told.accounts[{kitchen_fan, "channel"}] = {100, 97, 0, 0, {{"gave_up", 2}}};
  told.accounts[{kitchen_fan, "tunnel"}] = {10, 10, 0, 0, {}};
  run_counters all;
  all.add(told);
  const auto x = of(all);
  const auto& packets = x.islands[0].network.channel_packets;
  CHECK(packets.sent == 100);
  CHECK(packets.arrived == 97);
  CHECK(packets.lost == cause_counts{{"gave_up", 2}});
  CHECK(packets.in_transit == 1);
  CHECK(x.tunnels.sent == 10);
  CHECK(x.messages().offered == 0);
}
