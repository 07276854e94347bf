// Many kernels on one network: they find each other, stay together and notice who is gone.
#include <algorithm>
#include <deque>
#include <iterator>
#include <set>

#include "peis/wire/announcement.hpp"
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis::test {
namespace {

std::size_t links_of(world& w, peer_id id) {
  std::set<peer_id> neighbours;
  for (const auto& x : w.at(id).network().links.views()) {
    if (x.neighbour)
      neighbours.insert(*x.neighbour);
  }
  return neighbours.size();
}

bool all_reachable(world& w) {
  const auto ids = w.peers();
  return std::all_of(ids.begin(), ids.end(), [&](peer_id a) {
    return !w.alive(a) || std::all_of(ids.begin(), ids.end(), [&](peer_id b) {
      return !w.alive(b) || w.at(a).network().reachable(b);
    });
  });
}

bool all_known(world& w) {
  const auto ids = w.peers();
  return std::all_of(ids.begin(), ids.end(), [&](peer_id a) {
    std::set<peer_id> known;
    for (const auto* host : w.at(a).network().hosts.records())
      known.insert(host->id);
    return !w.alive(a) || std::all_of(ids.begin(), ids.end(),
                                      [&](peer_id b) { return !w.alive(b) || known.contains(b); });
  });
}

/// Runs until `done`, at most as long. @returns how long it took
template <class Condition>
duration run_until(world& w, duration at_most, Condition done) {
  const auto start = w.now();
  while (!done() && w.now() - start < at_most)
    w.run_for(100ms);
  return w.now() - start;
}

/// Longest way in links between any two peers.
std::size_t diameter(world& w) {
  std::size_t longest = 0;
  for (const auto start : w.peers()) {
    std::map<peer_id, std::size_t> distance{{start, 0}};
    std::vector<peer_id> open{start};
    for (std::size_t i = 0; i < open.size(); ++i) {
      for (const auto& x : w.at(open[i]).network().links.views()) {
        if (x.neighbour && distance.emplace(*x.neighbour, distance[open[i]] + 1).second)
          open.push_back(*x.neighbour);
      }
    }
    for (const auto& [id, hops] : distance)
      longest = std::max(longest, hops);
  }
  return longest;
}

std::uint64_t opened(world& w) {
  std::uint64_t sum = 0;
  for (const auto id : w.peers())
    sum += w.at(id).counters().network.links_opened;
  return sum / 2;
}

} // namespace

TEST_CASE("thirty peers on one network settle into a small, stable mesh",
          "[peis][CM-01][CM-06][CM-07][CM-08][CLU-01]") {
  const auto seed = GENERATE(1, 2);
  world w(static_cast<std::uint64_t>(seed));
  for (int i = 1; i <= 30; ++i)
    w.add(lan_config_of(i));
  const auto joined = run_until(w, 60s, [&] { return all_reachable(w) && all_known(w); });
  CHECK(joined < 5s);
  w.run_for(60s - joined);
  CHECK(diameter(w) <= 3);
  for (const auto id : w.peers()) {
    INFO("peer " << id.value);
    CHECK(links_of(w, id) >= 3);
    CHECK(links_of(w, id) <= 7);
    CHECK(w.at(id).network().hosts.records().front()->cluster == 1);
  }
  const auto before = opened(w);
  w.run_for(3min);
  CHECK(opened(w) - before < 3); // less than one change a minute
}

TEST_CASE("twenty peers of one host know each other within three seconds", "[peis][TCP-03]") {
  world w;
  for (int i = 1; i <= 20; ++i) {
    auto config = lan_config_of(i);
    config.network.host_name = "pc";
    w.add(config);
  }
  CHECK(run_until(w, 10s, [&] { return all_reachable(w) && all_known(w); }) < 3s);
  std::uint64_t announced = 0;
  w.run_for(20s);
  for (const auto id : w.peers())
    announced += w.at(id).counters().network.announcements_sent;
  CHECK(announced < 20 * (3 + 2) + 23); // after three, one of them speaks for all
}

TEST_CASE("a parted network comes together again", "[peis][CLU-02]") {
  const auto seed = GENERATE(1, 2, 3);
  world w(static_cast<std::uint64_t>(seed));
  for (int i = 1; i <= 12; ++i)
    w.add(lan_config_of(i));
  w.run_for(20s);
  REQUIRE(all_reachable(w));
  w.separated = [](peer_id a, peer_id b) { return (a.value <= 6) != (b.value <= 6); };
  w.run_for(30s);
  CHECK(w.at(peer_id{8}).network().hosts.records().size() == 6); // the others are gone
  CHECK(w.at(peer_id{8}).network().hosts.records().front()->cluster !=
        w.at(peer_id{1}).network().hosts.records().front()->cluster);
  w.separated = nullptr;
  CHECK(run_until(w, 20s, [&] { return all_reachable(w) && all_known(w); }) < 10s);
}

TEST_CASE("a parted network without announcements comes together again", "[peis][CLU-02][TCP-07]") {
  world w;
  for (int i = 1; i <= 6; ++i) {
    auto config = lan_config_of(i);
    config.network.connections.announces = false;
    if (i > 1)
      config.network.connections.seeds = {"inproc://1"};
    w.add(config);
  }
  CHECK(run_until(w, 20s, [&] { return all_reachable(w) && all_known(w); }) < 10s);
  w.run_for(10s);
  w.separated = [](peer_id a, peer_id b) { return (a.value <= 3) != (b.value <= 3); };
  w.run_for(30s);
  CHECK(w.at(peer_id{4}).network().hosts.records().size() == 3);
  w.separated = nullptr;
  CHECK(run_until(w, 60s, [&] { return all_reachable(w) && all_known(w); }) < 20s);
}

TEST_CASE("leaves keep to their master and come back to it", "[peis][LEA-01][LEA-03][AUT-01]") {
  world w;
  w.add(lan_config_of(1));
  for (int i = 2; i <= 21; ++i) {
    auto config = config_of(i);
    config.network.connections.leaf = true;
    config.network.connections.always = {"inproc://1"};
    w.add(config);
  }
  w.run_for(30s);
  CHECK(all_reachable(w));
  CHECK(all_known(w));
  for (const auto id : w.peers())
    CHECK(links_of(w, id) == (id == peer_id{1} ? 20U : 1U));
  w.kill(peer_id{1});
  w.run_for(7s);
  CHECK(!w.at(peer_id{2}).network().reachable(peer_id{3}));
  w.restart(peer_id{1});
  CHECK(run_until(w, 60s, [&] { return all_reachable(w); }) < 32s);
}

TEST_CASE("leaves whose master is off are tried ever more rarely, of each machine one at a time",
          "[peis][CM-10][LEA-01]") {
  world w;
  const peer_id other{2};
  for (int i = 1; i <= 22; ++i) {
    auto config = lan_config_of(i);
    if (i > 1)
      config.network.host_name = "the other";
    if (i > 2) {
      config.network.connections.leaf = true;
      config.network.connections.announces = false;
      config.network.connections.always = {"inproc://2"};
    }
    w.add(config);
  }
  const auto tries = [&w] { // in vain
    std::size_t count = 0;
    for (int i = 3; i <= 22; ++i)
      for (const auto& x : w.all<close_link>(peer_id{i}))
        count += x.why == close_cause::leaf ? 1 : 0;
    return count;
  };
  w.run_for(1min);
  REQUIRE(all_reachable(w));
  w.kill(other);
  w.run_for(90s);
  const auto before = tries();
  CHECK(before > 20); // each may be one that takes links
  w.run_for(6min);
  CHECK(tries() - before >= 6min / 30s - 2);
  CHECK(tries() - before <= 6min / 30s + 2);
  w.restart(other);
  CHECK(run_until(w, 60s, [&] { return all_reachable(w); }) < 32s);
}

TEST_CASE("a leaf takes no links from other hosts", "[peis][LEA-01]") {
  world w;
  w.add(lan_config_of(1));
  auto leaf = config_of(2);
  leaf.network.connections.leaf = true;
  leaf.network.connections.always = {"inproc://1"};
  leaf.network.addresses.push_back(tcp_address("eth0", false, {10, 0, 0, 2}, 8000));
  leaf.network.addresses.push_back(tcp_address("lo", true, {127, 0, 0, 1}, 8000));
  w.add(leaf);
  auto roommate = config_of(3);
  roommate.network.host_name = leaf.network.host_name;
  roommate.network.connections.always = {"inproc://2"};
  w.add(roommate);
  auto stranger = config_of(4);
  stranger.network.connections.always = {"inproc://2"};
  w.add(stranger);
  w.run_for(60s);
  CHECK(links_of(w, peer_id{2}) == 2);
  CHECK(w.at(peer_id{2}).counters().network.links_refused > 0);
  const auto causes = w.all<close_link>(peer_id{2});
  REQUIRE_FALSE(causes.empty());
  CHECK(std::ranges::all_of(causes, [](const auto& x) { return x.why == close_cause::leaf; }));
  const auto hosts =
      w.at(peer_id{1}).network().hosts.records(); // nobody is told where to come from elsewhere
  const auto told = std::ranges::find(hosts, peer_id{2}, &host_record::id);
  REQUIRE(told != hosts.end());
  CHECK(std::ranges::all_of((*told)->addresses, &low_level_address::loopback));
  CHECK((*told)->addresses.size() == 1);
}

TEST_CASE("a silent death is noticed by neighbours and far away", "[peis][KH-05][RTE-07]") {
  world w;
  w.add_line(7);
  w.connect(peer_id{4}, peer_id{6}); // a cycle, in which stale ways could go round
  w.connect(peer_id{4}, peer_id{7});
  w.run_for(20s);
  REQUIRE(all_reachable(w));
  w.power_off(peer_id{7});
  w.run_for(5s);
  CHECK(!w.at(peer_id{6}).network().reachable(peer_id{7}));
  w.run_for(10s);
  for (int i = 1; i <= 6; ++i) {
    INFO("peer " << i);
    CHECK(!w.at(peer_id{i}).network().reachable(peer_id{7}));
    CHECK(w.at(peer_id{i}).network().hosts.records().size() == 6);
  }
}

TEST_CASE("a closed link does not cut off what another way leads to", "[peis][RTE-05]") {
  world w;
  for (int i = 1; i <= 6; ++i) {
    auto config = config_of(i);
    config.network.connections.manager = false;
    w.add(config);
  }
  std::map<int, link_id> ring;
  for (int i = 1; i <= 6; ++i)
    ring[i] = w.connect(peer_id{i}, peer_id{i % 6 + 1});
  w.run_for(25s);
  w.clear_logs();
  w.cut(ring[3]);
  w.run_for(60s);
  CHECK(all_reachable(w));
  for (const auto id : w.peers())
    CHECK(w.all<host_vanished>(id).empty());
}

TEST_CASE("five hundred peers that know one of them know each other soon",
          "[peis][TCP-07][.large]") {
  world w;
  for (int i = 1; i <= 500; ++i) {
    auto config = lan_config_of(i);
    config.network.connections.announces = false;
    if (i > 1)
      config.network.connections.seeds = {"inproc://1"};
    w.add(config);
  }
  CHECK(run_until(w, 60s, [&] { return all_reachable(w) && all_known(w); }) < 30s);
}

TEST_CASE("a referral leads on when a peer is full", "[peis][TCP-07]") {
  world w;
  for (int i = 1; i <= 20; ++i) {
    auto config = lan_config_of(i);
    config.network.connections.announces = false;
    config.network.links_max = 6;
    if (i > 1)
      config.network.connections.seeds = {"inproc://1"};
    w.add(config);
  }
  CHECK(run_until(w, 60s, [&] { return all_reachable(w) && all_known(w); }) < 30s);
  for (const auto id : w.peers())
    CHECK(links_of(w, id) <= 6);
}

TEST_CASE("two links between the same peers become one, and stay one", "[peis][CM-11]") {
  world w;
  w.add(lan_config_of(1));
  w.add(lan_config_of(2));
  w.connect(peer_id{1}, peer_id{2});
  w.connect(peer_id{2}, peer_id{1});
  w.run_for(10s);
  CHECK(w.at(peer_id{1}).network().links.views().size() == 1);
  const auto link = w.at(peer_id{1}).network().links.views().front().link;
  w.run_for(2min);
  REQUIRE(w.at(peer_id{1}).network().links.views().size() == 1);
  CHECK(w.at(peer_id{1}).network().links.views().front().link == link);
}

TEST_CASE("much traffic to a host forces a link to it", "[peis][CM-03][CM-02]") {
  world w;
  for (int i = 1; i <= 4; ++i) {
    auto config = i == 2 || i == 3 ? config_of(i) : lan_config_of(i);
    config.network.connections.announces = false;
    config.network.connections.announces = false;
    config.network.connections.links_min = 0;
    config.network.connections.links_suitable = 0;
    w.add(config);
  }
  for (int i = 1; i < 4; ++i)
    w.connect(peer_id{i}, peer_id{i + 1});
  w.separated = [](peer_id a, peer_id b) { return std::abs(a.value - b.value) > 1; };
  w.run_for(5s);
  w.separated = nullptr;
  REQUIRE(w.at(peer_id{1}).network().routes.routes().find(peer_id{4})->hops == 6);
  for (int i = 0; i < 150; ++i) {
    w.perform(peer_id{1},
              w.at(peer_id{1})
                  .messages()
                  .send(peer_id{4}, 30, bytes(600), true, priority::normal, no_request, w.now()));
    w.run_for(100ms);
  }
  CHECK(w.at(peer_id{1}).network().routes.routes().find(peer_id{4})->hops == 2);
}

TEST_CASE("a trace names the peers on the way and back", "[peis][API-12]") {
  world w;
  w.add_line(5);
  w.run_for(5s);
  w.perform(peer_id{1}, w.at(peer_id{1}).messages().trace(peer_id{5}, request_id{7}, w.now()));
  w.perform(peer_id{1}, w.at(peer_id{1}).messages().trace(peer_id{99}, request_id{8}, w.now()));
  w.run_for(1s);
  const auto told = w.all<traced>(peer_id{1});
  REQUIRE(told.size() == 2);
  CHECK(told[0].request == request_id{8});
  CHECK(told[0].route.empty());
  CHECK(told[1].request == request_id{7});
  std::vector<peer_id> expected;
  for (const int i : {1, 2, 3, 4, 5, 4, 3, 2, 1})
    expected.emplace_back(i);
  CHECK(told[1].route == expected);
}

TEST_CASE("an answer is for every question about its peer", "[peis][API-12]") {
  world w;
  w.add(config_of(1));
  w.add(config_of(2));
  w.connect(peer_id{1}, peer_id{2});
  w.run_for(2s);
  bool lossy = true;
  w.keep = [&](const package_header& x) { return !lossy || x.port != port::trace; };
  w.perform(peer_id{1}, w.at(peer_id{1}).messages().trace(peer_id{2}, request_id{1}, w.now()));
  w.run_for(1s);
  lossy = false;
  w.perform(peer_id{1}, w.at(peer_id{1}).messages().trace(peer_id{2}, request_id{2}, w.now()));
  w.run_for(1s);
  const auto told = w.all<traced>(peer_id{1});
  REQUIRE(told.size() == 2);
  CHECK(told[1].request == request_id{2});
  CHECK(told[1].route.size() == 3);
}

TEST_CASE("others learn where a peer listens when its networks change", "[peis][LNK-03][TCP-03]") {
  world w;
  w.add_line(3); // the third has no link to the first, and hears no announcements
  w.add(lan_config_of(4));
  w.add(lan_config_of(5));
  w.run_for(10s);
  const std::vector moved{tcp_address("eth1", false, {10, 1, 0, 9}, 8000)};
  const auto knows = [&](int who, int whom) {
    const auto hosts = w.at(peer_id{who}).network().hosts.records();
    return std::ranges::any_of(
        hosts, [&](const auto* x) { return x->id == peer_id{whom} && x->addresses == moved; });
  };
  for (const int whom : {1, 4})
    w.perform(peer_id{whom}, w.at(peer_id{whom}).set_addresses(moved, w.now()));
  w.run_for(2s);
  CHECK(knows(2, 1));                                                    // over their link
  CHECK(knows(5, 4));                                                    // as announced
  w.perform(peer_id{1}, w.at(peer_id{1}).set_addresses(moved, w.now())); // no news
}

TEST_CASE("two computers of one name find each other at their network addresses",
          "[peis][RTE-08]") {
  auto config = lan_config_of(1);
  config.network.host_name = "raspberrypi";
  config.network.addresses = {tcp_address("lo", true, {127, 0, 0, 1}, 8000),
                              tcp_address("eth0", false, {10, 0, 0, 1}, 8000)};
  host_record other;
  other.id = peer_id{2};
  other.magic = 77;
  other.host_name = config.network.host_name;
  other.full_name = "robot@raspberrypi!5";
  other.marked = true;
  other.cluster = 2;
  other.addresses = {tcp_address("lo", true, {127, 0, 0, 1}, 8000),
                     tcp_address("eth0", false, {10, 0, 0, 2}, 8000)};
  const bool is_here = GENERATE(false, true); // a peer of our own that has lost its port to us
  if (is_here)
    other.addresses[1] = tcp_address("eth0", false, {10, 0, 0, 1}, 8001);
  kernel self(config, random_stream(1), instant{});
  std::vector<std::string> tried;
  std::size_t told = 0;
  std::map<link_id, link_id> ends; // of links to ourselves: that is who answers there
  std::uint64_t links = 0;
  std::deque<output> todo;
  const auto take = [&todo](outputs x) { std::ranges::move(x, std::back_inserter(todo)); };
  const auto carry_out = [&](output& x, instant at) {
    told += std::holds_alternative<namesake_found>(x) ? 1 : 0;
    if (const auto* octets = std::get_if<to_link>(&x); octets && ends.contains(octets->link)) {
      take(self.on_link_octets(ends.at(octets->link), octets->octets.view(), at));
    } else if (const auto* closed = std::get_if<close_link>(&x)) {
      if (const auto end = ends.extract(closed->link))
        take(self.on_link_closed(end.mapped(), at));
    } else if (const auto* wanted = std::get_if<connect_to>(&x)) {
      tried.push_back(wanted->url);
      if (wanted->url.find("127.0.0.1") == std::string::npos)
        return;
      const link_id from{++links};
      const link_id to{++links};
      ends = {{from, to}, {to, from}};
      take(self.on_link_open(to, link_role::acceptor, at));
      take(self.on_link_open(from, link_role::initiator, at, wanted->attempt));
    }
  };
  for (instant at{}; at < instant{20s}; at += 100ms) {
    if (at.time_since_epoch() % 1s == 0s)
      take(self.on_announcement(
          encode(announcement{protocol_version, config.network.network, other}), at));
    take(self.on_time(at));
    for (; !todo.empty(); todo.pop_front()) {
      auto x = std::move(todo.front());
      carry_out(x, at);
    }
  }
  REQUIRE(tried.size() > 1);
  CHECK(tried.front() == "tcp://127.0.0.1:8000");
  CHECK(tried.back() == (is_here ? "tcp://127.0.0.1:8000" : "tcp://10.0.0.2:8000"));
  CHECK(told == (is_here ? 0 : 1));
}

TEST_CASE("a peer hears once that another one has its id", "[peis][RTE-08]") {
  world w;
  w.add(lan_config_of(1));
  w.run_for(1s);
  auto twin = lan_config_of(1);
  twin.network.name = "twin";
  kernel other(twin, random_stream(9, "twin"), w.now());
  for (int i = 0; i < 3; ++i) {
    for (const auto& x : other.on_time(w.now() + i * 1s)) {
      if (const auto* news = std::get_if<announce>(&x))
        w.perform(peer_id{1}, w.at(peer_id{1}).on_announcement(news->octets.view(), w.now()));
    }
  }
  const auto told = w.all<id_taken>(peer_id{1});
  REQUIRE(told.size() == 1);
  CHECK(told[0].by.starts_with("twin@"));
  CHECK(w.at(peer_id{1}).counters().network.duplicate_id == 3);
}

TEST_CASE("who has just come is answered before there are routes to it", "[peis][P2P-09]") {
  world w;
  for (int i = 1; i <= 4; ++i)
    w.add(config_of(i));
  w.connect(peer_id{1}, peer_id{2});
  w.run_for(5s);
  w.perform(peer_id{1}, w.at(peer_id{1}).tuples().set("x", text_content("1"), w.now()));
  w.connect(peer_id{4}, peer_id{2}); // routes are told: those to the next one wait a while
  w.run_for(50ms);
  w.connect(peer_id{3}, peer_id{2});
  w.run_for(50ms);
  REQUIRE(w.at(peer_id{3}).network().reachable(peer_id{1}));
  w.perform(
      peer_id{3},
      w.at(peer_id{3}).subscriptions().subscribe(peer_id{1}, "x", subscription_id{1}, w.now()));
  w.run_for(50ms);
  CHECK_FALSE(w.at(peer_id{1}).network().reachable(peer_id{3}));
  CHECK(w.all<tuple_changed>(peer_id{3}).size() == 1);
}

TEST_CASE("clocks of peers agree after three periods, however far the way",
          "[peis][CLK-06][CLK-07]") {
  world w;
  for (int i = 1; i <= 10; ++i) {
    auto config = config_of(i);
    config.network.connections.manager = false;
    config.network.clock_offset += (i * 7 % 11 - 5) * 1s;
    w.add(config);
  }
  for (int i = 1; i < 10; ++i)
    w.connect(peer_id{i}, peer_id{i + 1}, 3ms);
  w.run_for(16s);
  auto least = w.at(peer_id{1}).network().clock.offset();
  auto most = least;
  for (const auto id : w.peers()) {
    least = std::min(least, w.at(id).network().clock.offset());
    most = std::max(most, w.at(id).network().clock.offset());
  }
  CHECK(most - least < 1ms);
  CHECK(least > 1'000'000'004s + 999ms); // the fastest clock's
  CHECK(most < 1'000'000'005s + 5ms);
  std::uint64_t told = 0;
  w.clear_logs();
  w.run_for(60s);
  for (const auto& x : w.packages)
    told += x.header.port == port::clock && x.header.hops == 1;
  CHECK(told <= 31); // one of them speaks, to one neighbour
}

TEST_CASE("a step of the clock moves no deadline", "[peis][SCH-07]") {
  world w;
  w.add(lan_config_of(1));
  w.add(lan_config_of(2));
  w.run_for(5s);
  w.perform(
      peer_id{2},
      w.at(peer_id{2}).subscriptions().subscribe(peer_id{1}, "a", subscription_id{1}, w.now()));
  w.run_for(1s);
  w.perform(peer_id{1}, w.at(peer_id{1}).step_clock(60s, w.now()));
  w.run_for(10s);
  CHECK(w.at(peer_id{1}).reader().has_subscriber("a"));
  CHECK(w.at(peer_id{1}).counters().network.links_broken == 0);
  CHECK(w.at(peer_id{2}).network().clock.offset() > 1'000'000'059s + 990ms);
}

} // namespace rubicon::peis::test
