// Whatever applications, nodes and channels do: promises are kept, and nothing leaks.
#include <map>
#include <set>
#include <tuple>

#include "support/catch.hpp"
#include "support/seeds.hpp"
#include "unit/synaptic/fixture.hpp"

using namespace rubicon;
using namespace rubicon::synaptic;
using test::synaptic_fixture;
using test::value_of;

namespace {

/// Applications that create, start, stop and dispose at random, and keep count.
class applications {
public:
  applications(std::uint64_t seed, double loss, duration delay_max)
      : rng_(seed, "applications"), world_(3, {}, seed), delay_max_(delay_max) {
    world_.loss = loss;
    world_.connect_loss = loss / 2;
    world_.delay_max = std::max(delay_max, world_.delay_min);
    world_.after_tick = [this] { look(); };
  }

  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      world_.run_ticks(1);
      act(rng_.below(3));
      look();
    }
    for (const auto& [id, x] : std::map(ends_)) {
      if (!x.gone)
        dispose(id);
    }
    world_.run_ticks(400);
  }

  /// To be called after run().
  void check() {
    CHECK(world_.is_quiet());
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(world_.at(i).open_channels() == 0);
      CHECK(world_.at(i).early_channels() == 0);
      CHECK(world_.open_ends(i) == 0);
      CHECK_FALSE(world_.at(i).deadline());
      CHECK(world_.at(i).counters().malformed == 0);
    }
    for (const auto& [id, x] : ends_) {
      if (std::get<1>(id) == world_.life(std::get<0>(id)))
        CHECK(x.creates_done == 1);
    }
  }

  std::uint64_t created = 0, failed = 0, updated = 0, missed = 0, lost_channels = 0;

private:
  using key = std::tuple<std::size_t, unsigned, std::uint16_t>; ///< node, life, descriptor

  struct end {
    bool is_out = false;
    std::size_t other = 0;
    std::size_t size = 0;
    int creates_done = 0;
    bool is_open = false;
    bool gone = false; ///< disposed of, or not created
  };

  void act(std::size_t node) {
    const auto action = rng_.below(100);
    if (action < 1) {
      world_.restart(node, rng_.chance(0.5));
      for (auto& [id, x] : ends_)
        x.gone = x.gone || std::get<0>(id) == node;
    } else if (action < 40) {
      create(node);
    } else if (const auto id = any_end(node)) {
      const descriptor channel{std::get<2>(*id)};
      if (action < 80)
        world_.take(node, world_.at(node).start(channel));
      else if (action < 90)
        world_.take(node, world_.at(node).stop(channel));
      else
        dispose(*id);
    }
  }

  void create(std::size_t node) {
    const bool is_out = rng_.chance(0.5);
    const auto other = rng_.below(3);
    const std::size_t size = rng_.chance(0.1) ? 5 : 2;
    const auto self = world_.address(node);
    const auto peer = world_.address(other);
    const auto x = is_out ? world_.at(node).create_out(self, peer, size, {}, world_.now)
                          : world_.at(node).create_in(self, peer, size, {}, world_.now);
    if (x.refused)
      return;
    ends_[{node, world_.life(node), x.channel.value}] = {is_out, other, size};
    world_.take(node, x);
  }

  void dispose(const key& id) {
    const auto done = world_.at(std::get<0>(id)).dispose(descriptor{std::get<2>(id)});
    if (done.refused)
      FAIL("dispose refused: " << to_string(*done.refused));
    ends_[id].gone = true;
    world_.take(std::get<0>(id), done);
  }

  std::optional<key> any_end(std::size_t node) {
    std::vector<key> open;
    for (const auto& [id, x] : ends_) {
      if (std::get<0>(id) == node && !x.gone)
        open.push_back(id);
    }
    if (open.empty())
      return std::nullopt;
    return open[rng_.below(open.size())];
  }

  void look() {
    for (const auto& x : world_.events)
      std::visit([&](const auto& y) { look_at(x, y); }, x.what);
    world_.events.clear();
  }

  end& end_of(const synaptic_fixture::node_event& x, descriptor channel) {
    const key id{x.node, x.life, channel.value};
    if (!ends_.contains(id))
      FAIL("an event of a channel that was not created");
    return ends_[id];
  }

  void look_at(const synaptic_fixture::node_event& from, const create_done& done) {
    auto& x = end_of(from, done.channel);
    if (++x.creates_done > 1 || done.is_out != x.is_out)
      FAIL("a second create_done, or one of the other end");
    x.is_open = done.success;
    x.gone = x.gone || !done.success;
    ++(done.success ? created : failed);
  }

  void look_at(const synaptic_fixture::node_event& from, const channel_failed& what) {
    auto& x = end_of(from, what.channel);
    if (!x.is_open)
      FAIL("a failure of a channel that is not open");
    x.is_open = false;
    ++lost_channels;
  }

  void look_at(const synaptic_fixture::node_event& from, const input_update& what) {
    const auto& x = end_of(from, what.channel);
    if (x.is_out || what.index >= x.size)
      FAIL("an update of no input");
    if (what.status == input_status::missed) {
      ++missed;
      return;
    }
    ++updated;
    const auto value = world_.at(from.node).read_input(what.channel, what.index);
    if (!value)
      return; // ended, or disposed of, since
    const auto tick = x.other == from.node ? from.tick : from.tick - 1;
    if (delay_max_ < 300ms && *value != value_of(x.other, tick, what.index))
      FAIL("node " << from.node << " shows another value than node " << x.other << " wrote");
  }

  random_stream rng_;
  synaptic_fixture world_;
  duration delay_max_;
  std::map<key, end> ends_;
};

} // namespace

TEST_CASE("exactly the vectors that are lost are told missed", "[synaptic][SYN-10]") {
  for (const double loss : {0.0, 0.05, 0.3, 0.7}) {
    for (std::uint64_t seed = 1; seed <= test::seeds(5); ++seed) {
      INFO("loss " << loss << ", seed " << seed);
      synaptic_fixture x(2, {.silence_max = 100, .stop_repeats = 255}, seed);
      x.delay_max = 200ms;
      const auto out = x.create_out(0, 1, 2);
      const auto in = x.create_in(1, 0, 2);
      x.run_ticks(2);
      REQUIRE_FALSE(x.at(0).start(out).refused);
      x.loss = loss;
      x.run_ticks(1000);
      std::map<std::uint32_t, bool> is_lost; // from the first one that arrived on
      for (const auto& y : x.vectors) {
        if (!is_lost.empty() || !y.lost)
          is_lost[y.tick] = y.lost;
      }
      std::map<std::uint32_t, bool> is_missed;
      for (const auto& y : x.events) {
        if (const auto* update = std::get_if<input_update>(&y.what)) {
          CHECK(update->channel == in);
          is_missed[y.tick - 1] = update->status == input_status::missed;
        }
      }
      is_lost.erase(x.tick - 1); // to be reported at the next tick
      REQUIRE(is_missed == is_lost);
    }
  }
}

TEST_CASE("after a stop nothing is missed but what was lost", "[synaptic][SYN-07][SYN-10]") {
  for (std::uint64_t seed = 1; seed <= test::seeds(30); ++seed) {
    INFO("seed " << seed);
    synaptic_fixture x(2, {}, seed);
    x.delay_max = 200ms;
    const auto out = x.create_out(0, 1, 2);
    const auto in = x.create_in(1, 0, 2);
    x.run_ticks(2);
    for (std::uint32_t i = 0; i < 20; ++i) {
      REQUIRE_FALSE(x.at(0).start(out).refused);
      x.run_ticks(1 + i % 4);
      x.take(0, x.at(0).stop(out));
      x.run_ticks(1 + i % 3);
    }
    CHECK(x.at(1).counters().missed == 0);
    CHECK(x.at(1).counters().updated == x.vectors.size());
    CHECK(x.at(1).read_input(in, 1) == value_of(0, x.vectors.back().tick, 1));
  }
}

TEST_CASE("under any faults each create is answered once, values are right, and nothing leaks",
          "[synaptic][SYN-02][SYN-04][SYN-05][SYN-17]") {
  const struct {
    double loss;
    duration delay_max;
  } services[] = {{0, 5ms}, {0.2, 200ms}, {0.4, 3s}};
  for (const auto& service : services) {
    std::uint64_t created = 0, failed = 0, updated = 0, missed = 0, lost_channels = 0;
    for (std::uint64_t seed = 1; seed <= test::seeds(20); ++seed) {
      INFO("loss " << service.loss << ", seed " << seed);
      applications x(seed, service.loss, service.delay_max);
      x.run(600);
      x.check();
      created += x.created;
      failed += x.failed;
      updated += x.updated;
      missed += x.missed;
      lost_channels += x.lost_channels;
    }
    INFO("loss " << service.loss << ": created " << created << ", failed " << failed << ", updated "
                 << updated << ", missed " << missed << ", lost channels " << lost_channels);
    if (test::seeds(20) < 20) // too few to happen often
      continue;
    CHECK(created > 500);
    CHECK(failed > 50);
    CHECK(updated > 1000);
    CHECK(missed > 10);
    CHECK(lost_channels > 50);
  }
}
