#include "unit/report/sample.hpp"

namespace rubicon::test {

namespace {

delay_histogram delays(const std::vector<duration>& all) {
  delay_histogram x;
  for (const auto each : all)
    x.add(each);
  return x;
}

using namespace report;

mote_report sample_mote(island_id island, std::uint16_t id, std::string name, double used_mah) {
  mote_report x;
  x.address = {island, mote_id{id}};
  x.name = std::move(name);
  x.type = "climate";
  x.joined = true;
  x.alive = true;
  x.incarnations = 1;
  x.energy.used_mah = used_mah;
  x.energy.battery_mah = 2500;
  x.energy.elapsed = 600s;
  x.energy.mcu_active = 6s;
  x.energy.mcu_sleep = 594s;
  x.energy.radio_listen = 597s;
  x.energy.radio_receive = 2s;
  x.energy.radio_transmit = 1s;
  return x;
}

island_report sample_kitchen() {
  island_report x;
  x.id = island_id{3};
  x.name = "kitchen";
  x.radio.sent = 12'400;
  x.radio.delivered = 8'321;
  x.radio.lost = {{"collision", 12}, {"duplicate", 9}, {"filtered", 3'991}, {"loss", 67}};
  x.radio.requests = 2'100;
  x.radio.mac_sent = 2'095;
  x.radio.mac_failed = {{"no_ack", 4}};
  x.radio.mac_open = 1;
  x.radio.transmissions = 4'321;
  x.serial = {124'000, 123'456, 100'000, 5'000, 4'990, {{"crc", 10}}};
  x.messages = {.offered = 1'253,
                .refused = {{"crowded", 2}},
                .reliable_sent = 1'234,
                .reliable_acked = 1'230,
                .reliable_failed = 3,
                .reliable_open = 1,
                .unreliable_sent = 17,
                .arrived = 1'245,
                .lost = {{"gave_up", 5}},
                .in_transit = 1,
                .received = 1'222,
                .duplicates = 5};
  x.motes = {sample_mote(x.id, 7, "climate-7", 3.301), sample_mote(x.id, 8, "climate-8", 3.287),
             sample_mote(x.id, 9, "lamp-9", 1.02)};
  x.motes[2].alive = false;
  x.motes[2].left_cause = "battery";
  x.motes[0].messages = {.offered = 111,
                         .refused = {{"crowded", 1}},
                         .reliable_sent = 100,
                         .reliable_acked = 99,
                         .reliable_failed = 1,
                         .unreliable_sent = 10,
                         .arrived = 108,
                         .lost = {{"gave_up", 2}}};
  x.motes[0].parent = mote_id{8};
  x.motes[0].hops = 2;
  x.motes[0].signal_dbm = -71;
  return x;
}

island_report living_room() {
  island_report x;
  x.id = island_id{12};
  x.name = "living-room";
  x.radio.sent = 900;
  x.radio.delivered = 900;
  x.radio.requests = 450;
  x.radio.mac_sent = 450;
  x.radio.transmissions = 900;
  x.serial = {9'876, 9'876, 9'000, 400, 400, {}};
  x.messages = {
      .offered = 200, .reliable_sent = 200, .reliable_acked = 200, .arrived = 200, .received = 200};
  x.motes = {sample_mote(x.id, 2, "climate-2", 3.311), sample_mote(x.id, 3, "blinds-3", 2.95)};
  x.motes[1].joined = false;
  return x;
}

island_report lab() {
  island_report x;
  x.id = island_id{20};
  x.name = "lab";
  x.radio.sent = 30;
  x.radio.delivered = 26;
  x.radio.lost = {{"captured", 1}, {"weak", 3}};
  x.radio.requests = 16;
  x.radio.mac_sent = 15;
  x.radio.mac_open = 1;
  x.radio.transmissions = 31;
  x.motes = {sample_mote(x.id, 2, "node-2", 3.1)};
  x.motes[0].joins = false;
  x.motes[0].joined = false;
  return x;
}

flow_report sample_flow(std::uint16_t from, mote_id to, const std::string& to_name) {
  flow_report x;
  x.from = {island_id{20}, mote_id{from}};
  x.to = {island_id{20}, to};
  x.from_name = "lab/node-" + std::to_string(from);
  x.to_name = "lab/" + to_name;
  x.sent = 1'000;
  x.delivered = 900;
  x.pdr = 0.9;
  x.goodput_bps = 1'440;
  x.delay_mean_ms = 12.5;
  x.delay_p50_ms = 10;
  x.delay_p95_ms = 30;
  x.tx_per_packet = 1.25;
  x.lost = {{"channel_access_failure", 20}, {"no_ack", 79}};
  x.open = 1;
  return x;
}

peer_report sample_peer(peer_id id, std::string name, std::uint64_t links, std::uint64_t hosts,
                        std::uint64_t tuples, peis_report peis) {
  peer_report x;
  x.id = id;
  x.name = std::move(name);
  x.links = links;
  x.hosts_known = hosts;
  x.tuples = tuples;
  x.peis = std::move(peis);
  return x;
}

} // namespace

run_report sample_report() {
  run_report x;
  x.ecology = "two rooms";
  x.seed = 42;
  x.mode = "virtual";
  x.simulated = 10min;
  x.wall_s = 0.84;
  x.events = 123'456;
  x.trace_hash = "0123456789abcdef";
  x.complete = true;
  x.actors = {31, 1, {"kitchen/climate-8: crash asked for"}};
  x.islands = {sample_kitchen(), living_room()};
  x.flows = {sample_flow(2, default_sink, "sink"), sample_flow(2, broadcast_mote, "*")};
  x.flows[1].delivered = 3'000;
  x.flows[1].pdr = 3;
  x.flows[1].lost = {};
  x.flows[1].open = 0;
  x.peers = {
      sample_peer(peer_id{3}, "kitchen-gateway", 2, 3, 41, {1, 5'321, 41, {{"queue_full", 2}}}),
      sample_peer(peer_id{100}, "robot", 1, 3, 7, {1, 812, 7, {}})};
  x.proxies = {{"kitchen.climate-7",
                "climate",
                "active",
                {{"humidity", "41 %"}, {"temperature", "22.3 C"}, {"voltage", "2.951 V"}},
                {}},
               {"kitchen.lamp-9",
                "lamp",
                "lost",
                {{"switch", "on"}},
                {5, 4, 0, 120ms, delays({20ms, 20ms, 30ms, 120ms}), {{"timeout", 1}}}},
               {"living-room.climate-2", "climate", "active", {{"temperature", "-3.25 C"}}, {}}};
  x.streams = {{7, "kitchen/climate-7", "robot", 600, 590, 585, 1, 14, 2, 1}};
  x.expectations = {
      {"joined within 20 s", expectation_report::verdict::met, "5 motes", instant{} + 10min}};
  x.event_log = {{instant{} + 2004160us, "kitchen/climate-7", "joined"},
                 {instant{} + 2120ms, "kitchen/lamp-9", "joined"},
                 {instant{} + 301s, "kitchen/lamp-9", "left: battery"}};
  return x;
}

run_report lab_report() {
  auto x = sample_report();
  x.islands.push_back(lab());
  return x;
}

run_report large_report() {
  run_report x;
  x.ecology = "a town";
  x.mode = "virtual";
  x.simulated = 24h;
  x.wall_s = 75;
  x.events = 1'234'567'890;
  for (std::uint32_t i = 1; i <= 50; ++i) {
    auto island = living_room();
    island.id = island_id{i};
    island.name = "house-" + std::to_string(i);
    island.motes.clear();
    for (std::uint16_t mote = 2; mote < 22; ++mote)
      island.motes.push_back(sample_mote(island.id, mote, "climate-" + std::to_string(mote),
                                         300 + 0.1 * i + 0.01 * mote));
    x.islands.push_back(island);
    x.peers.push_back(sample_peer(gateway_of(island.id), island.name + "-gateway", 1, 50, 100, {}));
    x.proxies.push_back(
        {island.name, "climate", "active", {{"temperature", "20.0 C"}}, {1, 1, 0, {}, {}, {}}});
  }
  for (std::uint16_t i = 2; i < 42; ++i)
    x.flows.push_back(sample_flow(i, default_sink, "sink"));
  for (int i = 0; i < 400; ++i)
    x.event_log.push_back({instant{} + i * 1s, "somebody", "line " + std::to_string(i)});
  x.event_log_left_out = 600;
  return x;
}

} // namespace rubicon::test
