#include "gateway/others/directory.hpp"
#include "support/catch.hpp"
#include "unit/gateway/fixture.hpp"

using namespace rubicon;
using gateway::announcement;
using gateway::directory;
using test::kitchen;

namespace {

constexpr peer_id kitchen_gateway{1};
constexpr peer_id spare{101};

directory make_directory() {
  directory x({}, random_stream(1));
  x.start({});
  return x;
}

/// When it announces itself until then.
std::vector<instant> announcements(directory& x, instant end) {
  std::vector<instant> all;
  while (*x.deadline() <= end) {
    const auto now = *x.deadline();
    if (x.on_time(now))
      all.push_back(now);
  }
  return all;
}

} // namespace

TEST_CASE("an announcement tells island, form and incarnation", "[gateway][GW-13]") {
  const announcement x{island_id{0x01020304}, wire_form::strict54, 7};
  CHECK(to_hex(encode(x)) == "5255424701000102030400000007");
  CHECK(*gateway::decode_announcement(encode(x)) == x);
  auto longer = encode(x);
  longer.push_back(9); // of a later version
  CHECK(gateway::decode_announcement(longer));
  for (std::size_t size = 0; size < 14; ++size)
    CHECK(gateway::decode_announcement(byte_view(longer).first(size)).error() == errc::truncated);
  for (const auto at : {0U, 4U, 5U}) {
    auto bad = encode(x);
    bad[at] = 0x77;
    CHECK(gateway::decode_announcement(bad).error() == errc::bad_value);
  }
  CHECK(gateway::decode_announcement(encode(announcement{})).error() == errc::bad_value);
}

TEST_CASE("a gateway announces itself often at first, then once a period", "[gateway][GW-13]") {
  auto x = make_directory();
  const auto all = announcements(x, instant{120s});
  REQUIRE(all.size() > 10);
  CHECK(all[0] <= instant{1s});
  CHECK(all[1] - all[0] == 1s);
  CHECK(all[2] - all[1] == 2s);
  CHECK(all.back() - *(all.end() - 2) == 10s);
}

TEST_CASE("a new gateway gets an answer at once, a known one none", "[gateway][GW-13]") {
  auto x = make_directory();
  static_cast<void>(announcements(x, instant{60s}));
  const auto regular = *x.deadline();
  const instant now{61s};
  x.on_announcement(kitchen_gateway, encode(announcement{kitchen}), now);
  CHECK(*x.deadline() <= now + 500ms);
  CHECK(announcements(x, now + 500ms).size() == 1);
  const auto next = *x.deadline();
  CHECK(next > regular - 10s);
  x.on_announcement(kitchen_gateway, encode(announcement{kitchen}), now + 600ms);
  CHECK(*x.deadline() == next);
  x.on_announcement(kitchen_gateway, encode(announcement{kitchen, wire_form::segment, 1}),
                    now + 700ms); // started again
  CHECK(*x.deadline() <= now + 1200ms);
}

TEST_CASE("any gateway of an island addresses it; a dead one is passed over", "[gateway][GW-14]") {
  auto x = make_directory();
  CHECK(x.gateway_for(kitchen) == kitchen_gateway); // not announced yet: the id says it
  x.on_announcement(spare, encode(announcement{kitchen}), instant{1s});
  CHECK(x.gateway_for(kitchen) == spare);
  x.on_announcement(kitchen_gateway, encode(announcement{kitchen}), instant{2s});
  CHECK(x.gateway_for(kitchen) == kitchen_gateway);
  CHECK(x.island_of(spare) == kitchen);
  CHECK(x.island_of(peer_id{5}) == island_id{5});

  SECTION("silent for three periods") {
    x.on_announcement(spare, encode(announcement{kitchen}), instant{30s});
    static_cast<void>(announcements(x, instant{43s}));
    CHECK(x.gateway_for(kitchen) == spare);
    CHECK(x.known().size() == 1);
  }
  SECTION("a message to it has failed") {
    x.on_unreachable(kitchen_gateway);
    CHECK(x.gateway_for(kitchen) == spare);
  }
}

TEST_CASE("a gateway of another make speaks 5.4 to the letter", "[gateway][WIR-04][GW-13]") {
  auto x = make_directory();
  CHECK(x.form_of(peer_id{9}) == wire_form::segment);
  x.on_announcement(peer_id{9}, bytes{'h', 'e', 'l', 'l', 'o'}, instant{1s});
  CHECK(x.form_of(peer_id{9}) == wire_form::strict54);
  CHECK(x.island_of(peer_id{9}) == island_id{9});
  CHECK(x.counters().foreign == 1);
}

TEST_CASE("the directory has room for so many gateways", "[gateway][GW-13]") {
  directory x({.gateways_max = 2}, random_stream(1));
  x.start({});
  for (const auto id : {1, 2, 3})
    x.on_announcement(peer_id{id}, encode(announcement{island_id{9}}), instant{1s});
  CHECK(x.known().size() == 2);
  CHECK(x.counters().refused == 1);
  CHECK(x.island_of(peer_id{3}) == island_id{3});
}

TEST_CASE("an announcement of one among several gateways tells its role", "[gateway][GW-14]") {
  for (const bool leads : {true, false}) {
    const announcement x{island_id{1}, wire_form::segment, 0, leads};
    CHECK(encode(x).back() == (leads ? 2 : 1));
    CHECK(*gateway::decode_announcement(encode(x)) == x);
  }
}

TEST_CASE("an island is reached through the gateway that last said it leads", "[gateway][GW-14]") {
  auto x = make_directory();
  const auto says = [&x](peer_id who, bool leads, instant now) {
    x.on_announcement(who, encode(announcement{kitchen, wire_form::segment, 0, leads}), now);
  };
  says(kitchen_gateway, true, {});
  says(spare, false, {});
  CHECK(x.leader_of(kitchen) == kitchen_gateway);
  CHECK(x.gateway_for(kitchen) == kitchen_gateway);
  SECTION("the first one has crashed") {
    says(spare, true, instant{3s});
    CHECK(x.gateway_for(kitchen) == spare);
    CHECK(x.gateway_for(island_id{101}) == spare); // its own id calls the island too
    CHECK(x.island_of(spare) == kitchen);
    CHECK(x.meant_by(island_id{101}) == kitchen);
  }
  SECTION("the first one has lost its line") {
    says(kitchen_gateway, false, instant{2s});
    CHECK(!x.leader_of(kitchen));
    CHECK(x.gateway_for(kitchen) == kitchen_gateway);
    says(spare, true, instant{3s});
    CHECK(x.gateway_for(kitchen) == spare);
  }
  SECTION("the alias has gone: its id still calls the island") {
    x.on_unreachable(spare);
    CHECK(x.gateway_for(island_id{101}) == kitchen_gateway);
  }
}
