// Peers of ours and real kernels together: what a cut of the network, or a process that stands
// still, leaves behind.
#include <algorithm>
#include <string>
#include <vector>

#include "peis/wire/announcement.hpp"
#include "peis/wire/link_url.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis::test {
namespace {

constexpr duration value_period = 100ms;

/// Real kernels tell their routes every 10 s and at the end of a link, take any way that they are
/// told, and take nobody for marked.
kernel_config original_config_of(std::int32_t id) {
  auto config = lan_config_of(id);
  auto& network = config.network;
  network.metric_limit = 10;
  network.tables.probes = 0;
  network.trigger_gap = network.routing_period;
  network.lost_timeout = 35s;
  network.connections.manager = false;
  return config;
}

/// A chain of peers, each of which hears its neighbours only. Who writes and reads are its ends.
struct chain {
  world w;
  std::vector<peer_id> peers;
  bool cut = false;
  int values = 0;

  /// @param kinds of the peers, `r` is a real one. @param ascending or descending ids
  chain(const std::string& kinds, bool ascending, std::uint64_t seed) : w(seed) {
    w.tcp = true;
    w.separated = [this](peer_id a, peer_id b) { return separated(a, b); };
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      const auto id = static_cast<std::int32_t>(10 * (ascending ? i + 1 : kinds.size() - i));
      auto config = kinds[i] == 'r' ? original_config_of(id) : lan_config_of(id);
      config.network.link_window = 512U * 1024;
      peers.push_back(w.add(std::move(config)));
      if (kinds[i] == 'r')
        w.unmarked.insert(peers.back());
    }
    const auto a = peers.front();
    const auto b = peers.back();
    w.perform(a, w.at(a).subscriptions().subscribe(b, "x", subscription_id{1}, w.now()));
    w.perform(b, w.at(b).subscriptions().subscribe(any_peer, "x", subscription_id{1}, w.now()));
  }

  [[nodiscard]] bool separated(peer_id a, peer_id b) const {
    const auto at = [this](peer_id x) { return std::ranges::find(peers, x) - peers.begin(); };
    const auto low = std::min(at(a), at(b));
    return std::max(at(a), at(b)) - low > 1 || (cut && low == 0);
  }

  /// Both ends go on writing.
  void run_for(duration length) {
    for (const auto end = w.now() + length; w.now() < end;) {
      ++values;
      for (const auto x : {peers.front(), peers.back()})
        if (!w.paused(x))
          w.perform(x, w.at(x).tuples().set("x", text_content(std::to_string(values)), w.now()));
      w.run_for(value_period);
    }
  }

  [[nodiscard]] int seen(peer_id at, peer_id owner) {
    const auto x = w.at(at).reader().find(owner, "x");
    return x == nullptr ? 0 : std::stoi(std::string(x->text()));
  }

  /// @returns how long it takes until both ends see what the other has written from now on
  duration until_values_flow(duration max) {
    const auto begun = w.now();
    const auto before = values;
    const auto a = peers.front();
    const auto b = peers.back();
    while ((seen(a, b) <= before || seen(b, a) <= before) && w.now() < begun + max)
      run_for(value_period);
    return w.now() - begun;
  }
};

/// A peer of ours and a real one that it sends a long message to, over a link of 2 MB/s.
struct pair_of_kinds {
  static constexpr peer_id ours{1};
  static constexpr peer_id original{2};
  static constexpr std::size_t size = 900'000;
  world w;

  pair_of_kinds() {
    w.tcp = true;
    w.octets_per_second = 2e6;
    auto config = lan_config_of(ours.value);
    config.network.link_window = 512U * 1024;
    w.add(config);
    auto other = original_config_of(original.value);
    other.network.link_window = 512U * 1024;
    w.add(other);
    w.unmarked.insert(original);
    w.run_for(8s);
    w.at(original).messages().hook_port(30);
    w.perform(ours, w.at(ours).messages().send(original, 30, bytes(size, 'x'), true,
                                               priority::normal, request_id{7}, w.now()));
  }

  [[nodiscard]] link_id link() { return w.at(ours).network().links.views().at(0).link; }
};

} // namespace

TEST_CASE("no more is under way to a real kernel than it lets others send", "[peis][P2P-05]") {
  pair_of_kinds x;
  CHECK(x.w.all<pace_link>(x.ours).size() == 1);
  CHECK(x.w.all<pace_link>(x.original).empty());
  x.w.run_for(100ms);
  std::size_t sent = 0;
  for (const auto& y : x.w.packages)
    sent += y.at == x.w.now() - 100ms && y.header.port == 30 ? header_size + y.header.length : 0;
  CHECK(sent > 19'000 - header_size - data_max);
  CHECK(sent <= 20'000);
  x.w.run_for(5s);
  REQUIRE(x.w.all<message>(x.original).size() == 1);
  CHECK(x.w.at(x.ours).counters().network.retransmissions == 0);
}

TEST_CASE("a link in which a long message is stuck is replaced, and the message sent anew",
          "[peis][ACK-05][ACK-07]") {
  pair_of_kinds x;
  x.w.run_for(200ms);
  const auto old = x.link();
  x.w.stuck.insert(old);
  x.w.run_for(5s);
  REQUIRE(x.w.at(x.ours).network().links.views().size() == 1);
  CHECK(x.link() != old);
  const auto closed = x.w.all<close_link>(x.ours);
  REQUIRE(closed.size() == 1);
  CHECK(closed[0].why == close_cause::replaced);
  const auto arrived = x.w.all<message>(x.original);
  REQUIRE(arrived.size() == 1);
  CHECK(arrived[0].octets == payload(bytes(x.size, 'x')));
  const auto outcomes = x.w.all<outcome>(x.ours);
  REQUIRE(outcomes.size() == 1);
  CHECK(outcomes[0].success);
  CHECK(x.w.at(x.ours).counters().network.messages_begun_anew == 1);
}

TEST_CASE("a message whose first part the receiver has dropped is no success before all has come",
          "[peis][ACK-07]") {
  pair_of_kinds x;
  const bool long_cut = GENERATE(false, true);
  x.w.run_for(200ms);
  x.w.separated = [](peer_id, peer_id) { return true; };
  x.w.cut(x.link());
  x.w.run_for(long_cut ? 15s : 3s);
  x.w.separated = {};
  x.w.run_for(6s);
  const auto outcomes = x.w.all<outcome>(x.ours);
  REQUIRE(outcomes.size() == 1);
  CHECK(outcomes[0].success);
  REQUIRE(x.w.all<message>(x.original).size() == 1);
  CHECK(x.w.all<message>(x.original)[0].octets.size() == x.size);
}

/// Something breaks for 1 to 70 s, when values flow; soon after its end they flow again.
template <class Break, class Mend>
static void check_healing(const std::string& kinds, Break breaks, Mend mends) {
  const bool ascending = GENERATE(false, true);
  for (std::uint64_t seed = 1; seed <= rubicon::test::seeds(12); ++seed) {
    random_stream rng(seed, kinds);
    const auto length = rng.between(duration(1s), 70s);
    CAPTURE(kinds, ascending, seed, seconds(length));
    chain x(kinds, ascending, seed);
    x.run_for(25s);
    REQUIRE(x.until_values_flow(1s) < 1s);
    breaks(x);
    x.run_for(length);
    mends(x);
    CHECK(x.until_values_flow(5s) < 5s);
  }
}

TEST_CASE("after a cut beside or between real kernels values flow again within five seconds",
          "[peis][AUT-01][TUP-10]") {
  const std::string kinds = GENERATE("or", "ro", "oro", "ror", "oor", "roo", "oo");
  check_healing(
      kinds, [](chain& x) { x.cut = true; }, [](chain& x) { x.cut = false; });
}

TEST_CASE("a real kernel that stood still is heard again within five seconds", "[peis][AUT-01]") {
  const std::string kinds = GENERATE("or", "ror", "oro");
  const auto stopped = kinds.find('r');
  check_healing(
      kinds, [=](chain& x) { x.w.pause(x.peers[stopped]); },
      [=](chain& x) { x.w.resume(x.peers[stopped]); });
}

/// A real kernel with neighbours of either kind, of which those of its kind notice late that it was
/// killed.
struct company {
  static constexpr peer_id killed{50};
  world w;
  std::vector<peer_id> peers;
  std::vector<link_id> noticed_late;

  /// @param is_chain it is at the end of a chain; else all have links to all
  company(const std::string& kinds, bool is_chain, std::uint64_t seed) : w(seed) {
    add(killed, 'r');
    for (std::size_t i = 0; i < kinds.size(); ++i)
      add(peer_id{static_cast<std::int32_t>(10 * (i + 6))}, kinds[i]);
    for (std::size_t i = 0; i < peers.size(); ++i)
      for (std::size_t k = i + 1; k < (is_chain ? std::min(i + 2, peers.size()) : peers.size());
           ++k) {
        const auto link = w.connect(peers[i], peers[k]);
        if (i == 0 && kinds[k - 1] == 'r')
          noticed_late.push_back(link);
      }
  }

  void add(peer_id id, char kind) {
    auto config = kind == 'r' ? original_config_of(id.value) : config_of(id.value);
    config.network.connections.manager = config.network.connections.announces = false;
    peers.push_back(w.add(std::move(config)));
    if (kind == 'r')
      w.unmarked.insert(id);
  }

  void kill() {
    w.power_off(killed);
    for (const auto x : peers)
      if (w.alive(x) && !w.unmarked.contains(x))
        for (const auto& link : w.at(x).network().links.views())
          if (link.neighbour == killed)
            w.cut(link.link);
    w.run_for(19s);
    for (const auto link : noticed_late)
      w.cut(link);
  }

  [[nodiscard]] bool is_known(peer_id at) {
    return std::ranges::any_of(w.at(at).network().hosts.records(),
                               [](const auto* x) { return x->id == killed; });
  }
};

TEST_CASE("a killed real kernel is forgotten as soon as by its kind, whoever is beside",
          "[peis][RTE-07][KH-05]") {
  const auto [kinds, is_chain] = GENERATE(table<std::string, bool>({{"o", false},
                                                                    {"or", false},
                                                                    {"oor", false},
                                                                    {"orr", false},
                                                                    {"oorr", false},
                                                                    {"ooorr", false},
                                                                    {"orrr", false},
                                                                    {"oo", true},
                                                                    {"or", true},
                                                                    {"ro", true},
                                                                    {"roo", true},
                                                                    {"oro", true}}));
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(kinds, is_chain, seed);
    company x(kinds, is_chain, seed);
    x.w.run_for(45s + seed * 3s);
    for (const auto id : x.peers)
      REQUIRE(x.is_known(id));
    const auto begun = x.w.now();
    x.kill();
    x.w.run_for(begun + 64s - x.w.now());
    for (const auto id : x.peers)
      if (!x.w.unmarked.contains(id)) {
        INFO("peer " << id.value);
        CHECK(!x.is_known(id));
      }
    x.w.run_for(3min); // nor does anybody bring it back
    for (const auto id : x.peers)
      CHECK((id == company::killed || !x.is_known(id)));
  }
}

TEST_CASE(
    "a real kernel that was killed and is back at another port is linked to as it announces itself",
    "[peis][RTE-08][TCP-03]") {
  const auto [ours, its] = GENERATE(table<int, int>({{10, 20}, {20, 10}}));
  const bool has_others = GENERATE(false, true);
  CAPTURE(ours, its, has_others);
  const peer_id own{ours};
  const peer_id other{its};
  world w;
  w.vacant = {"tcp://" + std::to_string(its) + ".0.0.1:8000"};
  auto config = lan_config_of(ours);
  config.network.addresses = {tcp_address("eth0", false, {10, 0, 0, 9}, 8000)};
  w.add(config);
  if (has_others) // which still believe in it
    w.add(original_config_of(30));
  const auto octet = static_cast<std::uint8_t>(its);
  auto original = original_config_of(its);
  original.network.addresses = {tcp_address("eth0", false, {octet, 0, 0, 1}, 8000)};
  original.network.connections.announces = false;
  w.add(original);
  w.unmarked = {other, peer_id{30}};
  w.connect(other, own);
  if (has_others) {
    w.connect(other, peer_id{30});
    w.connect(own, peer_id{30});
  }
  w.run_for(25s);
  REQUIRE(w.at(own).network().knows_present(other));
  if (has_others) {
    w.power_off(other);
    for (const auto& link : w.at(own).network().links.views())
      if (link.neighbour == other)
        w.cut(link.link);
  } else {
    w.kill(other);
  }
  w.run_for(1s);
  w.config(other).network.addresses[0] = tcp_address("eth0", false, {octet, 0, 0, 1}, 8001);
  w.restart(other);
  w.run_for(4s);
  REQUIRE(!w.at(own).network().knows_present(other));
  auto record = *w.at(other).network().hosts.records().at(0);
  record.marked = false;
  for (int i = 0; i < 10 && !w.at(own).network().knows_present(other); ++i) {
    if (i % 10 == 0)
      w.perform(own, w.at(own).on_announcement(
                         encode(announcement{protocol_version, "test", record}), w.now()));
    w.run_for(100ms);
  }
  CHECK(w.at(own).network().knows_present(other));
}

TEST_CASE("a relay that is back at another port is found at the address that it tells",
          "[peis][AUT-01][LEA-03]") {
  const bool is_leaf = GENERATE(false, true); // else it has no manager
  const bool is_original = GENERATE(false, true);
  CAPTURE(is_leaf, is_original);
  const peer_id relay{20};
  world w;
  const std::string configured = "tcp://20.0.0.1:8000";
  auto config = lan_config_of(10);
  config.network.addresses = {tcp_address("eth0", false, {10, 0, 0, 9}, 8000)};
  config.network.connections.always = {configured};
  config.network.connections.leaf = is_leaf;
  config.network.connections.manager = is_leaf;
  w.add(config);
  auto original = is_original ? original_config_of(20) : lan_config_of(20);
  original.network.addresses = {tcp_address("eth0", false, {20, 0, 0, 1}, 8000)};
  original.network.connections.manager = false;
  w.add(original);
  if (is_original)
    w.unmarked = {relay};
  w.run_for(20s);
  REQUIRE(w.at(peer_id{10}).network().knows_present(relay));
  w.kill(relay);
  w.vacant = {configured};
  w.run_for(30s);
  w.config(relay).network.addresses[0] = tcp_address("eth0", false, {20, 0, 0, 1}, 8001);
  w.restart(relay);
  w.run_for(5s);
  CHECK(w.at(peer_id{10}).network().knows_present(relay));
  REQUIRE(w.at(peer_id{10}).network().links.views().size() == 1);
  CHECK(w.at(peer_id{10}).network().links.views()[0].neighbour == relay);
}

} // namespace rubicon::peis::test
