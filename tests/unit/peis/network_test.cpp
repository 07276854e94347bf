// Lines and rings of kernels.
#include "peis/wire/dead_host.hpp"
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis {
namespace {

using test::world;

std::vector<peer_id> line(world& w, int count) {
  std::vector<peer_id> peers;
  for (int i = 1; i <= count; ++i)
    peers.push_back(w.add(i * 10));
  for (std::size_t i = 1; i < peers.size(); ++i)
    w.connect(peers[i - 1], peers[i]);
  return peers;
}

std::vector<peer_id> ring(world& w, int count) {
  auto peers = line(w, count);
  w.connect(peers.back(), peers.front());
  return peers;
}

std::string last_text(world& w, peer_id at, peer_id owner, std::string_view name) {
  const auto x = w.at(at).reader().find(owner, name);
  return x == nullptr ? "none" : std::string(x->text());
}

void set(world& w, peer_id who, std::string_view name, std::string_view text) {
  w.perform(who, w.at(who).tuples().set(name, text_content(text), w.now()));
}

void subscribe(world& w, peer_id who, peer_id owner, std::string_view pattern,
               std::uint64_t id = 1) {
  w.perform(who, w.at(who).subscriptions().subscribe(owner, pattern, subscription_id{id}, w.now()));
}

} // namespace

TEST_CASE("everybody knows everybody soon, by routes and records", "[peis][RTE-05][KH-01]") {
  const bool closed = GENERATE(false, true);
  world w;
  const auto peers = closed ? ring(w, 6) : line(w, 6);
  w.run_for(4s); // well before one routing period
  for (const auto at : peers) {
    CHECK(w.at(at).network().hosts.records().size() == 6);
    CHECK(w.all<host_appeared>(at).size() == 5);
    for (const auto other : peers)
      CHECK(w.at(at).network().reachable(other));
  }
}

TEST_CASE("tuples cross a line of three, subscribed before or after", "[peis][TUP-08][P2P-01]") {
  world w;
  const auto peers = line(w, 3);
  w.run_for(3s);
  set(w, peers[0], "before", "1");
  subscribe(w, peers[2], peers[0], "before", 1);
  subscribe(w, peers[2], any_peer, "*", 2);
  w.run_for(1s);
  set(w, peers[0], "after", "2");
  w.run_for(1s);
  CHECK(last_text(w, peers[2], peers[0], "before") == "1");
  CHECK(last_text(w, peers[2], peers[0], "after") == "2");
  w.perform(peers[2], w.at(peers[2]).tuples().set_remote(peers[0], "after", text_content("3"),
                                                         request_id{9}, w.now()));
  w.run_for(1s);
  CHECK(w.all<outcome>(peers[2]).at(0).success);
  CHECK(last_text(w, peers[2], peers[0], "after") == "3");
}

TEST_CASE("a late joiner's tuples arrive by an older subscription", "[peis][TUP-11]") {
  world w;
  const auto peers = line(w, 3);
  subscribe(w, peers[0], any_peer, "door.*");
  w.run_for(30s);
  const auto late = w.add(99);
  set(w, late, "door.state", "open");
  w.connect(late, peers[2]);
  w.run_for(3s);
  CHECK(last_text(w, peers[0], late, "door.state") == "open");
}

TEST_CASE("a ring heals when a link is cut, and again when it returns", "[peis][RTE-06]") {
  world w;
  auto peers = line(w, 5);
  const auto closing = w.connect(peers[4], peers[0]);
  subscribe(w, peers[4], peers[0], "x");
  w.run_for(3s);
  set(w, peers[0], "x", "1");
  w.run_for(1s);
  CHECK(last_text(w, peers[4], peers[0], "x") == "1");
  w.cut(closing);
  set(w, peers[0], "x", "2");
  w.run_for(5s);
  CHECK(last_text(w, peers[4], peers[0], "x") == "2");
  w.connect(peers[0], peers[4]);
  w.run_for(2s);
  set(w, peers[0], "x", "3");
  w.run_for(2s);
  CHECK(last_text(w, peers[4], peers[0], "x") == "3");
  CHECK(w.all<host_vanished>(peers[4]).empty());
}

TEST_CASE("a cut line loses its far end after a while and finds it again",
          "[peis][RTE-07][TUP-19]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  const auto c = w.add(3);
  w.connect(a, b);
  const auto far_link = w.connect(b, c);
  subscribe(w, a, c, "x");
  set(w, c, "x", "1");
  w.run_for(3s);
  CHECK(last_text(w, a, c, "x") == "1");
  w.cut(far_link);
  w.run_for(1s);
  CHECK(!w.at(a).network().reachable(c));
  w.run_for(45s);
  CHECK(w.all<host_vanished>(a).size() == 1);
  CHECK(last_text(w, a, c, "x") == "none");
  CHECK(w.all<tuple_deleted>(a).size() == 1);
  set(w, c, "x", "2");
  w.connect(c, b);
  w.run_for(25s);
  CHECK(last_text(w, a, c, "x") == "2");
}

TEST_CASE("a peer that exits is gone everywhere within a second", "[peis][KH-04][RTE-09]") {
  world w;
  const auto peers = ring(w, 5);
  subscribe(w, peers[2], peers[0], "x");
  set(w, peers[0], "x", "1");
  w.run_for(5s);
  w.perform(peers[0], w.at(peers[0]).leave(w.now()));
  w.run_for(1s);
  for (std::size_t i = 1; i < peers.size(); ++i) {
    CHECK(!w.at(peers[i]).network().reachable(peers[0]));
    CHECK(w.at(peers[i]).network().hosts.records().size() == 4);
  }
  CHECK(last_text(w, peers[2], peers[0], "x") == "none");
  w.run_for(60s);
  CHECK(w.all<host_vanished>(peers[2]).size() == 1);
  CHECK(w.all<host_appeared>(peers[2]).size() == 4); // nobody has brought it back
  const auto refused = w.at(peers[0]).tuples().set("x", text_content("2"), w.now(), request_id{1});
  CHECK(std::get<outcome>(refused.at(0)).why == cause::left);
}

TEST_CASE("nobody but a host itself says that it exits", "[peis][KH-04]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  const auto c = w.add(3);
  w.connect(a, b);
  const auto link = w.connect(b, c);
  w.run_for(5s);
  const auto say = [&](peer_id host, std::int32_t id) {
    const auto data = encode(dead_host_message{host, dead_host_message::reason::route});
    package_header header;
    header.id = header.ack_id = id;
    header.type = package_type::broadcast;
    header.port = port::dead_host;
    header.source = c;
    header.length = static_cast<std::uint16_t>(data.size());
    bytes octets;
    encode(header, octets);
    octets.insert(octets.end(), data.begin(), data.end());
    w.perform(b, w.at(b).on_link_octets(link, octets, w.now()));
    w.run_for(1s);
  };
  say(a, 1'000'000);
  CHECK(w.at(b).network().reachable(a));
  CHECK(w.all<host_vanished>(b).empty());
  CHECK(w.at(b).counters().network.malformed == 1);
  say(c, 1'000'001);
  CHECK(w.all<host_vanished>(b).size() == 1);
}

TEST_CASE("a restarted peer is met anew and subscribed to again", "[peis][RTE-08][TUP-10]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  const auto c = w.add(3);
  w.connect(a, b);
  const auto far_link = w.connect(b, c);
  subscribe(w, a, c, "x");
  set(w, c, "x", "old");
  w.run_for(20s);
  w.cut(far_link);
  w.restart(c);
  set(w, c, "x", "new");
  w.connect(c, b);
  w.run_for(5s);
  CHECK(last_text(w, a, c, "x") == "new");
  CHECK(w.all<host_vanished>(a).size() == 1);
  CHECK(w.all<host_appeared>(a).size() == 3);
}

TEST_CASE("a broadcast reaches everybody in a ring once and stops", "[peis][API-07][P2P-07]") {
  world w;
  const auto peers = ring(w, 5);
  w.run_for(3s);
  for (const auto id : peers)
    w.at(id).messages().hook_port(30);
  w.packages.clear();
  w.perform(peers[0], w.at(peers[0]).messages().broadcast(30, bytes{1, 2}, request_id{1}, w.now()));
  w.run_for(1s);
  CHECK(w.all<message>(peers[0]).empty());
  for (std::size_t i = 1; i < peers.size(); ++i) {
    const auto got = w.all<message>(peers[i]);
    REQUIRE(got.size() == 1);
    CHECK(got[0].broadcast);
    CHECK(got[0].source == peers[0]);
  }
  std::size_t sent = 0;
  for (const auto& x : w.packages)
    sent += x.header.port == 30 ? 1 : 0;
  CHECK(sent == 6); // five links, one of them in both directions
}

TEST_CASE("a message passes 14 links and not 15", "[peis][P2P-08]") {
  world w;
  const auto peers = line(w, 16);
  w.run_for(30s);
  for (const auto id : peers)
    w.at(id).messages().hook_port(30);
  w.perform(peers[0], w.at(peers[0]).messages().broadcast(30, bytes{1}, no_request, w.now()));
  w.run_for(1s);
  CHECK(w.all<message>(peers[14]).size() == 1);
  CHECK(w.all<message>(peers[15]).empty());
  CHECK(w.at(peers[14]).counters().network.hops > 0);
}

TEST_CASE("the same seed gives the same packages", "[peis][determinism]") {
  const auto run = [](std::uint64_t seed) {
    world w(seed);
    const auto peers = ring(w, 5);
    subscribe(w, peers[3], any_peer, "");
    w.run_for(30s);
    std::vector<std::int32_t> ids;
    for (const auto& x : w.packages)
      ids.push_back(x.header.id);
    return ids;
  };
  CHECK(run(1) == run(1));
  CHECK(run(1) != run(2));
}

TEST_CASE("a host that cannot be linked to is tried ever more rarely, once a period at most",
          "[peis][CM-10]") {
  world w;
  for (const int id : {10, 20, 30}) {
    auto config = test::lan_config_of(id);
    config.network.connections.announces = false;
    w.add(config);
  }
  const peer_id near{10};
  const peer_id deaf{30};
  std::vector<instant> tries;
  w.separated = [&](peer_id from, peer_id to) {
    if (from == near && to == deaf)
      tries.push_back(w.now());
    return (from == near && to == deaf) || (from == deaf && to == near);
  };
  w.connect(near, peer_id{20});
  w.connect(peer_id{20}, deaf);
  w.run_for(10min);
  REQUIRE(w.at(near).network().reachable(deaf)); // known, and wanted: it has one link of three
  REQUIRE(tries.size() > 10);
  const auto gap = [&](std::size_t i) { return tries[i + 1] - tries[i]; };
  for (std::size_t i = 0; i + 1 < tries.size(); ++i)
    CHECK(gap(i) >= 3s); // the manager's period
  CHECK(gap(0) < 15s);
  CHECK(gap(tries.size() - 2) >= 30s);
  CHECK(tries.size() < 40);
}

TEST_CASE("a changed cluster is announced at once", "[peis][CLU-03]") {
  world w;
  const auto high = w.add(test::lan_config_of(50));
  auto quiet = test::config_of(30);
  quiet.network.connections.manager = false;
  const auto low = w.add(quiet);
  w.run_for(10s);
  const auto said = [&] { return w.at(high).counters().network.announcements_sent; };
  for (const auto before = said(); said() == before;) // the next regular one is a second away
    w.run_for(1ms);
  const auto before = said();
  const auto cluster = [&] {
    for (const auto* host : w.at(high).network().hosts.records()) {
      if (host->id == high)
        return host->cluster;
    }
    return 0;
  };
  CHECK(cluster() == high.value);
  w.connect(low, high);
  const auto begun = w.now();
  while (cluster() != low.value && w.now() < begun + 500ms)
    w.run_for(1ms);
  REQUIRE(cluster() == low.value);
  w.run_for(100ms);
  REQUIRE(w.now() < begun + 800ms);
  CHECK(said() == before + 1);
}

} // namespace rubicon::peis
