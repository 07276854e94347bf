// A hostile mote on the air of an island that goes about its business.
#include <cstdlib>
#include <sstream>

#include <malloc.h>

#include "hostile_mote.hpp"
#include "support/catch.hpp"
#include "support/mote_ids.hpp"
#include "support/programs.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using test::act;
using test::hostile_mote;
using test::id;
using test::island_fixture;
using test::malice;
using test::recorder;

namespace {

constexpr int side = 3;
constexpr int motes = side * side; ///< the sink among them
constexpr duration recovery_max = 5min;

/// An island whose motes tell each other something reliable every two seconds.
class island {
public:
  explicit island(std::uint64_t seed)
      : world({.width = side, .height = side, .delivery = 0.95, .seed = seed}) {
    REQUIRE(world.run_until([&] { return world.root().members() == motes - 1; }, 3min));
    world.run_for(1min);
    world.outcomes.clear();
    world.on_performed = [this](mote_id) { ++work; };
  }

  /// Everybody sends to everybody in turn for so long. @returns how much of it was acknowledged
  double exchange(duration length) {
    const auto before = world.outcomes.size();
    for (const auto end = world.now() + length; world.now() < end;) {
      for (int from = 2; from <= motes; ++from) {
        const auto to = 2 + (from + turn_) % (motes - 1);
        if (to != from && world.send(id(from), {own_island, id(to)}, 10, bytes{1, 2, 3}, true))
          ++accepted;
        ++tried;
      }
      ++turn_;
      world.run_for(2s);
    }
    const auto acked =
        std::ranges::count_if(world.outcomes.begin() + static_cast<std::ptrdiff_t>(before),
                              world.outcomes.end(), [](const auto& x) { return x.second; });
    return static_cast<double>(acked) /
           static_cast<double>(std::max<std::size_t>(world.outcomes.size() - before, 1));
  }

  /// All are members, and nearly all that is sent within 30 s is acknowledged.
  bool is_well() {
    if (world.root().members() != motes - 1 || world.joined() != motes - 1)
      return false;
    const auto before = accepted;
    const auto share = exchange(30s);
    return share > 0.97 && accepted - before > 80;
  }

  /// @returns how long it took until it was well; more than recovery_max: it never was
  duration recovers() {
    const auto from = world.now();
    while (world.now() - from <= recovery_max) {
      const auto began = world.now();
      if (is_well())
        return began - from;
      if (world.now() == began)
        world.run_for(1s);
    }
    return world.now() - from;
  }

  island_fixture world;
  std::uint64_t work = 0; ///< steps of cores
  std::size_t accepted = 0;
  std::size_t tried = 0;

private:
  int turn_ = 0;
};

/// What an island that is not well looks like.
std::string looks(island& x) {
  std::ostringstream text;
  text << "members " << x.world.root().members() << '\n';
  for (int i = 2; i <= motes; ++i) {
    const auto& node = x.world.at(id(i));
    const auto& router = node.packets().router();
    text << i << ": joined " << node.member().joined() << ", root " << router.tree().root().value
         << ", parent " << router.tree().parent().value << ", hops " << int(router.tree().hops())
         << ", cost " << router.tree().cost() << ", clock " << router.clock().synchronised();
    for (const auto& each : router.links().all())
      text << " [" << each.mote.value << " in " << each.in << " out " << each.out.value_or(1)
           << " n" << int(each.samples) << " m" << int(each.missed) << ']';
    text << '\n';
  }
  return text.str();
}

std::size_t heap() {
  return ::mallinfo2().uordblks;
}

void survive(malice what, std::uint64_t seed, duration length) {
  CAPTURE(static_cast<int>(what), seed);
  island here(seed);
  hostile_mote enemy(here.world, motes, seed);
  CHECK(here.is_well());
  const auto quiet_heap = heap();
  const auto frames = enemy.sent();
  const auto work = here.work;
  for (const auto end = here.world.now() + length; here.world.now() < end;) {
    static_cast<void>(here.exchange(1ns));
    enemy.attack(what, 2s);
  }
  const auto received = static_cast<double>(enemy.sent() - frames) * motes;
  const auto steps = static_cast<double>(here.work - work);
  CHECK(steps < 3 * received + 2000 * static_cast<double>(length / 1s)); // nobody spins
  here.world.up.clear();
  here.world.received.clear();
  here.world.memberships.clear();
  const auto grown = static_cast<std::ptrdiff_t>(heap()) - static_cast<std::ptrdiff_t>(quiet_heap);
  CHECK(grown < 1'000'000);
  const auto took = here.recovers();
  if (std::getenv("RUBICON_HOSTILE_TELL") != nullptr)
    WARN("kind " << static_cast<int>(what) << " seed " << seed << ": well after " << took / 1s
                 << " s, " << grown << " octets, " << steps / received << " steps a frame");
  INFO((took <= recovery_max ? std::string() : looks(here)));
  CHECK(took <= recovery_max);
  here.world.run_for(3min);
  CHECK(here.world.outcomes.size() == here.accepted); // each reliable message has its end
}

std::uint64_t seeds_wanted(std::uint64_t usual) {
  const auto* text = std::getenv("RUBICON_HOSTILE_SEEDS");
  return text != nullptr ? std::strtoull(text, nullptr, 10) : test::seeds(usual);
}

} // namespace

TEST_CASE("an island survives a hostile mote and is well again after it",
          "[hostile][network][mote]") {
  const auto what = GENERATE(malice::replay, malice::mutation, malice::noise, malice::beacons,
                             malice::management, malice::anything);
  for (std::uint64_t seed = 1; seed <= seeds_wanted(3); ++seed)
    survive(what, seed, 60s);
}
