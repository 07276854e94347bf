#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/hash.hpp"
#include "support/catch.hpp"
#include "unit/radio/fixture.hpp"
#include "unit/radio/samples.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::channel_with;
using test::links_of;
using test::mote;
using test::radio_fixture;

namespace {

link_override loss_of(mote_address from, mote_address to, double loss) {
  return {from, to, loss, {}};
}

link_override gain_of(mote_address from, mote_address to, double gain_db) {
  return {from, to, {}, gain_db};
}

/// The sum of the radio_counters of all links that radios have now.
copy_counters over_links(const channel& x) {
  copy_counters sum;
  for (std::uint32_t from = 0; from < x.links().size(); ++from)
    for (std::uint32_t to = 0; to < x.links().size(); ++to)
      sum += x.counts().on_link(radio_index{from}, radio_index{to});
  return sum;
}

std::string text_of(const output& x) {
  if (const auto* got = std::get_if<delivered>(&x))
    return "delivered " + to_string(got->to) + ' ' + to_hex(got->psdu.view()) + ' ' +
           std::to_string(got->rssi_dbm) + ' ' + std::to_string(got->lqi);
  if (const auto* end = std::get_if<done>(&x))
    return "done " + to_string(end->radio) + ' ' + std::to_string(end->token) + ' ' +
           to_string(end->status) + ' ' + std::to_string(end->transmissions) + ' ' +
           std::to_string(end->arrived) + ' ' + to_string(end->last);
  if (const auto* flat = std::get_if<exhausted>(&x))
    return "exhausted " + to_string(flat->radio);
  return "overheard";
}

/// Some traffic between four motes.
void chatter(radio_fixture& x, std::uint64_t seed, int frames = 300) {
  random_stream rng(seed);
  for (int i = 0; i < frames; ++i) {
    const radio_index from{static_cast<std::uint32_t>(rng.below(4))};
    const auto to =
        rng.chance(0.3) ? broadcast_mote.value : static_cast<std::uint16_t>(1 + rng.below(4));
    x.send(from, static_cast<std::uint64_t>(i), to, rng.below(60), rng.chance(0.7));
    x.run_for(rng.between(0ms, 8ms));
  }
  x.run_for(1s);
}

} // namespace

TEST_CASE("a file's loss of 1 on one link lets nothing cross it and leaves the others alone",
          "[radio][links][GEN-03]") {
  const auto run = [](bool lossy) {
    radio_fixture x(channel_with([&](auto& c) {
      c.retries_max = 0;
      if (lossy)
        c.links = {loss_of(mote(1), mote(2), 1)};
    }));
    for (std::uint16_t i = 1; i <= 3; ++i)
      x.add(i, i);
    for (std::uint32_t i = 0; i < 90; ++i) { // one after the other
      x.send(radio_index{i % 3}, i, 0xffff, 20);
      x.run_for(20ms);
    }
    return x;
  };
  const auto plain = run(false);
  const auto lossy = run(true);
  for (std::uint32_t from = 0; from < 3; ++from) {
    for (std::uint32_t to = 0; to < 3; ++to) {
      if (from == to)
        continue;
      const auto counters = lossy.channel.counts().on_link(radio_index{from}, radio_index{to});
      INFO(from << " to " << to);
      CHECK(counters.sent == 30);
      if (from == 0 && to == 1)
        CHECK(counters.of(copy_outcome::loss) == 30);
      else
        CHECK(counters == plain.channel.counts().on_link(radio_index{from}, radio_index{to}));
    }
  }
  CHECK(lossy.delivered_to(radio_index{1}) == 30);
  CHECK(plain.delivered_to(radio_index{1}) == 60);
}

TEST_CASE("a link's loss replaces the channel's", "[radio][links][GEN-03]") {
  radio_fixture x(channel_with([](auto& c) {
    c.loss = 0.5;
    c.links = {loss_of(mote(1), mote(2), 0.1), loss_of(mote(1), mote(3), 0)};
  }));
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 1);
  const auto c = x.add(3, 2);
  const auto d = x.add(4, 3);
  constexpr int frames = 4000;
  for (int i = 0; i < frames; ++i) {
    x.send(a, 0, 0xffff, 4);
    x.run_for(10ms);
  }
  const auto lost = [&](radio_index to) {
    return static_cast<double>(x.channel.counts().on_link(a, to).of(copy_outcome::loss)) / frames;
  };
  CHECK(lost(b) == Approx(0.1).margin(0.025)); // five standard deviations
  CHECK(lost(c) == 0);
  CHECK(lost(d) == Approx(0.5).margin(0.04));
}

TEST_CASE("a link's gain holds for its direction only", "[radio][links]") {
  radio_fixture x(channel_with([](auto& c) {
    c.propagation = log_distance{};
    c.collisions = collision_rule::sinr;
    c.links = {gain_of(mote(1), mote(2), -92), gain_of(mote(2), mote(3), -96),
               gain_of(mote(3), mote(1), -120)};
  }));
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  const auto c = x.add(3, 20);
  for (const auto from : {a, b, c}) {
    x.send(from, 0, 0xffff, 4);
    x.run_for(100ms);
  }
  CHECK(x.channel.counts().on_link(a, b).of(copy_outcome::delivered) == 1);
  CHECK(x.channel.counts().on_link(b, a).of(copy_outcome::delivered) == 1);
  CHECK(x.channel.counts().on_link(b, c).of(copy_outcome::weak) == 1); // below the sensitivity
  CHECK(x.channel.counts().on_link(c, b).of(copy_outcome::delivered) == 1);
  CHECK(x.channel.counts().on_link(c, a).sent == 0); // below the cutoff: no link
  CHECK(x.channel.counts().on_link(a, c).of(copy_outcome::delivered) == 1);
  for (const auto& got : x.all<delivered>()) {
    if (got.to == b && got.content.source == mote_id{1})
      CHECK(got.rssi_dbm == -92);
    if (got.to == a)
      CHECK(got.rssi_dbm == -70); // 10 m
  }
}

TEST_CASE("an ack goes back over the other direction", "[radio][links]") {
  radio_fixture x(channel_with([](auto& c) {
    c.propagation = links_of({{1, 2, -60}}); // there is no route back
    c.retries_max = 2;
  }));
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  x.send(a, 7, 2, 4);
  x.run_for(1s);
  CHECK(x.delivered_to(b) == 1);
  const auto ended = x.all<done>().front();
  CHECK(ended.status == send_status::no_ack);
  CHECK(ended.arrived);
  CHECK(ended.transmissions == 3);
  CHECK(x.channel.counts().on_link(a, b).of(copy_outcome::delivered) == 1);
  CHECK(x.channel.counts().on_link(a, b).of(copy_outcome::duplicate) == 2);
  CHECK(x.channel.counts().by(b).acks == 3);
  CHECK(x.channel.counts().on_link(b, a) == copy_counters{});
}

TEST_CASE("a request has the outcome of its last copy at its destination", "[radio][links]") {
  const auto last = [](float gain, double loss, power state, std::uint16_t to) {
    radio_fixture x(channel_with([&](auto& c) {
      c.propagation = links_of({{1, 2, gain}});
      c.loss = loss;
      c.retries_max = 0;
    }));
    const auto a = x.add(1, 0);
    const auto b = x.add(2, 10);
    x.set_power(b, state);
    x.send(a, 7, to, 4);
    x.run_for(100ms);
    return x.all<done>().front().last;
  };
  CHECK(last(-60, 0, power::on, 2) == copy_outcome::delivered);
  CHECK(last(-96, 0, power::on, 2) == copy_outcome::weak);
  CHECK(last(-60, 1, power::on, 2) == copy_outcome::loss);
  CHECK(last(-60, 0, power::off, 2) == copy_outcome::off);
  CHECK(last(-116, 0, power::on, 2) == copy_outcome::out_of_reach);
  CHECK(last(-60, 0, power::on, 3) == copy_outcome::out_of_reach);
}

TEST_CASE("links add up to the radios and these to the channel", "[radio][links]") {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    radio_fixture x(channel_with([](auto& c) {
                      c.propagation = log_distance{3, 40, 6, 3};
                      c.collisions = collision_rule::sinr;
                      c.noise = constant_noise{-95};
                      c.loss = 0.05;
                    }),
                    seed);
    for (std::uint16_t i = 1; i <= 4; ++i)
      x.add(i, 25.0 * i);
    chatter(x, seed);
    const auto all = x.channel.counts().by_all();
    CHECK(over_links(x.channel) == all.copies);
    for (std::uint32_t to = 0; to < 4; ++to) {
      copy_counters into;
      for (std::uint32_t from = 0; from < 4; ++from) {
        const auto link = x.channel.counts().on_link(radio_index{from}, radio_index{to});
        CHECK(link.balanced());
        into += link;
      }
      CHECK(into == x.channel.counts().by(radio_index{to}).copies);
      CHECK(x.channel.counts().by(radio_index{to}) == x.channel.counts().by_radio()[to]);
    }
    CHECK(x.channel.counts().balanced());
  }
}

TEST_CASE("a radio that moves closes the radio_counters of its links but loses none of them",
          "[radio][links]") {
  radio_fixture x;
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  const auto c = x.add(3, 20);
  for (int i = 0; i < 5; ++i) {
    x.send(a, 0, 0xffff, 4);
    x.run_for(20ms);
  }
  CHECK(x.channel.counts().on_link(a, b).of(copy_outcome::delivered) == 5);
  x.channel.move(b, {500, 0, 0});
  x.send(a, 0, 0xffff, 4);
  x.run_for(20ms);
  CHECK(x.channel.counts().on_link(a, b) == copy_counters{});
  CHECK(x.channel.counts().on_link(a, c).sent == 1);
  CHECK(x.channel.counts().by(b).copies.sent == 5); // not forgotten
  CHECK(x.channel.counts().by(c).copies.sent == 6);
  CHECK(x.channel.counts().balanced());
  x.channel.move(b, {10, 0, 0});
  x.send(a, 0, 0xffff, 4);
  x.run_for(20ms);
  CHECK(x.channel.counts().on_link(a, b).of(copy_outcome::delivered) == 1);
  CHECK(x.channel.counts().by(b).copies.sent == 6);
  CHECK(x.channel.counts().balanced());
}

TEST_CASE("radio_counters balance while radios wander and more of them come", "[radio][links]") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    random_stream rng(seed);
    radio_fixture x(channel_with([&](auto& c) {
                      c.propagation = unit_disk{25};
                      c.loss = 0.1;
                    }),
                    seed);
    for (std::uint16_t i = 1; i <= 4; ++i)
      x.add(i, 10.0 * i);
    for (int i = 0; i < 300; ++i) {
      const radio_index any{static_cast<std::uint32_t>(rng.below(x.channel.links().size()))};
      x.send(any, 0, 0xffff, rng.below(100));
      x.run_for(rng.between(0ms, 3ms));
      const radio_index mover{static_cast<std::uint32_t>(rng.below(x.channel.links().size()))};
      if (rng.chance(0.3))
        x.channel.move(mover, {60 * rng.unit(), 0, 0});
      if (rng.chance(0.02))
        x.add(static_cast<std::uint16_t>(5 + i), 60 * rng.unit());
      if (!x.channel.counts().balanced())
        FAIL("out of balance at step " << i);
    }
    x.run_for(1s);
    CHECK(x.channel.counts().balanced());
    const auto all = x.channel.counts().by_all();
    CHECK(all.copies.sent > over_links(x.channel).sent);
  }
}

TEST_CASE("watching lets frames out and changes nothing else", "[radio][links]") {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    std::vector<std::pair<instant, std::string>> plain;
    std::vector<std::pair<instant, std::string>> watched;
    std::vector<overheard> seen;
    radio_counters counted[2];
    for (const bool watch : {false, true}) {
      radio_fixture x(channel_with([](auto& c) {
                        c.propagation = log_distance{};
                        c.collisions = collision_rule::sinr;
                        c.noise = constant_noise{-90};
                      }),
                      seed);
      for (std::uint16_t i = 1; i <= 4; ++i)
        x.add(i, 15.0 * i);
      if (watch)
        x.channel.watch();
      chatter(x, seed);
      for (const auto& [at, what] : x.log)
        if (!std::holds_alternative<overheard>(what))
          (watch ? watched : plain).emplace_back(at, text_of(what));
      if (watch)
        seen = x.all<overheard>();
      else
        CHECK(x.all<overheard>().empty());
      counted[watch ? 1 : 0] = x.channel.counts().by_all();
    }
    CHECK(plain == watched);
    CHECK(plain.size() > 300);
    CHECK(counted[0] == counted[1]);
    CHECK(seen.size() == counted[1].transmissions);
    std::size_t acks = 0;
    std::size_t received = 0;
    for (const auto& x : seen) {
      const auto content = decode(x.psdu.view());
      REQUIRE(content);
      CHECK(x.pan == 1);
      acks += content->type == frame_type::ack ? 1 : 0;
      received += x.received ? 1 : 0;
    }
    CHECK(acks == counted[1].acks);
    CHECK(received > 0);
    CHECK(received < seen.size());
  }
}

TEST_CASE("what is overheard has its beginning and whether it was received", "[radio][links]") {
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 0; }));
  const auto a = x.add(1, 0, 5);
  x.add(2, 10, 5);
  x.channel.watch();
  x.send(a, 1, 2, 2);
  x.run_for(100ms);
  x.send(a, 2, 9, 2); // nobody
  x.run_for(100ms);
  const auto seen = x.all<overheard>();
  REQUIRE(seen.size() == 3);
  const auto frame_end = x.times_of<delivered>().front();
  CHECK(seen[0].begin == frame_end - 672us);
  CHECK(seen[0].psdu == x.all<delivered>().front().psdu);
  CHECK(seen[0].received);
  CHECK(seen[0].pan == 5);
  CHECK(seen[1].begin == frame_end + 192us);
  CHECK(decode(seen[1].psdu.view())->type == frame_type::ack);
  CHECK(decode(seen[1].psdu.view())->dsn == decode(seen[0].psdu.view())->dsn);
  CHECK(seen[1].received);
  CHECK_FALSE(seen[2].received);
  CHECK(seen[0].outcome == copy_outcome::delivered);
  CHECK(seen[2].outcome == copy_outcome::out_of_reach);
}

TEST_CASE("an ack that falls due while its radio sends is not sent", "[radio][links]") {
  // By energy alone a radio does not sense the weak frame that it is receiving: it may turn to
  // sending at the frame's end and be busy when the ack would be due.
  radio_fixture x(channel_with([](auto& c) {
    c.propagation = links_of({{1, 2, -85}, {2, 1, -85}});
    c.collisions = collision_rule::sinr;
    c.sensing = sensing::energy;
    c.retries_max = 0;
    c.queue = 2;
  }));
  auto quick = *find_platform("iris");
  quick.service_time = 10us;
  const auto a = x.add(1, 0, 1, &quick);
  const auto b = x.add(2, 10, 1, &quick);
  const auto until = x.now + 60s;
  random_stream rng(1);
  while (x.now < until) {
    x.send(a, 1, 2, 4);
    x.send(b, 2, 0xffff, 4);
    x.run_for(rng.between(0ms, 8ms));
  }
  x.run_for(1s);
  const auto radio_counters = x.channel.counts().by(b);
  CHECK(radio_counters.copies.of(copy_outcome::delivered) > 1000);
  CHECK(radio_counters.acks > 1000);
  CHECK(radio_counters.acks < radio_counters.copies.of(copy_outcome::delivered));
  CHECK(x.channel.counts().balanced());
}

TEST_CASE("one mote of two islands with the same id is not the other", "[radio][links][RTG-06]") {
  radio_fixture x(channel_with([](auto& c) {
    c.retries_max = 0;
    c.links = {loss_of(mote(1, 1), mote(2, 1), 1)};
  }));
  const auto a1 = x.add(1, 0, 1);
  const auto b1 = x.add(2, 1, 1);
  const auto a2 = x.add(1, 2, 2);
  const auto b2 = x.add(2, 3, 2);
  x.send(a1, 1, 2, 4);
  x.run_for(100ms);
  x.send(a2, 2, 2, 4);
  x.run_for(100ms);
  CHECK(x.delivered_to(b1) == 0);
  CHECK(x.delivered_to(b2) == 1);
  CHECK(x.channel.counts().on_link(a1, b1).of(copy_outcome::loss) == 1);
  CHECK(x.channel.counts().on_link(a1, b2).of(copy_outcome::filtered) == 1);
  CHECK(x.channel.counts().on_link(a2, b1).of(copy_outcome::filtered) >= 1);
}
