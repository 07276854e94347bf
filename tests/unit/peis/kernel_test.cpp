// Tuples between two kernels.
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis {
namespace {

using test::world;

struct pair_of_peers {
  world w;
  peer_id a = w.add(1);
  peer_id b = w.add(2);
  link_id link = w.connect(a, b);

  pair_of_peers() { w.run_for(1s); }

  void set(peer_id who, std::string_view name, std::string_view text,
           std::optional<instant> expiry = {}) {
    w.perform(who, w.at(who).tuples().set(name, text_content(text, expiry), w.now()));
  }
  void subscribe(peer_id who, peer_id owner, std::string_view pattern, std::uint64_t id = 1) {
    w.perform(who,
              w.at(who).subscriptions().subscribe(owner, pattern, subscription_id{id}, w.now()));
  }
  [[nodiscard]] std::string changes(peer_id who) const {
    std::string all;
    for (const auto& x : w.all<tuple_changed>(who))
      all += std::string(x.content->text()) + ' ';
    return all;
  }
};

} // namespace

TEST_CASE("a late subscriber gets the current value, then updates", "[peis][TUP-04][TUP-08]") {
  pair_of_peers p;
  p.set(p.a, "room.Temp", "20");
  p.subscribe(p.b, p.a, "ROOM.temp");
  p.w.run_for(100ms);
  CHECK(p.changes(p.b) == "20 ");
  p.set(p.a, "room.temp", "21");
  p.set(p.a, "room.temp", "21");
  p.set(p.a, "room.light", "9");
  p.w.run_for(100ms);
  CHECK(p.changes(p.b) == "20 21 21 ");
  const auto held = p.w.at(p.b).reader().find(p.a, "room.temp");
  REQUIRE(held != nullptr);
  CHECK(held->name.text() == "room.Temp"); // the letter case of the first stays
  CHECK(held->owner == p.a);
  CHECK(held->creator == p.a);
  CHECK(held->seqno == 2);
  CHECK(held->mimetype == "text/plain");
  CHECK(p.w.at(p.b).reader().find(p.a, "room.light") == nullptr);
}

TEST_CASE("each subscription is told once of each change, in order of id", "[peis][CB-01][CB-02]") {
  pair_of_peers p;
  p.subscribe(p.b, any_peer, "a.*", 3);
  p.subscribe(p.b, p.a, "a.b", 2);
  p.subscribe(p.b, p.a, "a.b", 4);
  p.subscribe(p.b, any_peer, "*.b", 1);
  p.w.run_for(100ms);
  p.w.clear_logs();
  p.set(p.a, "a.b", "x");
  p.w.run_for(100ms);
  std::vector<std::uint64_t> ids;
  for (const auto& x : p.w.all<tuple_changed>(p.b))
    ids.push_back(x.subscription.value);
  CHECK(ids == std::vector<std::uint64_t>{1, 2, 3, 4});
  CHECK(p.w.at(p.a).counters().tuples.pushes_sent > 0);
  std::size_t pushes = 0;
  for (const auto& x : p.w.packages)
    pushes += x.header.port == port::push ? 1 : 0;
  CHECK(pushes == 1); // one package, however many subscriptions
}

TEST_CASE("all fields survive the journey, empty values included", "[peis][TUP-02]") {
  pair_of_peers p;
  p.subscribe(p.b, p.a, "", 1);
  p.w.perform(p.a, p.w.at(p.a).tuples().set("bin", binary_content(bytes{0, 1, 0, 255}), p.w.now()));
  p.w.perform(p.a, p.w.at(p.a).tuples().set("none", binary_content({}), p.w.now()));
  p.w.run_for(100ms);
  const auto x = p.w.at(p.b).reader().find(p.a, "bin");
  REQUIRE(x != nullptr);
  CHECK(to_hex(x->value.view()) == "000100ff");
  CHECK(x->form == encoding::binary);
  CHECK(x->mimetype == binary_mimetype);
  const auto none = p.w.at(p.b).reader().find(p.a, "none");
  REQUIRE(none != nullptr);
  CHECK(none->value.empty());
  CHECK(none->mimetype == empty_mimetype);
}

TEST_CASE("a remote set reaches owner and subscribers and reports success", "[peis][TUP-05]") {
  pair_of_peers p;
  p.subscribe(p.a, p.a, "lamp", 7);
  p.w.perform(p.b, p.w.at(p.b).tuples().set_remote(p.a, "lamp", text_content("on"), request_id{3},
                                                   p.w.now()));
  p.w.run_for(100ms);
  REQUIRE(p.w.all<outcome>(p.b).size() == 1);
  CHECK(p.w.all<outcome>(p.b)[0].success);
  CHECK(p.changes(p.a) == "on ");
  const auto x = p.w.at(p.a).reader().find(p.a, "lamp");
  REQUIRE(x != nullptr);
  CHECK(x->creator == p.b);
  p.w.perform(p.b, p.w.at(p.b).tuples().remove_remote(p.a, "lamp", request_id{4}, p.w.now()));
  p.w.run_for(100ms);
  CHECK(p.w.at(p.a).reader().find(p.a, "lamp") == nullptr);
  CHECK(p.w.all<tuple_deleted>(p.a).size() == 1);
}

TEST_CASE("a remote set to an unknown owner fails at once", "[peis][API-02]") {
  pair_of_peers p;
  const auto todo = p.w.at(p.b).tuples().set_remote(peer_id{77}, "lamp", text_content("on"),
                                                    request_id{3}, p.w.now());
  REQUIRE(todo.size() == 1);
  const auto& o = std::get<outcome>(todo[0]);
  CHECK(!o.success);
  CHECK(o.why == cause::no_route);
}

TEST_CASE("kernel tuples are there and cannot be written by others", "[peis][TUP-22]") {
  pair_of_peers p;
  const auto value = [&](const char* name) {
    return std::string(p.w.at(p.a).reader().find(p.a, name)->text());
  };
  CHECK(value("kernel.id") == "1");
  CHECK(value("kernel.name") == "peer1");
  CHECK(value("kernel.hostname") == "host1");
  p.w.perform(p.b, p.w.at(p.b).tuples().set_remote(p.a, "Kernel.ID", text_content("9"),
                                                   request_id{1}, p.w.now()));
  p.w.perform(p.b, p.w.at(p.b).tuples().set_remote(p.a, "kernel.do-quit", text_content("yes"),
                                                   request_id{2}, p.w.now()));
  p.w.perform(p.b,
              p.w.at(p.b).tuples().remove_remote(p.a, "kernel.name", request_id{3}, p.w.now()));
  prototype name;
  name.owner = p.a;
  name.name = *key::parse("kernel.name");
  p.w.perform(p.b, p.w.at(p.b).tuples().append(name, payload(to_bytes(std::string_view("x"))),
                                               p.w.now(), request_id{4}));
  p.w.run_for(100ms);
  CHECK(value("kernel.id") == "1");
  CHECK(value("kernel.name") == "peer1");
  CHECK(p.w.at(p.a).counters().tuples.refused == 1); // what is certain is not even sent
  CHECK(p.w.all<quit_requested>(p.a).empty());
  const auto& ended = p.w.all<outcome>(p.b);
  REQUIRE(ended.size() == 3);
  for (const auto& each : ended)
    CHECK(each.why == cause::refused);
  p.w.run_for(7s); // whether it quits is for it to decide: it has not
  REQUIRE(p.w.all<outcome>(p.b).size() == 4);
  CHECK(p.w.all<outcome>(p.b)[3].request == request_id{2});
  CHECK(p.w.all<outcome>(p.b)[3].why == cause::refused);
}

TEST_CASE("managers and peers of the same host may stop a peer", "[peis][TUP-22]") {
  world w;
  auto config = test::config_of(1);
  config.managers = {peer_id{3}};
  const auto a = w.add(config);
  auto same_host = test::config_of(2);
  same_host.network.host_name = "host1";
  const auto b = w.add(same_host);
  const auto c = w.add(3);
  w.connect(a, b);
  w.connect(c, a);
  w.run_for(1s);
  const auto stop = [&](peer_id by, std::string_view text) {
    w.perform(by, w.at(by).tuples().set_remote(a, "kernel.do-quit", text_content(text), no_request,
                                               w.now()));
    w.run_for(100ms);
  };
  stop(b, "no");
  CHECK(w.all<quit_requested>(a).empty());
  stop(b, "yes");
  stop(c, "yes");
  CHECK(w.all<quit_requested>(a).size() == 2);
}

TEST_CASE("deletion frees caches and tells subscribers; a new value follows", "[peis][TUP-16]") {
  pair_of_peers p;
  p.subscribe(p.b, any_peer, "x", 1);
  p.w.run_for(100ms);
  p.set(p.a, "x", "1");
  p.set(p.a, "x", "2");
  p.w.run_for(100ms);
  p.w.perform(p.a, p.w.at(p.a).tuples().remove("X", p.w.now()));
  p.w.run_for(100ms);
  CHECK(p.w.at(p.b).reader().find(p.a, "x") == nullptr);
  REQUIRE(p.w.all<tuple_deleted>(p.b).size() == 1);
  CHECK(p.w.all<tuple_deleted>(p.b)[0].content->text() == "2");
  p.set(p.a, "x", "3");
  p.w.run_for(100ms);
  CHECK(p.changes(p.b) == "1 2 3 ");
  CHECK(p.w.at(p.a).reader().find(p.a, "x")->seqno > 2); // numbers never fall
}

TEST_CASE("tuples expire at their time at owner and subscriber", "[peis][TUP-15]") {
  pair_of_peers p;
  p.subscribe(p.b, p.a, "x", 1);
  p.subscribe(p.a, p.a, "x", 1);
  p.set(p.a, "x", "1", p.w.now() + 3s);
  p.w.run_for(2999ms);
  CHECK(p.w.at(p.a).reader().find(p.a, "x") != nullptr);
  CHECK(p.w.at(p.b).reader().find(p.a, "x") != nullptr);
  p.w.run_for(2ms);
  for (const auto who : {p.a, p.b}) {
    CHECK(p.w.at(who).reader().find(p.a, "x") == nullptr);
    CHECK(p.w.all<tuple_deleted>(who).size() == 1);
  }
}

TEST_CASE("unsubscribing stops pushes and frees the cache", "[peis][TUP-09]") {
  const auto owner = GENERATE(peer_id{1}, any_peer);
  pair_of_peers p;
  p.subscribe(p.b, owner, "x", 1);
  p.subscribe(p.b, owner, "x", 2);
  p.set(p.a, "x", "1");
  p.w.run_for(100ms);
  CHECK(p.w.at(p.a).reader().has_subscriber("X"));
  p.w.perform(p.b, p.w.at(p.b).subscriptions().unsubscribe(subscription_id{1}, p.w.now()));
  p.w.run_for(100ms);
  CHECK(p.w.at(p.a).reader().has_subscriber("x")); // the second still wants it
  CHECK(p.w.at(p.b).reader().find(p.a, "x") != nullptr);
  p.w.perform(p.b, p.w.at(p.b).subscriptions().unsubscribe(subscription_id{2}, p.w.now()));
  p.w.run_for(100ms);
  CHECK(!p.w.at(p.a).reader().has_subscriber("x"));
  CHECK(p.w.at(p.b).reader().find(p.a, "x") == nullptr);
  p.set(p.a, "x", "2");
  p.w.run_for(100ms);
  CHECK(p.changes(p.b) == "1 1 ");
}

TEST_CASE("subscriptions live while they are refreshed and end when they are not",
          "[peis][TUP-10]") {
  pair_of_peers p;
  p.subscribe(p.b, p.a, "x", 1);
  p.set(p.a, "x", "1");
  p.w.run_for(200s);
  CHECK(p.w.at(p.a).reader().has_subscriber("x"));
  CHECK(p.changes(p.b) == "1 "); // a refresh is no reason to push again
  p.w.keep = [](const package_header& x) { return x.port != port::subscribe; };
  p.w.run_for(100s);
  CHECK(!p.w.at(p.a).reader().has_subscriber("x"));
}

TEST_CASE("illegal commands change nothing and say why", "[peis][TUP-24]") {
  pair_of_peers p;
  auto& kernel = p.w.at(p.a);
  const auto why = [&](const outputs& todo) { return std::get<outcome>(todo.at(0)).why; };
  const request_id r{1};
  const auto now = p.w.now();
  CHECK(why(kernel.tuples().set("a.b*", text_content("1"), now, r)) == cause::bad_key);
  CHECK(why(kernel.tuples().set("a.*", text_content("1"), now, r)) == cause::bad_key);
  CHECK(why(kernel.tuples().set(std::string(128, 'k'), text_content("1"), now, r)) ==
        cause::bad_key);
  auto content = text_content("1");
  content.mimetype = std::string(255, 'm');
  CHECK(why(kernel.tuples().set("a", content, now, r)) == cause::bad_value);
  CHECK(why(kernel.subscriptions().subscribe(any_peer, "b*", subscription_id{1}, now, r)) ==
        cause::bad_key);
  CHECK(why(kernel.subscriptions().subscribe(any_peer, "b", subscription_id{1}, now, r)) ==
        cause::none);
  CHECK(why(kernel.subscriptions().subscribe(any_peer, "c", subscription_id{1}, now, r)) ==
        cause::bad_handle);
  CHECK(kernel.reader().find_all(p.a, "a").empty());
}

TEST_CASE("pushes that fail for a while are made up for with the newest value", "[peis][TUP-18]") {
  pair_of_peers p;
  p.subscribe(p.b, p.a, "x", 1);
  p.w.run_for(100ms);
  p.w.keep = [](const package_header& x) { return x.port != port::push; };
  p.set(p.a, "x", "1");
  p.set(p.a, "x", "2");
  p.w.run_for(11500ms); // both have failed
  p.w.keep = nullptr;
  p.w.run_for(2s);
  CHECK(p.changes(p.b) == "2 ");
}

TEST_CASE("a kernel tells its owner whose messages a debug log is to have", "[peis][NFR-02]") {
  pair_of_peers p;
  p.w.perform(p.a,
              p.w.at(p.a).tuples().set("Rubicon.Debug", text_content("mote/kitchen"), p.w.now()));
  p.w.perform(p.b, p.w.at(p.b).tuples().set_remote(p.a, "rubicon.debug", text_content(""),
                                                   no_request, p.w.now()));
  p.w.perform(p.b, p.w.at(p.b).tuples().set_remote(p.a, "rubicon.debugs", text_content("x"),
                                                   no_request, p.w.now()));
  p.w.run_for(100ms);
  const auto told = p.w.all<debug_requested>(p.a);
  REQUIRE(told.size() == 2);
  CHECK(told[0].text == "mote/kitchen");
  CHECK(told[1].text.empty());
  CHECK(p.w.all<debug_requested>(p.b).empty());
}

} // namespace rubicon::peis
