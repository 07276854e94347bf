#include "radio/channel/disturbances.hpp"

#include "support/catch.hpp"

using namespace rubicon::radio;

TEST_CASE("losses add up as chances do, for the islands that they concern",
          "[radio][channel][GEN-03]") {
  disturbances x;
  CHECK(x.empty());
  CHECK(x.loss_in(1) == 0);
  const auto everywhere = x.begin(std::nullopt, 0.5);
  const auto here = x.begin(1, 0.2);
  CHECK(x.loss_in(1) == Approx(0.6));
  CHECK(x.loss_in(2) == Approx(0.5));
  x.end(everywhere);
  CHECK(x.loss_in(1) == Approx(0.2));
  CHECK(x.loss_in(2) == 0);
  x.end(everywhere); // it has ended already
  CHECK(x.loss_in(1) == Approx(0.2));
  x.end(here);
  CHECK(x.empty());
}
