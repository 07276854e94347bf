// Restarts, partitions and stale memories: everybody is known as it is now, within seconds.
#include <algorithm>
#include <string>
#include <vector>

#include "peis/wire/host_query.hpp"
#include "peis/wire/link_url.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis::test {
namespace {

/// A link that each of its ends but the first keeps up.
using wires = std::vector<std::pair<int, int>>;

wires shape_of(std::string_view name, int count) {
  wires all;
  for (int i = 2; i <= count; ++i)
    all.emplace_back(i, name == "star" ? 1 : name == "tree" ? i / 2 : i - 1);
  if (name == "ring")
    all.emplace_back(1, count);
  return all;
}

void build(world& w, const wires& shape, int count) {
  for (int i = 1; i <= count; ++i) {
    auto config = config_of(i);
    config.network.connections.manager = false;
    for (const auto& [from, to] : shape) {
      if (from == i)
        config.network.connections.always.push_back("inproc://" + std::to_string(to));
    }
    w.add(config);
  }
}

std::int32_t magic_of(world& w, peer_id at, peer_id whose) {
  for (const auto* host : w.at(at).network().hosts.records()) {
    if (host->id == whose)
      return host->magic;
  }
  return 0;
}

/// Who does not know whom as it is now; empty: all is well.
std::string unknown(world& w) {
  std::string all;
  for (const auto a : w.peers()) {
    for (const auto b : w.peers()) {
      if (w.alive(a) && w.alive(b) && magic_of(w, a, b) != magic_of(w, b, b))
        all += to_string(a) + "->" + to_string(b) + ' ';
    }
  }
  return all;
}

/// Kills, power cuts, restarts at once or later, partitions; in the end all run and are joined.
void disturb(world& w, random_stream& rng, int count) {
  std::set<peer_id> down;
  for (int i = 0; i < 12; ++i) {
    const peer_id who{static_cast<std::int32_t>(1 + rng.below(static_cast<std::uint64_t>(count)))};
    switch (rng.below(4)) {
    case 0:
      w.kill(who);
      w.run_for(rng.between(duration(1ms), 3s));
      w.restart(who);
      down.erase(who);
      break;
    case 1:
      if (down.insert(who).second)
        w.power_off(who);
      break;
    case 2: {
      const auto part = rng.below(static_cast<std::uint64_t>(count));
      w.separated = [part](peer_id a, peer_id b) {
        return (static_cast<std::uint64_t>(a.value) <= part) !=
               (static_cast<std::uint64_t>(b.value) <= part);
      };
      break;
    }
    case 3:
      w.separated = {};
      break;
    }
    w.run_for(rng.between(duration(10ms), 40s));
  }
  for (const auto who : down)
    w.restart(who);
  w.separated = {};
}

void set(world& w, peer_id who, std::string_view text) {
  w.perform(who, w.at(who).tuples().set("x", text_content(text), w.now()));
}

std::string seen(world& w, peer_id at, peer_id owner) {
  const auto x = w.at(at).reader().find(owner, "x");
  return x ? std::string(x->text()) : "none";
}

} // namespace

TEST_CASE("after any disturbance everybody is known as it is now, within ten seconds",
          "[peis][KH-01][KH-02][RTE-08]") {
  const std::string shape = GENERATE("line", "ring", "star", "tree");
  constexpr int count = 6;
  for (std::uint64_t seed = 1; seed <= rubicon::test::seeds(20); ++seed) {
    CAPTURE(shape, seed);
    world w(seed);
    build(w, shape_of(shape, count), count);
    w.run_for(10s);
    REQUIRE(unknown(w).empty());
    random_stream rng(seed, shape);
    disturb(w, rng, count);
    w.run_for(10s);
    CHECK(unknown(w) == "");
  }
}

TEST_CASE("a stale memory on the way keeps nobody unknown", "[peis][KH-02]") {
  const bool joins_late = GENERATE(false, true); // nothing is known, or an earlier incarnation is
  world w;
  build(w, shape_of("line", 3), 3);
  if (joins_late)
    w.power_off(peer_id{3});
  w.run_for(5s);
  for (const auto* host : w.at(peer_id{2}).network().hosts.records()) {
    if (host->id == peer_id{1})
      w.remember(peer_id{2}, *host);
  }
  w.keep = [](const package_header& x) { // no broadcast either: answers alone tell
    return x.port != port::host_record || x.type != package_type::broadcast;
  };
  w.kill(peer_id{1});
  w.run_for(1s);
  w.restart(peer_id{1});
  w.run_for(3s);
  if (joins_late)
    w.restart(peer_id{3});
  w.run_for(5s);
  CHECK(magic_of(w, peer_id{3}, peer_id{1}) == magic_of(w, peer_id{1}, peer_id{1}));
}

TEST_CASE("a question in one fragment is answered by whom it is for, not on the way",
          "[peis][KH-02]") {
  world w;
  w.add_line(3);
  w.run_for(3s);
  w.clear_logs();
  host_query question{peer_id{3}, any_magic};
  const auto data = encode(question);
  package_header header;
  header.id = header.ack_id = 77;
  header.type = package_type::direct;
  header.hops = 1;
  header.source = peer_id{3};
  header.destination = peer_id{1};
  header.port = port::host_query;
  header.seqlen = 1;
  header.seqid = 5;
  header.length = static_cast<std::uint16_t>(data.size());
  bytes octets;
  encode(header, octets);
  octets.insert(octets.end(), data.begin(), data.end());
  const auto link = w.at(peer_id{3}).network().links.views().front().link;
  w.perform(peer_id{2}, w.at(peer_id{2}).on_link_octets(link, octets, w.now()));
  w.run_for(1s);
  const auto answer = std::ranges::find_if(w.packages, [](const carried& x) {
    return x.header.port == port::host_record && x.header.destination == peer_id{3};
  });
  REQUIRE(answer != w.packages.end());
  CHECK(answer->header.source == peer_id{1});
}

TEST_CASE("values flow again within five seconds of the mend, both ways, whoever is lower",
          "[peis][AUT-01][TUP-10]") {
  const bool real = GENERATE(false, true);
  const auto cut = GENERATE(as<duration>{}, 3s, 12s, 29s, 40s, 46s, 55s, 63s, 70s);
  const bool swapped = GENERATE(false, true);
  CAPTURE(real, seconds(cut), swapped);
  world w;
  const peer_id ours{swapped ? 9 : 1};
  const peer_id other{swapped ? 1 : 9};
  auto config = config_of(ours.value);
  config.network.connections.always = {"inproc://" + to_string(other)};
  w.add(config);
  w.add(other.value);
  if (real)
    w.unmarked.insert(other);
  w.run_for(5s);
  w.perform(ours, w.at(ours).subscriptions().subscribe(other, "x", subscription_id{1}, w.now()));
  w.perform(other,
            w.at(other).subscriptions().subscribe(any_peer, "x", subscription_id{1}, w.now()));
  set(w, ours, "before");
  set(w, other, "before");
  w.run_for(2s);
  REQUIRE(seen(w, ours, other) == "before");
  REQUIRE(seen(w, other, ours) == "before");
  w.separated = [](peer_id, peer_id) { return true; };
  w.run_for(cut / 2);
  set(w, ours, "meanwhile");
  set(w, other, "meanwhile");
  w.run_for(cut - cut / 2);
  w.separated = {};
  w.run_for(5s);
  CHECK(seen(w, ours, other) == "meanwhile");
  CHECK(seen(w, other, ours) == "meanwhile");
  set(w, ours, "after");
  set(w, other, "after");
  w.run_for(1s);
  CHECK(seen(w, ours, other) == "after");
  CHECK(seen(w, other, ours) == "after");
}

TEST_CASE("a restart that only an announcement tells of is a restart", "[peis][RTE-08][TUP-10]") {
  world w;
  w.add(lan_config_of(1));
  w.add(lan_config_of(2));
  w.perform(peer_id{1},
            w.at(peer_id{1}).subscriptions().subscribe(any_peer, "x", subscription_id{1}, w.now()));
  w.run_for(5s);
  set(w, peer_id{2}, "old");
  w.run_for(1s);
  w.kill(peer_id{2});
  w.run_for(1s);
  w.restart(peer_id{2});
  set(w, peer_id{2}, "new");
  w.run_for(5s);
  CHECK(w.all<host_vanished>(peer_id{1}).size() == 1);
  CHECK(seen(w, peer_id{1}, peer_id{2}) == "new");
}

TEST_CASE("a long value crosses a slow link with no package sent twice", "[peis][ACK-02][P2P-05]") {
  const std::size_t window = GENERATE(16U * 1024, 64U * 1024, 512U * 1024);
  CAPTURE(window);
  world w;
  w.octets_per_second = 600'000;
  for (const auto id : {1, 2}) {
    auto config = config_of(id);
    config.network.link_window = window;
    w.add(config);
  }
  w.connect(peer_id{1}, peer_id{2});
  w.run_for(3s);
  tuple_content content;
  content.value = bytes(900'000, 'x');
  w.perform(peer_id{1}, w.at(peer_id{1}).tuples().set("long", content, w.now()));
  w.perform(
      peer_id{2},
      w.at(peer_id{2}).subscriptions().subscribe(peer_id{1}, "long", subscription_id{1}, w.now()));
  w.run_for(2s);
  CHECK(w.at(peer_id{2}).reader().find(peer_id{1}, "long") != nullptr);
  CHECK(w.at(peer_id{1}).counters().network.retransmissions == 0);
}

TEST_CASE("a link from which nothing leaves is closed", "[peis][ACK-05]") {
  world w;
  for (const auto id : {1, 2}) {
    auto config = config_of(id);
    config.network.link_window = 1024;
    w.add(config);
  }
  w.connect(peer_id{1}, peer_id{2});
  w.run_for(3s);
  w.drains = false;
  w.perform(peer_id{1},
            w.at(peer_id{1})
                .messages()
                .send(peer_id{2}, 20, bytes(5000), true, priority::normal, request_id{7}, w.now()));
  w.run_for(75s);
  CHECK(w.at(peer_id{1}).network().links.views().empty());
  const auto outcomes = w.all<outcome>(peer_id{1});
  REQUIRE(outcomes.size() == 1);
  CHECK(!outcomes[0].success);
}

TEST_CASE("in-process addresses are told inside the process only", "[peis][LNK-03]") {
  world w;
  auto config = lan_config_of(1);
  config.network.connections.announces = false;
  config.network.addresses.push_back(tcp_address("eth0", false, {10, 0, 0, 1}, 8000));
  config.network.outside_from = link_id{2};
  w.add(config);
  w.add(2);
  w.add(3);
  w.connect(peer_id{1}, peer_id{2}); // link 1
  w.connect(peer_id{1}, peer_id{3}); // link 2, to another process
  w.run_for(3s);
  const auto addresses = [&](peer_id at) {
    for (const auto* host : w.at(at).network().hosts.records()) {
      if (host->id == peer_id{1})
        return host->addresses.size();
    }
    return std::size_t{0};
  };
  CHECK(addresses(peer_id{2}) == 2);
  CHECK(addresses(peer_id{3}) == 1);
}

} // namespace rubicon::peis::test
