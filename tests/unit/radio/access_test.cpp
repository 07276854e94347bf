// Parameters that a radio has of its own: medium access and channel.
#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "radio/mac.hpp"
#include "support/catch.hpp"
#include "unit/radio/fixture.hpp"
#include "unit/radio/samples.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::channel_with;
using test::micaz;
using test::radio_fixture;
using test::standard;

namespace {

constexpr island_id here{default_pan};

radio_config radio_at(std::uint16_t address, double x_m, const access_parameters& access = {},
                      std::uint8_t channel = default_channel) {
  radio_config x;
  x.address = mote_id{address};
  x.place = {x_m, 0, 0};
  x.kind = &micaz;
  x.access = access;
  x.channel = channel;
  return x;
}

/// Exponents of the windows after 0, 1, 2, ... busy assessments.
std::vector<unsigned> exponents(const mac_rules& x) {
  std::vector<unsigned> all;
  for (const auto& window : x.backoffs) {
    unsigned exponent = 0;
    while (1U << exponent < window.count)
      ++exponent;
    CHECK(1U << exponent == window.count);
    all.push_back(exponent);
  }
  return all;
}

/// Two radios side by side send to a third at the same moment, again and again, without repeats.
/// @returns copies that the third lost to collisions
std::uint64_t collisions(const access_parameters& access) {
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 0; }));
  const auto a = x.add(radio_at(1, 0, access));
  const auto b = x.add(radio_at(2, 10, access));
  const auto middle = x.add(radio_at(3, 5));
  for (int i = 0; i < 300; ++i) {
    x.send(a, 0, 3, 28);
    x.send(b, 0, 3, 28);
    x.run_for(100ms);
  }
  return x.channel.counts().by(middle).copies.of(copy_outcome::collision);
}

/// Frames of 1000 that arrive where three in ten copies are lost.
std::size_t delivered_with(const access_parameters& access) {
  radio_fixture x(channel_with([](auto& c) { c.loss = 0.3; }));
  const auto a = x.add(radio_at(1, 0, access));
  const auto b = x.add(radio_at(2, 10));
  for (int i = 0; i < 1000; ++i) {
    x.send(a, 0, 2, 28);
    x.run_for(100ms);
  }
  return x.delivered_to(b);
}

} // namespace

TEST_CASE("back-offs grow from macMinBE to macMaxBE", "[radio][mac][NET-15]") {
  CHECK(exponents(*standard) == std::vector<unsigned>{3, 4, 5, 5, 5, 5});
  CHECK(exponents(adjusted(*standard, {.min_be = 0})) == std::vector<unsigned>{0, 1, 2, 3, 4, 5});
  CHECK(exponents(adjusted(*standard, {.min_be = 6, .max_be = 8})) ==
        std::vector<unsigned>{6, 7, 8, 8, 8, 8});
  CHECK(exponents(adjusted(*standard, {.max_be = 3})) == std::vector<unsigned>{3, 3, 3, 3, 3, 3});
}

TEST_CASE("access fails after macMaxCSMABackoffs back-offs more", "[radio][mac][NET-15]") {
  for (const unsigned most : {0U, 1U, 4U, 5U}) {
    INFO(most);
    const auto rules = adjusted(*standard, {.backoffs_max = most});
    random_stream rng(1);
    mac x(&rules, 8, 3);
    outgoing frame;
    frame.psdu = bytes(41);
    x.submit(std::move(frame), instant{}, rng);
    unsigned assessments = 0;
    mac_action last;
    while (x.deadline()) {
      CHECK(x.earliest_output() >= *x.deadline());
      last = x.on_time(*x.deadline(), false, rng);
      ++assessments;
    }
    CHECK(assessments == most + 1);
    REQUIRE(last.ended);
    CHECK(last.ended->status == send_status::channel_access_failure);
  }
}

TEST_CASE("parameters that are not set are the rules' own", "[radio][mac]") {
  for (const auto& name : mac_names()) {
    const auto& rules = *find_mac(name, micaz);
    const auto same = adjusted(rules, {.retries_max = 7});
    CHECK(same.retries_max == 7);
    CHECK(same.assessments_max == rules.assessments_max);
    CHECK(same.backoffs.front().longest() == rules.backoffs.front().longest());
    CHECK(same.backoffs.back().longest() == rules.backoffs.back().longest());
  }
  // TinyOS's back-offs have no exponents.
  const auto& tinyos = *find_mac("cc2420", micaz);
  const auto tried = adjusted(tinyos, {.min_be = 0, .max_be = 3, .backoffs_max = 0});
  CHECK(tried.assessments_max == tinyos.assessments_max);
  CHECK(tried.backoffs.front().longest() == tinyos.backoffs.front().longest());
  CHECK(has_exponents(*standard));
  CHECK(!has_exponents(tinyos));
}

TEST_CASE("without a first back-off radios that begin together always collide",
          "[radio][channel][NET-15]") {
  CHECK(collisions({.min_be = 0}) == 600); // both copies, each time
  const auto usual = collisions({});       // one time in eight at most
  CHECK(usual > 0);
  CHECK(usual < 150);
  CHECK(collisions({.min_be = 6, .max_be = 8}) < usual);
}

TEST_CASE("a radio repeats a frame as often as it may itself", "[radio][channel][NET-15]") {
  const auto none = delivered_with({.retries_max = 0});
  const auto usual = delivered_with({});
  const auto most = delivered_with({.retries_max = 7});
  CHECK(none == Approx(700).margin(50));  // 0.7
  CHECK(usual == Approx(992).margin(10)); // 1 - 0.3^4
  CHECK(most >= 998);                     // 1 - 0.3^8
}

TEST_CASE("a repeat after a long back-off is known as one", "[radio][channel][NET-15]") {
  // Acknowledgements never come back, and repeats are farther apart than usual ones can be.
  for (const bool receiver_is_first : {true, false}) {
    radio_fixture x(channel_with([](auto& c) {
      c.links = {{{here, mote_id{2}}, {here, mote_id{1}}, 1.0, {}}};
    }));
    const auto slow = radio_at(1, 0, {.min_be = 8, .max_be = 8, .retries_max = 7});
    const auto a = receiver_is_first ? radio_index{1} : x.add(slow);
    const auto receiver = x.add(radio_at(2, 10));
    if (receiver_is_first)
      x.add(slow);
    for (int i = 0; i < 50; ++i) {
      x.send(a, 0, 2, 28);
      x.run_for(2s);
    }
    CHECK(x.delivered_to(receiver) == 50);
    CHECK(x.channel.counts().by(a).requests.failed.no_ack == 50);
  }
}

TEST_CASE("radios on different channels neither receive nor disturb each other",
          "[radio][channel][NET-15]") {
  radio_fixture x;
  const auto a = x.add(radio_at(1, 0, {}, 15));
  const auto b = x.add(radio_at(2, 10, {}, 15));
  const auto c = x.add(radio_at(3, 5, {}, 16));
  const auto d = x.add(radio_at(4, 6, {}, 16));
  CHECK(x.neighbours(a) == std::vector<radio_index>{b});
  CHECK(x.neighbours(d) == std::vector<radio_index>{c});
  // Both at once, without back-off: on one channel nothing would arrive.
  for (int i = 0; i < 100; ++i) {
    x.send(a, 0, 2, 28);
    x.send(c, 0, 4, 28);
    x.run_for(20ms);
  }
  CHECK(x.delivered_to(b) == 100);
  CHECK(x.delivered_to(d) == 100);
  const auto all = x.channel.counts().by_all().copies;
  CHECK(all.of(copy_outcome::collision) == 0);
  CHECK(all.of(copy_outcome::captured) == 0);
  CHECK(x.channel.counts().by_all().requests.failed.channel_access_failure == 0);
  CHECK(x.channel.counts().balanced());
}

TEST_CASE("no gain leads from one channel to another", "[radio][topology][NET-15]") {
  radio_fixture x(channel_with([](auto& c) {
    c.links = {{{here, mote_id{1}}, {here, mote_id{2}}, {}, -40.0}};
  }));
  const auto a = x.add(radio_at(1, 0, {}, 11));
  const auto b = x.add(radio_at(2, 500, {}, 26));
  CHECK(x.neighbours(a).empty()); // for all the gain that the file gives them
  x.channel.move(b, {1, 0, 0});
  CHECK(x.neighbours(a).empty());
  x.channel.change({{here, mote_id{2}}, {here, mote_id{1}}, {}, -50.0});
  CHECK(x.neighbours(b).empty());
  const auto c = x.add(radio_at(2, 500, {}, 11)); // on the sender's, it has that gain
  CHECK(x.neighbours(a) == std::vector<radio_index>{c});
}

TEST_CASE("noise disturbs its own channel, or all", "[radio][channel][GEN-03]") {
  for (const auto channel : {all_channels, std::uint8_t{15}, std::uint8_t{16}}) {
    INFO(int{channel});
    radio_fixture x;
    const auto a = x.add(radio_at(1, 0, {}, 15));
    const auto b = x.add(radio_at(2, 10, {}, 15));
    const auto c = x.add(radio_at(3, 0, {}, 16));
    const auto d = x.add(radio_at(4, 10, {}, 16));
    const auto noise = x.add(radio_at(no_mote.value, 5, {}, channel));
    x.set_power(noise, power::off);
    x.note(x.channel.set_noise(noise, true, x.now));
    for (int i = 0; i < 20; ++i) {
      x.send(a, 0, 2, 28);
      x.send(c, 0, 4, 28);
      x.run_for(50ms);
    }
    CHECK(x.delivered_to(b) == (channel == 16 ? 20 : 0));
    CHECK(x.delivered_to(d) == (channel == 15 ? 20 : 0));
  }
}
