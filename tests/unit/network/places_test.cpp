#include "network/places/place_cache.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::network;

namespace {

constexpr virtual_coordinates here{1, 2, 3};
constexpr virtual_coordinates there{3, 2, 1};

} // namespace

TEST_CASE("the place learnt longest ago makes room for another", "[network][NET-10]") {
  place_cache x(2, 10min);
  x.learn(mote_id{5}, here, instant{1s});
  x.learn(mote_id{3}, here, instant{2s});
  CHECK(x.size() == 2);
  x.learn(mote_id{5}, there, instant{3s}); // again: newer now
  x.learn(mote_id{4}, here, instant{4s});
  CHECK(x.size() == 2);
  CHECK_FALSE(x.find(mote_id{3}, instant{4s}));
  CHECK(x.find(mote_id{5}, instant{4s}) == there);
  CHECK(x.find(mote_id{4}, instant{4s}) == here);
}

TEST_CASE("a place is not known for ever, nor in another epoch", "[network][NET-10]") {
  place_cache x(4, 10min);
  x.learn(mote_id{5}, here, instant{});
  CHECK(x.find(mote_id{5}, instant{10min - 1ns}) == here);
  CHECK_FALSE(x.find(mote_id{5}, instant{10min}));
  CHECK(x.find_old(mote_id{5}) == here);
  CHECK_FALSE(x.find_old(mote_id{6}));
  x.learn(mote_id{5}, here, instant{10min});
  x.keep_epoch(0);
  CHECK(x.find(mote_id{5}, instant{10min}) == here);
  x.keep_epoch(1);
  CHECK(x.size() == 0);
  CHECK_FALSE(x.find_old(mote_id{5}));
  place_cache of_sink(4, 0s);
  of_sink.learn(mote_id{5}, here, instant{});
  CHECK(of_sink.find(mote_id{5}, instant{24h}) == here);
}
