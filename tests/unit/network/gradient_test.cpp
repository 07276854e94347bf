#include "network/tree/gradient.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::network;

namespace {

constexpr mote_id sink{1};

/// A mote of id 9 whose neighbours all have an ETX of about one.
struct listener {
  gradient tree{gradient_config{.self = mote_id{9}}};
  neighbours links;
  instant now{};
  std::uint16_t sequence = 0;

  void hear(mote_id mote) {
    link_report x;
    x.source = mote;
    x.next = 24s;
    x.hears_us = 255;
    for (int i = 0; i < 40; ++i) {
      x.sequence = ++sequence;
      static_cast<void>(links.on_beacon(x, now));
    }
  }

  gradient_change beacon(std::uint16_t mote, gradient_part x) {
    if (!links.find(mote_id{mote}))
      hear(mote_id{mote});
    static_cast<void>(tree.on_beacon(mote_id{mote}, x, links));
    return tree.update(links, now);
  }

  /// Four unicasts fail: the link is not usable any more.
  gradient_change lose(std::uint16_t mote) {
    for (int i = 0; i < 4; ++i)
      links.on_sent(mote_id{mote}, false, 4, now);
    return tree.update(links, now);
  }
};

gradient_part route(std::uint16_t root_sequence, double etx, std::uint8_t hops = 1,
                    mote_id parent = sink) {
  return {sink, root_sequence, parent, static_cast<etx_cost>(etx * etx_one), hops};
}

const gradient_part poison{sink, 0, no_mote, etx_infinite, 0};

} // namespace

TEST_CASE("the parent is the neighbour with the least cost, then hops, then id",
          "[network][NET-02]") {
  listener at;
  CHECK(!at.tree.has_route());
  CHECK(at.beacon(5, route(1, 4)) == gradient_change::parent);
  CHECK(at.tree.parent() == mote_id{5});
  CHECK(at.tree.root() == sink);
  CHECK(at.tree.cost() == Approx(5 * etx_one).margin(10));
  CHECK(at.tree.hops() == 2);
  CHECK(at.beacon(4, route(1, 3.9)) == gradient_change::none); // hysteresis
  CHECK(at.beacon(6, route(1, 3)) == gradient_change::parent);
  CHECK(at.tree.parent() == mote_id{6});
  CHECK(at.tree.counters().parent_changes == 1);

  listener tied;
  static_cast<void>(tied.beacon(5, route(1, 4)));
  static_cast<void>(tied.beacon(6, route(1, 3, 2)));
  static_cast<void>(tied.beacon(7, route(1, 3, 1)));
  static_cast<void>(tied.beacon(8, route(1, 3, 1)));
  CHECK(tied.beacon(6, poison) == gradient_change::parent);
  CHECK(tied.tree.parent() == mote_id{7});
}

TEST_CASE("a lost parent is replaced by a neighbour with as new or newer news of the root",
          "[network][NET-09]") {
  listener at;
  static_cast<void>(at.beacon(5, route(7, 1)));
  static_cast<void>(at.beacon(6, route(6, 1)));
  static_cast<void>(at.tree.advertise());
  CHECK(at.lose(5) == gradient_change::lost); // 6 might be telling what it once had from us
  CHECK(at.beacon(6, route(7, 1)) == gradient_change::parent);
  CHECK(at.tree.parent() == mote_id{6});
  CHECK(at.lose(6) == gradient_change::lost);
  CHECK(!at.tree.has_route());
  const auto told = at.tree.advertise();
  CHECK(told.cost == etx_infinite);
  CHECK(told.parent == no_mote);
  CHECK(at.tree.counters().losses == 2);
}

TEST_CASE("a route that may lead back to this mote is not taken", "[network][NET-09]") {
  listener at;
  static_cast<void>(at.beacon(5, route(7, 1)));
  static_cast<void>(at.tree.advertise());
  static_cast<void>(at.beacon(6, route(7, 3, 3, mote_id{9}))); // our child
  static_cast<void>(at.beacon(7, route(7, 4, 4, mote_id{6}))); // our grandchild
  CHECK(at.tree.children() == std::vector{mote_id{6}});
  CHECK(at.beacon(5, poison) == gradient_change::lost);
  CHECK(at.beacon(7, route(7, 2.5, 4, mote_id{6})) == gradient_change::none);
  // A newer number cannot have come from us.
  CHECK(at.beacon(7, route(8, 2.5, 4, mote_id{2})) == gradient_change::parent);
  CHECK(at.tree.parent() == mote_id{7});
}

TEST_CASE("a route of too many hops or too much cost is none", "[network][NET-02]") {
  listener at;
  CHECK(at.beacon(5, route(1, 4, 64)) == gradient_change::none);
  CHECK(at.beacon(6, {sink, 1, sink, etx_infinite - 5, 3}) == gradient_change::none);
  CHECK(at.beacon(5, route(1, 4, 63)) == gradient_change::parent);
  CHECK(at.tree.hops() == 64);
}

TEST_CASE("a root that is silent is gone after a while", "[network][NET-09]") {
  listener at;
  static_cast<void>(at.beacon(5, route(7, 1)));
  static_cast<void>(at.tree.advertise());
  at.now += 20min;
  CHECK(at.beacon(5, route(7, 1)) == gradient_change::none);
  at.now += 1s;
  CHECK(at.beacon(5, route(7, 1)) == gradient_change::lost);
  CHECK(at.beacon(5, route(6, 1)) == gradient_change::none);
  CHECK(at.beacon(5, route(8, 1)) == gradient_change::parent);
}

TEST_CASE("another root is turned to only when there is no route to ours", "[network][NET-09]") {
  listener at;
  static_cast<void>(at.beacon(5, route(7, 3)));
  const gradient_part foreign{mote_id{2}, 1, mote_id{2}, etx_one, 1};
  CHECK(at.beacon(6, foreign) == gradient_change::none);
  CHECK(at.tree.counters().foreign_roots == 1);
  CHECK(at.beacon(5, poison) == gradient_change::parent);
  CHECK(at.tree.root() == mote_id{2});
}

TEST_CASE("a root advertises cost 0 and goes on counting after a restart", "[network][NET-09]") {
  gradient root({.self = sink, .is_root = true});
  listener at;
  CHECK(root.has_route());
  CHECK(root.advertise() == gradient_part{sink, 1, no_mote, 0, 0});
  CHECK(root.advertise().root_sequence == 2);
  at.hear(mote_id{5});
  static_cast<void>(root.on_beacon(mote_id{5}, route(4711, 1), at.links));
  CHECK(root.update(at.links, at.now) == gradient_change::none);
  CHECK(root.parent() == no_mote);
  CHECK(root.advertise().root_sequence == 4712);
}

TEST_CASE("a mote with a route is asked to beacon soon by a neighbour without",
          "[network][NET-09]") {
  listener at;
  at.hear(mote_id{6});
  CHECK(!at.tree.on_beacon(mote_id{6}, poison, at.links)); // no route ourselves
  static_cast<void>(at.beacon(5, route(1, 1)));
  CHECK(at.tree.on_beacon(mote_id{6}, poison, at.links));
  CHECK(!at.tree.on_beacon(mote_id{5}, route(2, 1), at.links));
  CHECK(!at.tree.on_beacon(mote_id{77}, poison, at.links)); // not a neighbour
}

TEST_CASE("a packet whose cost does not fall is on a loop", "[network][NET-09]") {
  listener at;
  CHECK(!at.tree.is_loop(0));
  static_cast<void>(at.beacon(5, route(1, 1)));
  CHECK(at.tree.is_loop(at.tree.cost()));
  CHECK(!at.tree.is_loop(static_cast<etx_cost>(at.tree.cost() + 1)));
}

TEST_CASE("a number that the root never had does not cut a mote off", "[network][NET-02]") {
  listener at;
  std::uint16_t number = 100;
  CHECK(at.beacon(5, route(number, 1)) == gradient_change::parent);
  CHECK(at.beacon(6, route(20'000, 1)) == gradient_change::none);
  CHECK(at.lose(5) == gradient_change::parent); // to the liar,
  static_cast<void>(at.tree.advertise());       // and tells others of it
  CHECK(at.beacon(6, poison) == gradient_change::lost);
  at.hear(mote_id{7});
  int beacons = 0;
  while (!at.tree.has_route() && beacons < 100) {
    at.now += 16s;
    static_cast<void>(at.beacon(7, route(++number, 1)));
    ++beacons;
  }
  CHECK(beacons == 9); // the first is compared with nothing
  CHECK(at.tree.parent() == mote_id{7});
  CHECK(at.tree.counters().forgotten == 1);
}

TEST_CASE("old news of a dead root does not count on", "[network]") {
  listener at;
  CHECK(at.beacon(5, route(100, 1)) == gradient_change::parent);
  static_cast<void>(at.tree.advertise());
  CHECK(at.beacon(5, poison) == gradient_change::lost);
  for (int i = 0; i < 100; ++i) {
    at.now += 16s;
    static_cast<void>(at.beacon(7, route(99, 3, 3, mote_id{8})));
  }
  CHECK(!at.tree.has_route());
  CHECK(at.tree.counters().forgotten == 0);
}

TEST_CASE("a parent whose route gets dearer is kept: it cannot lead back here",
          "[network][NET-09]") {
  listener at;
  static_cast<void>(at.beacon(5, route(7, 2)));
  CHECK(at.tree.advertise().cost == Approx(3 * etx_one).margin(10));
  CHECK(at.beacon(5, route(7, 6)) == gradient_change::none);
  CHECK(at.tree.parent() == mote_id{5});
  CHECK(at.tree.cost() == Approx(7 * etx_one).margin(10));
  // Who never told less than we do may have its route from us.
  CHECK(at.beacon(6, route(7, 4)) == gradient_change::none);
  CHECK(at.beacon(5, poison) == gradient_change::lost);
}

TEST_CASE("what a neighbour has advertised in an earlier life proves nothing",
          "[network][NET-09]") {
  listener at;
  static_cast<void>(at.beacon(5, route(7, 2)));
  static_cast<void>(at.tree.advertise());
  const bool restarted = true;
  static_cast<void>(at.tree.on_beacon(mote_id{5}, route(7, 6), at.links, restarted));
  CHECK(at.tree.update(at.links, at.now) == gradient_change::lost);
}

TEST_CASE("who waits for a newer sequence number is noticed, and the number passed on",
          "[network][NET-09]") {
  listener at;
  static_cast<void>(at.beacon(5, route(7, 1)));
  at.hear(mote_id{6});
  const gradient_part lost{sink, 7, no_mote, etx_infinite, 0};
  static_cast<void>(at.beacon(6, lost));
  CHECK_FALSE(at.tree.starves(mote_id{6})); // it may not have received our route yet
  static_cast<void>(at.beacon(6, lost));
  CHECK(at.tree.starves(mote_id{6}));
  CHECK_FALSE(at.tree.starves(mote_id{5}));
  auto news = route(8, 1);
  news.urgent = true;
  static_cast<void>(at.beacon(5, news));
  CHECK(at.tree.is_urgent());
  CHECK_FALSE(at.tree.starves(mote_id{6})); // what we tell now is new to it
  const auto told = at.tree.advertise();
  CHECK(told.urgent);
  CHECK(told.root_sequence == 8);
  CHECK_FALSE(at.tree.advertise().urgent); // once
  static_cast<void>(at.beacon(5, news));
  CHECK_FALSE(at.tree.is_urgent()); // the same number again is no news
}

TEST_CASE("who is a little behind is not proof that a sequence number is false",
          "[network][NET-09]") {
  const int behind = GENERATE(4, 40);
  listener at;
  static_cast<void>(at.beacon(5, route(200, 2)));
  static_cast<void>(at.tree.advertise());
  static_cast<void>(at.beacon(5, poison));
  // It may have its route through us: to use it would close a loop.
  for (int i = 0; i < 20; ++i)
    static_cast<void>(
        at.beacon(6, route(static_cast<std::uint16_t>(200 - behind + i % behind), 4)));
  CHECK(at.tree.has_route() == (behind == 40));
}
