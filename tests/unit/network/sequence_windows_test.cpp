#include <set>

#include "core/numbers/random.hpp"
#include "network/tree/sequence_windows.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::network;

namespace {

const mote_id a{2};
const mote_id b{3};

} // namespace

TEST_CASE("a packet is taken once, in whatever order copies come", "[network][collection]") {
  sequence_windows x;
  CHECK(x.take(a, 0));
  CHECK_FALSE(x.take(a, 0));
  CHECK(x.take(b, 0));
  CHECK(x.take(a, 3));
  CHECK(x.take(a, 1));
  CHECK_FALSE(x.take(a, 1));
  CHECK_FALSE(x.take(a, 3));
  CHECK(x.take(a, 2));
}

TEST_CASE("numbers wrap", "[network][collection]") {
  sequence_windows x;
  CHECK(x.take(a, 0xfffe));
  CHECK(x.take(a, 1));
  CHECK(x.take(a, 0xffff));
  CHECK_FALSE(x.take(a, 0xfffe));
  CHECK_FALSE(x.take(a, 1));
}

TEST_CASE("an origin that begins anew with another number is believed", "[network][collection]") {
  sequence_windows x;
  CHECK(x.take(a, 1000));
  CHECK(x.take(a, 1000 - 32));
  CHECK(x.take(a, 1000 - 31));
}

TEST_CASE("of copies that are late by less than 32 packets none is taken twice or refused",
          "[network][collection]") {
  random_stream rng(GENERATE(1, 2, 3, 4, 5));
  sequence_windows x;
  std::set<unsigned> taken;
  for (unsigned newest = 40; newest < 20'000; ++newest)
    for (int copies = 0; copies < 2; ++copies) {
      const auto number = newest - static_cast<unsigned>(rng.below(31));
      CHECK(x.take(a, static_cast<std::uint16_t>(number)) == taken.insert(number).second);
    }
}
