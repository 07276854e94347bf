#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "exports/mcap_file.hpp"
#include "exports/mcap_writer.hpp"
#include "exports/mote_places.hpp"
#include "exports/stations.hpp"
#include "exports/trace_events.hpp"
#include "support/catch.hpp"
#include "support/mcap_file.hpp"
#include "support/trace_event_file.hpp"
#include "unit/explain/fixture.hpp"
#include "view/sample_json.hpp"

using namespace rubicon;
using namespace rubicon::exports;
using namespace rubicon::test;

namespace {

/// All of a file, and the longest part of it.
struct collected {
  std::string octets;
  std::size_t part_max = 0;

  octets_out out() {
    return [this](std::string_view part) {
      octets += part;
      part_max = std::max(part_max, part.size());
    };
  }
};

constexpr const char* ecology = R"({"islands":[{"id":1,"sink":{"id":1,"x":2.0,"y":2.0},
  "motes":[[7,"near",1.0,0.0,"t"],[8,"far",5.0,0.0,"t"]]}],"paths":{"1":[[10,5,0],[20,15,0]]}})";

/// Motes 7 and 8 at a moment.
std::string sample_at(instant at) {
  report::run_sample x;
  x.at = at;
  for (const auto id : {mote_id{7}, mote_id{8}}) {
    auto& mote = x.motes.emplace_back();
    mote.address = {island_id{1}, id};
    mote.alive = id == mote_id{7};
    mote.used_mah = 0.5;
    mote.parent = mote_id{1};
    mote.hops = 1;
    mote.neighbours.push_back({mote_id{1}, 1.5});
  }
  x.motes[0].etx = 1.25;
  x.motes[0].signal_dbm = -60;
  return view::encode(x);
}

void add_text(explain_fixture& world, explain::kind what, std::string text) {
  explain::record r;
  r.text = std::move(text);
  world.put(what, "ecology/test", "", 0, std::move(r));
}

/// Both motes send to the sink, 7 twice at once; 8 is not received; a fault, a tuple and samples.
explain::traces small_run() {
  explain_fixture world;
  add_text(world, explain::kind::ecology, ecology);
  for (const std::uint64_t token : {1, 2}) {
    const auto number = static_cast<std::uint16_t>(token);
    const bytes content{0, static_cast<std::uint8_t>(token)};
    const auto cause = world.program_sends(near_mote, content, true, token);
    const auto packet = world.packet_up(world.reliable(7, number, content));
    world.asks_radio({near_mote, sink_actor, 7, 1, network::am::up,
                      world.up(7, number, world.whole(packet)), token},
                     cause);
    world.now += 1us;
  }
  for (const std::uint64_t token : {1, 2})
    world.on_air({near_mote, sink_actor, 7, 1, network::am::up, {}, token}, "delivered");
  const auto lost = world.program_sends(far_mote, reading, true);
  const explain_fixture::frame_of weak{
      far_mote,
      sink_actor,
      8,
      1,
      network::am::up,
      world.up(8, 1, world.whole(world.packet_up(world.reliable(8, 1, reading))))};
  world.asks_radio(weak, lost);
  for (int i = 0; i < 3; ++i)
    world.on_air(weak, "weak");
  world.radio_ends(weak, "no_ack");
  world.sets("proxy/kitchen.near", pc_kernel, "kitchen.near.temperature", "21.5", 0);
  add_text(world, explain::kind::event, "mote far: killed");
  for (const auto at : {5s, 15s}) {
    world.now = instant{} + at;
    add_text(world, explain::kind::sample, sample_at(world.now));
  }
  add_text(world, explain::kind::sample, "no sample");
  world.now = instant{} + 200s;
  add_text(world, explain::kind::event, "end");
  return explain::follow(world.x);
}

std::size_t count_of(const std::map<std::string, std::size_t>& all, const std::string& name) {
  const auto found = all.find(name);
  return found == all.end() ? 0 : found->second;
}

} // namespace

TEST_CASE("the checksum of MCAP is that of ISO 3309", "[exports]") {
  CHECK(crc32("123456789") == 0xcbf43926);
  CHECK(crc32("6789", crc32("12345")) == 0xcbf43926);
  CHECK(crc32("") == 0);
}

TEST_CASE("an MCAP file without messages has a summary", "[exports]") {
  collected to;
  mcap_writer x(to.out());
  const bool has_channel = GENERATE(false, true);
  if (has_channel)
    x.add_channel("/a", {"A", "jsonschema", "{}"});
  x.finish();
  const mcap_file y(to.octets);
  CHECK(y.problems == std::vector<std::string>{});
  CHECK(y.messages.empty());
  CHECK(y.channels.size() == (has_channel ? 1U : 0U));
}

TEST_CASE("an MCAP file of many chunks is read back, and none is kept", "[exports]") {
  collected to;
  mcap_writer x(to.out());
  const auto a = x.add_channel("/a", {"A", "jsonschema", "{}"});
  const auto b = x.add_channel("/b", {"B", "jsonschema", "{\"type\":\"object\"}"});
  const std::string message(100'000, 'x');
  for (int i = 0; i < 25; ++i)
    x.add(i % 3 == 0 ? a : b, instant{} + (i / 2) * 1s, message);
  x.finish();
  const mcap_file y(to.octets);
  CHECK(y.problems == std::vector<std::string>{});
  CHECK(y.chunks == 3);
  CHECK(y.of("/a").size() == 9);
  CHECK(y.of("/b").size() == 16);
  CHECK(y.messages[24].data == message);
  CHECK(y.messages[24].time == 12'000'000'000U);
  CHECK(to.part_max < mcap_writer::chunk_octets + 2 * message.size());
}

TEST_CASE("any other octet of an MCAP file is noticed by its reader", "[exports]") {
  collected to;
  mcap_writer x(to.out());
  x.add(x.add_channel("/a", {"A", "jsonschema", "{}"}), instant{} + 1s, "{}");
  x.finish();
  REQUIRE(mcap_file(to.octets).problems.empty());
  for (auto& octet : to.octets) {
    octet = static_cast<char>(octet ^ 1);
    CHECK_FALSE(mcap_file(to.octets).problems.empty());
    octet = static_cast<char>(octet ^ 1);
  }
}

TEST_CASE("steps of a record take place at motes, sinks, peers and proxies", "[exports]") {
  const explain_fixture world;
  const explain::names known(world.x.about);
  for (const auto& [path, name] : {std::pair("mote/kitchen/far", "kitchen/far"),
                                   {"sink/kitchen", "kitchen/sink"},
                                   {"mote_app/kitchen/far/sampler-1", "kitchen/far"},
                                   {"gateway/kitchen", "kitchen/gateway"},
                                   {"mote_app/kitchen/sink/flow-1", "kitchen/sink"},
                                   {"peis_peer/pc", "pc"},
                                   {"peer_app/robot/collector-1", "robot"},
                                   {"proxy_manager/pc", "pc"},
                                   {"proxy/kitchen.far", "proxy kitchen.far"},
                                   {"peis_lan", "peis_lan"},
                                   {"", "ecology"}})
    CHECK(station_of(known, path) == name);
}

TEST_CASE("carried motes are where their paths have them", "[exports]") {
  const auto all = places_of(ecology);
  REQUIRE(all.size() == 3);
  CHECK(all[0].who == mote_address{island_id{1}, mote_id{1}});
  CHECK(all[0].path.at(instant{} + 15s) == position{2, 2});
  CHECK(all[1].path.at(instant{} + 15s) == position{1, 0});
  CHECK(all[2].path.at(instant{} + 1s) == position{5, 0});
  CHECK(all[2].path.at(instant{} + 15s) == position{10, 0});
}

TEST_CASE("the description of an ecology that is none has no places", "[exports]") {
  for (const auto* const text :
       {"", "x", "[]", "{}", "3", R"({"islands":3})", R"({"islands":[3,[],{}]})",
        R"({"islands":[{"id":-1,"sink":{"id":1}}]})",
        R"({"islands":[{"id":1,"motes":[3,[],["a"]]}]})",
        R"({"islands":[{"id":99999999999,"sink":{"id":1}}],"paths":[]})"})
    CHECK(places_of(text).empty());
  const auto odd = places_of(
      R"({"islands":[{"id":1,"motes":[[7]]}],"paths":{"0":[3,[],[1e300,1,1],[-1,2,2],["a"]]}})");
  REQUIRE(odd.size() == 1);
  static_cast<void>(odd[0].path.at(instant{} + 1s));
}

TEST_CASE("trace events have a track for each mote and bind the steps of a message", "[exports]") {
  const auto all = small_run();
  collected to;
  write_trace_events(all, to.out());
  const trace_event_file x(to.octets);
  CHECK(x.problems == std::vector<std::string>{});
  std::map<std::string, int> processes;
  for (const auto& each : x.processes)
    ++processes[each.second];
  for (const auto* const name : {"kitchen/near", "kitchen/far", "proxy kitchen.near", "test"})
    CHECK(processes[name] == 1);
  std::map<std::string, int> threads;
  for (const auto& each : x.threads)
    ++threads[x.processes.at(each.first.first) + ": " + each.second];
  CHECK(threads["kitchen/near: radio"] == 1);
  CHECK(threads["kitchen/near: radio 2"] == 1); // two frames wait at once
  CHECK(threads["kitchen/far: radio 2"] == 0);
  CHECK(x.flows >= 3);
  CHECK(count_of(x.slices, "kitchen/far#1") == 2); // sends, and a hop
  CHECK(count_of(x.slices, "attempt 3") == 1);
  CHECK(to.part_max < 10'000);
}

TEST_CASE("a record without anything is a trace without events", "[exports]") {
  collected to;
  write_trace_events({}, to.out());
  const trace_event_file x(to.octets);
  CHECK(x.problems == std::vector<std::string>{});
  CHECK(x.processes.empty());
  collected mcap;
  write_mcap({}, mcap.out());
  const mcap_file y(mcap.octets);
  CHECK(y.problems == std::vector<std::string>{});
  CHECK(y.channels.size() == 6);
  CHECK(y.messages.empty());
}

TEST_CASE("MCAP has messages, tuples, events, places and links of a record", "[exports]") {
  using nlohmann::json;
  const auto all = small_run();
  collected to;
  write_mcap(all, to.out());
  const mcap_file x(to.octets);
  REQUIRE(x.problems == std::vector<std::string>{});
  for (const auto& [id, each] : x.channels) {
    CHECK(each.encoding == "json");
    const auto& [name, encoding, text] = x.schemas.at(each.schema);
    CHECK(encoding == "jsonschema");
    CHECK(json::parse(text).at("type") == "object");
  }
  const auto messages = x.of("/messages");
  REQUIRE(messages.size() == all.messages.size());
  std::map<std::string, std::string> outcomes;
  for (const auto& each : messages) {
    const auto y = json::parse(each.data);
    outcomes[y.at("message").get<std::string>()] = y.at("outcome").get<std::string>();
  }
  CHECK(outcomes["kitchen/far#1"] == "lost");
  const auto tuple = json::parse(x.of("/tuples").at(0).data);
  CHECK(tuple["key"] == "kitchen.near.temperature");
  CHECK(tuple["value"] == "21.5");
  CHECK(json::parse(x.of("/events").at(0).data).at("message") == "mote far: killed");
  const auto places = x.of("/places");
  REQUIRE(places.size() == 3); // at the start, and in two samples
  CHECK(places[0].time == 0);
  CHECK(json::parse(places[2].data).at("motes").at(2) ==
        json({{"mote", "kitchen/far"}, {"x_m", 10.0}, {"y_m", 0.0}}));
  const auto links = json::parse(x.of("/links").at(1).data);
  CHECK(links.at("motes").at(0).at("parent") == "kitchen/sink");
  CHECK(links.at("motes").at(0).at("etx") == 1.25);
  CHECK_FALSE(links.at("motes").at(1).contains("etx"));
  CHECK(links.at("neighbours").size() == 2);
  CHECK(json::parse(x.of("/scene").at(2).data).at("entities").size() == 4);
}
