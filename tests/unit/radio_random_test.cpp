#include <map>
#include <set>
#include <utility>
#include <variant>

#include "core/codec.hpp"
#include "core/hash.hpp"
#include "radio_world.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::radio_world;

namespace {

constexpr std::uint16_t motes = 7; ///< in each of two islands

struct scenario {
  bool power_faults = true;
  int steps = 600;
};

/// One mote in three is so slow that its receive slots run out.
const platform* kind_of(std::uint32_t radio) {
  static const auto slow = [] {
    auto x = platforms()[2];
    x.service_time = 40ms;
    return x;
  }();
  return radio % 3 == 2 ? &slow : &platforms()[radio % 3];
}

position somewhere(random_stream& dice) {
  return {dice.unit() * 60, dice.unit() * 60, 0};
}

/// Two islands in one place; sends, power faults, moves and link losses at random.
class random_run {
public:
  random_run(std::uint64_t seed, const scenario& what)
      : world(config_of(seed), seed), dice_(seed + 1000), what_(what) {
    for (std::uint16_t i = 0; i < 2 * motes; ++i) {
      radio_config x;
      x.address = mote_id{static_cast<std::uint16_t>(1 + i % motes)};
      x.pan = static_cast<std::uint16_t>(1 + i / motes);
      x.place = somewhere(dice_);
      x.kind = kind_of(i);
      world.channel.add(x, world.now);
    }
  }

  void go() {
    for (int i = 0; i < what_.steps; ++i) {
      step();
      if (!world.channel.balanced())
        FAIL("books do not balance at " << to_text(world.now));
    }
    world.run_for(5s); // everything comes to its end
  }

  [[nodiscard]] std::uint64_t requests() const { return requests_; }

  radio_world world;

private:
  static channel_config config_of(std::uint64_t seed) {
    random_stream dice(seed + 2000);
    return {.range_m = 20 + 20 * dice.unit(),
            .loss = dice.chance(0.5) ? 0.3 * dice.unit() : 0,
            .queue = 1 + dice.below(8),
            .retries_max = static_cast<unsigned>(dice.below(5))};
  }

  radio_index any() { return radio_index{static_cast<std::uint32_t>(dice_.below(2 * motes))}; }

  void step() {
    const auto kind = dice_.below(100);
    if (kind < 80) {
      const auto to = dice_.chance(0.2) ? broadcast_mote.value
                                        : static_cast<std::uint16_t>(1 + dice_.below(motes));
      bytes octets(8 + dice_.below(100));
      for (std::size_t i = 0; i < 8; ++i)
        octets[i] = static_cast<std::uint8_t>(requests_ >> (8 * i));
      world.note(world.channel.send(
          any(), {requests_++, mote_id{to}, 6, std::move(octets), dice_.chance(0.8)}, world.now));
    } else if (kind < 90 && what_.power_faults) {
      world.set_power(any(), dice_.chance(0.5) ? power::off : power::on);
    } else if (kind == 90 && what_.power_faults) {
      world.set_power(any(), power::flat);
    } else if (kind < 95) {
      world.channel.move(any(), somewhere(dice_));
    } else {
      world.channel.set_loss(any(), any(), dice_.unit());
    }
    world.run_for(dice_.chance(0.5) ? dice_.between(0ms, 1ms) : dice_.between(0ms, 15ms));
  }

  random_stream dice_;
  scenario what_;
  std::uint64_t requests_ = 0;
};

std::uint64_t hash_of(const radio_world& x) {
  fold64 fold;
  for (const auto& [at, what] : x.log) {
    fold.add(static_cast<std::uint64_t>(at.time_since_epoch().count()));
    if (const auto* got = std::get_if<delivered>(&what))
      fold.add(got->to.value).add(got->psdu.view());
    else if (const auto* end = std::get_if<done>(&what))
      fold.add(end->radio.value).add(end->token).add(to_string(end->status));
  }
  return fold.value();
}

} // namespace

TEST_CASE("both books balance at every moment of a random run", "[radio][random][RTG-06]") {
  copy_book all;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    INFO("seed " << seed);
    random_run run(seed, {});
    run.go();
    const auto books = run.world.channel.counted();
    CHECK(run.world.channel.balanced());
    CHECK(books.requests.requests == run.requests());
    CHECK(books.requests.open == 0);
    CHECK(run.world.all<done>().size() == run.requests());
    CHECK(run.world.all<delivered>().size() == books.copies.delivered - books.acks_received);
    auto parts = run.world.channel.counted_in_pan(1);
    parts += run.world.channel.counted_in_pan(2);
    CHECK(parts == books);
    all += books.copies;
  }
  // Every line of the book has been in use.
  for (const auto line : {all.delivered, all.loss, all.collision, all.half_duplex, all.off,
                          all.filtered, all.overflow, all.duplicate})
    CHECK(line > 0);
}

TEST_CASE("every request ends once, and its outcome is true", "[radio][random]") {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    INFO("seed " << seed);
    random_run run(seed, {.power_faults = false});
    run.go();
    std::set<std::uint64_t> ended;
    std::set<std::pair<std::uint64_t, radio_index>> received;
    std::map<std::uint64_t, int> takers;
    for (const auto& x : run.world.all<delivered>()) {
      const auto token = byte_reader(x.content.payload).little<std::uint64_t>();
      CHECK(received.emplace(token, x.to).second); // at most once
      CHECK(x.content.pan == 1 + x.to.value / motes);
      ++takers[token];
    }
    for (const auto& x : run.world.all<done>()) {
      CHECK(ended.insert(x.token).second);
      if (x.transmissions == 0) // what never left the radio reached nobody
        CHECK(takers.count(x.token) == 0);
      if (x.status == send_status::sent)
        CHECK(x.transmissions > 0);
      if (x.status == send_status::queue_full)
        CHECK(x.transmissions == 0);
    }
    CHECK(ended.size() == run.requests());
  }
}

TEST_CASE("the same seed gives the same run, another seed another", "[radio][random][GEN-07]") {
  std::set<std::uint64_t> hashes;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    random_run first(seed, {});
    random_run second(seed, {});
    first.go();
    second.go();
    CHECK(hash_of(first.world) == hash_of(second.world));
    hashes.insert(hash_of(first.world));
  }
  CHECK(hashes.size() == 8);
}

TEST_CASE("times of every radio add up in a random run", "[radio][random][NRG-05]") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    random_run run(seed, {});
    run.go();
    for (std::uint32_t i = 0; i < 2 * motes; ++i) {
      const radio_index radio{i};
      const auto use = run.world.channel.energy(radio, run.world.now);
      const auto& t = use.times;
      const bool flat = run.world.channel.power_of(radio) == power::flat;
      const auto lived = (flat ? use.empty_at : run.world.now).time_since_epoch();
      CHECK(t.radio_off + t.radio_listen + t.radio_receive + t.radio_transmit == lived);
      CHECK(t.mcu_active + t.mcu_sleep == lived);
      CHECK(t.mcu_sleep >= 0ns);
      CHECK(use.used_mah == Approx(used_mah(t, *kind_of(i))).epsilon(1e-3));
    }
  }
}
