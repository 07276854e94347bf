// Prototypes, inserting, reading, callbacks, and why each may fail.
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"
#include "unit/peis/ids.hpp"

namespace rubicon::peis {
namespace {

using test::start;
using test::world;

key named(std::string_view text) {
  return *key::parse(text);
}

struct lone_kernel {
  kernel x{test::config_of(1), random_stream(1, "a"), start};

  void set(std::string_view name, std::string_view text) {
    static_cast<void>(x.tuples().set(name, text_content(text), start));
  }
  [[nodiscard]] static cause why(const outputs& todo) { return std::get<outcome>(todo.back()).why; }
  [[nodiscard]] static std::string changes(const outputs& todo) {
    std::string all;
    for (const auto& x : todo) {
      if (const auto* changed = std::get_if<tuple_changed>(&x))
        all += std::to_string(changed->subscription.value) + '=' +
               std::string(changed->content->text()) + ' ';
      if (const auto* gone = std::get_if<tuple_deleted>(&x))
        all += std::to_string(gone->subscription.value) + "- ";
    }
    return all;
  }
};

} // namespace

TEST_CASE("every field of a prototype counts", "[peis][TUP-06][TUP-08]") {
  tuple x;
  x.owner = peer_id{3};
  x.creator = peer_id{4};
  x.name = named("a.b");
  x.written = {5, 6};
  x.user_time = {7, 8};
  x.expiry = {9, 10};
  x.form = encoding::binary;
  x.mimetype = "m/m";
  x.value = payload(bytes{'v'});
  prototype wanted;
  const auto check = [&](auto& field, auto fitting, auto different) {
    field = fitting;
    CHECK(wanted.matches(x));
    field = different;
    CHECK(!wanted.matches(x));
    field = fitting;
  };
  CHECK(wanted.matches(x));
  check(wanted.owner, peer_id{3}, peer_id{4});
  check(wanted.creator, peer_id{4}, peer_id{3});
  check(wanted.name, named("A.*"), named("a.*.*"));
  check(wanted.written, timestamp{5, -1}, timestamp{6, -1});
  check(wanted.user_time, timestamp{-1, 8}, timestamp{-1, 7});
  check(wanted.expiry, timestamp{9, 10}, never);
  check(wanted.form, encoding::binary, encoding::text);
  check(wanted.mimetype, std::string("m/m"), std::string("M/M"));
  check(wanted.value, payload(bytes{'V'}), payload(bytes{'v', 0}));
}

TEST_CASE("a prototype travels with all its fields", "[peis][TUP-08]") {
  subscribe_message message;
  auto& x = message.wanted;
  x.owner = peer_id{3};
  x.creator = peer_id{4};
  x.name = named("a.*");
  x.written = {5, -1};
  x.user_time = {7, 8};
  x.expiry = {9, 10};
  x.form = encoding::binary;
  x.mimetype = "m/m";
  x.value = payload(bytes{1, 2});
  const auto again = decode_subscribe(encode(message), {});
  REQUIRE(again);
  CHECK(again->wanted == x);
  x.written = {6, -1};
  CHECK(!(again->wanted == x));
}

TEST_CASE("a subscription by prototype requests and reports nothing else", "[peis][TUP-08]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(1s);
  prototype wanted = prototype_of(any_peer, named("a.*"));
  wanted.mimetype = "m/m";
  w.perform(b, w.at(b).subscriptions().subscribe(wanted, subscription_id{1}, w.now()));
  w.perform(b, w.at(b).subscriptions().subscribe(a, "a.y", subscription_id{2}, w.now()));
  auto content = text_content("1");
  w.perform(a, w.at(a).tuples().set("a.x", content, w.now()));
  content.mimetype = "m/m";
  w.perform(a, w.at(a).tuples().set("a.y", content, w.now()));
  w.run_for(100ms);
  CHECK(!w.at(b).reader().find(a, "a.x"));
  CHECK(w.all<tuple_changed>(b).size() == 2); // one for each subscription
  w.perform(a, w.at(a).tuples().remove("a.y", w.now()));
  w.run_for(100ms);
  CHECK(w.all<tuple_deleted>(b).size() == 2);
}

TEST_CASE("a full tuple can be inserted, here and at another owner", "[peis][TUP-06]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(1s);
  tuple x;
  x.name = named("a");
  x.value = payload(bytes{1, 2});
  x.form = encoding::binary;
  x.mimetype = "m/m";
  x.user_time = {11, 12};
  x.expiry = w.at(a).reader().network_time(w.now() + 60s);
  for (const auto owner : {a, b}) {
    x.owner = owner;
    w.perform(a, w.at(a).tuples().insert(x, w.now(), request_id{1}));
    w.run_for(100ms);
    const auto stored = w.at(owner).reader().find(owner, "a");
    REQUIRE(stored);
    CHECK(stored->value == x.value);
    CHECK(stored->form == encoding::binary);
    CHECK(stored->mimetype == "m/m");
    CHECK(stored->user_time == timestamp{11, 12});
    CHECK(stored->expiry == x.expiry);
    CHECK(stored->creator == a);
    CHECK(stored->written > never);
    CHECK(w.all<outcome>(a).back().success);
  }
}

TEST_CASE("an abstract tuple cannot be inserted", "[peis][TUP-06][TUP-24]") {
  lone_kernel k;
  tuple x;
  x.owner = peer_id{1};
  x.name = named("a");
  const auto why = [&](const tuple& draft) {
    return lone_kernel::why(k.x.tuples().insert(draft, start, request_id{1}));
  };
  CHECK(why(x) == cause::none);
  const auto owner = GENERATE(1, 2); // ours, and somebody else's
  x.owner = peer_id{owner};
  auto y = x;
  y.owner = any_peer;
  CHECK(why(y) == cause::abstract);
  y = x;
  y.name = named("a.*");
  CHECK(why(y) == cause::abstract);
  y.name = key();
  CHECK(why(y) == cause::abstract);
  y = x;
  y.user_time = {-1, 0};
  CHECK(why(y) == cause::abstract);
  y = x;
  y.expiry = {0, -1};
  CHECK(why(y) == cause::abstract);
  y = x;
  y.form = encoding::any;
  CHECK(why(y) == cause::abstract);
  y = x;
  y.mimetype.clear();
  CHECK(why(y) == cause::abstract);
  y.mimetype = std::string(255, 'm');
  CHECK(why(y) == cause::bad_value);
}

TEST_CASE("reading one tuple returns whether it is new", "[peis][TUP-12]") {
  lone_kernel k;
  k.set("a.b", "1");
  const auto get = [&](read_mode mode) { return k.x.reader().get(peer_id{1}, "A.b", mode, start); };
  CHECK(get(read_mode::filter_old).was_new);
  CHECK(!get(read_mode::filter_old));
  const auto old = get(read_mode::keep_old);
  REQUIRE(old);
  CHECK(!old.was_new);
  k.set("a.b", "1");
  CHECK(get(read_mode::keep_old).was_new);
  CHECK(!get(read_mode::filter_old));
  CHECK(old.content->text() == "1"); // lives on although replaced
}

TEST_CASE("reading one tuple needs its full name", "[peis][TUP-12][TUP-24]") {
  lone_kernel k;
  k.set("a.b", "1");
  const auto why = [&](peer_id owner, std::string_view name) {
    return k.x.reader().get(owner, name, read_mode::keep_old, start).why;
  };
  CHECK(why(any_peer, "a.b") == cause::abstract);
  CHECK(why(peer_id{1}, "a.*") == cause::abstract);
  CHECK(why(peer_id{1}, "a*") == cause::bad_key);
  CHECK(why(peer_id{1}, "nothing") == cause::none);
}

TEST_CASE("nothing expired is ever read", "[peis][TUP-12][TUP-15]") {
  lone_kernel k;
  static_cast<void>(k.x.tuples().set("a", text_content("1", start + 1s), start));
  result_set found;
  CHECK(k.x.reader().get(peer_id{1}, "a", read_mode::keep_old, start));
  CHECK(!k.x.reader().get(peer_id{1}, "a", read_mode::keep_old, start + 1s));
  k.x.reader().get_all(prototype_of(any_peer, named("a")), found, start + 1s);
  CHECK(found.is_empty());
}

TEST_CASE("a result set gathers what several queries find", "[peis][TUP-13][TUP-14]") {
  world w;
  for (const int id : {1, 2, 3, 4}) {
    const auto peer = w.add(id);
    w.perform(peer, w.at(peer).tuples().set("t", text_content(std::to_string(id)), w.now()));
    if (id > 1)
      w.connect(peer, peer_id{1});
  }
  const peer_id me{1};
  w.perform(me, w.at(me).subscriptions().subscribe(any_peer, "t", subscription_id{1}, w.now()));
  w.run_for(3s);
  w.packages.clear();
  w.perform(me, w.at(me).tuples().set("a", text_content("a"), w.now()));
  result_set found;
  w.at(me).reader().get_all(prototype_of(any_peer, named("t")), found, w.now());
  w.at(me).reader().get_all(prototype_of(any_peer, named("a")), found, w.now());
  CHECK(w.packages.empty()); // none was asked
  CHECK(found.size() == 5);
  std::string all;
  CHECK(found.value().why == cause::bad_index); // before the first
  while (found.next())
    all += found.value().content->text();
  CHECK(all == "1234a");
  CHECK(!found.next());
  CHECK(found.value().why == cause::bad_index); // after the last
  found.first();
  REQUIRE(found.next());
  CHECK(found.value().content->text() == "1");
  CHECK(found.value().was_new);
  found.reset();
  CHECK(found.is_empty());
  CHECK(!found.next());
  w.at(me).reader().get_all(prototype_of(any_peer, named("t")), found, w.now(),
                            read_mode::filter_old);
  CHECK(found.is_empty());
}

TEST_CASE("callbacks are notified of what arrives and request nothing", "[peis][CB-01][CB-04]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(1s);
  w.perform(a, w.at(a).tuples().set("x", text_content("1"), w.now()));
  w.perform(b, w.at(b).subscriptions().register_callback(prototype_of(any_peer, named("*")),
                                                         subscription_id{9}, w.now()));
  w.run_for(1s);
  CHECK(!w.at(a).reader().has_subscriber("x"));
  CHECK(!w.at(b).reader().find(a, "x"));
  w.perform(b, w.at(b).subscriptions().subscribe(a, "x", subscription_id{1}, w.now()));
  w.run_for(100ms);
  w.perform(a,
            w.at(a).tuples().set("x", text_content("1"), w.now())); // equal: notified all the same
  w.run_for(100ms);
  w.perform(a, w.at(a).tuples().remove("x", w.now()));
  w.run_for(100ms);
  std::size_t notified = 0;
  for (const auto& x : w.all<tuple_changed>(b))
    notified += x.subscription == subscription_id{9} ? 1 : 0;
  CHECK(notified == 2);
  CHECK(w.all<tuple_deleted>(b).size() == 2);
  w.perform(b, w.at(b).subscriptions().unsubscribe(subscription_id{9}, w.now(), request_id{1}));
  CHECK(w.all<outcome>(b).back().success);
  w.clear_logs();
  w.perform(a, w.at(a).tuples().set("x", text_content("2"), w.now()));
  w.run_for(100ms);
  CHECK(w.all<tuple_changed>(b).size() == 1); // the subscription lives on
}

TEST_CASE("a callback on own tuples hears of local and remote writes", "[peis][CB-01]") {
  lone_kernel k;
  static_cast<void>(k.x.subscriptions().register_callback(prototype_of(peer_id{1}, named("a")),
                                                          subscription_id{4}, start));
  CHECK(!k.x.reader().has_subscriber("a"));
  CHECK(lone_kernel::changes(k.x.tuples().set("a", text_content("1"), start)) == "4=1 ");
  CHECK(lone_kernel::changes(k.x.tuples().remove("a", start)) == "4- ");
}

TEST_CASE("10 000 updates at full speed are 10 000 calls in order", "[peis][CB-02]") {
  world w;
  const auto a = w.add(1);
  const auto b = w.add(2);
  w.connect(a, b);
  w.run_for(1s);
  w.perform(b, w.at(b).subscriptions().subscribe(a, "x", subscription_id{1}, w.now()));
  w.run_for(100ms);
  for (int i = 0; i < 10'000; ++i) {
    w.perform(a, w.at(a).tuples().set("x", text_content(std::to_string(i)), w.now()));
    if (i % 100 == 99)
      w.run_for(30ms);
  }
  w.run_for(1s);
  const auto notified = w.all<tuple_changed>(b);
  REQUIRE(notified.size() == 10'000);
  for (std::size_t i = 0; i < notified.size(); ++i)
    CHECK(notified[i].content->text() == std::to_string(i));
}

TEST_CASE("each failure has its cause", "[peis][TUP-24]") {
  auto config = test::config_of(1);
  config.tuples.tuples_max = 14;
  config.tuples.subscriptions_max = 2;
  kernel x(config, random_stream(1, "a"), start);
  const request_id r{1};
  const auto set = [&](std::string_view name, tuple_content content) {
    return lone_kernel::why(x.tuples().set(name, std::move(content), start, r));
  };
  const auto subscribe = [&](std::uint64_t id) {
    return lone_kernel::why(
        x.subscriptions().subscribe(any_peer, "a", subscription_id{id}, start, r));
  };
  CHECK(set("a*", text_content("")) == cause::bad_key);
  CHECK(set("a", binary_content(bytes(tuple_value_max + 1))) == cause::too_long); // overflow
  CHECK(set("a", {bytes{1}, "", encoding::text, {}}) == cause::abstract);
  CHECK(set("a", text_content("", instant(-2'000'000'000s))) == cause::bad_value); // bad argument
  CHECK(set("a", text_content("")) == cause::none);
  CHECK(set("b", text_content("")) == cause::none);
  CHECK(set("c", text_content("")) == cause::space_full); // out of memory
  CHECK(subscribe(1) == cause::none);
  CHECK(subscribe(1) == cause::bad_handle);
  CHECK(subscribe(own_ids_first) == cause::bad_handle);
  CHECK(subscribe(2) == cause::none);
  CHECK(subscribe(3) == cause::space_full);
  CHECK(lone_kernel::why(x.subscriptions().unsubscribe(subscription_id{7}, start, r)) ==
        cause::bad_handle);
  CHECK(x.meta_tuples().get_indirectly(peer_id{1}, "a", read_mode::keep_old, start).why ==
        cause::bad_meta_tuple);
  CHECK(result_set().value().why == cause::bad_index);
  CHECK(x.counters().tuples.refused > 0);
}

TEST_CASE("values of a dead host stay with a mark where that is wanted", "[peis][TUP-19]") {
  world w;
  auto config = test::config_of(1);
  config.tuples.keep_values_of_dead_hosts = true;
  const auto a = w.add(config);
  const auto b = w.add(2);
  w.connect(a, b);
  w.perform(a, w.at(a).subscriptions().subscribe(b, "x", subscription_id{1}, w.now()));
  w.perform(b, w.at(b).tuples().set("x", text_content("1"), w.now()));
  w.run_for(3s);
  CHECK(!w.at(a).reader().find(b, "x")->stale);
  w.perform(b, w.at(b).leave(w.now()));
  w.run_for(1s);
  const auto last = w.at(a).reader().find(b, "x");
  REQUIRE(last);
  CHECK(last->stale);
  CHECK(last->text() == "1");
  CHECK(w.all<tuple_changed>(a).back().content->stale);
}

TEST_CASE("a walk for a pattern keeps order and misses nothing", "[peis][TUP-20]") {
  tuple_store store;
  for (const auto* name : {"a.b.c", "A.b.d", "a.c", "ab.c.d", "b", "a.b", "a..c"}) {
    for (const int owner : {2, 1}) {
      tuple x;
      x.owner = peer_id{owner};
      x.name = named(name);
      static_cast<void>(store.put(std::move(x), std::nullopt, {}));
    }
  }
  const auto found = [&](int owner, std::string_view pattern) {
    std::string all;
    for (const auto& x : store.find_all(prototype_of(peer_id{owner}, named(pattern))))
      all += x->name.text() + to_string(x->owner) + ' ';
    return all;
  };
  CHECK(found(-1, "a.b.*") == "a.b.c1 a.b.c2 A.b.d1 A.b.d2 ");
  CHECK(found(1, "*.b.*") == "a.b.c1 A.b.d1 ");
  CHECK(found(1, "a.*") == "a.b1 a.c1 ");
  CHECK(found(1, "A.*.C") == "a..c1 a.b.c1 ");
  CHECK(found(2, "") == "a..c2 a.b2 a.b.c2 A.b.d2 a.c2 ab.c.d2 b2 ");
  CHECK(found(3, "").empty());
}

} // namespace rubicon::peis
