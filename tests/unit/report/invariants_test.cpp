#include "report/invariants.hpp"
#include "support/catch.hpp"
#include "unit/report/sample.hpp"

using namespace rubicon;
using namespace rubicon::report;
using rubicon::test::sample_report;

namespace {

const mote_address lamp{island_id{3}, mote_id{9}};
const mote_address blinds{island_id{12}, mote_id{3}};
const std::string crashed = "kitchen/climate-8";

} // namespace

TEST_CASE("a run whose run_counters balance violates nothing", "[report][invariants]") {
  CHECK(check_radio(test::lab_report()).empty());
  const run_truth truth{{lamp, blinds}, {{island_id{3}, {mote_id{7}}, {mote_id{7}}}}};
  CHECK(check_all(sample_report(), truth).empty());
  CHECK(check_all(run_report{}, {}).empty());
}

TEST_CASE("a radio copy that vanishes is a violation", "[report][invariants]") {
  auto x = sample_report();
  ++x.islands[0].radio.sent;
  const auto found = check_radio(x);
  REQUIRE(found.size() == 1);
  CHECK(found[0].at == instant{} + 10min);
  CHECK(found[0].invariant == "radio copies balance");
  CHECK(found[0].detail == "kitchen: sent 12401, delivered + lost 12400");
}

TEST_CASE("one island's surplus does not hide another's loss", "[report][invariants]") {
  auto x = sample_report();
  ++x.islands[0].radio.sent;
  --x.islands[1].radio.sent;
  CHECK(check_radio(x).size() == 2);
}

TEST_CASE("an event of a group that vanishes is a violation", "[report][invariants]") {
  auto x = sample_report();
  auto& groups = x.islands[0].smepp;
  groups.events_raised = 10;
  groups.events_received = 6;
  groups.events_lost["gave_up"] = 1;
  groups.events_open = 1;
  groups.refused["wrong_key"] = 2;
  CHECK(check_groups(x).empty());
  ++groups.events_raised;
  const auto found = check_groups(x);
  REQUIRE(found.size() == 1);
  CHECK(found[0].detail == "kitchen: 3 events are missing, but only 2 frames were refused");
  CHECK(check_all(x, {{lamp, blinds}, {}}).size() > check_radio(x).size());
  groups.events_received = 8; // an acknowledgement was lost, so one is received and lost
  CHECK(check_groups(x).empty());
}

TEST_CASE("all checks look at flows and at energy", "[report][invariants]") {
  auto x = sample_report();
  ++x.flows[0].sent;
  ++x.islands[0].motes[0].energy.elapsed;
  CHECK(check_all(x, {{lamp, blinds}, {}}).size() == 3);
}

TEST_CASE("every term of the run_counters counts", "[report][invariants]") {
  const auto broken = [](auto change) {
    auto x = sample_report();
    change(x.islands[1]);
    return check_radio(x).size() + check_messages(x).size();
  };
  CHECK(broken([](island_report&) {}) == 0);
  CHECK(broken([](island_report& x) { ++x.radio.delivered; }) == 1);
  CHECK(broken([](island_report& x) { ++x.radio.lost["loss"]; }) == 1);
  CHECK(broken([](island_report& x) { ++x.radio.requests; }) == 1);
  CHECK(broken([](island_report& x) { ++x.radio.mac_sent; }) == 1);
  CHECK(broken([](island_report& x) { ++x.radio.mac_failed["no_ack"]; }) == 1);
  CHECK(broken([](island_report& x) { ++x.radio.mac_open; }) == 1);
  CHECK(broken([](island_report& x) { ++x.messages.reliable_sent; }) == 3); // nobody offered it
  CHECK(broken([](island_report& x) { ++x.messages.reliable_acked; }) == 1);
  CHECK(broken([](island_report& x) { ++x.messages.reliable_failed; }) == 1);
  CHECK(broken([](island_report& x) { ++x.messages.reliable_open; }) == 1);
  CHECK(broken([](island_report& x) { ++x.messages.unreliable_sent; }) == 2);
  CHECK(broken([](island_report& x) { ++x.messages.arrived; }) == 1);
  CHECK(broken([](island_report& x) { ++x.messages.in_transit; }) == 1);
  CHECK(broken([](island_report& x) { // lost, and nobody knows why
          ++x.messages.lost["unknown"];
          --x.messages.lost["gave_up"];
        }) == 1);
  CHECK(broken([](island_report& x) { ++x.messages.offered; }) == 1);
  CHECK(broken([](island_report& x) { ++x.messages.refused["crowded"]; }) == 1);
  CHECK(broken([](island_report& x) { ++x.messages.lost["gave_up"]; }) == 1);
}

TEST_CASE("a message that vanishes on one mote or on a PC is a violation", "[report][invariants]") {
  auto x = sample_report();
  REQUIRE(check_messages(x).empty());
  ++x.islands[0].motes[0].messages.offered;
  ++x.pc_messages.offered;
  const auto found = check_messages(x);
  REQUIRE(found.size() == 2);
  CHECK(found[0].invariant == "one outcome per message");
  CHECK(found[0].detail == "kitchen/climate-7: offered 112, refused + sent 111");
  CHECK(found[1].detail == "PCs: offered 1, refused + sent 0");
}

TEST_CASE("a channel whose source has none is leaked", "[report][invariants]") {
  const mote_address source{island_id{3}, mote_id{7}};
  const mote_address relay{island_id{3}, mote_id{8}};
  CHECK(check_channels({}, std::vector<channel_entry>{{source, source, 4}, {relay, source, 4}})
            .empty());
  const auto found = check_channels(
      {}, std::vector<channel_entry>{{source, source, 4}, {relay, source, 4}, {relay, source, 5}});
  REQUIRE(found.size() == 1);
  CHECK(found[0].invariant == "no channel is leaked");
  CHECK(found[0].detail ==
        "mote 3/8 has channel 5 of mote 3/7, which has no channel of that number");
}

TEST_CASE("a stream may be half open for a while only", "[report][invariants]") {
  CHECK(check_streams({}, std::vector<half_open_stream>{{7, "a/m", "pc", 10min}}).empty());
  const auto found = check_streams({}, std::vector<half_open_stream>{{7, "a/m", "pc", 11min}});
  REQUIRE(found.size() == 1);
  CHECK(found[0].detail == "stream 7 is open at a/m and not at pc since 11 min");
}

TEST_CASE("island time has a bound where it is promised", "[report][invariants]") {
  auto x = sample_report();
  x.islands[0].network.clock_error_max = 4ms;
  using islands = std::vector<steady_island>;
  CHECK(check_clocks(x, {}).empty());
  CHECK(check_clocks(x, islands{{island_id{3}, true}, {island_id{12}, false}}).empty());
  const auto off = check_clocks(x, islands{{island_id{3}, false}});
  REQUIRE(off.size() == 1);
  CHECK(off[0].detail == "kitchen: a mote's island time is 4 ms off, more than 3 ms");

  x.islands[0].network.clock_excess_max = 2ms;
  const auto unforeseen = check_clocks(x, islands{{island_id{3}, true}});
  REQUIRE(unforeseen.size() == 1);
  CHECK(unforeseen[0].detail ==
        "kitchen: a mote's island time is 2 ms farther off than its error bound");
}

TEST_CASE("ticks come together in islands and among peers",
          "[report][invariants][CLK-06][CLK-08]") {
  using islands = std::vector<steady_island>;
  auto x = sample_report();
  x.islands[0].network.time_excess_max = 6ms;
  CHECK(check_ticks(x, islands{{island_id{3}, true, false}}, {}).empty());
  const auto late = check_ticks(x, islands{{island_id{3}, true, true}}, {});
  REQUIRE(late.size() == 1);
  CHECK(late[0].invariant == "ticks come together");
  CHECK(late[0].detail ==
        "kitchen: a mote's network time is 6 ms farther off its gateway's than its error bound");

  const peer_view pc{peer_id{1}, "pc", {peer_id{1}, peer_id{2}}, {}, 1h};
  const peer_view robot{peer_id{2}, "robot", {peer_id{1}, peer_id{2}}, {}, 1h + 25ms};
  const peer_view stranger{peer_id{3}, "stranger", {peer_id{3}}, {}, 0s};
  auto others = std::vector{pc, robot, stranger};
  CHECK(check_ticks({}, {}, others).empty());
  others[1].clock_offset += 1ms;
  const auto apart = check_ticks({}, {}, others);
  REQUIRE(apart.size() == 1);
  CHECK(apart[0].detail == "the network times of pc and robot are 26 ms apart");
}

TEST_CASE("timeouts are a few for each actor", "[report][invariants]") {
  const auto x = sample_report(); // 31 actors
  CHECK(check_timers(x, 1000 + 16 * 31).empty());
  const auto found = check_timers(x, 1000 + 16 * 31 + 1);
  REQUIRE(found.size() == 1);
  CHECK(found[0].invariant == "no timer queue grows");
}

TEST_CASE("a packet of a flow is counted once", "[report][invariants][traffic]") {
  auto x = sample_report();
  REQUIRE(check_flows(x).empty()); // the broadcast arrived thrice as often as it was sent
  const auto detail = [](const run_report& y) {
    const auto found = check_flows(y);
    return found.size() == 1 ? found[0].invariant + ": " + found[0].detail : "";
  };
  ++x.flows[0].open;
  CHECK(detail(x) == "flow packets balance: lab/node-2 to lab/sink: sent 1000, delivered + lost + "
                     "open 1001");
  x.flows[0].open = 0;
  CHECK(!detail(x).empty());
  ++x.flows[0].delivered;
  CHECK(detail(x).empty());
  ++x.flows[0].lost["no_ack"];
  x.flows[0].open = static_cast<std::uint64_t>(-1); // sent - delivered - lost
  CHECK(detail(x) == "flow packets balance: lab/node-2 to lab/sink: sent 1000, delivered + lost "
                     "1001");
}

TEST_CASE("a mote's times fill its life to the nanosecond", "[report][invariants]") {
  const auto details = [](auto change) {
    auto x = sample_report();
    change(x.islands[1].motes[0]);
    std::string all;
    for (const auto& each : check_energy(x))
      all += each.invariant + ": " + each.detail + '\n';
    return all;
  };
  CHECK(details([](mote_report&) {}).empty());
  CHECK(details([](mote_report& x) { x.energy.radio_off += 1ns; }) ==
        "energy times sum to elapsed time: living-room/climate-2: elapsed ns 600000000000, radio "
        "ns 600000000001\n");
  CHECK(details([](mote_report& x) { x.energy.mcu_sleep -= 1ns; }) ==
        "energy times sum to elapsed time: living-room/climate-2: elapsed ns 600000000000, MCU ns "
        "599999999999\n");
  for (const auto part : {&energy_report::radio_listen, &energy_report::radio_receive,
                          &energy_report::radio_transmit, &energy_report::mcu_active})
    CHECK(!details([part](mote_report& x) { x.energy.*part += 1ns; }).empty());
  CHECK(details([](mote_report& x) { x.energy.elapsed += 1ns; }).find("MCU") != std::string::npos);
}

TEST_CASE("a mote that only measures need not join", "[report][invariants]") {
  CHECK(check_joined(test::lab_report(), std::vector{lamp, blinds}).empty());
  auto x = test::lab_report();
  x.islands[2].motes[0].joins = true;
  CHECK(check_joined(x, std::vector{lamp, blinds}).size() == 1);
}

TEST_CASE("packets and inputs of real motes balance", "[report][invariants][GW-17]") {
  run_report x;
  x.islands.resize(1);
  auto& island = x.islands[0];
  island.name = "kitchen";
  auto& real = island.real;
  real.packets = 10;
  real.taken = 6;
  real.dropped = {{"out_of_range", 3}, {"malformed", 1}};
  real.inputs = 5;
  real.inputs_sent = 2;
  real.inputs_failed = {{"no_ack", 1}};
  real.inputs_open = 2;
  CHECK(check_real_lines(x).empty());
  ++real.packets;
  auto found = check_real_lines(x);
  REQUIRE(found.size() == 1);
  CHECK(found[0].invariant == "packets of real motes balance");
  CHECK(found[0].detail == "kitchen: came 11, taken + dropped 10");
  --real.packets;
  ++real.inputs_sent;
  found = check_real_lines(x);
  REQUIRE(found.size() == 1);
  CHECK(found[0].invariant == "inputs of real motes balance");
}

TEST_CASE("an actuation has one outcome or is still waiting", "[report][invariants]") {
  auto x = sample_report();
  ++x.proxies[1].actuations.requested; // waiting
  CHECK(check_actuations(x).empty());
  x.proxies[1].actuations.acknowledged += 2;
  const auto found = check_actuations(x);
  REQUIRE(found.size() == 1);
  CHECK(found[0].detail == "kitchen.lamp-9: requested 6, outcomes 7");
}

TEST_CASE("a mote that is not listed at the end needs a fault that ended it",
          "[report][invariants]") {
  const auto x = sample_report();
  const auto found = check_joined(x, {});
  REQUIRE(found.size() == 2);
  CHECK(found[0].detail == "kitchen/lamp-9: left: battery");
  CHECK(found[1].detail == "living-room/blinds-3: never joined");
  CHECK(check_joined(x, std::vector{lamp}).size() == 1);
}

TEST_CASE("a device list is compared as a set in which nothing stands twice",
          "[report][invariants]") {
  const run_report x;
  const auto details = [&](std::vector<mote_id> expected, std::vector<mote_id> actual) {
    const auto found = check_device_lists(
        x, std::vector<device_list>{{island_id{3}, std::move(expected), std::move(actual)}});
    return found.empty() ? "" : found[0].detail;
  };
  const mote_id a{7};
  const mote_id b{8};
  CHECK(details({}, {}).empty());
  CHECK(details({a, b}, {b, a}).empty());
  CHECK(details({a, b}, {a}) == "island 3: not listed: 8");
  CHECK(details({a}, {a, b}) == "island 3: listed in error: 8");
  CHECK(details({a}, {b}) == "island 3: not listed: 7; listed in error: 8");
  CHECK(details({a}, {a, a}) == "island 3: listed in error: 7");
}

TEST_CASE("a peer must know exactly those whom it can reach", "[report][KH-05][RTE-07]") {
  const auto id = [](std::int32_t x) { return peer_id{x}; };
  const auto of = [](std::vector<peer_view> peers) {
    std::vector<std::string> details;
    for (const auto& each : check_peers({}, peers)) {
      CHECK(each.invariant == "peers know whom they reach");
      details.push_back(each.detail);
    }
    return details;
  };
  CHECK(of({}).empty());
  CHECK(of({{id(1), "a", {id(1)}, {}}}).empty());
  const peer_view a{id(1), "a", {id(3), id(1), id(2)}, {id(2)}};
  const peer_view b{id(2), "b", {id(1), id(2), id(3)}, {}}; // its end of the link is not there yet
  const peer_view c{id(3), "c", {id(1), id(2), id(3)}, {id(2)}};
  CHECK(of({a, b, c}).empty());
  auto forgetful = c;
  forgetful.hosts = {id(3)};
  CHECK(of({a, b, forgetful}) == std::vector<std::string>{"c: does not know 1 2"});
  auto haunted = c;
  haunted.hosts.push_back(id(7));
  CHECK(of({a, b, haunted}) == std::vector<std::string>{"c: cannot reach 7"});
  haunted.neighbours.push_back(id(7)); // a peer of another process
  CHECK(of({a, b, haunted}).empty());
  const peer_view alone{id(9), "d", {id(9), id(1)}, {}};
  CHECK(of({a, b, c, alone}) == std::vector<std::string>{"d: cannot reach 1"});
}
