// Components that share one kernel.
#include "peis/kernel_clients.hpp"
#include "support/catch.hpp"
#include "unit/peis/ids.hpp"

namespace rubicon::peis {
namespace {

using test::start;

constexpr client_id gateway{7};
constexpr client_id rules{8};
kernel make_kernel() {
  kernel_config config;
  config.network.id = peer_id{11};
  return {std::move(config), random_stream(1, "kernel"), start};
}

template <class T>
std::vector<T> only(const kernel_clients::outputs& all) {
  std::vector<T> found;
  for (const auto& x : all)
    found.push_back(std::get<T>(x)); // throws if there is another
  return found;
}

tuple_changed changed(subscription_id which) {
  tuple x;
  x.owner = peer_id{11};
  return {which, std::make_shared<const tuple>(std::move(x))};
}

/// A kernel whose tuples `room.N` others subscribe to.
struct subscribed_kernel {
  kernel of = make_kernel();
  kernel_clients clients;
  std::uint64_t count = 0;

  void subscribe(std::uint64_t n = 1) {
    for (; n > 0; --n) {
      const auto key = "room." + std::to_string(++count);
      static_cast<void>(of.subscriptions().subscribe(of.id(), key, subscription_id{count}, start));
    }
  }
  std::size_t told(instant now) { return clients.review(of, now).size(); }
};

} // namespace

TEST_CASE("clients hear of a tuple under their own names, though these are equal", "[peis]") {
  kernel_clients clients;
  const auto first = clients.watch(gateway, 5);
  const auto second = clients.watch(rules, 5);
  REQUIRE(first != second);
  const auto told = only<tuple_notice>(clients.on(changed(second)));
  REQUIRE(told.size() == 1);
  CHECK(told[0].client == rules);
  CHECK(told[0].watch == 5);
  CHECK(!told[0].deleted);
  const auto content = changed(first).content;
  const auto gone = only<tuple_notice>(clients.on(tuple_deleted{first, content}));
  REQUIRE(gone.size() == 1);
  CHECK(gone[0].client == gateway);
  CHECK(gone[0].content == content);
  CHECK(gone[0].deleted);
  CHECK(clients.on(changed(subscription_id{99})).empty());
}

TEST_CASE("how a request ended is told once, to the client that has asked", "[peis]") {
  kernel_clients clients;
  const auto first = clients.request(gateway, 5);
  const auto second = clients.request(rules, 6);
  const auto told = only<outcome_notice>(clients.on(outcome{second, false, cause::no_route}));
  REQUIRE(told.size() == 1);
  CHECK(told[0].client == rules);
  CHECK(told[0].token == 6);
  CHECK(!told[0].success);
  CHECK(told[0].why == cause::no_route);
  CHECK(clients.on(outcome{second, true}).empty());
  CHECK(only<outcome_notice>(clients.on(outcome{first, true})).at(0).success);
  CHECK(clients.on(outcome{no_request, true}).empty());
}

TEST_CASE("messages of a port go to the one client that has hooked it", "[peis]") {
  kernel_clients clients;
  CHECK(clients.hook(gateway, 30));
  CHECK(clients.hook(gateway, 30));
  CHECK(!clients.hook(rules, 30));
  CHECK(clients.hook(rules, 31));
  message x;
  x.port = 30;
  x.source = peer_id{4};
  x.octets = bytes{1, 2};
  const auto told = only<message_notice>(clients.on(x));
  REQUIRE(told.size() == 1);
  CHECK(told[0].client == gateway);
  CHECK(told[0].source == peer_id{4});
  CHECK(told[0].octets == payload(bytes{1, 2}));
  x.port = 32;
  CHECK(clients.on(x).empty());
}

TEST_CASE("what a client has wanted goes with it, and nothing of others", "[peis]") {
  kernel_clients clients;
  const auto of = make_kernel();
  const auto first = clients.watch(gateway, 1);
  const auto kept = clients.watch(rules, 1);
  const auto third = clients.watch(gateway, 2);
  const auto asked = clients.request(gateway, 1);
  const auto asked_by_other = clients.request(rules, 1);
  CHECK(clients.hook(gateway, 30));
  CHECK(clients.watch_clock(gateway, of).size() == 1);
  CHECK(clients.watch_subscribers(gateway, "room", of, start).size() == 1);

  const auto withdrawn = only<withdraw>(clients.forget(gateway));
  REQUIRE(withdrawn.size() == 2);
  CHECK(withdrawn[0].subscription == first);
  CHECK(withdrawn[1].subscription == third);
  CHECK(clients.on(changed(first)).empty());
  CHECK(clients.on(changed(kept)).size() == 1);
  CHECK(clients.on(outcome{asked, true}).empty());
  CHECK(clients.on(outcome{asked_by_other, true}).size() == 1);
  CHECK(clients.hook(rules, 30));
  CHECK(clients.review(of, start).empty());
  CHECK(clients.forget(gateway).empty());
}

TEST_CASE("the keys that others subscribe to are told when they are others", "[peis]") {
  subscribed_kernel x;
  x.subscribe(2);
  auto told = only<subscribers_notice>(x.clients.watch_subscribers(gateway, "room", x.of, start));
  REQUIRE(told.size() == 1);
  CHECK(told[0].client == gateway);
  CHECK(told[0].keys == std::vector<std::string>{"room.1", "room.2"});
  CHECK(x.clients.review(x.of, start).size() == 0);
  x.subscribe();
  told = only<subscribers_notice>(x.clients.review(x.of, start));
  REQUIRE(told.size() == 1);
  CHECK(told[0].keys.size() == 3);
  static_cast<void>(
      x.of.subscriptions().subscribe(x.of.id(), "ROOM.3", subscription_id{99}, start));
  CHECK(x.told(start) == 0); // it is among them already
  told = only<subscribers_notice>(x.clients.watch_subscribers(rules, "room", x.of, start));
  REQUIRE(told.size() == 1);
  CHECK(told[0].client == rules); // who has asked last
  x.subscribe();
  CHECK(only<subscribers_notice>(x.clients.review(x.of, start)).at(0).client == rules);
}

TEST_CASE("a long list of keys is told again only after 10 us a key", "[peis]") {
  const auto [keys, pause] = GENERATE(std::pair<std::uint64_t, duration>{100, 0us},
                                      std::pair<std::uint64_t, duration>{101, 1010us});
  subscribed_kernel x;
  x.subscribe(keys);
  CHECK(x.clients.watch_subscribers(gateway, "room", x.of, start).size() == 1);
  x.subscribe();
  if (pause > duration(0)) {
    CHECK(x.told(start + pause - 1us) == 0);
    REQUIRE(x.clients.deadline() == start + pause);
  }
  CHECK(x.told(start + pause) == 1);
  CHECK(!x.clients.deadline());
  x.subscribe();
  CHECK(x.told(start + pause) == 0);
  static_cast<void>(x.clients.forget(gateway));
  CHECK(!x.clients.deadline()); // nobody waits any more
}

TEST_CASE("all who watch the clock hear of each change", "[peis]") {
  auto of = make_kernel();
  kernel_clients clients;
  static_cast<void>(clients.review(of, start));
  const auto told = only<clock_notice>(clients.watch_clock(gateway, of));
  REQUIRE(told.size() == 1);
  CHECK(told[0].offset == of.network().clock.offset());
  CHECK(clients.watch_clock(rules, of).size() == 1);
  CHECK(clients.review(of, start).empty());
  static_cast<void>(of.step_clock(3s, start));
  const auto after = only<clock_notice>(clients.review(of, start));
  REQUIRE(after.size() == 2);
  CHECK(after[0].client == gateway);
  CHECK(after[1].client == rules);
  CHECK(after[1].offset == told[0].offset + 3s);
  CHECK(clients.review(of, start).empty());
}

} // namespace rubicon::peis
