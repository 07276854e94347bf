// The simulated network and Bluetooth, and the ends of their links.
#include <set>

#include "peis/link/link.hpp"
#include "peis/media/simulated_bluetooth.hpp"
#include "peis/media/simulated_lan.hpp"
#include "peis/media/simulated_link.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/package.hpp"
#include "support/catch.hpp"
#include "unit/peis/overlay/numbered_package.hpp"

namespace rubicon::peis {
namespace {

using test::numbered_package;

constexpr peer_id first{11};
constexpr peer_id second{12};
constexpr peer_id third{13};
constexpr station_id a{1};
constexpr station_id b{2};
constexpr station_id c{3};

template <class T, class Outputs>
std::vector<T> all(const Outputs& outputs) {
  std::vector<T> found;
  for (const auto& x : outputs)
    found.push_back(std::get<T>(x)); // throws if there is another
  return found;
}

template <class T, class Outputs>
T one(const Outputs& outputs) {
  REQUIRE(outputs.size() == 1);
  return std::get<T>(outputs[0]);
}

/// A network with three peers.
simulated_lan network(double loss = 0) {
  simulated_lan x(loss, random_stream(1, "lan"));
  x.join(a, first, true);
  x.join(b, second, true);
  x.join(c, third, true);
  return x;
}

/// A link from the first to the second.
link_made connect(simulated_lan& x) {
  return all<link_made>(x.connect(a, attempt_id{5}, second)).at(1);
}

} // namespace

TEST_CASE("octets leave at the rate of a link, one after another, and arrive a delay later",
          "[peis]") {
  simulated_link x(link_role::acceptor, {}, 1ms, 8000); // an octet a millisecond
  random_stream rng;
  const instant start{1s};
  for (const auto end : {start + 3ms, start + 6ms}) {
    const auto sent = x.send(bytes{1, 2, 3}, start, rng);
    REQUIRE(sent.size() == 2);
    CHECK(std::get<octets_leave>(sent[0]).at == end);
    CHECK(std::get<octets_leave>(sent[0]).octets == 3);
    CHECK(std::get<octets_arrive>(sent[1]).at == end + 1ms);
    CHECK(std::get<octets_arrive>(sent[1]).octets == payload(bytes{1, 2, 3}));
  }
  CHECK(x.close(start) == start + 7ms);
  CHECK(x.close(start + 9ms) == start + 10ms);
  const auto later = x.send(bytes{1}, start + 20ms, rng);
  CHECK(std::get<octets_leave>(later[0]).at == start + 21ms);
}

TEST_CASE("a cut link tells what it swallows, and nothing passes it, not even its end", "[peis]") {
  simulated_link x(link_role::acceptor, {}, 1ms, 0);
  random_stream rng;
  x.set_condition({true, 0});
  const auto sent = x.send(bytes{1, 2}, instant(1s), rng);
  REQUIRE(sent.size() == 2);
  CHECK(std::get<octets_leave>(sent[0]).at == instant(1s)); // as if they had
  CHECK(std::get<octets_cut>(sent[1]).octets == payload(bytes{1, 2}));
  CHECK(!x.close(instant(1s)));
  x.set_condition({});
  CHECK(x.close(instant(1s)) == instant(1s) + 1ms);
}

TEST_CASE("a lossy link loses whole packages, and never an initiator's request", "[peis]") {
  const auto role = GENERATE(link_role::initiator, link_role::acceptor);
  simulated_link x(role, {false, 1}, 1ms, 0);
  random_stream rng;
  auto octets = role == link_role::initiator ? encode(connect_request{}) : bytes{};
  const auto request = octets;
  const auto lost = numbered_package(1, 7);
  octets.insert(octets.end(), lost.begin(), lost.end());
  const auto sent = x.send(octets, instant(1s), rng);
  REQUIRE(sent.size() == (request.empty() ? 2 : 3));
  CHECK(std::get<packages_lost>(sent[1]).count == 1);
  CHECK(std::get<packages_lost>(sent[1]).octets == lost);
  if (!request.empty())
    CHECK(std::get<octets_arrive>(sent[2]).octets == payload(request));
  CHECK(x.send(lost, instant(1s), rng).size() == 2); // only its first octets have a request
}

TEST_CASE("a LAN opens a link to whoever has the id, and the acceptor hears of it first",
          "[peis]") {
  auto x = network();
  x.join(station_id{4}, second, true); // a second process with that id: the older one is meant
  const auto made = all<link_made>(x.connect(a, attempt_id{5}, second));
  REQUIRE(made.size() == 2);
  CHECK(made[0].station == b);
  CHECK(made[0].other == a);
  CHECK(made[0].role == link_role::acceptor);
  CHECK(made[0].attempt == attempt_id{0});
  CHECK(made[1].station == a);
  CHECK(made[1].other == b);
  CHECK(made[1].role == link_role::initiator);
  CHECK(made[1].attempt == attempt_id{5});
  CHECK(made[0].link == made[1].link);
  CHECK(made[1].condition == link_condition{});
  CHECK(connect(x).link != made[0].link);
  const auto refused = one<link_refused>(x.connect(a, attempt_id{6}, first)); // itself
  CHECK(refused.station == a);
  CHECK(refused.attempt == attempt_id{6});
  CHECK(x.connect(station_id{9}, attempt_id{7}, first).empty()); // nobody asks
}

TEST_CASE("announcements on a LAN come to the others that hear", "[peis]") {
  auto x = network();
  x.join(station_id{4}, peer_id{14}, false);
  const auto heard = all<announcement_heard>(x.announce(b, bytes{7}, instant()));
  REQUIRE(heard.size() == 2);
  CHECK(heard[0].station == a);
  CHECK(heard[1].station == c);
  CHECK(heard[1].octets == payload(bytes{7}));
  static_cast<void>(x.end(c));
  CHECK(x.announce(b, bytes{7}, instant()).size() == 1);
  CHECK(x.announce(station_id{9}, bytes{7}, instant()).empty());
}

TEST_CASE("in a large LAN an announcement that has not changed comes to a station once in 30 s",
          "[peis][NFR-06]") {
  simulated_lan x(0, random_stream(1, "lan"));
  for (int i = 1; i <= 60; ++i)
    x.join(station_id{static_cast<std::uint64_t>(i)}, peer_id{i}, true);
  host_record record;
  record.id = peer_id{1};
  record.host_name = "first";
  const payload octets(encode(announcement{500, "default", record}));
  const instant start(1s);
  CHECK(x.announce(a, octets, start).size() == 59);
  CHECK(x.announce(a, octets, start + 1s).empty());
  SECTION("again when that is over") {
    CHECK(x.announce(a, octets, start + 29s).empty());
    CHECK(x.announce(a, octets, start + 30s).size() == 59);
  }
  SECTION("what has changed at once") {
    record.cluster = 7;
    CHECK(x.announce(a, payload(encode(announcement{500, "default", record})), start + 2s).size() ==
          59);
  }
  SECTION("to one that has come at once") {
    x.join(station_id{61}, peer_id{61}, true);
    CHECK(one<announcement_heard>(x.announce(a, octets, start + 2s)).station == station_id{61});
  }
  SECTION("to one that has come again at once") {
    static_cast<void>(x.end(b));
    x.join(b, peer_id{2}, true);
    CHECK(one<announcement_heard>(x.announce(a, octets, start + 2s)).station == b);
  }
  SECTION("to all after a fault, in which they may have lost each other") {
    static_cast<void>(x.begin_fault(1, {{{second}}, 0, {}}));
    static_cast<void>(x.end_fault(1));
    CHECK(x.announce(a, octets, start + 2s).size() == 59);
  }
  SECTION("to others of its computer each time: they count them") {
    record.id = peer_id{2};
    CHECK(x.announce(b, payload(encode(announcement{500, "default", record})), start).size() == 59);
    CHECK(one<announcement_heard>(x.announce(a, octets, start + 2s)).station == b);
  }
}

TEST_CASE("announcements on a LAN are lost as often as packages, and to whom a partition cuts off",
          "[peis][ACT-04]") {
  auto x = network(0.25);
  static_cast<void>(x.begin_fault(1, {{{third}}, 0, {}})); // within the rest all goes on
  std::size_t heard = 0;
  for (int i = 0; i < 1000; ++i) {
    for (const auto& each : all<announcement_heard>(x.announce(a, bytes{1}, instant())))
      heard += each.station == b ? 1 : 1000;
  }
  CHECK(heard > 700);
  CHECK(heard < 800);
}

TEST_CASE("faults of a LAN change the condition of open links, each as it is now",
          "[peis][ACT-04]") {
  auto x = network(0.5);
  const auto link = connect(x).link;
  const auto lossy = all<condition_set>(x.begin_fault(1, {{}, 0.5, {first, second}}));
  REQUIRE(lossy.size() == 2);
  CHECK(lossy[0].station == a);
  CHECK(lossy[1].station == b);
  CHECK(lossy[0].link == link);
  CHECK(lossy[0].condition == link_condition{false, 0.75});
  CHECK(x.begin_fault(2, {{}, 0.5, {first, third}}).empty()); // not between these
  const auto cut = all<condition_set>(x.begin_fault(3, {{{first}}, 0, {}}));
  REQUIRE(cut.size() == 2);
  CHECK(cut[0].condition == link_condition{true, 0.75});
  CHECK(x.begin_fault(4, {{{}, {second}}, 0, {}}).empty()); // it is cut already
  CHECK(x.connect(a, attempt_id{5}, second).empty());
  CHECK(x.connect(a, attempt_id{5}, peer_id{99}).empty()); // nobody can say that there is none
  CHECK(x.end_fault(3).empty());
  CHECK(!all<condition_set>(x.end_fault(4)).at(0).condition.cut);
}

TEST_CASE("links of a process that has ended are reset, once its computer can say so",
          "[peis][ACT-04]") {
  auto x = network();
  const auto link = connect(x).link;
  static_cast<void>(x.set_power(b, false));
  CHECK(x.end(b).empty());
  const auto reset = one<link_reset>(x.set_power(b, true));
  CHECK(reset.station == a);
  CHECK(reset.link == link);
  CHECK(x.set_power(b, false).empty()); // it is forgotten
  x.join(b, second, true);
  x.end_link(connect(x).link); // both ends know
  CHECK(x.end(b).empty());
}

namespace {

constexpr bluetooth_address phone_adapter{{0, 0x1b, 0x44, 0x11, 0x3a, 0xb7}};
const auto desk = address_of_adapter("desk", "hci0");
const auto robot_adapter = address_of_adapter("robot", "hci0");

/// Two peers that share the desk's adapter, a robot 5 m away, a phone.
simulated_bluetooth room(bool takeover = false) {
  simulated_bluetooth x({10, 40, 3, takeover});
  x.add_device(phone_adapter, {-10, 0, 0});
  x.join(a, "desk", {"hci0"}, {}, 1);
  x.join(b, "desk", {"hci0"}, {}, 3);
  x.join(c, "robot", {"hci0"}, {5, 0, 0}, 1);
  return x;
}

std::vector<std::pair<bluetooth_address, int>> seen(const simulated_bluetooth& x,
                                                    station_id station) {
  std::vector<std::pair<bluetooth_address, int>> found;
  for (const auto& each : one<devices_seen>(x.scan(station, "hci0")).devices)
    found.emplace_back(each.address, each.strength_dbm);
  return found;
}

using strengths = std::vector<std::pair<bluetooth_address, int>>;

} // namespace

TEST_CASE("an adapter sees what is in range and on, more weakly the farther it is", "[peis]") {
  auto x = room();
  CHECK(seen(x, a) == strengths{{phone_adapter, -70}, {robot_adapter, -61}});
  CHECK(seen(x, c) == strengths{{desk, -61}}); // the phone is 15 m away
  CHECK(x.move("robot", {0.5, 0, 0}).empty());
  CHECK(seen(x, a) == strengths{{phone_adapter, -70}, {robot_adapter, -40}});
  CHECK(x.set_power(c, false).empty());
  CHECK(seen(x, a) == strengths{{phone_adapter, -70}});
  CHECK(x.scan(a, "hci1").empty()); // not one of its own
  CHECK(x.scan(station_id{9}, "hci0").empty());
}

TEST_CASE("a HELLO comes to all who share an announced adapter, and is else not heard", "[peis]") {
  const bool takeover = GENERATE(false, true);
  auto x = room(takeover);
  const auto heard = all<hello_heard>(x.hello(c, {"hci0", desk, bytes{7}}));
  REQUIRE(heard.size() == 2);
  CHECK(heard[0].station == a);
  CHECK(heard[1].station == b);
  CHECK(heard[1].from == c);
  CHECK(heard[1].question.octets == payload(bytes{7}));
  CHECK(one<hello_unheard>(x.hello(a, {"hci0", phone_adapter, {}})).question.to == phone_adapter);
  static_cast<void>(x.end(a)); // which has announced
  const auto after = x.hello(c, {"hci0", desk, {}});
  if (takeover)
    CHECK(one<hello_heard>(after).station == b);
  else
    CHECK(one<hello_unheard>(after).station == c);
}

TEST_CASE("a link over Bluetooth opens to the process of that port, and ends out of range",
          "[peis]") {
  auto x = room();
  const auto made = all<link_made>(x.connect(c, attempt_id{9}, desk, 3));
  REQUIRE(made.size() == 2);
  CHECK(made[0].station == b);
  CHECK(made[0].role == link_role::acceptor);
  CHECK(made[1].station == c);
  CHECK(made[1].attempt == attempt_id{9});
  CHECK(made[1].link.value >= first_bluetooth_link);
  CHECK(one<link_refused>(x.connect(c, attempt_id{10}, desk, 5)).attempt == attempt_id{10});
  const auto reset = all<link_reset>(x.move("robot", {11, 0, 0}));
  REQUIRE(reset.size() == 2);
  CHECK(reset[0].station == c);
  CHECK(reset[1].station == b);
  CHECK(reset[1].link == made[1].link);
  static_cast<void>(one<link_refused>(x.connect(c, attempt_id{11}, desk, 3)));
  CHECK(x.move("robot", {5, 0, 0}).empty()); // it is gone
  CHECK(x.connect(c, attempt_id{12}, desk, 3).size() == 2);
  CHECK(one<link_reset>(x.end(b)).station == c);
  CHECK(x.connect(station_id{9}, attempt_id{13}, desk, 1).empty());
}

TEST_CASE("ports of links over Bluetooth are legal ones, each once", "[peis][BT-05]") {
  std::set<std::uint16_t> ports;
  for (std::size_t i = 0; i < 1000; ++i) {
    const auto port = bluetooth_port(i);
    ports.insert(port);
    CHECK(port % 2 == 1);
    CHECK((port >> 8) % 2 == 0);
    CHECK(port != hello_port);
  }
  CHECK(ports.size() == 1000);
}

} // namespace rubicon::peis
