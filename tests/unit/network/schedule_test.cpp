#include <vector>

#include "core/numbers/random.hpp"
#include "network/channels/radio_schedule.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::network;
using std::chrono::microseconds;
using std::chrono::milliseconds;

namespace {

island_time at(milliseconds x) {
  return island_time(x);
}

const radio_need each_second{at(milliseconds{5000}), milliseconds{1000}, milliseconds{2},
                             milliseconds{10}};

} // namespace

TEST_CASE("a radio is on around the times of a need only", "[network][NRG-02]") {
  radio_schedule x;
  CHECK_FALSE(x.next_change(at(milliseconds{0})));
  x.set(1, each_second);
  CHECK_FALSE(x.is_on(at(milliseconds{500}))); // also before `first`: time may have begun anew
  CHECK(x.next_change(at(milliseconds{500})) == at(milliseconds{998}));
  CHECK(x.is_on(at(milliseconds{-2})));
  CHECK(x.next_change(at(milliseconds{4010})) == at(milliseconds{4998}));
  CHECK(x.is_on(at(milliseconds{4998})));
  CHECK(x.is_on(at(milliseconds{5009})));
  CHECK(x.next_change(at(milliseconds{4998})) == at(milliseconds{5010}));
  CHECK_FALSE(x.is_on(at(milliseconds{5010})));
  CHECK(x.is_on(at(milliseconds{105'000})));
  x.remove(1);
  CHECK_FALSE(x.is_on(at(milliseconds{105'000})));
}

TEST_CASE("a radio goes off when the packet has gone on, until the next", "[network][NRG-02]") {
  radio_schedule x;
  x.set(1, each_second);
  x.served(1, at(milliseconds{5003}));
  CHECK_FALSE(x.is_on(at(milliseconds{5003})));
  CHECK(x.next_change(at(milliseconds{5003})) == at(milliseconds{5998}));
  CHECK(x.is_on(at(milliseconds{6000})));
  x.served(1, at(milliseconds{6500})); // between two turns: nothing to end
  CHECK(x.is_on(at(milliseconds{7000})));
  x.served(9, at(milliseconds{7000})); // nobody's
}

TEST_CASE("several needs are met together: the union of their intervals", "[network][NRG-04]") {
  random_stream rng(3);
  radio_schedule all;
  std::vector<radio_schedule> single(6);
  for (std::uint64_t i = 0; i < single.size(); ++i) {
    const radio_need need{at(milliseconds{static_cast<int>(rng.below(3000))}),
                          milliseconds{100 + static_cast<int>(rng.below(900))},
                          milliseconds{static_cast<int>(rng.below(20))},
                          milliseconds{1 + static_cast<int>(rng.below(40))}};
    all.set(i, need);
    single[i].set(1, need);
  }
  island_time changes{};
  for (island_time now{}; now < at(milliseconds{20'000}); now += milliseconds{1}) {
    bool any = false;
    for (const auto& x : single)
      any = any || x.is_on(now);
    REQUIRE(all.is_on(now) == any);
    const auto next = *all.next_change(now);
    REQUIRE(next > now);
    for (auto between = now; between < std::min(next, now + milliseconds{5});
         between += microseconds{500})
      REQUIRE(all.is_on(between) == any);
    changes = next;
  }
  CHECK(changes > at(milliseconds{19'999}));
}
