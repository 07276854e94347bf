#include "support/catch.hpp"
#include "traffic/part.hpp"

using namespace rubicon;
using namespace rubicon::traffic;

TEST_CASE("the parts of a flow add up", "[traffic]") {
  part origin;
  origin.from = {island_id{1}, mote_id{2}};
  origin.to = {island_id{1}, mote_id{1}};
  origin.sent = 10;
  origin.transmissions = 14;
  origin.lost = {{"no_ack", 2}};
  origin.active = 9s;
  part target = origin;
  target.sent = 0;
  target.transmissions = 0;
  target.delivered = 7;
  target.octets = 140;
  target.lost = {{"no_ack", 1}, {"queue_full", 0}};
  target.active = 0s;
  target.delay.add(5ms);

  part sum;
  sum += origin;
  sum += target;
  CHECK(sum.from == origin.from);
  CHECK(sum.to == origin.to);
  CHECK(sum.sent == 10);
  CHECK(sum.delivered == 7);
  CHECK(sum.octets == 140);
  CHECK(sum.transmissions == 14);
  CHECK(sum.lost.at("no_ack") == 3);
  CHECK(sum.active == 9s);
  CHECK(sum.delay.count() == 1);
}
