#include "peis/space/tuple_space.hpp"
#include "peis/wire/package.hpp"
#include "support/catch.hpp"
#include "unit/peis/ids.hpp"

namespace rubicon::peis {
namespace {

using test::me;
using test::robot;
using test::start;

tuple_space space() {
  return {tuple_space_config{}, me, 1'000'000'000s};
}

bytes pushed(std::int32_t seqno, std::int32_t written, std::string_view text,
             timestamp expiry = never) {
  tuple x;
  x.owner = x.creator = robot;
  x.name = *key::parse("x");
  x.mimetype = "text/plain";
  x.written = {written, 0};
  x.expiry = expiry;
  x.seqno = seqno;
  auto octets = encode_tuple_head(x, tuple_message_kind::push);
  octets.insert(octets.end(), text.begin(), text.end());
  octets.push_back(0);
  return octets;
}

bytes subscription_for(std::string_view pattern, std::optional<lifetime_tag> lifetime = {}) {
  subscribe_message message;
  message.wanted.name = *key::parse(pattern);
  message.lifetime = lifetime;
  return encode(message);
}

void subscribe(tuple_space& x, std::string_view pattern) {
  static_cast<void>(x.subscribe(prototype_of(any_peer, *key::parse(pattern)), subscription_id{1},
                                tuple_space::interest::subscription, start));
}

} // namespace

TEST_CASE("a repeated subscription of a real kernel pushes again but is stored once",
          "[peis][TUP-08]") {
  auto x = space();
  static_cast<void>(x.set(*key::parse("a.b"), text_content("1"), start));
  CHECK(x.on_message(port::subscribe, robot, subscription_for("A.*"), start).size() == 1);
  CHECK(x.on_message(port::subscribe, robot, subscription_for("a.*"), start).size() == 1);
  CHECK(x.counters().subscribers == 1);
  CHECK(x.set(*key::parse("a.b"), text_content("2"), start).second.size() == 1);
}

TEST_CASE("a refresh of an unknown subscription counts as a new one", "[peis][TUP-10]") {
  auto x = space();
  static_cast<void>(x.set(*key::parse("a"), text_content("1"), start));
  const auto refresh = subscription_for("a", lifetime_tag{true, 60});
  CHECK(x.on_message(port::subscribe, robot, refresh, start).size() == 1);
  CHECK(x.on_message(port::subscribe, robot, refresh, start + 20s).empty());
  REQUIRE(x.deadline());
  while (x.deadline() && *x.deadline() <= start + 120s)
    static_cast<void>(x.on_time(*x.deadline()));
  CHECK(x.counters().subscribers == 0);
  CHECK(!x.deadline()); // nothing left to watch
}

TEST_CASE("real kernels are sent nothing of lifetimes and nothing twice", "[peis][TUP-10]") {
  auto x = space();
  subscribe(x, "a");
  const auto check = [&](peer_id host, bool marked) {
    const auto sent = x.on_host_appeared(host, marked, start);
    REQUIRE(sent.size() == 1);
    const auto message = decode_subscribe(std::get<transmit>(sent[0]).content.head.view(), {});
    REQUIRE(message);
    CHECK(message->lifetime.has_value() == marked);
  };
  check(peer_id{5}, true);
  check(peer_id{6}, false);
  const auto refreshed = x.on_time(*x.deadline());
  REQUIRE(refreshed.size() == 1);
  CHECK(std::get<transmit>(refreshed[0]).destination == peer_id{5});
}

TEST_CASE("subscribers of a vanished host are forgotten", "[peis][TUP-19]") {
  auto x = space();
  static_cast<void>(x.on_host_appeared(robot, false, start));
  static_cast<void>(x.on_message(port::subscribe, robot, subscription_for("a"), start));
  static_cast<void>(x.on_message(port::subscribe, robot, subscription_for("*"), start));
  CHECK(x.audience().has_subscriber(*key::parse("a")));
  static_cast<void>(x.on_host_vanished(robot, start));
  CHECK(!x.audience().has_subscriber(*key::parse("a")));
}

TEST_CASE("everything held is found in order of key and owner", "[peis][TUP-13]") {
  auto x = space();
  subscribe(x, "");
  static_cast<void>(x.on_message(port::push, robot, pushed(0, 1, "v"), start));
  for (const auto* name : {"x", "b.c", "A.z"})
    static_cast<void>(x.set(*key::parse(name), text_content("1"), start));
  std::string order;
  for (const auto& t : x.stored().find_all(prototype()))
    order += t->name.text() + to_string(t->owner) + ' ';
  CHECK(order == "A.z1 b.c1 x1 x2 ");
  CHECK(x.stored().find_all(prototype_of(any_peer, *key::parse("*.*"))).size() == 2);
  CHECK(x.stored().find_all(prototype_of(robot, *key::parse("X"))).size() == 1);
}

} // namespace rubicon::peis
