#include "peis/space/pending_feeds.hpp"

#include "support/catch.hpp"
#include "unit/peis/ids.hpp"

namespace rubicon::peis {

using test::hostile;
using test::robot;
using test::start;

TEST_CASE("a feed is looked at when it is due, the earliest first", "[peis][TUP-18]") {
  pending_feeds x;
  CHECK(!x.deadline());
  x.open(robot);
  x.open(hostile);
  x.schedule(robot, start + 2s);
  x.schedule(hostile, start + 1s);
  CHECK(x.deadline() == start + 1s);
  CHECK(!x.take_due(start));
  CHECK(x.take_due(start + 2s) == hostile);
  CHECK(x.take_due(start + 2s) == robot);
  CHECK(!x.take_due(start + 2s));
  x.pause(start + 3s);
  CHECK(!x.deadline());
  x.schedule(robot, start + 1s);
  x.pause(start + 3s);
  CHECK(x.deadline() == start + 3s);
  x.schedule(robot, std::nullopt);
  CHECK(!x.due(robot));
  CHECK(!x.take_due(start + 9s));
}

TEST_CASE("a feed that is closed is in the agenda no more", "[peis][TUP-18]") {
  pending_feeds x;
  x.open(robot);
  x.schedule(robot, start);
  CHECK(x.add_undelivered(robot, "a", {}));
  x.close(robot);
  x.close(robot); // again
  CHECK(x.find(robot) == nullptr);
  CHECK(x.size() == 0);
  CHECK(!x.take_due(start));
}

TEST_CASE("a value fails since it failed first", "[peis][TUP-18]") {
  pending_feeds x;
  CHECK(x.add_undelivered(robot, "a", std::nullopt));
  CHECK(!x.add_undelivered(robot, "a", start + 1s));
  CHECK(!x.add_undelivered(robot, "a", start + 2s));
  CHECK(x.find(robot)->undelivered.at("a") == start + 1s);
  CHECK(!x.find(robot)->is_empty());
  CHECK(!x.remove_undelivered(robot, "b"));
  CHECK(!x.remove_undelivered(hostile, "a"));
  CHECK(x.remove_undelivered(robot, "a"));
  CHECK(x.find(robot)->is_empty());
}

TEST_CASE("one host has too many undelivered values beyond its limit, or its part of all",
          "[peis][TUP-18]") {
  pending_feeds x;
  const auto miss = [&](peer_id host, int count) {
    for (int i = 0; i < count; ++i)
      x.add_undelivered(host, "k" + std::to_string(i), {});
  };
  miss(robot, 10);
  CHECK(!x.has_too_many(robot, 10));
  CHECK(x.has_too_many(robot, 9));
  CHECK(!x.has_too_many(hostile, 9));
  x.clear_undelivered(robot);
  CHECK(!x.has_too_many(robot, 9));
  for (int i = 0; i < 100; ++i)
    miss(peer_id{100 + i}, 6);
  miss(robot, 9);
  CHECK(!x.has_too_many(robot, 10)); // within 640 in all
  CHECK(x.has_too_many(robot, 9));   // beyond 576 in all, and more than others
  CHECK(!x.has_too_many(peer_id{100}, 9));
}

} // namespace rubicon::peis
