#include "actors/messages/common.hpp"
#include "actors/messages/links.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/peis/peis_bluetooth.hpp"
#include "actors/peis/peis_peer.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;

namespace {

constexpr peis::bluetooth_address phone{{0, 0x1b, 0x44, 0x11, 0x3a, 0xb7}};
constexpr std::uint16_t port_a = 0x1001;
constexpr std::uint16_t port_b = 0x1003;

const auto desk = peis::address_of_adapter("desk", "hci0");
const auto robot_adapter = peis::address_of_adapter("robot", "hci0");

std::vector<std::pair<peis::bluetooth_address, int>> devices(const bluetooth_seen& x) {
  std::vector<std::pair<peis::bluetooth_address, int>> found;
  for (const auto& each : x.devices)
    found.emplace_back(each.address, each.strength_dbm);
  return found;
}

using strengths = std::vector<std::pair<peis::bluetooth_address, int>>;

/// Two peers (stations 1 and 2) that share the desk's adapter, a robot (3) 5 m away, a phone.
struct peis_bluetooth_fixture {
  fixture world;
  fake<bluetooth_user_actor> a{world};
  fake<bluetooth_user_actor> b{world};
  fake<bluetooth_user_actor> c{world};
  peis_bluetooth_actor medium;

  explicit peis_bluetooth_fixture(bool takeover = false) {
    config::peis_description network;
    network.bluetooth.takeover = takeover;
    medium = world.spawn_at("peis_bluetooth", peis_bluetooth, network,
                            std::vector<config::bluetooth_device>{{"phone", phone, {-10, 0, 0}}});
    world.send(medium, join_bluetooth{1, "desk", {"hci0"}, {}, port_a, a});
    world.send(medium, join_bluetooth{2, "desk", {"hci0"}, {}, port_b, b});
    world.send(medium, join_bluetooth{3, "robot", {"hci0"}, {5, 0, 0}, port_a, c});
  }

  void move_robot(position to) { world.send(medium, move_machine{"robot", to}); }

  bluetooth_seen scan(std::uint64_t station, const fake<bluetooth_user_actor>& who) {
    world.send(medium, scan_bluetooth{station, "hci0"});
    world.run_for(1ms);
    return who.all<bluetooth_seen>().back();
  }

  void hello(const peis::bluetooth_address& to) {
    world.send(medium, send_hello{3, {"hci0", to, bytes{7}}});
    world.run_for(1ms);
  }

  /// From the robot to the second peer of the desk.
  void connect(std::uint16_t port = port_b) {
    world.send(medium, bluetooth_connect{3, 9, desk, port});
    world.run_for(1ms);
  }

  void end(const fake<bluetooth_user_actor>& who) {
    post_exit(who.handle(), caf::exit_reason::user_shutdown);
    world.run_for(1ms);
  }
};

} // namespace

TEST_CASE("a scan shows who is in range, peers or not, and how strongly",
          "[actors][peis_bluetooth][BT-02][BT-04][ACT-01]") {
  peis_bluetooth_fixture x;
  CHECK(devices(x.scan(1, x.a)) == strengths{{phone, -70}, {robot_adapter, -61}});
  CHECK(devices(x.scan(3, x.c)) == strengths{{desk, -61}}); // the phone is 15 m away
  x.move_robot({1, 0, 0});
  CHECK(devices(x.scan(1, x.a)) == strengths{{phone, -70}, {robot_adapter, -40}});
  x.move_robot({10.1, 0, 0});
  CHECK(devices(x.scan(1, x.a)) == strengths{{phone, -70}});
  x.world.send(x.medium, scan_bluetooth{1, "hci1"}); // not one of its own
  x.world.run_for(1ms);
  CHECK(x.a.count<bluetooth_seen>() == 3);
}

TEST_CASE("a HELLO comes to all who share an adapter, and to nobody behind other devices",
          "[actors][peis_bluetooth][BT-05]") {
  peis_bluetooth_fixture x;
  x.hello(desk);
  REQUIRE(x.a.count<hello_arrived>() == 1);
  REQUIRE(x.b.count<hello_arrived>() == 1);
  CHECK(x.a.all<hello_arrived>()[0].question.octets == payload(bytes{7}));
  CHECK(x.a.all<hello_arrived>()[0].question.device == desk);
  CHECK(x.c.count<hello_answer>() == 0); // theirs to give
  x.move_robot({-5, 0, 0});
  x.hello(phone);
  REQUIRE(x.c.count<hello_answer>() == 1);
  CHECK(x.c.all<hello_answer>()[0].device == phone);
  CHECK(x.c.all<hello_answer>()[0].octets.empty());
  x.move_robot({50, 0, 0});
  x.hello(desk);
  CHECK(x.c.count<hello_answer>() == 2);
  CHECK(x.a.count<hello_arrived>() == 1);
}

TEST_CASE("only the first to open an adapter announces, and the right ends with it",
          "[actors][peis_bluetooth][BT-03]") {
  peis_bluetooth_fixture second_ends;
  second_ends.end(second_ends.b);
  second_ends.hello(desk);
  CHECK(second_ends.a.count<hello_arrived>() == 1);

  peis_bluetooth_fixture first_ends;
  first_ends.end(first_ends.a);
  first_ends.hello(desk);
  CHECK(first_ends.b.count<hello_arrived>() == 0);
  CHECK(first_ends.c.all<hello_answer>().at(0).octets.empty());
  first_ends.connect();
  CHECK(first_ends.c.count<attempt_failed>() == 1);
  fake<bluetooth_user_actor> later(first_ends.world);
  first_ends.world.send(first_ends.medium, join_bluetooth{4, "desk", {"hci0"}, {}, port_a, later});
  first_ends.hello(desk); // who opens it now is the first again
  CHECK(later.count<hello_arrived>() == 1);
  CHECK(first_ends.b.count<hello_arrived>() == 1);

  peis_bluetooth_fixture with_takeover(true);
  with_takeover.end(with_takeover.a);
  with_takeover.hello(desk);
  CHECK(with_takeover.b.count<hello_arrived>() == 1);
}

TEST_CASE("a link opens within range, to the peer of that port, and is slow",
          "[actors][peis_bluetooth][BT-02]") {
  peis_bluetooth_fixture x;
  x.connect();
  REQUIRE(x.c.count<bluetooth_opened>() == 1);
  REQUIRE(x.b.count<bluetooth_opened>() == 1);
  CHECK(x.a.count<bluetooth_opened>() == 0);
  const auto at_c = x.c.all<bluetooth_opened>()[0];
  const auto at_b = x.b.all<bluetooth_opened>()[0];
  CHECK(at_c.link.link == at_b.link.link);
  CHECK(at_c.link.initiator);
  CHECK(at_c.link.attempt == 9);
  CHECK(!at_b.link.initiator);
  CHECK(at_c.rate_bps == 16000); // 2 kB/s
  CHECK(at_b.rate_bps == 16000);
  x.connect(0x1005); // nobody's
  CHECK(x.c.count<attempt_failed>() == 1);
  x.move_robot({11, 0, 0});
  x.connect();
  CHECK(x.c.count<attempt_failed>() == 2);
}

TEST_CASE("a link is dropped when its ends are moved apart, end, or lose their power",
          "[actors][peis_bluetooth][BT-02]") {
  peis_bluetooth_fixture apart;
  apart.connect();
  apart.move_robot({9, 0, 0});
  apart.world.run_for(1ms);
  CHECK(apart.c.count<link_closed>() == 0);
  apart.move_robot({11, 0, 0});
  apart.world.run_for(1ms);
  REQUIRE(apart.c.count<link_closed>() == 1);
  CHECK(apart.b.count<link_closed>() == 1);
  CHECK(apart.c.all<link_closed>()[0].link == apart.c.all<bluetooth_opened>()[0].link.link);

  peis_bluetooth_fixture ended;
  ended.connect();
  ended.end(ended.c);
  CHECK(ended.b.count<link_closed>() == 1);

  peis_bluetooth_fixture dark;
  dark.connect();
  dark.world.send(dark.medium, set_lan_power{3, false});
  dark.world.run_for(1ms);
  CHECK(dark.b.count<link_closed>() == 1);
  CHECK(devices(dark.scan(1, dark.a)) == strengths{{phone, -70}});
  dark.world.send(dark.medium, set_lan_power{3, true});
  CHECK(dark.scan(1, dark.a).devices.size() == 2);

  peis_bluetooth_fixture closed;
  closed.connect();
  const auto link = closed.c.all<bluetooth_opened>()[0].link.link;
  closed.world.send(closed.medium, lan_link_ended{link}); // by one end, which tells the other
  closed.move_robot({11, 0, 0});
  closed.world.run_for(1ms);
  CHECK(closed.c.count<link_closed>() == 0);
}

namespace {

/// Two kernels with nothing but Bluetooth, 5 m apart, and a component that watches at the first.
struct kernels {
  fixture world;
  fake<ecology_actor> ecology{world};
  fake<peis_client_actor> watcher{world};
  fake<peis_client_actor> listener{world};
  peis_bluetooth_actor medium;
  peis_peer_actor at_desk;
  peis_peer_actor at_robot;

  kernels() {
    medium = world.spawn_at("peis_bluetooth", peis_bluetooth, config::peis_description(),
                            std::vector<config::bluetooth_device>{{"phone", phone, {1, 0, 0}}});
    at_desk = spawn(1, "desk", {});
    at_robot = spawn(30, "robot", {5, 0, 0});
    world.send(at_desk, watch_tuples{watcher, 1, peer_id{1}, "kernel.hci0.*.str"});
    world.send(at_desk, watch_tuples{watcher, 2, peer_id{1}, "kernel.hci0.*.peis"});
    world.send(at_robot, hook_port{listener, 30});
  }

  peis_peer_actor spawn(std::int32_t id, const std::string& name, position place) {
    peis_peer_arguments x;
    auto& network = x.config.network;
    network.id = peer_id{id};
    network.name = network.host_name = x.name = name;
    network.link_window = 512;
    network.reliable.retry_time = 1100ms;
    network.connections.announces = false;
    network.bluetooth.adapters = {"hci0"};
    network.addresses = {
        peis::bluetooth_interface("hci0", peis::address_of_adapter(name, "hci0"), port_a)};
    x.station = static_cast<std::uint64_t>(id);
    x.bluetooth = medium;
    x.adapters = {x.station, name, {"hci0"}, place, port_a, {}};
    x.ecology = ecology.handle();
    return world.spawn_at("peis_peer/" + name, peis_peer, std::move(x));
  }

  /// The newest value of a tuple `kernel.hci0.ADDRESS.WHAT`; empty if there is none.
  std::string newest(const peis::bluetooth_address& device, const std::string& what) {
    auto address = to_string(device);
    std::replace(address.begin(), address.end(), ':', '-');
    std::string value;
    for (const auto& x : watcher.all<tuple_event>()) {
      if (x.key == "kernel.hci0." + address + '.' + what)
        value = x.deleted ? std::string() : to_string(x.value.view());
    }
    return value;
  }

  peer_status status(const peis_peer_actor& who) {
    world.send(who, status_request{});
    return ecology.all<peer_status>().back();
  }
};

} // namespace

TEST_CASE("tuples tell the strength of every device near, and follow its distance",
          "[actors][peis_bluetooth][BT-04]") {
  kernels x;
  x.world.run_for(20s);
  CHECK(x.newest(robot_adapter, "str") == "-61");
  CHECK(x.newest(phone, "str") == "-40");
  x.world.send(x.medium, move_machine{"robot", {10, 0, 0}});
  x.world.run_for(10s);
  CHECK(x.newest(robot_adapter, "str") == "-70");
  x.world.send(x.medium, move_machine{"robot", {20, 0, 0}});
  x.world.run_for(10s);
  CHECK(x.newest(robot_adapter, "str").empty());
  CHECK(x.newest(phone, "str") == "-40");
}

TEST_CASE("one failed HELLO marks a device as no peer, and a peer becomes a known host",
          "[actors][peis_bluetooth][BT-05]") {
  kernels x;
  x.world.run_for(2s); // one scan
  CHECK(x.newest(phone, "peis") == "no");
  CHECK(x.newest(robot_adapter, "peis") == "yes");
  x.world.run_for(20s);
  CHECK(x.status(x.at_desk).hosts == std::vector{peer_id{1}, peer_id{30}});
  CHECK(x.status(x.at_robot).neighbours == std::vector{peer_id{1}});
}

TEST_CASE("octets take as long over Bluetooth as 2 kB/s allow", "[actors][peis_bluetooth][BT-02]") {
  kernels x;
  x.world.run_for(30s);
  const auto sent = x.world.now();
  x.world.send(x.at_desk, send_peis_message{x.watcher, 1, peer_id{30}, 30, bytes(10000), true});
  x.world.run_for(30s);
  const auto times = x.listener.times<peis_message>();
  REQUIRE(times.size() == 1);
  CHECK(times[0] - sent >= 5s);
  CHECK(times[0] - sent < 6500ms);
}
