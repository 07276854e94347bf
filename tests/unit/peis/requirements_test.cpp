// Requirement rows of A4 to A12 that no other test shows, one test a row or two.
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "peis/delivery/delivery.hpp"
#include "peis/overlay/connection_manager.hpp"
#include "peis/overlay/routing_table.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/link_url.hpp"
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis::test {
namespace {

constexpr link_id left{1};
constexpr link_id right{2};
constexpr peer_id here{1};
constexpr peer_id next_door{2};
constexpr peer_id stranger{9};

/// A kernel whose only neighbour is played by the test.
class lone_kernel {
public:
  explicit lone_kernel(kernel_config config)
      : kernel_(std::move(config), random_stream(1), instant{}) {
    keep(kernel_.on_link_open(left, link_role::initiator, now_));
  }

  /// A package of the neighbour, or passed on by it.
  void hear(peer_id source, package_type type, std::uint16_t to_port, const bytes& data,
            std::uint8_t hops = 1) {
    package_header header;
    header.id = header.ack_id = next_id_++;
    header.type = type;
    header.hops = hops;
    header.source = source;
    header.destination = type == package_type::direct ? here : any_peer;
    header.port = to_port;
    header.length = static_cast<std::uint16_t>(data.size());
    bytes octets;
    encode(header, octets);
    octets.insert(octets.end(), data.begin(), data.end());
    keep(kernel_.on_link_octets(left, octets, now_));
  }

  void hear_route(std::int32_t seqno, std::int32_t magic) {
    const routing_page page{
        0, 1, seqno, {{next_door, seqno, 22, 0, 1}, {stranger, seqno, magic, 2, 1}}};
    hear(next_door, package_type::link, port::routing, encode(page));
  }

  void hear_record(peer_id id, std::int32_t magic, bool cached) {
    host_record record;
    record.id = id;
    record.magic = magic;
    record.host_name = "elsewhere";
    record.full_name = "component@elsewhere!1";
    const auto from = cached ? next_door : id;
    hear(from, package_type::direct, port::host_record, encode(host_record_message{record, cached}),
         static_cast<std::uint8_t>(from == next_door ? 1 : 2));
  }

  void wait(duration length) {
    const auto end = now_ + length;
    for (auto due = kernel_.deadline(); due && *due <= end; due = kernel_.deadline()) {
      now_ = std::max(now_, *due);
      keep(kernel_.on_time(now_));
    }
    now_ = end;
  }

  /// As if the owner had been busy elsewhere.
  void stall(duration length) {
    now_ += length;
    keep(kernel_.on_time(now_));
  }

  [[nodiscard]] std::uint64_t routing_sendings() const {
    return kernel_.counters().network.routing_sendings;
  }

  /// The magic number under which a host is known; 0 if it is not.
  [[nodiscard]] std::int32_t known_magic(peer_id id) const {
    for (const auto* host : kernel_.network().hosts.records()) {
      if (host->id == id)
        return host->magic;
    }
    return 0;
  }

private:
  void keep(const outputs& todo) {
    for (const auto& x : todo)
      REQUIRE(!std::holds_alternative<close_link>(x));
  }

  kernel kernel_;
  instant now_;
  std::int32_t next_id_ = 1000;
};

kernel_config patient_config() {
  auto config = config_of(1);
  config.network.link_timeout = config.network.greeting_timeout = 1h;
  config.network.connections.manager = false;
  return config;
}

reliable_message message_to(peer_id destination) {
  return {here,
          destination,
          20,
          priority::normal,
          request_id{1},
          std::make_shared<const message_octets>(message_octets{payload(bytes(10)), {}})};
}

/// Two peers, one link, each knows the other.
struct pair {
  world w;
  peer_id a = w.add(1);
  peer_id b = w.add(2);
  pair() {
    w.connect(a, b);
    w.run_for(1s);
  }
};

std::string value_of_tuple(const tuple_pointer& x) {
  return x ? std::string(x->text()) : "none";
}

} // namespace

TEST_CASE("periodic work is done at no more than its rate", "[peis][SCH-01]") {
  lone_kernel x(patient_config());
  x.wait(5s); // what the new link has triggered
  const auto before = x.routing_sendings();
  x.wait(100s); // a period of 10 s
  CHECK(x.routing_sendings() - before == 10);
}

TEST_CASE("periods that were missed are not made up for", "[peis][SCH-02]") {
  lone_kernel x(patient_config());
  x.wait(5s);
  const auto before = x.routing_sendings();
  x.stall(65s);
  CHECK(x.routing_sendings() - before == 1);
  x.wait(9s);
  CHECK(x.routing_sendings() - before == 1);
  x.wait(2s);
  CHECK(x.routing_sendings() - before == 2);
}

TEST_CASE("a hook hears each message of its port once, a callback each tuple once",
          "[peis][SCH-04]") {
  pair p;
  p.w.at(p.b).messages().hook_port(30);
  p.w.perform(
      p.b, p.w.at(p.b).subscriptions().subscribe(p.a, "watched.*", subscription_id{1}, p.w.now()));
  p.w.run_for(1s);
  for (std::uint64_t i = 1; i <= 3; ++i) {
    p.w.perform(p.a, p.w.at(p.a).messages().send(p.b, 30, payload(bytes(10)), true,
                                                 priority::normal, request_id{i}, p.w.now()));
    p.w.perform(p.a, p.w.at(p.a).messages().send(p.b, 31, payload(bytes(10)), true,
                                                 priority::normal, request_id{10 + i}, p.w.now()));
    p.w.perform(p.a, p.w.at(p.a).tuples().set("watched.x", text_content("1"), p.w.now()));
    p.w.perform(p.a, p.w.at(p.a).tuples().set("other.x", text_content("1"), p.w.now()));
    p.w.run_for(1s);
  }
  CHECK(p.w.all<message>(p.b).size() == 3);
  CHECK(p.w.all<tuple_changed>(p.b).size() == 3);
}

TEST_CASE("all known hosts can be walked, each with a usable address", "[peis][API-01]") {
  world w;
  for (int i = 1; i <= 5; ++i)
    w.add(lan_config_of(i));
  w.run_for(30s);
  const auto hosts = w.at(here).network().hosts.records();
  REQUIRE(hosts.size() == 5);
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    const auto id = peer_id{static_cast<std::int32_t>(i) + 1};
    CHECK(hosts[i]->id == id);
    CHECK(hosts[i]->host_name == "host" + to_string(id));
    CHECK(hosts[i]->full_name.starts_with("peer" + to_string(id) + '@'));
    CHECK(hosts[i]->magic != 0);
    CHECK(hosts[i]->cluster == 1);
    REQUIRE(hosts[i]->addresses.size() == 1);
    CHECK(to_string(url_of(hosts[i]->addresses[0])) == "inproc://" + to_string(id));
  }
}

TEST_CASE("whoever answers a broadcast need not have known who asks", "[peis][API-10][P2P-09]") {
  world w;
  w.add_line(4);
  w.run_for(5s);
  const peer_id far{4};
  w.at(far).messages().hook_port(30);
  w.at(here).messages().hook_port(31);
  w.perform(here, w.at(here).messages().broadcast(30, payload(bytes{'?'}), no_request, w.now()));
  w.run_for(1s);
  const auto asked = w.all<message>(far);
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].broadcast);
  w.perform(far, w.at(far).messages().send(asked[0].source, 31, payload(bytes{'!'}), true,
                                           priority::normal, request_id{1}, w.now()));
  w.run_for(1s);
  const auto answers = w.all<message>(here);
  REQUIRE(answers.size() == 1);
  CHECK(answers[0].source == far);
  CHECK(to_bytes(answers[0].octets.view()) == bytes{'!'});
}

TEST_CASE("a peer tells addresses of several link modules, and others take what they can use",
          "[peis][LNK-02]") {
  host_record both;
  both.id = next_door;
  both.host_name = "robot";
  both.full_name = "arm@robot!1";
  both.addresses = {tcp_address("lo", true, {127, 0, 0, 1}, 8001),
                    tcp_address("eth0", false, {192, 168, 1, 7}, 8001),
                    inproc_address(5, next_door)};
  const auto arrived = decode_host_record(encode(host_record_message{both, false}));
  REQUIRE(arrived);
  REQUIRE(arrived->addresses == both.addresses);

  using urls = std::vector<std::string>;
  host_record other;
  other.id = here;
  other.host_name = "robot";
  other.addresses = {inproc_address(5, here)};
  CHECK(connectable_urls(other, *arrived) == urls{"tcp://127.0.0.1:8001", "inproc://2"});
  other.addresses = {inproc_address(6, here)}; // another process
  CHECK(connectable_urls(other, *arrived) == urls{"tcp://127.0.0.1:8001"});
  other.host_name = "pc";
  other.addresses = {tcp_address("eth0", false, {192, 168, 1, 9}, 8000)};
  CHECK(connectable_urls(other, *arrived) == urls{"tcp://192.168.1.7:8001"});
}

TEST_CASE("the main table holds what is known of the way to each host", "[peis][RTE-01]") {
  routing_table routes(here, 111, 30);
  const std::array entries{routing_entry{stranger, 40, 7, 3, 5}};
  static_cast<void>(routes.on_table(left, 2, entries, instant{}));
  REQUIRE(routes.routes().size() == 1);
  const auto& way = routes.routes().at(stranger);
  CHECK(way.seqno == 40);
  CHECK(way.magic == 7);
  CHECK(way.hops == 5);
  CHECK(way.connections == 5);
  CHECK(way.via == left);
  CHECK(!way.lost());
}

TEST_CASE("each link has a table of its own", "[peis][RTE-02]") {
  routing_table routes(here, 111, 30);
  const std::array over_left{routing_entry{stranger, 40, 7, 3, 5},
                             routing_entry{peer_id{8}, 1, 8, 1, 1}};
  const std::array over_right{routing_entry{stranger, 40, 7, 6, 5}};
  static_cast<void>(routes.on_table(left, 1, over_left, instant{}));
  static_cast<void>(routes.on_table(right, 2, over_right, instant{}));
  CHECK(routes.find(stranger)->hops == 4);
  static_cast<void>(routes.on_link_closed(left, instant{}));
  CHECK(routes.find(stranger)->hops == 8); // as if through the other link, all the time
  CHECK(routes.way_to(stranger) == right);
  CHECK(!routes.way_to(peer_id{8}));
}

TEST_CASE("a remembered record of another incarnation is not believed", "[peis][KH-02]") {
  lone_kernel x(patient_config());
  x.hear_record(next_door, 22, false);
  x.hear_route(5, 77);
  x.hear_record(stranger, 66, true);
  CHECK(x.known_magic(stranger) == 0);
  x.hear_record(stranger, 77, true); // fits the way that the neighbour has told
  CHECK(x.known_magic(stranger) == 77);

  x.hear_route(6, 78); // it was restarted
  x.hear_record(stranger, 66, true);
  CHECK(x.known_magic(stranger) == 77);
  x.hear_record(stranger, 78, false); // its own word
  CHECK(x.known_magic(stranger) == 78);

  x.hear_record(stranger, 77, false); // was long in flight: the route leads to 78
  CHECK(x.known_magic(stranger) == 78);
  x.wait(5s);
  x.hear_route(7, 79);
  x.hear_record(stranger, 79, true); // somebody else knows already, and the route says so too
  CHECK(x.known_magic(stranger) == 79);
}

TEST_CASE("one configured link joins two networks that cannot hear each other", "[peis][AUT-02]") {
  const bool joined = GENERATE(false, true);
  world w;
  for (int i = 1; i <= 6; ++i) {
    auto config = lan_config_of(i);
    auto& connections = config.network.connections;
    connections.announces = false;
    if (i != 1 && i != 4)
      connections.seeds = {i < 4 ? "inproc://1" : "inproc://4"};
    if (i == 4 && joined)
      connections.always = {"inproc://1"};
    w.add(config);
  }
  w.run_for(30s);
  const peer_id far{6};
  w.at(far).messages().hook_port(30);
  w.perform(next_door, w.at(next_door).messages().send(far, 30, payload(bytes{1}), true,
                                                       priority::normal, request_id{1}, w.now()));
  w.run_for(1s);
  CHECK(w.at(next_door).network().reachable(peer_id{3}));
  CHECK(w.at(next_door).network().reachable(far) == joined);
  CHECK(w.all<message>(far).size() == (joined ? 1U : 0U));
}

TEST_CASE("a reliable package is kept until it is acknowledged or given up", "[peis][ACK-01]") {
  random_stream rng(1);
  id_source ids(rng);
  delivery reliable{delivery_config{}};
  std::vector<std::int32_t> sent;
  for (int i = 0; i < 2; ++i) {
    REQUIRE(reliable.add(message_to(stranger), ids));
    sent.push_back(reliable.next(stranger, ids)->second.header.ack_id);
    reliable.on_transmitted(sent.back(), instant{});
  }
  CHECK(reliable.in_flight() == 2);
  CHECK(reliable.acknowledge(sent[0])->finished);
  CHECK(reliable.in_flight() == 1);
  CHECK(!reliable.acknowledge(sent[0]));
  CHECK(reliable.fail_all(stranger).size() == 1);
  CHECK(reliable.in_flight() == 0);
  CHECK(!reliable.deadline());
}

TEST_CASE("an owner has one value for a name, another owner one of its own", "[peis][TUP-01]") {
  pair p;
  auto& a = p.w.at(p.a);
  p.w.perform(p.a, a.subscriptions().subscribe(p.b, "lamp", subscription_id{1}, p.w.now()));
  p.w.perform(p.a, a.tuples().set("lamp", text_content("red"), p.w.now()));
  p.w.perform(p.b, p.w.at(p.b).tuples().set("lamp", text_content("green"), p.w.now()));
  p.w.run_for(1s);
  CHECK(value_of_tuple(a.reader().find(p.a, "lamp")) == "red");
  CHECK(value_of_tuple(a.reader().find(p.b, "lamp")) == "green");
  CHECK(a.reader().find_all(any_peer, "lamp").size() == 2);
  p.w.perform(p.a, a.tuples().set("LAMP", text_content("blue"), p.w.now()));
  CHECK(a.reader().find_all(any_peer, "lamp").size() == 2);
  CHECK(value_of_tuple(a.reader().find(p.a, "lamp")) == "blue");
  p.w.perform(p.a, a.tuples().remove("lamp", p.w.now()));
  CHECK(value_of_tuple(a.reader().find(p.a, "lamp")) == "none");
  CHECK(value_of_tuple(a.reader().find(p.b, "lamp")) == "green");
}

TEST_CASE("an owner can ask whether anyone subscribes", "[peis][TUP-23]") {
  pair p;
  auto& owner = p.w.at(p.a);
  CHECK(!owner.reader().has_subscriber("devices.7.output.2"));
  p.w.perform(p.b, p.w.at(p.b).subscriptions().subscribe(any_peer, "devices.*.output.2",
                                                         subscription_id{1}, p.w.now()));
  p.w.run_for(1s);
  CHECK(owner.reader().has_subscriber("devices.7.output.2"));
  CHECK(!owner.reader().has_subscriber("devices.7.output.3"));
  p.w.perform(p.b, p.w.at(p.b).subscriptions().unsubscribe(subscription_id{1}, p.w.now()));
  p.w.run_for(1s);
  CHECK(!owner.reader().has_subscriber("devices.7.output.2"));
}

} // namespace rubicon::peis::test
