#include "peis/space/local_subscriptions.hpp"

#include "peis/space/tuple_audience.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "unit/peis/tuples/lone_space.hpp"

namespace rubicon::peis {

using namespace test;

namespace {

using interest = local_subscriptions::interest;

struct subscribed {
  local_subscriptions x{me, 4, 60s};

  local_subscriptions::addition add(peer_id owner, std::string_view pattern, std::uint64_t id,
                                    interest kind = interest::subscription) {
    return x.add(prototype_of(owner, name_of(pattern)), subscription_id{id}, kind);
  }
  [[nodiscard]] std::vector<std::uint64_t> notified(const tuple& content) const {
    tuple_events out;
    x.notify_changed(std::make_shared<const tuple>(content), out);
    std::vector<std::uint64_t> ids;
    for (const auto& event : out)
      ids.push_back(std::get<tuple_changed>(event).subscription.value);
    return ids;
  }
};

} // namespace

TEST_CASE("equal subscriptions make one question, callbacks none", "[peis][TUP-08][CB-01]") {
  subscribed s;
  const auto first = s.add(any_peer, "a.*", 1);
  REQUIRE(first.unasked != nullptr);
  CHECK(first.unasked->serial == 0);
  CHECK(s.add(any_peer, "A.*", 2).unasked == nullptr); // asked already
  CHECK(s.add(any_peer, "b", 3, interest::callback).unasked == nullptr);
  REQUIRE(s.x.next_question(0) != nullptr);
  CHECK(s.x.next_question(1) == nullptr);
  CHECK(s.x.remove(subscription_id{1}));
  CHECK(s.x.find_question(0) != nullptr); // one asker is left
  CHECK(s.x.remove(subscription_id{2}));
  CHECK(s.x.find_question(0) == nullptr);
  CHECK(!s.x.has_questions());
  CHECK(s.x.size() == 1);
}

TEST_CASE("a subscription is refused if its id is in use, it is too long or there are too many",
          "[peis][TUP-24]") {
  subscribed s;
  CHECK(s.add(any_peer, "a", 1).why == cause::none);
  CHECK(s.add(any_peer, "b", 1).why == cause::bad_handle);
  prototype x;
  x.mimetype = std::string(mimetype_length_max + 1, 'm');
  CHECK(s.x.add(x, subscription_id{2}, interest::subscription).why == cause::bad_value);
  const auto version = s.x.version();
  for (std::uint64_t id = 2; id < 5; ++id)
    CHECK(s.add(any_peer, "a", id).why == cause::none);
  CHECK(s.add(any_peer, "a", 5).why == cause::space_full);
  CHECK(s.x.version() == version + 3);
  CHECK(!s.x.remove(subscription_id{5}));
}

TEST_CASE("each subscription and callback is notified once, by id", "[peis][CB-01]") {
  subscribed s;
  static_cast<void>(s.add(any_peer, "a.*", 9));
  static_cast<void>(s.add(robot, "a.b", 3, interest::callback));
  static_cast<void>(s.add(hostile, "a.b", 1));
  CHECK(s.notified(tuple_of(robot, "a.b", 1)) == std::vector<std::uint64_t>{3, 9});
  CHECK(s.x.wants(tuple_of(robot, "a.b", 1)));
  CHECK(s.notified(tuple_of(robot, "b", 1)).empty());
}

TEST_CASE("callbacks watch own tuples, but do not want them", "[peis][TUP-23]") {
  subscribed s;
  static_cast<void>(s.add(any_peer, "a", 1, interest::callback));
  static_cast<void>(s.add(robot, "b", 2));
  static_cast<void>(s.add(me, "c.d", 3));
  const subscriber_table no_subscribers;
  const tuple_audience audience(s.x, no_subscribers);
  CHECK(!audience.has_subscriber(name_of("a")));
  CHECK(audience.is_watched(name_of("a")));
  CHECK(!audience.is_watched(name_of("b"))); // of another owner
  CHECK(audience.has_subscriber(name_of("c.d")));
  CHECK(audience.subscribed("c") == std::set<std::string>{"c.d"});
  CHECK(audience.subscribed("a").empty());
}

TEST_CASE("only marked hosts are sent a lifetime", "[peis][TUP-10]") {
  subscribed s;
  const bool marked = GENERATE(false, true);
  const auto request = s.x.request_to(robot, marked, prototype_of(any_peer, name_of("a")), true);
  CHECK(request.destination == robot);
  CHECK(request.port == port::subscribe);
  const auto message = decode_subscribe(request.content.head.view(), {});
  REQUIRE(message);
  REQUIRE(message->lifetime.has_value() == marked);
  CHECK((!marked || (message->lifetime->refresh && message->lifetime->seconds == 60)));
}

} // namespace rubicon::peis
