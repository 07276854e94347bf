// Devices near a peer, and which of them are peers (D1.1 3.1.5.3).
#include <algorithm>
#include <string>
#include <vector>

#include "peis/bluetooth/bluetooth.hpp"
#include "peis/kernel/kernel.hpp"
#include "peis/overlay/connection_manager.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/link_url.hpp"
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis::test {
namespace {

using standing = bluetooth::standing;

constexpr bluetooth_address robot_device{{2, 0x4b, 0, 0x1f, 0xa0, 7}};
constexpr bluetooth_address phone_device{{2, 0, 0, 0, 0, 1}};

template <class T, class Outputs>
std::vector<T> all(const Outputs& from) {
  std::vector<T> found;
  for (const auto& x : from) {
    if (const auto* match = std::get_if<T>(&x))
      found.push_back(*match);
  }
  return found;
}

std::vector<std::pair<std::string, std::string>> notes(const bluetooth::outputs& from) {
  std::vector<std::pair<std::string, std::string>> found;
  for (const auto& x : all<device_noted>(from))
    found.emplace_back(x.key, x.value.value_or("gone"));
  return found;
}

using texts = std::vector<std::pair<std::string, std::string>>;

bluetooth with_adapters(std::vector<std::string> adapters) {
  bluetooth_config config;
  config.adapters = std::move(adapters);
  return {config, instant{}};
}

instant at(duration x) {
  return instant{} + x;
}

bluetooth::outputs see(bluetooth& x, std::vector<seen_device> seen, instant now) {
  return x.on_scan("hci0", seen, now);
}

kernel_config config_with_adapter(std::int32_t id, const bluetooth_address& address) {
  auto config = config_of(id);
  config.network.bluetooth.adapters = {"hci0"};
  config.network.addresses = {bluetooth_interface("hci0", address, 4097)};
  return config;
}

bytes hello_of(std::int32_t id, const bluetooth_address& address) {
  return kernel(config_with_adapter(id, address), random_stream(9), instant{})
      .network()
      .own.hello();
}

} // namespace

TEST_CASE("addresses of Bluetooth devices are read and written", "[peis][BT-05][LNK-05]") {
  CHECK(to_string(robot_device) == "02:4B:00:1F:A0:07");
  CHECK(*parse_bluetooth_address("02:4b:00:1F:a0:07") == robot_device);
  for (const auto* wrong : {"", "02:4B:00:1F:A0", "02:4B:00:1F:A0:0", "02:4B:00:1F:A0:07:",
                            "02-4B-00-1F-A0-07", "02:4B:00:1F:A0:0G", "0 :4B:00:1F:A0:07"}) {
    CAPTURE(wrong);
    CHECK(!parse_bluetooth_address(wrong));
  }
  const auto interface = bluetooth_interface("hci0", robot_device, hello_port);
  CHECK(bluetooth_address_of(interface) == robot_device);
  CHECK(to_string(url_of(interface)) == "bt://02:4B:00:1F:A0:07;7315");
}

TEST_CASE("only the adapters that are named are used, each of them", "[peis][BT-01]") {
  auto none = with_adapters({});
  CHECK(!none.deadline());
  CHECK(none.on_time(at(1h)).empty());
  auto both = with_adapters({"hci0", "hci2"});
  const auto scans = all<scan_adapter>(both.on_time(*both.deadline()));
  REQUIRE(scans.size() == 2);
  CHECK(scans[0].adapter == "hci0");
  CHECK(scans[1].adapter == "hci2");
  CHECK(both.on_scan("hci1", std::vector<seen_device>{{phone_device, -50}}, at(2s)).empty());
  CHECK(!both.standing_of("hci1", phone_device));
}

TEST_CASE("an adapter scans again and again", "[peis][BT-04]") {
  auto x = with_adapters({"hci0"});
  CHECK(x.on_time(at(999ms)).empty());
  std::size_t scans = 0;
  for (auto now = *x.deadline(); now <= at(60s); now = *x.deadline())
    scans += all<scan_adapter>(x.on_time(now)).size();
  CHECK(scans == 6);
}

TEST_CASE("strengths are told when they change, and when a device is gone", "[peis][BT-04]") {
  auto x = with_adapters({"hci0"});
  CHECK(notes(see(x, {{phone_device, -80}, {robot_device, -90}}, at(1s))) ==
        texts{{"kernel.hci0.02-00-00-00-00-01.str", "-80"},
              {"kernel.hci0.02-4B-00-1F-A0-07.str", "-90"}});
  CHECK(notes(see(x, {{phone_device, -75}, {robot_device, -90}}, at(11s))) ==
        texts{{"kernel.hci0.02-00-00-00-00-01.str", "-75"}});
  CHECK(notes(see(x, {{robot_device, -90}}, at(21s))) ==
        texts{{"kernel.hci0.02-00-00-00-00-01.str", "gone"}});
}

TEST_CASE("a device that answers a HELLO is a peer, one that does not is none after one",
          "[peis][BT-05]") {
  auto x = with_adapters({"hci0"});
  const auto asked = all<ask_device>(see(x, {{phone_device, -50}, {robot_device, -50}}, at(1s)));
  REQUIRE(asked.size() == 2);
  CHECK(asked[0].adapter == "hci0");
  CHECK(asked[1].address == robot_device);
  CHECK(x.standing_of("hci0", phone_device) == standing::unknown);
  CHECK(notes(x.on_answer("hci0", robot_device, true, at(2s))) ==
        texts{{"kernel.hci0.02-4B-00-1F-A0-07.peis", "yes"}});
  CHECK(notes(x.on_answer("hci0", phone_device, false, at(2s))) ==
        texts{{"kernel.hci0.02-00-00-00-00-01.peis", "no"}});
  CHECK(x.standing_of("hci0", robot_device) == standing::peer);
  CHECK(x.standing_of("hci0", phone_device) == standing::no_peer);

  // The peer is asked after each scan, the other one a minute later.
  const auto again = all<ask_device>(see(x, {{phone_device, -50}, {robot_device, -50}}, at(11s)));
  REQUIRE(again.size() == 1);
  CHECK(again[0].address == robot_device);
  CHECK(notes(x.on_answer("hci0", robot_device, true, at(11s))).empty());
  CHECK(all<ask_device>(see(x, {{phone_device, -50}}, at(61s))).empty());
  CHECK(all<ask_device>(see(x, {{phone_device, -50}}, at(62s))).size() == 1);
}

TEST_CASE("a HELLO that nobody answers has failed after five seconds", "[peis][BT-05]") {
  auto x = with_adapters({"hci0"});
  static_cast<void>(x.on_time(at(1s)));
  CHECK(see(x, {{phone_device, -50}}, at(2s)).size() == 2);
  CHECK(all<ask_device>(see(x, {{phone_device, -50}}, at(3s))).empty()); // one is in flight
  CHECK(x.deadline() == at(7s));
  CHECK(x.on_time(at(6999ms)).empty());
  CHECK(notes(x.on_time(at(7s))).size() == 1);
  CHECK(x.standing_of("hci0", phone_device) == standing::no_peer);
  static_cast<void>(x.on_answer("hci0", phone_device, false, at(8s)));
  static_cast<void>(x.on_answer("hci0", phone_device, true, at(8s)));
  CHECK(x.standing_of("hci0", phone_device) == standing::peer);   // it was only slow
  CHECK(x.on_answer("hci0", robot_device, true, at(8s)).empty()); // out of sight
}

TEST_CASE("connectable is who is strong enough and has answered the last HELLO", "[peis][BT-06]") {
  auto x = with_adapters({"hci0"});
  CHECK(!x.is_connectable(robot_device));
  CHECK(all<ask_device>(see(x, {{robot_device, -68}}, at(1s)))
            .empty()); // below the threshold of -67 dBm
  CHECK(!x.is_connectable(robot_device));
  CHECK(all<ask_device>(see(x, {{robot_device, -67}}, at(11s))).size() == 1);
  CHECK(!x.is_connectable(robot_device)); // not yet
  static_cast<void>(x.on_answer("hci0", robot_device, true, at(12s)));
  CHECK(x.is_connectable(robot_device));
  static_cast<void>(see(x, {{robot_device, -68}}, at(21s)));
  CHECK(!x.is_connectable(robot_device));
  static_cast<void>(see(x, {{robot_device, -60}}, at(31s)));
  CHECK(x.is_connectable(robot_device));
  static_cast<void>(x.on_answer("hci0", robot_device, false, at(32s)));
  CHECK(!x.is_connectable(robot_device));
  static_cast<void>(x.on_answer("hci0", robot_device, true, at(33s)));
  static_cast<void>(see(x, {}, at(41s)));
  CHECK(!x.is_connectable(robot_device));
}

TEST_CASE("what is near at one adapter may be far at another", "[peis][BT-01][BT-06]") {
  auto x = with_adapters({"hci0", "hci1"});
  static_cast<void>(x.on_scan("hci0", std::vector<seen_device>{{robot_device, -80}}, at(1s)));
  static_cast<void>(x.on_scan("hci1", std::vector<seen_device>{{robot_device, -50}}, at(1s)));
  static_cast<void>(x.on_answer("hci1", robot_device, true, at(1s)));
  CHECK(x.is_connectable(robot_device));
  static_cast<void>(x.on_scan("hci1", {}, at(11s)));
  CHECK(!x.is_connectable(robot_device));
}

TEST_CASE("devices beyond the limit are counted and passed over", "[peis][BT-04]") {
  bluetooth_config config;
  config.adapters = {"hci0"};
  config.devices_max = 2;
  bluetooth x(config, instant{});
  std::vector<seen_device> crowd;
  for (std::uint8_t i = 1; i <= 3; ++i)
    crowd.push_back({{{i}}, -90});
  CHECK(see(x, crowd, at(1s)).size() == 2);
  CHECK(x.passed_over() == 1);
}

TEST_CASE("an address over Bluetooth is tried only if it is connectable and there is no other",
          "[peis][BT-06][LNK-02]") {
  auto near = with_adapters({"hci0"});
  static_cast<void>(see(near, {{robot_device, -50}}, at(1s)));
  host_record self;
  self.host_name = "pc";
  host_record other;
  other.host_name = "robot";
  other.addresses = {bluetooth_interface("hci0", robot_device, 4097)};
  CHECK(connectable_urls(self, other).empty());
  CHECK(connectable_urls(self, other, near).empty()); // has not answered
  static_cast<void>(near.on_answer("hci0", robot_device, true, at(2s)));
  CHECK(connectable_urls(self, other, near) ==
        std::vector<std::string>{"bt://02:4B:00:1F:A0:07;4097"});
  other.addresses.push_back(tcp_address("eth0", false, {10, 0, 0, 2}, 8000));
  self.addresses.push_back(tcp_address("eth0", false, {10, 0, 0, 1}, 8000));
  CHECK(connectable_urls(self, other, near) == std::vector<std::string>{"tcp://10.0.0.2:8000"});
}

TEST_CASE("a HELLO tells both sides who the other one is", "[peis][BT-05]") {
  kernel x(config_with_adapter(1, phone_device), random_stream(1), instant{});
  const auto seen =
      x.on_bluetooth_scan("hci0", std::vector<seen_device>{{robot_device, -50}}, at(1s));
  const auto hellos = all<say_hello>(seen);
  REQUIRE(hellos.size() == 1);
  CHECK(hellos[0].adapter == "hci0");
  CHECK(hellos[0].to == robot_device);
  const auto told = decode_announcement(hellos[0].octets.view());
  REQUIRE(told);
  CHECK(told->sender.id.value == 1);
  REQUIRE(told->sender.addresses.size() == 1); // with the port where links are taken
  CHECK(to_string(url_of(told->sender.addresses[0])) == "bt://02:00:00:00:00:01;4097");

  static_cast<void>(x.on_hello_answer("hci0", robot_device, hello_of(2, robot_device), at(2s)));
  CHECK(x.network().adapters.is_connectable(robot_device));
  static_cast<void>(x.on_hello(hello_of(3, {}), at(3s)));
  CHECK(x.counters().network.announcements_received == 2);
}

TEST_CASE("no link is tried below the threshold, and one is above it", "[peis][BT-06]") {
  for (const int strength : {-68, -67}) {
    CAPTURE(strength);
    kernel x(config_with_adapter(1, phone_device), random_stream(1), instant{});
    outputs done;
    const auto keep = [&](outputs more) { done.insert(done.end(), more.begin(), more.end()); };
    keep(x.on_hello(hello_of(2, robot_device), at(500ms))); // it has seen us before we see it
    for (auto now = *x.deadline(); now < at(60s); now = *x.deadline()) {
      const auto todo = x.on_time(now);
      keep(todo);
      if (!all<scan_adapter>(todo).empty())
        keep(x.on_bluetooth_scan("hci0", std::vector<seen_device>{{robot_device, strength}}, now));
      if (strength >= -67)
        keep(x.on_hello_answer("hci0", robot_device, hello_of(2, robot_device), now));
    }
    const auto tried = all<connect_to>(done);
    if (strength < -67) {
      CHECK(tried.empty());
      CHECK(all<say_hello>(done).empty());
    } else {
      REQUIRE(!tried.empty());
      CHECK(tried[0].url == "bt://02:4B:00:1F:A0:07;4097");
    }
  }
}

TEST_CASE("a peer of another network is a peer, but no link is tried", "[peis][BT-05][LNK-06]") {
  auto foreign = config_with_adapter(2, robot_device);
  foreign.network.network = "elsewhere";
  const auto answer = kernel(foreign, random_stream(9), instant{}).network().own.hello();
  kernel x(config_with_adapter(1, phone_device), random_stream(1), instant{});
  static_cast<void>(
      x.on_bluetooth_scan("hci0", std::vector<seen_device>{{robot_device, -50}}, at(1s)));
  static_cast<void>(x.on_hello_answer("hci0", robot_device, answer, at(2s)));
  CHECK(x.reader().find(peer_id{1}, "kernel.hci0.02-4B-00-1F-A0-07.peis")->text() == "yes");
  outputs done;
  for (auto now = *x.deadline(); now < at(60s); now = *x.deadline()) {
    const auto todo = x.on_time(now);
    done.insert(done.end(), todo.begin(), todo.end());
  }
  CHECK(all<connect_to>(done).empty());
}

TEST_CASE("an answer that is no announcement is that of no peer", "[peis][BT-05]") {
  kernel x(config_with_adapter(1, phone_device), random_stream(1), instant{});
  for (const auto& answer : {bytes{}, bytes{1, 2, 3}, bytes(616, 0xff)}) {
    static_cast<void>(
        x.on_bluetooth_scan("hci0", std::vector<seen_device>{{robot_device, -50}}, at(1s)));
    static_cast<void>(x.on_hello_answer("hci0", robot_device, answer, at(2s)));
    CHECK(!x.network().adapters.is_connectable(robot_device));
    CHECK(x.reader().find(peer_id{1}, "kernel.hci0.02-4B-00-1F-A0-07.peis")->text() == "no");
    static_cast<void>(x.on_bluetooth_scan("hci0", {}, at(3s)));
    CHECK(!x.reader().find(peer_id{1}, "kernel.hci0.02-4B-00-1F-A0-07.peis"));
  }
}

} // namespace rubicon::peis::test
