#include "network/tree/neighbours.hpp"
#include "support/catch.hpp"
#include "support/start.hpp"

using namespace rubicon;
using namespace rubicon::network;
using test::start;

namespace {

/// Beacons of one neighbour, a second apart.
struct sender {
  mote_id mote;
  std::uint16_t sequence = 100;
  instant now = start;
  std::optional<std::uint8_t> hears_us = 255;
  bool is_crowded = false;

  /// One that arrives.
  admission beacon(neighbours& at) {
    now += 1s;
    link_report x;
    x.source = mote;
    x.sequence = ++sequence;
    x.next = 1s;
    x.hears_us = hears_us;
    x.is_crowded = is_crowded;
    return at.on_beacon(x, now);
  }

  void beacons(neighbours& at, int count) {
    for (int i = 0; i < count; ++i)
      static_cast<void>(beacon(at));
  }

  /// One that does not, as the receiver learns from the next one's number.
  void lose() {
    now += 1s;
    ++sequence;
  }
};

double in_of(const neighbours& at, mote_id mote) {
  return static_cast<double>(at.find(mote)->in) / quality_max;
}

neighbours full_of_good_ones(std::size_t count) {
  neighbours at({.capacity = count});
  for (std::size_t i = 0; i < count; ++i)
    sender{mote_id{static_cast<std::uint16_t>(10 + i)}}.beacons(at, 6);
  return at;
}

} // namespace

TEST_CASE("a few beacons prove little, and many show the share that arrives", "[network][NET-10]") {
  neighbours at;
  sender a{mote_id{7}};
  CHECK(a.beacon(at) == admission::added);
  CHECK(in_of(at, a.mote) == Approx(0.75).margin(0.001));
  CHECK(a.beacon(at) == admission::known);
  a.lose();
  a.beacons(at, 1);
  CHECK(in_of(at, a.mote) == Approx(3.5 / 5).margin(0.001)); // three of four, and a half of one
  for (int i = 0; i < 60; ++i) {
    a.lose();
    a.beacons(at, 1);
  }
  CHECK(in_of(at, a.mote) == Approx(0.5).margin(0.05));
  a.beacons(at, 100);
  CHECK(in_of(at, a.mote) > 0.98);
}

TEST_CASE("a link is good from six beacons on, in both directions, with hysteresis",
          "[network][NET-10]") {
  neighbours at;
  sender a{mote_id{7}};
  a.hears_us = 217; // 0.851
  a.beacons(at, 5);
  CHECK(!at.good(a.mote));
  a.beacons(at, 1);
  CHECK(at.good(a.mote));
  a.hears_us = 180; // 0.706
  a.beacons(at, 1);
  CHECK(at.good(a.mote));
  a.hears_us = 178; // 0.698
  a.beacons(at, 1);
  CHECK(!at.good(a.mote));
  a.hears_us = 216; // 0.847
  a.beacons(at, 20);
  CHECK(!at.good(a.mote));
  a.hears_us = 217;
  a.beacons(at, 1);
  CHECK(at.good(a.mote));
}

TEST_CASE("a link that works in one direction only is neither good nor usable",
          "[network][NET-10]") {
  neighbours at;
  sender a{mote_id{7}};
  a.hears_us.reset();
  a.beacons(at, 30);
  CHECK(in_of(at, a.mote) > 0.9);
  CHECK(!at.good(a.mote));
  CHECK(!at.etx(a.mote));
  a.hears_us = 255;
  a.beacons(at, 1);
  CHECK(at.good(a.mote));
  CHECK(at.etx(a.mote));
  a.hears_us.reset();
  a.beacons(at, 5);
  CHECK(at.good(a.mote)); // lists take turns
  a.beacons(at, 1);
  CHECK(!at.good(a.mote)); // it has forgotten us
}

TEST_CASE("a link to a mote that has no room for us in its table is tried, and judged by unicasts",
          "[network][NET-10]") {
  neighbours at;
  sender a{mote_id{7}};
  a.hears_us.reset();
  a.is_crowded = true;
  a.beacons(at, 2);
  CHECK(!at.etx(a.mote));
  a.beacons(at, 200);
  REQUIRE(at.etx(a.mote));
  CHECK(*at.etx(a.mote) == Approx(etx_one / 0.75).margin(3)); // more than if it heard us well
  CHECK(!at.good(a.mote));                                    // nothing is proved
  at.on_sent(a.mote, true, 1, a.now);
  CHECK(at.etx(a.mote));
  for (int i = 0; i < 4; ++i)
    at.on_sent(a.mote, false, 4, a.now);
  CHECK(!at.etx(a.mote));
}

TEST_CASE("ETX is one over the product of both directions", "[network][NET-09]") {
  neighbours at;
  sender a{mote_id{7}};
  a.hears_us = 128;
  a.beacons(at, 2);
  CHECK(!at.etx(a.mote)); // too few
  a.beacons(at, 200);
  CHECK(*at.etx(a.mote) == Approx(2 * etx_one).margin(3));
  a.hears_us = 12; // 0.047
  a.beacons(at, 1);
  CHECK(!at.etx(a.mote));
  CHECK(!at.etx(mote_id{8}));
}

TEST_CASE("unicasts that are not acknowledged make a link unusable before beacons do",
          "[network][NET-09]") {
  neighbours at;
  sender a{mote_id{7}};
  a.beacons(at, 30);
  const auto before = *at.etx(a.mote);
  at.on_sent(a.mote, true, 1, a.now);
  CHECK(*at.etx(a.mote) <= before + 10);
  int packets = 0;
  while (at.etx(a.mote) && packets < 10) {
    at.on_sent(a.mote, false, 4, a.now);
    ++packets;
  }
  CHECK(packets == 4);
  CHECK(!at.good(a.mote));
  a.beacons(at, 16); // what is heard counts again when nothing is sent
  CHECK(at.good(a.mote));
  CHECK(*at.etx(a.mote) <= before);
  at.on_sent(mote_id{99}, false, 4, a.now); // nobody we know
}

TEST_CASE("a neighbour that acknowledges, or sends anything, is not silent", "[network][NET-09]") {
  for (const bool acknowledges : {true, false}) {
    neighbours at({.beacon_gap_max = 24s});
    sender a{mote_id{7}};
    a.beacons(at, 30);
    for (int i = 0; i < 20; ++i) {
      const auto now = *at.deadline();
      CHECK(at.on_time(now).empty());
      CHECK(at.find(a.mote)->missed == 1);
      if (acknowledges)
        at.on_sent(a.mote, true, 1, now);
      else
        at.hear(a.mote, now);
      CHECK(at.find(a.mote)->missed == 0);
      CHECK(*at.deadline() > now);
    }
    CHECK(at.etx(a.mote));
    at.hear(mote_id{99}, a.now); // nobody we know
    CHECK(at.all().size() == 1);
  }
}

TEST_CASE("a neighbour that is new makes room soon", "[network][NET-09]") {
  neighbours at;
  link_report x;
  x.source = mote_id{7};
  x.sequence = 1;
  x.next = 16384s; // it says
  static_cast<void>(at.on_beacon(x, instant{} + 1s));
  CHECK(at.deadline() == instant{} + 25s + 250ms);
  for (std::uint16_t i = 2; i <= 10; ++i) {
    x.sequence = i;
    static_cast<void>(at.on_beacon(x, instant{} + i * 1s));
  }
  CHECK(at.deadline() == instant{} + 10s + 12min + 250ms); // one that has shown itself
}

TEST_CASE("a neighbour that falls silent decays and is dropped", "[network][NET-09]") {
  neighbours at({.beacon_gap_max = 24s});
  sender a{mote_id{7}};
  a.beacons(at, 30);
  const auto last = a.now;
  REQUIRE(at.deadline() == last + 1250ms);
  CHECK(at.on_time(last + 1249ms).empty());
  CHECK(at.find(a.mote)->missed == 0);
  CHECK(at.on_time(last + 1250ms).empty());
  CHECK(at.find(a.mote)->missed == 1);
  CHECK(at.etx(a.mote));
  CHECK(at.on_time(*at.deadline()).empty()); // then 3 s, 9 s, 24 s, 24 s ...
  CHECK(!at.etx(a.mote));
  CHECK(at.good(a.mote));
  CHECK(at.on_time(*at.deadline()).empty());
  CHECK(at.find(a.mote)->missed == 3);
  CHECK(!at.good(a.mote));
  CHECK(at.heard(17).empty());
  const auto gone = at.on_time(last + 13250ms + 5 * 24s);
  CHECK(gone == std::vector{a.mote});
  CHECK(at.all().empty());
  CHECK(!at.deadline());
  CHECK(at.counters().dropped == 1);
}

TEST_CASE("a beacon that was overdue is not counted as lost twice", "[network][NET-09]") {
  neighbours once;
  neighbours both;
  sender a{mote_id{7}};
  sender b{mote_id{7}};
  a.beacons(once, 10);
  b.beacons(both, 10);
  a.lose();
  b.lose();
  static_cast<void>(both.on_time(b.now + 300ms));
  CHECK(both.find(b.mote)->missed == 1);
  a.beacons(once, 1);
  b.beacons(both, 1);
  CHECK(once.find(a.mote)->in == both.find(b.mote)->in);
  CHECK(both.find(b.mote)->missed == 0);
}

TEST_CASE("a neighbour that restarts is known anew, a repeated beacon teaches nothing",
          "[network][NET-09]") {
  neighbours at;
  sender a{mote_id{7}};
  a.sequence = 65530; // and on over the wrap
  a.beacons(at, 30);
  at.on_sent(a.mote, false, 4, a.now);
  --a.sequence;
  CHECK(a.beacon(at) == admission::repeated);
  CHECK(at.find(a.mote)->samples == 30);
  a.sequence = 0;
  CHECK(a.beacon(at) == admission::restarted);
  CHECK(at.find(a.mote)->samples == 1);
  CHECK(at.find(a.mote)->data_weight == 0);
  CHECK(!at.good(a.mote));
}

TEST_CASE("beacons that were not received are no restart, however many", "[network][NET-09]") {
  neighbours at;
  sender a{mote_id{7}};
  a.beacons(at, 6);
  a.sequence = static_cast<std::uint16_t>(a.sequence + 31);
  CHECK(a.beacon(at) == admission::known);
  CHECK(at.find(a.mote)->samples == 38);
  for (const int missed : {32, 500, 30'000}) {
    a.sequence = static_cast<std::uint16_t>(a.sequence + missed);
    CHECK(a.beacon(at) == admission::added);
    CHECK(at.find(a.mote)->samples == 1); // what it was before says nothing any more
  }
  CHECK(at.find(a.mote)->sequence > 30'000);
  a.sequence = 0; // less than half of all numbers ahead, but one of the first
  CHECK(a.beacon(at) == admission::restarted);
  CHECK(at.counters().restarted == 1);
}

TEST_CASE("a full table gives up the overdue, the deaf and the weak, in this order",
          "[network][NET-02]") {
  neighbours at({.capacity = 4});
  sender overdue{mote_id{1}};
  sender deaf{mote_id{2}};
  sender weak{mote_id{3}};
  sender good{mote_id{4}};
  deaf.hears_us.reset();
  weak.hears_us = 100;
  overdue.beacons(at, 20);
  for (auto* x : {&deaf, &weak, &good}) {
    x->now = start + 20s;
    x->beacons(at, 6);
  }
  static_cast<void>(at.on_time(start + 26s));
  REQUIRE(at.find(overdue.mote)->missed == 2);
  std::uint16_t next = 20;
  const auto newcomer = [&](instant now, bool matters = false) {
    link_report x;
    x.source = mote_id{next++};
    x.next = 16s;
    x.matters = matters;
    return at.on_beacon(x, now);
  };
  CHECK(newcomer(start + 26s) == admission::replaced);
  CHECK(!at.find(overdue.mote));
  CHECK(newcomer(start + 35s) == admission::refused); // too soon
  CHECK(newcomer(start + 36s) == admission::replaced);
  CHECK(!at.find(deaf.mote));
  CHECK(newcomer(start + 46s) == admission::replaced);
  CHECK(!at.find(weak.mote));
  CHECK(newcomer(start + 56s) == admission::refused); // one is good, the others are new
  CHECK(at.counters().refused == 2);
  at.pin(good.mote, true);
  CHECK(newcomer(start + 56s, true) == admission::refused);
  at.pin(good.mote, false);
  CHECK(newcomer(start + 56s, true) == admission::added); // it needs us
  CHECK(!at.find(good.mote));
  CHECK(at.all().size() == 4);
}

TEST_CASE("a pinned neighbour is never evicted, and of equals the highest id is",
          "[network][NET-02]") {
  auto at = full_of_good_ones(3);
  at.pin(mote_id{12}, true);
  link_report x;
  x.source = mote_id{5};
  x.matters = true;
  CHECK(at.on_beacon(x, start + 6s) == admission::added);
  CHECK(at.find(mote_id{10}));
  CHECK(!at.find(mote_id{11}));
  CHECK(at.find(mote_id{12}));
}

TEST_CASE("a pinned neighbour that restarts stays pinned", "[network][NET-02]") {
  auto at = full_of_good_ones(3);
  at.pin(mote_id{12}, true);
  sender again{mote_id{12}};
  again.sequence = 7;
  again.now = start + 6s;
  CHECK(again.beacon(at) == admission::restarted);
  again.beacons(at, 5);
  link_report x;
  x.source = mote_id{5};
  x.matters = true;
  CHECK(at.on_beacon(x, start + 12s) == admission::added);
  CHECK(!at.find(mote_id{11}));
  CHECK(at.find(mote_id{12}));
}

TEST_CASE("there is room for the sink in a table full of motes that nothing is known of",
          "[network][DIS-05]") {
  neighbours at({.capacity = 3});
  link_report x;
  for (const int mote : {2, 3, 4}) {
    x.source = mote_id{static_cast<std::uint16_t>(mote)};
    REQUIRE(at.on_beacon(x, start) == admission::added);
  }
  x.source = mote_id{5};
  x.matters = true;
  CHECK(at.on_beacon(x, start) == admission::refused); // all are new
  x.source = mote_id{1};
  x.is_sink = true;
  CHECK(at.on_beacon(x, start) == admission::added);
  CHECK(at.find(mote_id{1}));
  CHECK(at.all().size() == 3);
}

TEST_CASE("every neighbour has its turn in the list of those heard", "[network][NET-10]") {
  auto at = full_of_good_ones(5);
  std::vector<std::uint16_t> told;
  for (int i = 0; i < 5; ++i) {
    for (const auto& x : at.heard(2)) {
      told.push_back(x.mote.value);
      CHECK(x.quality == at.find(x.mote)->in / 257);
    }
  }
  CHECK(told == std::vector<std::uint16_t>{10, 11, 12, 13, 14, 10, 11, 12, 13, 14});
  CHECK(at.heard(17).size() == 5);
  CHECK(at.heard(0).empty());
}

TEST_CASE("the deadline is the earliest of all neighbours', whoever comes, goes and is late",
          "[network][NET-09]") {
  neighbours at({.capacity = 4});
  std::uint32_t rng = 7;
  auto now = start;
  std::uint64_t seen_departures = 0;
  for (int i = 0; i < 2000; ++i) {
    rng = rng * 1664525U + 1013904223U;
    now += std::chrono::milliseconds(rng >> 20);
    link_report x;
    x.source = mote_id{static_cast<std::uint16_t>(1 + (rng >> 8) % 7)};
    x.sequence = static_cast<std::uint16_t>(i);
    x.next = std::chrono::milliseconds((rng >> 4) % 8000);
    x.hears_us = 255;
    x.matters = (rng & 256U) != 0;
    const auto before = at.all().size();
    const auto departures = at.departures();
    static_cast<void>((rng & 512U) != 0 ? at.on_time(now).size()
                                        : static_cast<std::size_t>(at.on_beacon(x, now)));
    const bool has_shrunk = at.all().size() < before;
    CHECK((!has_shrunk || at.departures() > departures));
    seen_departures = at.departures();
    std::optional<instant> earliest_due;
    for (const auto& each : at.all())
      earliest_due = earliest(earliest_due, each.due);
    REQUIRE(at.deadline() == earliest_due);
  }
  CHECK(seen_departures > 10);
}

TEST_CASE("a backbone costs next to nothing until two unicasts in a row fail",
          "[network][NET-02]") {
  constexpr mote_id sink{1};
  neighbours at({.backbone = {sink}});
  CHECK(at.etx_min(sink) == etx_backbone);
  CHECK(at.etx_min(mote_id{2}) == etx_one);
  CHECK_FALSE(at.etx(sink));
  sender its{sink};
  its.hears_us.reset();
  its.beacon(at);
  CHECK(at.etx(sink) == etx_backbone); // at once, and whatever it says of us
  at.on_sent(sink, false, 1, its.now);
  CHECK(at.etx(sink) == etx_backbone);
  at.on_sent(sink, true, 1, its.now);
  at.on_sent(sink, false, 1, its.now);
  CHECK(at.etx(sink) == etx_backbone);
  at.on_sent(sink, false, 1, its.now);
  CHECK_FALSE(at.etx(sink));
  its.beacon(at);
  CHECK(at.etx(sink) == etx_backbone);
  at.on_time(its.now + 1h);
  CHECK_FALSE(at.etx(sink)); // silent
}
