// Peers of ours and real kernels together: what a cut of the network, or a process that stands
// still, leaves behind.
#include <algorithm>
#include <string>
#include <vector>

#include "peis/link_url.hpp"
#include "peis_fixture.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

namespace rubicon::peis::test {
namespace {

constexpr duration value_period = 100ms;

/// Real kernels tell their routes every 10 s and at the end of a link, and take nobody for marked.
kernel_config original_config_of(std::int32_t id) {
  auto config = lan_config_of(id);
  auto& network = config.network;
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
    w.perform(a, w.at(a).subscribe(b, "x", subscription_id{1}, w.now()));
    w.perform(b, w.at(b).subscribe(any_peer, "x", subscription_id{1}, w.now()));
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
          w.perform(x, w.at(x).set_tuple("x", text_content(std::to_string(values)), w.now()));
      w.run_for(value_period);
    }
  }

  [[nodiscard]] int seen(peer_id at, peer_id owner) {
    const auto x = w.at(at).find_tuple(owner, "x");
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

} // namespace

TEST_CASE("after a cut beside or between real kernels values flow again within five seconds",
          "[peis][AUT-01][TUP-10][A-76]") {
  const std::string kinds = GENERATE("or", "ro", "oro", "ror", "oor", "roo", "oo");
  const bool ascending = GENERATE(false, true);
  for (std::uint64_t seed = 1; seed <= rubicon::test::seeds(12); ++seed) {
    random_stream rng(seed, kinds);
    const auto length = rng.between(duration(1s), 70s);
    CAPTURE(kinds, ascending, seed, seconds(length));
    chain x(kinds, ascending, seed);
    x.run_for(25s);
    REQUIRE(x.until_values_flow(1s) < 1s);
    x.cut = true;
    x.run_for(length);
    x.cut = false;
    CHECK(x.until_values_flow(5s) < 5s);
  }
}

TEST_CASE("a real kernel that stood still is heard again within five seconds", "[peis][AUT-01]") {
  const std::string kinds = GENERATE("or", "ror", "oro");
  const bool ascending = GENERATE(false, true);
  for (std::uint64_t seed = 1; seed <= rubicon::test::seeds(12); ++seed) {
    random_stream rng(seed, kinds);
    const auto length = rng.between(duration(1s), 70s);
    CAPTURE(kinds, ascending, seed, seconds(length));
    chain x(kinds, ascending, seed);
    x.run_for(25s);
    REQUIRE(x.until_values_flow(1s) < 1s);
    const auto stopped = x.peers[kinds.find('r')];
    x.w.pause(stopped);
    x.run_for(length);
    x.w.resume(stopped);
    CHECK(x.until_values_flow(5s) < 5s);
  }
}

} // namespace rubicon::peis::test
