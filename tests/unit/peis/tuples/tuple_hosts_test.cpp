#include "peis/space/tuple_hosts.hpp"

#include "support/catch.hpp"
#include "unit/peis/ids.hpp"

namespace rubicon::peis {

using test::hostile;
using test::robot;
using test::start;

namespace {

std::vector<prototype> prototypes(std::size_t count) {
  return std::vector<prototype>(count, prototype_of(any_peer, *key::parse("a.*")));
}

} // namespace

TEST_CASE("strangers have places until they are silent or known", "[peis][P2P-09]") {
  tuple_hosts x(2, 45s);
  CHECK(x.admit(peer_id{10}, start));
  CHECK(x.admit(peer_id{11}, start + 1s));
  CHECK(!x.admit(peer_id{12}, start + 1s));
  CHECK(x.strangers_refused() == 1);
  CHECK(!x.knows(peer_id{10}));
  CHECK(x.is_present(peer_id{10}));
  CHECK(!x.is_present(peer_id{12}));
  CHECK(x.appear(peer_id{10}, false, 0).empty()); // its place is free
  CHECK(x.admit(peer_id{12}, start + 2s));
  CHECK(x.admit(peer_id{10}, start + 2s)); // known: it needs none
  CHECK(x.take_silent(start + 44s).empty());
  CHECK(x.deadline() == start + 45s);
  CHECK(x.take_silent(start + 46s) == std::vector{peer_id{11}});
  CHECK(x.deadline() == start + 47s);
  CHECK(x.take_silent(start + 47s) == std::vector{peer_id{12}});
  CHECK(!x.deadline());
}

TEST_CASE("a message of a stranger gives it more time", "[peis][P2P-09]") {
  tuple_hosts x(2, 45s);
  CHECK(x.admit(robot, start));
  CHECK(x.admit(robot, start + 10s));
  CHECK(x.take_silent(start + 45s).empty());
  CHECK(x.take_silent(start + 55s) == std::vector{robot});
}

TEST_CASE("only an unmarked host that comes back as the same gets its subscriptions",
          "[peis][TUP-10][TUP-19]") {
  tuple_hosts x(2, 45s);
  const auto return_as = [&](bool marked, std::int32_t before, std::int32_t after) {
    static_cast<void>(x.appear(robot, marked, before));
    x.vanish(robot, prototypes(3));
    CHECK(!x.is_present(robot));
    return x.appear(robot, false, after).size();
  };
  CHECK(return_as(false, 7, 7) == 3);
  CHECK(return_as(false, 7, 8) == 0);
  CHECK(return_as(false, 0, 0) == 0);
  CHECK(return_as(true, 7, 7) == 0);
  x.vanish(hostile, prototypes(3)); // it was not known
  CHECK(x.appear(hostile, false, 7).empty());
}

TEST_CASE("as many suspended hosts as there are places are remembered", "[peis][TUP-19]") {
  tuple_hosts x(2, 45s);
  for (int id = 100; id < 100 + static_cast<int>(suspended_hosts_max) + 1; ++id) {
    static_cast<void>(x.appear(peer_id{id}, false, 1));
    x.vanish(peer_id{id}, prototypes(1));
  }
  CHECK(x.suspended_forgotten() == 1);
  CHECK(x.appear(peer_id{100}, false, 1).empty());
  CHECK(x.appear(peer_id{101}, false, 1).size() == 1);
}

} // namespace rubicon::peis
