#include <algorithm>

#include "actors/base/line_allowance.hpp"
#include "actors/kitchen.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/links.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/peis/peis_lan.hpp"
#include "actors/peis/peis_peer.hpp"
#include "peis/link/link.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/link_url.hpp"
#include "peis/wire/package.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::text;

namespace {

constexpr peer_id robot{30};
constexpr peer_id pc{11};

/// Two kernels with a component each and a link between them.
struct peis_peer_fixture {
  fixture world;
  fake<ecology_actor> ecology{world};
  fake<peis_client_actor> on_robot{world};
  fake<peis_client_actor> on_pc{world};
  peis_peer_actor robot_peer;
  peis_peer_actor pc_peer;

  explicit peis_peer_fixture(bool same_host = false) {
    robot_peer = spawn(robot, "robot", same_host);
    pc_peer = spawn(pc, "pc", same_host);
    world.send(pc_peer, link_opened{1, {robot_peer}, false});
    world.send(robot_peer, link_opened{1, {pc_peer}, true});
    world.run_for(5s);
  }

  peis_peer_actor spawn(peer_id id, const std::string& name, bool same_host) {
    peis_peer_arguments x;
    x.config.network.id = id;
    x.config.network.name = name;
    x.config.network.host_name = same_host ? "local" : name;
    x.name = name;
    x.ecology = ecology.handle();
    return world.spawn_at("peis_peer/" + name, peis_peer, std::move(x));
  }

  report::peer_report report(const peis_peer_actor& who) {
    world.send(who, status_request{});
    return ecology.all<peer_status>().back().peer;
  }
};

} // namespace

TEST_CASE("a watched tuple of another peer is told with the watch's name when it is set",
          "[actors][peis_peer][TUP-08][ACT-01]") {
  peis_peer_fixture x;
  x.world.send(x.robot_peer, watch_tuples{x.on_robot, 77, any_peer, "kitchen.*"});
  x.world.send(x.pc_peer, set_tuple{"kitchen.lamp", text("on"), true});
  CHECK(x.on_robot.size() == 0); // octets take their time
  x.world.run_for(1s);
  const auto events = x.on_robot.all<tuple_event>();
  REQUIRE(events.size() == 1);
  CHECK(events[0].watch == 77);
  CHECK(events[0].owner == pc);
  CHECK(events[0].key == "kitchen.lamp");
  CHECK(events[0].value == text("on")); // without the NUL that travels
  CHECK(!events[0].deleted);

  x.world.send(x.pc_peer, set_tuple{"kitchen.lamp", bytes{0, 1}, false});
  x.world.send(x.pc_peer, set_tuple{"bedroom.lamp", text("on"), true});
  x.world.run_for(1s);
  REQUIRE(x.on_robot.count<tuple_event>() == 2);
  CHECK(x.on_robot.all<tuple_event>()[1].value == payload(bytes{0, 1}));

  x.world.send(x.pc_peer, delete_tuple{"kitchen.lamp"});
  x.world.run_for(1s);
  REQUIRE(x.on_robot.count<tuple_event>() == 3);
  CHECK(x.on_robot.all<tuple_event>()[2].deleted);
}

TEST_CASE("what matches already is told at once, to each watcher under its own name",
          "[actors][peis_peer][TUP-08]") {
  peis_peer_fixture x;
  fake<peis_client_actor> second(x.world);
  x.world.send(x.pc_peer, set_tuple{"kitchen.lamp", text("on"), true});
  x.world.send(x.pc_peer, watch_tuples{x.on_pc, 1, pc, "kitchen.lamp"});
  x.world.send(x.pc_peer, watch_tuples{second, 9, any_peer, "kitchen.lamp"});
  REQUIRE(x.on_pc.count<tuple_event>() == 1);
  CHECK(x.on_pc.all<tuple_event>()[0].watch == 1);
  REQUIRE(second.count<tuple_event>() == 1);
  CHECK(second.all<tuple_event>()[0].watch == 9);
}

TEST_CASE("a remote set reaches the owner and its outcome the client",
          "[actors][peis_peer][TUP-05]") {
  peis_peer_fixture x;
  x.world.send(x.pc_peer, watch_tuples{x.on_pc, 1, pc, "kitchen.lamp"});
  x.world.send(x.robot_peer, set_remote_tuple{x.on_robot, 5, pc, "kitchen.lamp", text("on"), true});
  CHECK(x.on_robot.count<peis_outcome>() == 0);
  x.world.run_for(1s);
  REQUIRE(x.on_pc.count<tuple_event>() == 1);
  CHECK(x.on_pc.all<tuple_event>()[0].value == text("on"));
  REQUIRE(x.on_robot.count<peis_outcome>() == 1);
  CHECK(x.on_robot.all<peis_outcome>()[0].token == 5);
  CHECK(x.on_robot.all<peis_outcome>()[0].success);
  CHECK(x.on_robot.all<peis_outcome>()[0].cause.empty());
}

TEST_CASE("a remote set to an owner that nobody knows fails and says why",
          "[actors][peis_peer][API-02]") {
  peis_peer_fixture x;
  x.world.send(x.robot_peer,
               set_remote_tuple{x.on_robot, 6, peer_id{99}, "kitchen.lamp", text("on"), true});
  x.world.run_for(1min);
  REQUIRE(x.on_robot.count<peis_outcome>() == 1);
  CHECK(x.on_robot.all<peis_outcome>()[0].token == 6);
  CHECK(!x.on_robot.all<peis_outcome>()[0].success);
  CHECK(!x.on_robot.all<peis_outcome>()[0].cause.empty());
}

TEST_CASE("a hooked port gets its messages, another port's go to nobody",
          "[actors][peis_peer][API-04][API-09]") {
  const bool reliable = GENERATE(false, true);
  peis_peer_fixture x;
  x.world.send(x.pc_peer, hook_port{x.on_pc, 30});
  x.world.send(x.robot_peer, send_peis_message{x.on_robot, 1, pc, 30, bytes(3000, 7), reliable});
  x.world.send(x.robot_peer, send_peis_message{x.on_robot, 2, pc, 31, bytes{8}, reliable});
  x.world.run_for(1s);
  const auto messages = x.on_pc.all<peis_message>();
  REQUIRE(messages.size() == 1);
  CHECK(messages[0].source == robot);
  CHECK(messages[0].port == 30);
  CHECK(messages[0].octets == payload(bytes(3000, 7)));
  REQUIRE(x.on_robot.count<peis_outcome>() == 2);
  for (const auto& outcome : x.on_robot.all<peis_outcome>())
    CHECK(outcome.success);
}

TEST_CASE("a port that users may not have is refused", "[actors][peis_peer][API-09]") {
  peis_peer_fixture x;
  x.world.send(x.pc_peer, hook_port{x.on_pc, 19});
  CHECK(x.world.logged("hook_refused port=19") == 1);
}

TEST_CASE("a port has one owner, and is free again when that component has ended",
          "[actors][peis_peer]") {
  peis_peer_fixture x;
  x.world.send(x.pc_peer, hook_port{x.on_pc, 30});
  x.world.send(x.pc_peer, hook_port{x.on_robot, 30});
  CHECK(x.world.logged("hook_refused port=30") == 1);
  post_exit(x.on_pc.handle(), caf::exit_reason::kill);
  x.world.run_for(1ms);
  x.world.send(x.pc_peer, hook_port{x.on_robot, 30});
  CHECK(x.world.logged("hook_refused port=30") == 1);
}

TEST_CASE("a component that has ended is told nothing more and leaves no subscription",
          "[actors][peis_peer][TUP-09]") {
  peis_peer_fixture x;
  x.world.send(x.robot_peer, watch_tuples{x.on_robot, 1, pc, "kitchen.lamp"});
  x.world.send(x.pc_peer, set_tuple{"kitchen.lamp", text("on"), true});
  x.world.run_for(1s);
  CHECK(x.on_robot.count<tuple_event>() == 1);
  post_exit(x.on_robot.handle(), caf::exit_reason::kill);
  x.world.run_for(1s);
  const auto before = x.report(x.pc_peer).peis.packages;
  for (int i = 0; i < 100; ++i)
    x.world.send(x.pc_peer, set_tuple{"kitchen.lamp", text("off"), true});
  x.world.run_for(1s);
  CHECK(x.report(x.pc_peer).peis.packages < before + 10); // nothing is pushed
}

TEST_CASE("a component hears what the kernel's clock is, and of each change",
          "[actors][peis_peer][CLK-08]") {
  peis_peer_fixture x;
  fake<clock_watcher_actor> watcher(x.world);
  x.world.send(x.pc_peer, watch_clock{watcher});
  const auto offset = [&] { return watcher.all<clock_changed>().back().offset; };
  REQUIRE(watcher.count<clock_changed>() == 1);
  const auto before = offset();
  x.world.send(x.pc_peer, set_tuple{"kitchen.lamp", text("on"), true});
  CHECK(watcher.count<clock_changed>() == 1);
  x.world.send(x.pc_peer, step_clock{3s});
  CHECK(offset() == before + 3s);
  x.world.send(x.robot_peer, step_clock{5s}); // whom the other follows
  x.world.run_for(10s);
  CHECK(std::chrono::abs(offset() - before - 5s) < 1ms);
}

TEST_CASE("a peer reports its links, hosts and tuples", "[actors][peis_peer]") {
  peis_peer_fixture x;
  x.world.send(x.robot_peer, set_tuple{"a", text("1"), true});
  const auto report = x.report(x.robot_peer);
  CHECK(report.id == robot);
  CHECK(report.name == "robot");
  CHECK(report.links == 1);
  CHECK(report.hosts_known == 2);
  CHECK(report.peis.packages > 0);
  CHECK(report.tuples == x.report(x.pc_peer).tuples + 1);
}

TEST_CASE("a closed link takes the other peer and its tuples away", "[actors][peis_peer]") {
  peis_peer_fixture x;
  x.world.send(x.robot_peer, watch_tuples{x.on_robot, 1, any_peer, "kitchen.lamp"});
  x.world.send(x.pc_peer, set_tuple{"kitchen.lamp", text("on"), true});
  x.world.run_for(1s);
  x.world.send(x.robot_peer, link_closed{1});
  CHECK(x.report(x.robot_peer).links == 0);
  x.world.run_for(10min);
  CHECK(x.report(x.robot_peer).hosts_known == 1);
  REQUIRE(x.on_robot.count<tuple_event>() == 2);
  CHECK(x.on_robot.all<tuple_event>()[1].deleted);
}

TEST_CASE("of claims to its id a peer tells a few, however many there are",
          "[actors][peis_peer][RTE-08]") {
  peis_peer_fixture x;
  const fake<link_end_actor> impostor(x.world);
  x.world.send(x.robot_peer, link_opened{7, impostor, false});
  auto octets =
      peis::encode(peis::connect_request{peis::protocol_version, peer_id{99}, 0, "default"});
  for (std::int32_t i = 1; i <= 100; ++i) {
    peis::host_record_message claim;
    claim.record.id = robot;
    claim.record.magic = i;
    claim.record.full_name = "impostor@" + std::to_string(i) + "!1";
    const auto data = peis::encode(claim);
    peis::package_header header;
    header.id = header.ack_id = i;
    header.counter = static_cast<std::uint32_t>(i);
    header.type = peis::package_type::link;
    header.source = robot;
    header.port = peis::port::host_record;
    header.length = static_cast<std::uint16_t>(data.size());
    peis::encode(header, octets);
    octets.insert(octets.end(), data.begin(), data.end());
  }
  x.world.send(x.robot_peer, link_octets{7, std::move(octets)});
  x.world.run_for(1s);
  const auto told = [&] {
    const auto all = x.ecology.all<notable_event>();
    return std::ranges::count_if(
        all, [](const auto& y) { return y.what.starts_with("its id is used by impostor"); });
  };
  CHECK(told() == line_allowance::lines_max);
}

TEST_CASE("a peer that is asked to quit says so and ends", "[actors][peis_peer][TUP-22][KH-04]") {
  peis_peer_fixture x(true);
  x.world.send(x.robot_peer,
               set_remote_tuple{x.on_robot, 1, pc, "kernel.do-quit", text("yes"), true});
  x.world.run_for(2s);
  REQUIRE(x.world.ends().size() == 1);
  CHECK(x.world.ends()[0].path == "peis_peer/pc");
  const auto report = x.report(x.robot_peer);
  CHECK(report.links == 0);
  CHECK(report.hosts_known == 1);
}

namespace {

/// A robot that keeps a link to a PC over a simulated network, and a component on each.
struct network_fixture {
  fixture world;
  fake<ecology_actor> ecology{world};
  fake<peis_client_actor> on_robot{world};
  fake<peis_client_actor> on_pc{world};
  peis_lan_actor lan;
  peis_peer_actor robot_peer;
  peis_peer_actor pc_peer;
  config::peis_description network;
  std::uint64_t stations = 0;

  explicit network_fixture(config::peis_description with = {}) : network(with) {
    lan = world.spawn_at("peis_lan", peis_lan, network, std::uint64_t{1});
    pc_peer = spawn(pc, "pc", {});
    robot_peer = spawn(robot, "robot", {"inproc://" + to_string(pc)});
    world.run_for(5s);
    world.send(robot_peer, watch_tuples{on_robot, 1, pc, "kitchen.lamp"});
    world.run_for(1s);
  }

  peis_peer_actor spawn(peer_id id, const std::string& name, std::vector<std::string> always) {
    peis_peer_arguments x;
    x.config.network.id = id;
    x.config.network.name = name;
    x.config.network.host_name = name;
    x.config.network.addresses = {peis::inproc_address(1, id)};
    x.config.network.connections.always = std::move(always);
    x.config.network.connections.announces = false;
    x.config.network.link_window = network.bandwidth_bps > 0 ? 8192 : 0;
    x.name = name;
    x.incarnation = lives[id]++; // of one that is started again another magic number follows
    x.station = ++stations;
    x.network = network;
    x.discovery = false;
    x.lan = lan;
    x.ecology = ecology.handle();
    return world.spawn_at("peis_peer/" + name, peis_peer, std::move(x));
  }

  std::map<peer_id, std::uint32_t> lives;

  void set_lamp(std::string_view to) {
    world.send(pc_peer, set_tuple{"kitchen.lamp", text(to), true});
  }

  [[nodiscard]] std::size_t seen() const { return on_robot.count<tuple_event>(); }

  report::peer_report report(const peis_peer_actor& who) {
    world.send(who, status_request{});
    return ecology.all<peer_status>().back().peer;
  }
};

} // namespace

TEST_CASE("a peer gets the link that it is to keep", "[actors][peis_peer][AUT-01]") {
  network_fixture x;
  CHECK(x.report(x.robot_peer).links == 1);
  CHECK(x.report(x.pc_peer).links == 1);
  CHECK(x.report(x.robot_peer).cluster == pc.value);
  x.set_lamp("on");
  CHECK(x.seen() == 0);
  x.world.run_for(1ms);
  CHECK(x.seen() == 1);
}

TEST_CASE("a cut link carries nothing, and what it missed is repeated",
          "[actors][peis_peer][ACT-04]") {
  network_fixture x;
  x.world.send(x.lan, begin_lan_fault{1, {{pc}}, 0, {}});
  x.set_lamp("on");
  x.world.run_for(2s);
  CHECK(x.seen() == 0);
  x.world.send(x.lan, end_lan_fault{1});
  x.world.run_for(30s);
  CHECK(x.seen() >= 1);
}

TEST_CASE("a lossy link loses packages and repeats what must arrive",
          "[actors][peis_peer][ACT-04][ACK-03]") {
  config::peis_description network;
  network.loss = 0.3;
  network_fixture x(network);
  for (int i = 0; i < 50; ++i) {
    x.set_lamp(i % 2 == 0 ? "on" : "off");
    x.world.run_for(1s);
  }
  CHECK(x.report(x.pc_peer).peis.lost.at("network") > 5);
  CHECK(x.report(x.robot_peer).peis.lost.at("illegal") == 0);
  CHECK(x.report(x.robot_peer).links_opened <= 3); // the stream stays in step
  CHECK(x.seen() > 30);
}

TEST_CASE("a slow link takes its time", "[actors][peis_peer]") {
  config::peis_description network;
  network.bandwidth_bps = 80'000; // 10 octets a millisecond
  network_fixture x(network);
  x.world.send(x.pc_peer, hook_port{x.on_pc, 30});
  x.world.send(x.robot_peer, send_peis_message{x.on_robot, 1, pc, 30, bytes(30'000, 7), true});
  x.world.run_for(2900ms);
  CHECK(x.on_pc.count<peis_message>() == 0);
  x.world.run_for(10s);
  CHECK(x.on_pc.count<peis_message>() == 1);
}

TEST_CASE("a kernel that stands still serves afterwards what has waited",
          "[actors][peis_peer][ACT-04]") {
  network_fixture x;
  x.world.send(x.robot_peer, pause_peer{2s});
  x.set_lamp("on");
  x.world.run_for(1999ms);
  CHECK(x.seen() == 0);
  x.world.run_for(1ms);
  CHECK(x.seen() == 1);
  CHECK(x.report(x.robot_peer).links == 1);
}

TEST_CASE("a peer whose neighbour's process ends loses its link and gets it back",
          "[actors][peis_peer][AUT-01][KH-04]") {
  network_fixture x;
  post_exit(x.pc_peer, caf::exit_reason::user_shutdown);
  x.world.run_for(1ms);
  CHECK(x.report(x.robot_peer).links == 0);
  CHECK(x.report(x.robot_peer).links_closed.at("far_end") == 1);
  x.world.run_for(10s);
  CHECK(x.report(x.robot_peer).attempts_failed >= 1);
  x.pc_peer = x.spawn(pc, "pc", {});
  x.set_lamp("on");
  x.world.run_for(40s);
  CHECK(x.report(x.robot_peer).links == 1);
  CHECK(x.seen() == 1);
}

TEST_CASE("a peer that leaves is forgotten by the others at once", "[actors][peis_peer][KH-04]") {
  network_fixture x;
  CHECK(x.report(x.robot_peer).hosts_known == 2);
  x.world.send(x.pc_peer, leave_network{});
  x.world.run_for(1ms);
  CHECK(x.report(x.robot_peer).hosts_known == 1);
  CHECK(x.report(x.robot_peer).links == 0);
}

TEST_CASE("a component follows its meta tuple, which another peer points elsewhere",
          "[actors][peis_peer][META-02][META-04][META-05]") {
  peis_peer_fixture x;
  const auto values = [&x](std::size_t from) {
    std::vector<std::string> all;
    const auto events = x.on_robot.all<tuple_event>();
    for (std::size_t i = from; i < events.size(); ++i)
      all.push_back(events[i].key + '=' + to_string(events[i].value.view()));
    return all;
  };
  using words = std::vector<std::string>;
  const auto set = [&x](const peis_peer_actor& who, const char* key, const char* value) {
    x.world.send(who, set_tuple{key, text(value), true});
    x.world.run_for(1s);
  };
  set(x.robot_peer, "robot.in", "own");
  set(x.pc_peer, "pc.out", "first");
  x.world.send(x.robot_peer, declare_meta_tuple{"robot.mi-in", "(META 30 robot.in)"});
  x.world.send(x.robot_peer, watch_indirectly{x.on_robot, 4, robot, "robot.mi-in"});
  CHECK(values(0) == words{"robot.in=own"});
  CHECK(x.on_robot.all<tuple_event>()[0].watch == 4);

  x.world.send(x.pc_peer, set_meta_tuple{x.on_pc, 9, robot, "robot.mi-in", "(META 11 pc.out)"});
  x.world.run_for(1s);
  REQUIRE(x.on_pc.count<peis_outcome>() == 1);
  CHECK(x.on_pc.all<peis_outcome>()[0].token == 9);
  CHECK(x.on_pc.all<peis_outcome>()[0].success);
  CHECK(values(1) == words{"pc.out=first"});
  set(x.robot_peer, "robot.in", "unheard");
  set(x.pc_peer, "pc.out", "second");
  CHECK(values(2) == words{"pc.out=second"});

  // Declared again, as by a component that has started anew, it stays where it points.
  x.world.send(x.robot_peer, declare_meta_tuple{"robot.mi-in", "(META 30 robot.in)"});
  set(x.robot_peer, "robot.in", "unheard");
  CHECK(values(3).empty());
  x.world.send(x.pc_peer, set_meta_tuple{x.on_pc, 10, robot, "robot.mi-in", "(META -1 NULL)"});
  x.world.run_for(1s);
  set(x.pc_peer, "pc.out", "unheard");
  CHECK(values(3).empty());
}
