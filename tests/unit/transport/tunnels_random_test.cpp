#include <algorithm>
#include <iterator>
#include <map>
#include <vector>

#include "support/seeds.hpp"
#include "unit/transport/tunnels_fixture.hpp"

using namespace rubicon;
using namespace rubicon::transport;
using test::alice;
using test::bob;
using test::pc;

TEST_CASE("every connect gets through or ends, whatever is lost, repeated or overtaken",
          "[transport][PAR-01][PAR-02][STR-19]") {
  int opened = 0;
  int ended = 0;
  for (std::uint64_t seed = 1; seed <= test::seeds(200); ++seed) {
    CAPTURE(seed);
    test::tunnel_fixture x(3s, 0.3, seed);
    x.copies = 0.2;
    std::map<mote_address, tunnel_id> ids;
    for (const auto& [from, to] : {std::pair{alice, bob}, {bob, alice}, {pc, alice}})
      ids[from] = x.connect(from, to);
    x.run_for(40s);
    for (const auto& [from, id] : ids) {
      const auto& y = x.ends_at(from)[id];
      REQUIRE((y.is_open || y.is_over));
      opened += y.is_open ? 1 : 0;
    }
    for (std::uint32_t i = 0; i < 20; ++i) {
      for (const auto who : {alice, bob, pc}) {
        for (const auto& [id, y] : x.ends_at(who)) {
          if (!y.is_over && y.is_open)
            CHECK(x.send(who, id, i));
        }
      }
      x.run_for(500ms);
    }
    x.run_for(5s);
    for (const auto& [from, id] : ids) { // openers close, acceptors must notice
      const auto& y = x.ends_at(from)[id];
      if (y.is_over) {
        ++ended;
        continue;
      }
      CHECK(!y.received.empty());
      x.close(from, id);
    }
    x.run_for(2min);
    for (const auto who : {alice, bob, pc}) {
      CHECK(x.at(who).size() == 0);
      CHECK_FALSE(x.at(who).deadline().has_value());
      CHECK(x.at(who).counters().malformed + x.at(who).counters().misdirected == 0);
    }
    CHECK(x.contents > 20);
  }
  CHECK(opened > static_cast<int>(test::seeds(200)) * 3 * 9 / 10);
  CHECK(ended < static_cast<int>(test::seeds(200)));
}

TEST_CASE("no tunnel is taken for another, whoever opens, closes or restarts when",
          "[transport][STR-19][SYN-17]") {
  std::uint64_t connected = 0;
  std::uint64_t strays = 0;
  int contents = 0;
  for (std::uint64_t seed = 1; seed <= test::seeds(200); ++seed) {
    CAPTURE(seed);
    random_stream rng(seed, "play");
    test::tunnel_fixture x(2s, 0.2, seed, 3);
    x.copies = 0.3;
    const std::vector<mote_address> all{alice, bob, pc};
    for (int i = 0; i < 400; ++i) {
      const auto who = all[rng.below(3)];
      const auto what = rng.below(100);
      if (what < 2) {
        connected += x.at(who).counters().connected;
        strays += x.at(who).counters().strays;
        x.restart(who);
      } else if (what < 20) {
        x.connect(who, all[rng.below(3)]); // perhaps to itself
      } else {
        const auto& ends = x.ends_at(who);
        if (!ends.empty()) {
          const auto id = std::next(ends.begin(), static_cast<long>(rng.below(ends.size())))->first;
          const auto& y = ends.at(id);
          if (what < 25 && !y.is_over)
            x.close(who, id);
          else if (what < 27 && !y.is_over)
            x.refuse(who, id);
          else
            CHECK(x.send(who, id, 1) == (y.is_open && !y.is_over));
        }
      }
      x.run_for(rng.between(0ms, 1s));
      for (const auto node : all) {
        const auto& ends = x.ends_at(node);
        CHECK(x.at(node).size() <= 3);
        CHECK(static_cast<long>(x.at(node).size()) ==
              std::ranges::count_if(ends, [](const auto& y) { return !y.second.is_over; }));
      }
    }
    for (const auto who : all) {
      for (const auto& [id, y] : x.ends_at(who)) {
        if (y.opened_here && !y.is_over)
          x.close(who, id);
      }
    }
    x.run_for(3min);
    for (const auto who : all) {
      CHECK(x.at(who).size() == 0);
      connected += x.at(who).counters().connected;
      strays += x.at(who).counters().strays;
    }
    contents += x.contents;
  }
  CHECK(connected > 20 * test::seeds(200));
  CHECK(strays > test::seeds(200));
  CHECK(contents > 20 * static_cast<int>(test::seeds(200)));
}
