#include "peis/overlay/connection_manager.hpp"

#include "peis/link/link.hpp"
#include "peis/overlay/network_clock.hpp"
#include "peis/overlay/routing_table.hpp"
#include "peis/wire/link_url.hpp"
#include "support/catch.hpp"

namespace rubicon::peis {
namespace {

std::vector<link_option> links(std::initializer_list<std::optional<unsigned>> losses) {
  std::vector<link_option> all;
  for (const auto& loss : losses)
    all.push_back({link_id{all.size() + 1}, loss});
  return all;
}

/// Whom or what a decision names: `+7` opens a link to host 7, `-2` closes link 2.
std::string told(const link_decision& x) {
  if (const auto* open = std::get_if<open_link_to>(&x))
    return '+' + std::to_string(open->host.value);
  if (const auto* worst = std::get_if<close_worst>(&x))
    return '-' + std::to_string(worst->link.value);
  return "";
}

std::string decided(std::initializer_list<std::optional<unsigned>> losses,
                    const std::vector<host_option>& hosts) {
  random_stream rng(1);
  return told(decide(links(losses), hosts, {}, rng));
}

routing_entry entry(std::int32_t id, std::uint8_t hops) {
  return {peer_id{id}, 10, 1, hops, 1};
}

} // namespace

TEST_CASE("the value of a connection is the metric that its loss would cost", "[peis][CM-04]") {
  routing_table routes(peer_id{1}, 1, 30);
  const link_id left{1};
  const link_id right{2};
  const std::vector<routing_entry> triangle_left{entry(2, 0), entry(3, 2)};
  const std::vector<routing_entry> triangle_right{entry(3, 0), entry(2, 2)};
  static_cast<void>(routes.on_table(left, 2, triangle_left, instant{}));
  CHECK(!routes.loss_without(left)); // a line: the others can be reached over it alone
  static_cast<void>(routes.on_table(right, 2, triangle_right, instant{}));
  CHECK(routes.loss_without(left) == 2); // a triangle: from 2 to 4
  const std::vector<routing_entry> ring_right{entry(3, 0), entry(2, 6)};
  static_cast<void>(routes.on_table(right, 2, ring_right, instant{}));
  CHECK(routes.loss_without(left) == 6); // a ring of five: from 2 to 8
  const std::vector<routing_entry> useless{entry(3, 4), entry(2, 2)};
  static_cast<void>(routes.on_table(left, 2, triangle_left, instant{}));
  static_cast<void>(routes.on_table(link_id{3}, 2, useless, instant{}));
  CHECK(routes.loss_without(link_id{3}) == 0); // nothing leads over it
}

TEST_CASE("the value of a host is a hundred times what a link would gain, and chance",
          "[peis][CM-05]") {
  for (int i = 0; i < 100; ++i) {
    random_stream rng(static_cast<std::uint64_t>(i));
    auto same = rng;
    const auto value = value_of({peer_id{5}, 6, 2, 3}, {}, rng);
    CHECK(value == 400 + static_cast<int>(same.below(100)));
  }
  random_stream rng(1);
  CHECK(value_of({peer_id{5}, 6, 2, 5}, {}, rng) < 300); // two connections above three
}

TEST_CASE("a peer with fewer than three connections takes the best host", "[peis][CM-06]") {
  CHECK(decided({}, {{peer_id{5}, 2, 2, 0}, {peer_id{6}, 6, 2, 0}}) == "+6");
  CHECK(decided({0, 0}, {{peer_id{5}, 2, 2, 9}}) == "+5"); // even one that gains nothing
  CHECK(decided({0, 0}, {}).empty());
}

TEST_CASE("between three and seven a host must be worth more than the worst connection",
          "[peis][CM-07]") {
  CHECK(decided({2, 4, 6}, {{peer_id{5}, 6, 2, 0}}) == "+5"); // 400 and more against 200
  CHECK(decided({6, 6, 6}, {{peer_id{5}, 6, 2, 0}}).empty());
  CHECK(decided({{}, {}, {}}, {{peer_id{5}, 20, 2, 0}}).empty()); // all forced or only ways
}

TEST_CASE("a peer with enough connections takes no host that has seven", "[peis][CM-01][CM-07]") {
  CHECK(decided({2, 4, 6}, {{peer_id{5}, 12, 2, 7}, {peer_id{6}, 8, 2, 6}}) == "+6");
  CHECK(decided({0, 0, 0}, {{peer_id{5}, 12, 2, 7}}).empty());
  CHECK(decided({0, 0}, {{peer_id{5}, 12, 2, 7}}) == "+5"); // too few: any
}

TEST_CASE("above seven the worst connection goes, at seven nothing happens", "[peis][CM-08]") {
  const std::vector<host_option> hosts{{peer_id{5}, 20, 2, 0}};
  CHECK(decided({2, 2, 2, 2, 2, 2, 2}, hosts).empty());
  CHECK(decided({6, 4, 2, 4, 6, 6, 6, 6}, hosts) == "-3");
  CHECK(decided({{}, {}, {}, {}, {}, {}, {}, {}}, hosts).empty()); // all forced
}

TEST_CASE("of connections of equal value the one goes whose neighbour has most others",
          "[peis][CM-08]") {
  auto options = links({6, 4, 4, 4, {}});
  CHECK(worst_of(options)->link == link_id{2});
  options[0].connections = options[4].connections = 9;
  options[3].connections = 8;
  CHECK(worst_of(options)->link == link_id{4});
}

TEST_CASE("requests are admitted up to the ceiling", "[peis][CM-09]") {
  const std::vector<link_option> some(9, {link_id{1}, 2});
  const std::vector<link_option> more(10, {link_id{1}, 2});
  const std::vector<link_option> full(20, {link_id{1}, 2});
  const std::vector<link_option> forced(20, {link_id{1}, std::nullopt});
  CHECK(admit(0, some, {}) == admission::accept);
  CHECK(admit(0, more, {}) == admission::refuse);
  CHECK(admit(connect_request::for_bandwidth, more, {}) == admission::accept);
  CHECK(admit(connect_request::for_bandwidth, full, {}) == admission::replace_worst);
  CHECK(admit(connect_request::for_bandwidth, forced, {}) == admission::refuse);
  CHECK(admit(connect_request::for_merge, forced, {}) == admission::accept);
}

TEST_CASE("addresses are tried where they can lead", "[peis][LNK-01]") {
  host_record self;
  self.host_name = "a";
  self.addresses = {tcp_address("lo", true, {127, 0, 0, 1}, 8000)};
  host_record other;
  other.host_name = "b";
  other.addresses = {tcp_address("lo", true, {127, 0, 0, 1}, 8001),
                     tcp_address("eth0", false, {10, 0, 0, 2}, 8001),
                     inproc_address(7, peer_id{2})};
  CHECK(connectable_urls(self, other).empty()); // another machine, and we keep to loopback
  self.addresses.push_back(tcp_address("eth0", false, {10, 0, 0, 1}, 8000));
  CHECK(connectable_urls(self, other) == std::vector<std::string>{"tcp://10.0.0.2:8001"});
  other.host_name = "a";
  CHECK(connectable_urls(self, other) == std::vector<std::string>{"tcp://127.0.0.1:8001"});
  self.addresses = {inproc_address(7, peer_id{1})};
  CHECK(connectable_urls(self, other) ==
        std::vector<std::string>{"tcp://127.0.0.1:8001", "inproc://2"});
  self.addresses = {inproc_address(8, peer_id{1})};
  CHECK(connectable_urls(self, other) == std::vector<std::string>{"tcp://127.0.0.1:8001"});
}

TEST_CASE("addresses of UDP are tried by who has UDP too", "[peis][UDP-01]") {
  host_record self;
  self.host_name = "a";
  self.addresses = {tcp_address("eth0", false, {10, 0, 0, 1}, 8000)};
  host_record other;
  other.host_name = "b";
  other.addresses = {tcp_address("eth0", false, {10, 0, 0, 2}, 8001),
                     udp_interface("lo", true, {127, 0, 0, 1}, 8002),
                     udp_interface("eth0", false, {10, 0, 0, 2}, 8002)};
  CHECK(connectable_urls(self, other) == std::vector<std::string>{"tcp://10.0.0.2:8001"});
  self.addresses.push_back(udp_interface("eth0", false, {10, 0, 0, 1}, 8000));
  CHECK(connectable_urls(self, other) ==
        std::vector<std::string>{"tcp://10.0.0.2:8001", "udp://10.0.0.2:8002"});
  other.host_name = "a";
  CHECK(connectable_urls(self, other) == std::vector<std::string>{"udp://127.0.0.1:8002"});
}

TEST_CASE("the fastest clock wins, a master overrules it", "[peis][CLK-06]") {
  const instant now{100s};
  network_clock clock({}, peer_id{5}, now);
  const auto says = [&](duration ahead, bool master, std::int32_t id, bool marked) {
    clock.on_message({now.time_since_epoch() + clock.offset() + ahead, master, {}}, peer_id{id}, 0s,
                     marked, now);
  };
  says(3s, false, 4, false);
  CHECK(clock.offset() == 3s);
  says(-3s, false, 9, false);
  CHECK(clock.offset() == 3s); // time does not go back for an equal
  says(400ms, false, 9, false);
  CHECK(clock.offset() == 3s); // within the real kernel's dead band
  says(400ms, false, 9, true);
  CHECK(clock.offset() == 3s + 400ms);
  says(-1s, true, 2, true);
  CHECK(clock.offset() == 2s + 400ms);
  CHECK(clock.last_error() == -1s);
}

TEST_CASE("the highest id keeps telling the time, others are quiet while they agree",
          "[peis][CLK-06]") {
  instant now{};
  network_clock clock({}, peer_id{5}, now);
  now += 2s;
  REQUIRE(clock.on_time(now));
  const clock_message same{now.time_since_epoch(), false, {}};
  clock.on_message(same, peer_id{4}, 0s, true, now);
  CHECK(clock.deadline() == now + 2s); // a lower id
  clock.on_message(same, peer_id{6}, 0s, true, now);
  CHECK(clock.deadline() == now + 7s);
  now += 7s;
  CHECK(clock.on_time(now));
  const clock_message late{now.time_since_epoch() - 1ms, false, {}};
  clock.on_message(late, peer_id{6}, 0s, true, now);
  CHECK(clock.deadline() == now + 2s); // it must learn that it is behind
}

TEST_CASE("a way is compensated", "[peis][CLK-07]") {
  const instant now{50s};
  network_clock clock({}, peer_id{5}, now);
  clock.on_message({48s, false, {}}, peer_id{6}, 2s + 30ms, true, now);
  CHECK(clock.offset() == 30ms);
}

TEST_CASE("a clock goes on when its seconds no longer fit into the wire's 32 bits",
          "[peis][CLK-06]") {
  const instant now{};
  constexpr auto day = std::chrono::seconds(24h);
  for (const auto known : {0x7fffffffs - 1s, 0x80000000s, 0xffffffffs - 1s, 0x100000000s}) {
    for (const auto ahead : {-day, -2s, 0s, 2s, day, 20 * 365 * day}) {
      CAPTURE(known.count(), ahead.count());
      network_clock sender({.offset = known + ahead}, peer_id{6}, now - 2s);
      const auto told = sender.on_time(now);
      REQUIRE(told);
      network_clock receiver({.offset = known}, peer_id{5}, now);
      const auto message = decode_clock(encode(*told), receiver.at(now));
      REQUIRE(message);
      CHECK(message->network_time == known + ahead);
      receiver.on_message(*message, peer_id{6}, 0s, true, now);
      CHECK(receiver.offset() == known + std::max(ahead, 0s));
    }
  }
}

TEST_CASE("no clock leaves the times that can be told", "[peis][CLK-06]") {
  network_clock clock({.offset = network_time_end - 10s}, peer_id{5}, instant{});
  clock.step(24h * 3650, instant{});
  CHECK(clock.at(instant{}) == network_time_end - 1ns);
  CHECK(decode_clock(encode({clock.at(instant{}), false, {}}), clock.at(instant{})));
  CHECK(!decode_clock(encode({network_time_end, false, {}}), clock.at(instant{})));
  clock = network_clock({.offset = 10s}, peer_id{5}, instant{});
  clock.step(-24h, instant{});
  CHECK(clock.at(instant{}) == 0s);
  CHECK(!decode_clock(encode({-1s, false, {}}), 0s));
}

} // namespace rubicon::peis
