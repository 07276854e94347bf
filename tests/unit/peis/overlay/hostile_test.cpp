// What a neighbour that keeps to no rule can bring about, and what not.
#include <algorithm>
#include <functional>
#include <limits>

#include "peis/overlay/network_clock.hpp"
#include "peis/overlay/routing_table.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/dead_host.hpp"
#include "peis/wire/host_query.hpp"
#include "peis/wire/routing_page.hpp"
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis {
namespace {

using test::world;

constexpr link_id hostile_link{1000};
constexpr peer_id hostile{666};

/// A package as it lies in a stream.
bytes package_of(package_header header, byte_view data) {
  static std::int32_t next_id = 1;
  header.id = next_id++;
  if (header.ack_id == 0)
    header.ack_id = header.id;
  header.length = static_cast<std::uint16_t>(data.size());
  bytes octets;
  encode(header, octets);
  octets.insert(octets.end(), data.begin(), data.end());
  return octets;
}

package_header header_of(package_type type, std::uint16_t port, peer_id source,
                         peer_id destination = any_peer) {
  package_header x;
  x.type = type;
  x.port = port;
  x.source = source;
  x.destination = destination;
  return x;
}

void say(world& w, peer_id to, const bytes& octets) {
  w.perform(to, w.at(to).on_link_octets(hostile_link, octets, w.now()));
}

/// A neighbour by whom anything may be said.
void befriend(world& w, peer_id to) {
  w.perform(to, w.at(to).on_link_open(hostile_link, link_role::acceptor, w.now()));
  say(w, to, encode(connect_request{500, hostile, connect_request::for_merge, "test"}));
}

} // namespace

TEST_CASE("what follows a clock message in its package is passed on as it is",
          "[peis][CLK-07][P2P-01]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(5s);
  befriend(w, a);
  for (const std::size_t size : {12U, 13U, 100U, 1024U}) {
    auto data = encode(clock_message{1s, false, 0s});
    data.resize(size, 0x55);
    for (const auto source : {b, peer_id{77}}) { // of a host that we know to be of our kind, or not
      w.packages.clear();
      say(w, a, package_of(header_of(package_type::broadcast, port::clock, source), data));
      w.run_for(100ms);
      const auto passed = std::ranges::find_if(w.packages, [&](const test::carried& x) {
        return x.header.port == port::clock && x.header.source == source;
      });
      REQUIRE(passed != w.packages.end());
      CHECK(passed->header.length == size);
    }
  }
}

TEST_CASE("a sequence number that nobody can have reached is not taken for ours",
          "[peis][RTE-03]") {
  routing_table table(peer_id{1}, 7, 30);
  const routing_entry incredible{peer_id{1}, std::numeric_limits<std::int32_t>::max(), 8, 1, 1};
  static_cast<void>(table.on_table(link_id{1}, 1, {&incredible, 1}, instant{}));
  CHECK_FALSE(table.take_overtaken());
  CHECK(table.next_seqno() == 1);
  const routing_entry earlier{peer_id{1}, 1'000'000, 8, 1, 1};
  static_cast<void>(table.on_table(link_id{1}, 1, {&earlier, 1}, instant{}));
  CHECK(table.take_overtaken());
  CHECK(table.next_seqno() == 1'000'001);
}

TEST_CASE("links take turns, however much one of them has brought", "[peis][P2P-03]") {
  world w;
  const auto a = w.add(1);
  befriend(w, a);
  w.run_for(1s);
  bytes flood;
  for (int i = 0; i < 10'000; ++i) {
    const auto one = package_of(header_of(package_type::direct, 20, hostile, a), bytes(8));
    flood.insert(flood.end(), one.begin(), one.end());
  }
  auto& kernel = w.at(a);
  const auto before = kernel.counters().network.packages_received;
  const auto out = kernel.on_link_octets(hostile_link, flood, w.now());
  const auto handled = kernel.counters().network.packages_received - before;
  CHECK(handled >= 250);
  CHECK(handled <= kernel_config().network.turn_work);
  const auto held = std::ranges::find_if(
      out, [](const output& x) { return std::holds_alternative<read_link>(x); });
  REQUIRE(held != out.end());
  CHECK_FALSE(std::get<read_link>(*held).wanted);
  CHECK(kernel.deadline() == w.now()); // the rest is due at once

  // Another link's packages are handled in the next turn, though most of the flood waits.
  const link_id other{1001};
  w.perform(a, kernel.on_link_open(other, link_role::acceptor, w.now()));
  const auto request = encode(connect_request{500, peer_id{5}, connect_request::for_merge, "test"});
  w.perform(a, kernel.on_link_octets(other, request, w.now()));
  w.perform(a, kernel.on_time(w.now()));
  CHECK(kernel.network().links.views().back().neighbour == peer_id{5});
  CHECK(kernel.counters().network.packages_received - before < 5000);
  w.run_for(1ms);
  CHECK(kernel.counters().network.packages_received - before == 10'000); // nothing is lost
  const auto told = w.all<read_link>(a);
  REQUIRE(!told.empty());
  CHECK(told.back().wanted);
}

TEST_CASE("a neighbour over its budget is not read until it is within it", "[peis][P2P-03]") {
  world w;
  auto config = test::config_of(1);
  config.network.budget.packages_per_second = 1000;
  const auto a = w.add(config);
  befriend(w, a);
  w.run_for(1s);
  bytes flood;
  for (int i = 0; i < 2000; ++i) {
    const auto one = package_of(header_of(package_type::direct, 20, hostile, a), bytes(8));
    flood.insert(flood.end(), one.begin(), one.end());
  }
  const auto before = w.at(a).counters().network.packages_received;
  const auto handled = [&] { return w.at(a).counters().network.packages_received - before; };
  say(w, a, flood);
  w.run_for(1us);
  CHECK(handled() >= 500);
  CHECK(handled() <= 502);
  w.run_for(500ms);
  CHECK(handled() >= 998);
  CHECK(handled() <= 1004);
  CHECK(w.at(a).counters().network.rests > 0);
  w.run_for(1100ms);
  CHECK(handled() == 2000);
}

TEST_CASE("the table of hosts has a limit and room for others", "[peis][KH-03]") {
  world w;
  const auto a = w.add(1);
  befriend(w, a);
  w.run_for(1s);
  host_record_message told;
  told.cached = true;
  const auto limit = static_cast<std::int32_t>(kernel_config().network.tables.hosts);
  for (std::int32_t i = 0; i < 2 * limit; ++i) {
    told.record.id = peer_id{1000 + i};
    say(w, a, package_of(header_of(package_type::link, port::host_record, hostile), encode(told)));
  }
  w.run_for(1s);
  CHECK(w.at(a).network().hosts.records().size() <= static_cast<std::size_t>(limit / 2 + 2));
  CHECK(w.at(a).counters().network.hosts_refused >= static_cast<std::uint64_t>(limit));
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(5s);
  CHECK(w.at(a).network().reachable(b));
  CHECK(w.all<host_appeared>(a).back().host == b);
  w.perform(a, w.at(a).on_link_closed(hostile_link, w.now()));
  w.run_for(90s);
  CHECK(w.at(a).network().hosts.records().size() == 2); // what cannot be reached is forgotten
}

TEST_CASE("the table of ways has a limit and room for others", "[peis][RTE-01]") {
  routing_table table(peer_id{1}, 7, 30, 100);
  const auto entries = [](std::int32_t first, std::int32_t count) {
    std::vector<routing_entry> all;
    for (std::int32_t i = 0; i < count; ++i)
      all.push_back({peer_id{first + i}, 1, 1, 1, 1});
    return all;
  };
  CHECK(table.on_table(link_id{1}, 1, entries(1000, 500), instant{}).size() == 50);
  CHECK(table.take_refused() == 450);
  CHECK(table.on_table(link_id{2}, 1, entries(2000, 10), instant{}).size() == 10);
  CHECK(table.on_table(link_id{3}, 1, entries(3000, 500), instant{}).size() == 20);
  // Other hosts each time: lost ways make room for them, and not for more.
  for (int i = 0; i < 20; ++i) {
    static_cast<void>(table.on_table(link_id{1}, 1, entries(10'000 + 500 * i, 500), instant{}));
    CHECK(table.routes().size() <= 100);
  }
  CHECK(table.way_to(peer_id{2000}) == link_id{2});
  CHECK(table.on_table(link_id{2}, 1, entries(2000, 12), instant{}).size() >= 2);
}

TEST_CASE("routing tables that come too fast are put off, and the newest counts",
          "[peis][RTE-03]") {
  world w;
  const auto a = w.add(1);
  befriend(w, a);
  w.run_for(1s);
  routing_page page;
  for (std::int32_t i = 0; i < 100; ++i) {
    page.seqno = i;
    page.entries = {{hostile, i, 7, 0, 1}, {peer_id{1000 + i}, i, 7, 1, 1}};
    say(w, a, package_of(header_of(package_type::link, port::routing, hostile), encode(page)));
  }
  CHECK(w.at(a).counters().network.tables_put_off >= 80);
  CHECK_FALSE(w.at(a).network().reachable(peer_id{1099}));
  w.run_for(1s);
  CHECK(w.at(a).network().reachable(peer_id{1099}));
  CHECK_FALSE(w.at(a).network().reachable(peer_id{1000}));
}

TEST_CASE("answers that nobody acknowledges are bounded", "[peis][KH-01]") {
  world w;
  auto config = test::config_of(1);
  config.network.tables.answers = 100;
  const auto a = w.add(config);
  befriend(w, a);
  w.run_for(1s);
  const auto question = encode(host_query{hostile, any_magic});
  for (std::int32_t i = 0; i < 1000; ++i)
    say(w, a, package_of(header_of(package_type::direct, port::host_query, hostile, a), question));
  CHECK(w.at(a).counters().network.questions_refused == 950);
  w.run_for(30s); // they fail, and others are answered
  say(w, a, package_of(header_of(package_type::direct, port::host_query, hostile, a), question));
  CHECK(w.at(a).counters().network.questions_refused == 950);
}

namespace {

/// Fills the links of `to` with others that ask for them, of which each then does `next`.
void hold_all_links(world& w, peer_id to, const std::function<void(link_id, peer_id)>& next) {
  for (std::uint64_t i = 0; i < 64; ++i) {
    const link_id link{2000 + i};
    const peer_id holder{static_cast<std::int32_t>(3000 + i)};
    w.perform(to, w.at(to).on_link_open(link, link_role::acceptor, w.now()));
    const connect_request request{500, holder, connect_request::for_merge, "test"};
    w.perform(to, w.at(to).on_link_octets(link, encode(request), w.now()));
    next(link, holder);
  }
}

bytes record_of(peer_id id) {
  host_record_message told;
  told.record.id = id;
  told.record.magic = 5;
  told.record.host_name = "elsewhere";
  return package_of(header_of(package_type::link, port::host_record, id), encode(told));
}

} // namespace

TEST_CASE("connections that ask for no link take none from others", "[peis][LNK-07][TCP-07]") {
  world w;
  const auto a = w.add(1);
  for (std::uint64_t i = 0; i < 1000; ++i)
    w.perform(a, w.at(a).on_link_open(link_id{5000 + i}, link_role::acceptor, w.now()));
  CHECK(w.at(a).network().links.views().size() == 48);
  CHECK(w.at(a).counters().network.greetings_evicted == 952);
  const auto b = w.add(2);
  w.connect(b, a);
  w.run_for(1s);
  CHECK(w.at(a).network().reachable(b));
  w.run_for(5s);
  CHECK(w.at(a).network().links.views().size() == 1);
}

TEST_CASE("a neighbour that never says who it is makes room for one that does",
          "[peis][TCP-07][LNK-07]") {
  world w;
  const auto a = w.add(1);
  hold_all_links(w, a, [](link_id, peer_id) {});
  w.run_for(6s);
  CHECK(w.at(a).network().links.views().size() == 64);
  const auto b = w.add(2);
  w.connect(b, a);
  w.run_for(1s);
  CHECK(w.at(a).network().reachable(b));
}

TEST_CASE("who finds all links in use is told whom else to ask", "[peis][TCP-07]") {
  world w;
  const auto a = w.add(1);
  hold_all_links(w, a, [&](link_id link, peer_id holder) {
    w.perform(a, w.at(a).on_link_octets(link, record_of(holder), w.now()));
  });
  for (std::uint64_t i = 0; i < 100; ++i) // and there are those that ask for nothing
    w.perform(a, w.at(a).on_link_open(link_id{5000 + i}, link_role::acceptor, w.now()));
  w.run_for(6s);
  for (std::uint64_t i = 0; i < 100; ++i)
    w.perform(a, w.at(a).on_link_open(link_id{6000 + i}, link_role::acceptor, w.now()));
  const auto b = w.add(2);
  w.packages.clear();
  w.connect(b, a);
  w.run_for(1s);
  const auto records = std::ranges::count_if(w.packages, [&](const test::carried& x) {
    return x.from == a && x.header.port == port::host_record;
  });
  CHECK(records == 1); // ours: those of the holders tell no address
  CHECK(w.at(a).counters().network.newcomers_referred == 1);
  CHECK(w.at(a).network().links.views().size() <= 64 + 48);
}

TEST_CASE("a neighbour that is alive speaks for itself over its own link only",
          "[peis][KH-02][P2P-09]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  const auto c = w.add(3);
  w.connect(a, b);
  w.connect(a, c);
  befriend(w, a);
  say(w, a, record_of(hostile));
  w.run_for(10s);
  host_record_message rebirth;
  rebirth.record = *w.at(a).network().hosts.records().at(1);
  REQUIRE(rebirth.record.id == b);
  rebirth.record.magic += 1;
  const auto exit = encode(dead_host_message{b, dead_host_message::reason::route});
  const auto links = w.at(a).counters().network.links_opened;
  for (int i = 0; i < 20; ++i) {
    for (const auto kind : {package_type::link, package_type::broadcast, package_type::direct}) {
      for (const auto hops : {std::uint8_t{1}, std::uint8_t{4}}) {
        auto header = header_of(kind, port::dead_host, b, a);
        header.hops = hops;
        say(w, a, package_of(header, exit));
        header.port = port::host_record;
        say(w, a, package_of(header, encode(rebirth)));
      }
    }
    w.run_for(500ms);
  }
  CHECK(w.all<host_vanished>(a).empty());
  CHECK(w.all<host_vanished>(c).empty()); // nor is it passed on
  CHECK(w.at(a).network().knows_present(b));
  CHECK(w.at(a).counters().network.links_opened == links);
  CHECK(w.at(a).counters().network.claims_refused == 240);

  // A route that lies does not help somebody's memory of what never was.
  const std::vector<routing_entry> ways = {{hostile, 1, 5, 0, 1},
                                           {b, 1'000'000, rebirth.record.magic, 0, 1}};
  for (const auto& page : paginate(ways, 1))
    say(w, a, package_of(header_of(package_type::link, port::routing, hostile), encode(page)));
  rebirth.cached = true;
  for (int i = 0; i < 5; ++i) {
    say(w, a,
        package_of(header_of(package_type::direct, port::host_record, hostile, a),
                   encode(rebirth)));
    w.run_for(1s);
  }
  CHECK(w.all<host_vanished>(a).empty());
  CHECK(w.at(a).network().hosts.records().at(1)->magic != rebirth.record.magic);
  w.perform(b, w.at(b).leave(w.now()));
  w.run_for(1s);
  CHECK_FALSE(w.at(a).network().reachable(b));
}

TEST_CASE("who is behind many ways is asked at a rate", "[peis][KH-01]") {
  world w;
  auto config = test::config_of(1);
  config.network.tables.questions_per_second = 100;
  const auto a = w.add(config);
  befriend(w, a);
  say(w, a, record_of(hostile));
  w.run_for(1s);
  std::vector<routing_entry> ways = {{hostile, 1, 5, 0, 1}};
  for (std::int32_t i = 0; i < 600; ++i)
    ways.push_back({peer_id{5000 + i}, 1, 7, 1, 1});
  const auto sent = [&] { return w.at(a).counters().network.packages_sent; };
  const auto before = sent();
  for (const auto& page : paginate(ways, 1))
    say(w, a, package_of(header_of(package_type::link, port::routing, hostile), encode(page)));
  CHECK(w.at(a).network().reachable(peer_id{5599}));
  w.run_for(100ms);
  CHECK(sent() - before >= 100);
  CHECK(sent() - before <= 130);
  w.run_for(10s); // none is left out
  CHECK(sent() - before >= 600);
}

TEST_CASE(
    "what is announced is dialled in the listed networks only, and a few of one sender at a time",
    "[peis][TCP-03][security]") {
  auto* const address_of = GENERATE(&tcp_address, &udp_interface);
  auto config = test::lan_config_of(1);
  config.network.addresses = {tcp_address("eth0", false, {10, 0, 0, 1}, 8000),
                              udp_interface("eth0", false, {10, 0, 0, 1}, 8000)};
  config.network.connections.networks = {{{10, 0, 0, 0}, 8}};
  kernel self(config, random_stream(1), instant{});
  std::map<std::string, std::size_t> dialled; // by the network
  const auto count = [&](const outputs& all, instant at) {
    for (const auto& x : all)
      if (const auto* wanted = std::get_if<connect_to>(&x)) {
        ++dialled[wanted->url.substr(6, 4)];
        static_cast<void>(self.on_attempt_failed(wanted->attempt, at));
      }
  };
  const auto announce = [&](int id, std::array<std::uint8_t, 4> address, ipv4_address from,
                            instant at) {
    host_record other;
    other.id = peer_id{id};
    other.magic = id;
    other.host_name = "h" + std::to_string(id);
    other.cluster = id;
    other.addresses = {address_of("eth0", false, address, 8000)};
    count(self.on_announcement(encode(announcement{protocol_version, "test", other}), at, from),
          at);
  };
  int id = 100;
  for (instant at{}; at < instant{60s}; at += 100ms) {
    const auto low = static_cast<std::uint8_t>(id % 250 + 1);
    announce(++id, {192, 168, 1, low}, {10, 0, 0, 66}, at);
    announce(++id, {10, 66, 0, low}, {10, 0, 0, 66}, at);
    if (at == instant{40s})
      announce(++id, {10, 77, 0, 1}, {10, 0, 0, 77}, at);
    count(self.on_time(at), at);
  }
  CHECK(dialled["192."] == 0);
  CHECK(self.counters().network.announcements_foreign == 600);
  CHECK(dialled["10.6"] >= 10);
  CHECK(dialled["10.6"] <= 25); // not two a second
  CHECK(dialled["10.7"] >= 1);  // another sender's are followed all the same
}

} // namespace rubicon::peis
