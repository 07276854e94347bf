#include "actors/messages/links.hpp"
#include "actors/peis/peis_lan.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;

namespace {

using ids = std::vector<peer_id>;

constexpr peer_id first{11};
constexpr peer_id second{12};
constexpr peer_id third{13};

/// A network with three peers, whose stations are 1, 2 and 3.
struct peis_lan_fixture {
  fixture world;
  fake<lan_user_actor> a{world};
  fake<lan_user_actor> b{world};
  fake<lan_user_actor> c{world};
  peis_lan_actor lan;

  explicit peis_lan_fixture(config::peis_description network = {}) {
    lan = world.spawn_at("peis_lan", peis_lan, network, std::uint64_t{1});
    world.send(lan, join_lan{1, first, true, a});
    world.send(lan, join_lan{2, second, true, b});
    world.send(lan, join_lan{3, third, true, c});
  }

  void part(std::vector<ids> groups) {
    world.send(lan, begin_lan_fault{7, std::move(groups), 0, {}});
  }

  /// A link from the first to the second.
  std::uint64_t connect() {
    world.send(lan, lan_connect{1, 5, second});
    world.run_for(1ms);
    return a.all<link_opened>().back().link;
  }

  void end(const fake<lan_user_actor>& who) {
    post_exit(who.handle(), caf::exit_reason::user_shutdown);
    world.run_for(1ms);
  }
};

} // namespace

TEST_CASE("both ends of a link that is asked for hear of it after the delay",
          "[actors][peis_lan][LNK-05][ACT-01]") {
  peis_lan_fixture x;
  x.world.send(x.lan, lan_connect{1, 5, second});
  CHECK(x.a.size() + x.b.size() == 0);
  x.world.run_for(199us);
  CHECK(x.a.size() + x.b.size() == 0);
  x.world.run_for(1us);
  REQUIRE(x.a.count<link_opened>() == 1);
  REQUIRE(x.b.count<link_opened>() == 1);
  const auto at_a = x.a.all<link_opened>()[0];
  const auto at_b = x.b.all<link_opened>()[0];
  CHECK(at_a.initiator);
  CHECK(at_a.attempt == 5);
  CHECK(at_a.other == link_end_actor(x.b.handle()));
  CHECK(!at_b.initiator);
  CHECK(at_b.attempt == 0);
  CHECK(at_a.link == at_b.link);
  CHECK(!at_a.condition.cut);
  CHECK(at_a.condition.loss == 0);
  CHECK(x.c.size() == 0);
  CHECK(x.connect() != at_a.link);
}

TEST_CASE("a link to an id that nobody has is refused", "[actors][peis_lan]") {
  peis_lan_fixture x;
  x.world.send(x.lan, lan_connect{1, 6, peer_id{99}});
  x.world.send(x.lan, lan_connect{1, 7, first}); // itself
  x.world.run_for(1ms);
  REQUIRE(x.a.count<attempt_failed>() == 2);
  CHECK(x.a.all<attempt_failed>()[0].attempt == 6);
  x.end(x.b);
  x.world.send(x.lan, lan_connect{1, 8, second});
  x.world.run_for(1ms);
  CHECK(x.a.count<attempt_failed>() == 3);
}

TEST_CASE("an announcement reaches all others that hear", "[actors][peis_lan][TCP-02]") {
  peis_lan_fixture x;
  fake<lan_user_actor> deaf(x.world);
  x.world.send(x.lan, join_lan{4, peer_id{14}, false, deaf});
  x.world.send(x.lan, lan_announce{1, bytes{1, 2}});
  x.world.run_for(1ms);
  CHECK(x.a.size() == 0);
  CHECK(deaf.size() == 0);
  REQUIRE(x.b.count<announcement>() == 1);
  CHECK(x.b.all<announcement>()[0].octets == payload(bytes{1, 2}));
  CHECK(x.c.count<announcement>() == 1);
}

TEST_CASE("a partition cuts links, connections and announcements between its groups, in silence",
          "[actors][peis_lan][ACT-04]") {
  peis_lan_fixture x;
  const auto link = x.connect();
  x.part({{first}, {second}});
  REQUIRE(x.a.count<condition_changed>() == 1);
  CHECK(x.a.all<condition_changed>()[0].link == link);
  CHECK(x.a.all<condition_changed>()[0].condition.cut);
  CHECK(x.b.count<condition_changed>() == 1);
  x.world.send(x.lan, lan_connect{1, 9, second});
  x.world.send(x.lan, lan_connect{1, 10, third}); // those in no group are a group
  x.world.send(x.lan, lan_connect{1, 11, peer_id{99}});
  x.world.send(x.lan, lan_announce{1, bytes{1}});
  x.world.run_for(1s);
  CHECK(x.a.count<link_opened>() == 1);
  CHECK(x.a.count<attempt_failed>() == 0);
  CHECK(x.b.count<announcement>() == 0);
  x.world.send(x.lan, end_lan_fault{7});
  REQUIRE(x.a.count<condition_changed>() == 2);
  CHECK(!x.a.all<condition_changed>()[1].condition.cut);
  x.world.send(x.lan, lan_announce{1, bytes{1}});
  x.world.run_for(1s);
  CHECK(x.b.count<announcement>() == 1);
}

TEST_CASE("a process that ends has its links reset", "[actors][peis_lan][ACT-04]") {
  peis_lan_fixture x;
  const auto link = x.connect();
  x.end(x.b);
  REQUIRE(x.a.count<link_closed>() == 1);
  CHECK(x.a.all<link_closed>()[0].link == link);
}

TEST_CASE("a computer without power says nothing until it is on again",
          "[actors][peis_lan][ACT-04][KH-05]") {
  peis_lan_fixture x;
  x.connect();
  x.world.send(x.lan, set_lan_power{2, false});
  x.end(x.b);
  x.world.send(x.lan, lan_connect{1, 9, second});
  x.world.run_for(1min);
  CHECK(x.a.count<link_closed>() == 0);
  CHECK(x.a.count<attempt_failed>() == 0);
  fake<lan_user_actor> again(x.world);
  x.world.send(x.lan, set_lan_power{2, true});
  x.world.send(x.lan, join_lan{4, second, true, again});
  x.world.run_for(1ms);
  CHECK(x.a.count<link_closed>() == 1);
  x.world.send(x.lan, lan_connect{1, 10, second});
  x.world.run_for(1ms);
  CHECK(again.count<link_opened>() == 1);
}
