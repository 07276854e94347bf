// Meta tuples: their text, and what follows them.
#include "peis/tuples/meta_tuple.hpp"
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis {
namespace {

using test::world;

/// A consumer, two producers of "out" and a configurator, all in a line.
struct workshop {
  world w;
  peer_id consumer = w.add(1);
  peer_id first = w.add(2);
  peer_id second = w.add(3);
  peer_id configurator = w.add(4);

  workshop() {
    w.connect(consumer, first);
    w.connect(first, second);
    w.connect(second, configurator);
    w.run_for(4s);
  }
  void produce(peer_id who, std::string_view text) {
    w.perform(who, w.at(who).tuples().set("out", text_content(text), w.now()));
  }
  void point_at(peer_id target) {
    w.perform(configurator, w.at(configurator)
                                .meta_tuples()
                                .set_reference(consumer, meta_key_of("in"), target, "out",
                                               request_id{1}, w.now()));
    w.run_for(200ms);
  }
  void declare() { w.perform(consumer, w.at(consumer).meta_tuples().declare("mi-in", w.now())); }
  void follow(peer_id who) {
    w.perform(who, w.at(who).subscriptions().subscribe_indirectly(consumer, "mi-in",
                                                                  subscription_id{5}, w.now()));
    w.run_for(200ms);
  }
  [[nodiscard]] std::string notified(peer_id who) const {
    std::string all;
    for (const auto& x : w.all<tuple_changed>(who)) {
      CHECK(x.subscription == subscription_id{5});
      all += to_string(x.content->owner) + std::string(x.content->text()) + ' ';
    }
    return all;
  }
};

} // namespace

TEST_CASE("references are read as real kernels write them", "[peis][META-01]") {
  const auto [text, owner, name] = GENERATE(
      table<std::string, int, std::string>({{"(META 20 kernel.name)", 20, "kernel.name"},
                                            {"( META  20\tkernel.name )", 20, "kernel.name"},
                                            {"(META 20 kernel.name", 20, "kernel.name"},
                                            {" (META 20 a.B) ", 20, "a.B"},
                                            {"(META -1 NULL)", -1, ""},
                                            {"(META -1 a.b)", -1, ""},
                                            {"(META 1 NULL)", 1, "NULL"}}));
  const auto x = parse_meta(text);
  REQUIRE(x);
  CHECK(x->has_value() == (owner > 0));
  if (*x) {
    CHECK((*x)->owner == peer_id{owner});
    CHECK((*x)->name.text() == name);
    CHECK(*parse_meta(format_meta(*x)) == *x);
  }
}

TEST_CASE("what is no reference is refused", "[peis][META-01][TUP-24]") {
  const auto text =
      GENERATE(as<std::string>{}, "", "(", "META 20 a", "(meta 20 a)", "(META 20)", "(META 20 )",
               "(META a b)", "(META20 a)", "(META 20a b)", "(META 20 a b)", "(META 20 a) b",
               "(META 20 a*)", "(META 20 a.*)", "(META 0 a)", "(META -2 a)", "(META 99999999999 a)",
               "(META 20 a.b.c.d.e.f.g.h)");
  CHECK(!parse_meta(text));
}

TEST_CASE("formats are those of real kernels", "[peis][META-01][META-04]") {
  CHECK(format_meta({}) == "(META -1 NULL)");
  CHECK(format_meta(meta_target{peer_id{20}, *key::parse("kernel.name")}) ==
        "(META 20 kernel.name)");
  CHECK(meta_key_of("in") == "mi-in");
  CHECK(meta_key_of("arm.left.in") == "arm.left.mi-in");
  tuple x;
  x.value = meta_content({}).value;
  CHECK(!read_meta(x)); // not the MIME type of meta tuples
  x.mimetype = meta_mimetype;
  CHECK(read_meta(x));
}

TEST_CASE("declaring makes an empty reference and keeps one that is there", "[peis][META-03]") {
  workshop p;
  auto& kernel = p.w.at(p.consumer);
  CHECK(!kernel.meta_tuples().is_meta_tuple(p.consumer, "mi-in"));
  p.declare();
  CHECK(kernel.meta_tuples().is_meta_tuple(p.consumer, "mi-in"));
  CHECK(kernel.reader().find(p.consumer, "mi-in")->text() == "(META -1 NULL)");
  p.follow(p.consumer);
  CHECK(p.notified(p.consumer).empty());
  p.point_at(p.first);
  p.declare();
  CHECK(kernel.reader().find(p.consumer, "mi-in")->text() == "(META 2 out)");
}

TEST_CASE("one write switches a consumer from one producer to another", "[peis][META-02]") {
  workshop p;
  const auto reader =
      GENERATE(true, false) ? p.consumer : p.configurator; // of its own and another's meta
  p.declare();
  p.produce(p.first, "a");
  p.produce(p.second, "x");
  p.follow(reader);
  p.point_at(p.first);
  CHECK(p.notified(reader) == "2a ");
  p.produce(p.first, "b");
  p.w.run_for(200ms);
  p.produce(p.first, "c"); // in transit while the reference changes
  p.point_at(p.second);
  const auto notified = p.notified(reader);
  CHECK(notified.substr(0, 6) == "2a 2b ");
  CHECK(notified.find("3x") != std::string::npos);
  p.produce(p.first, "d");
  p.produce(p.second, "y");
  p.w.run_for(200ms);
  const auto after = p.notified(reader).substr(notified.find("3x"));
  CHECK(after == "3x 3y ");
  CHECK(!p.w.at(p.first).reader().has_subscriber("out"));
  p.point_at(p.second); // the same again: nothing is repeated
  CHECK(p.notified(reader).substr(notified.find("3x")) == "3x 3y ");
}

TEST_CASE("an unset or broken reference delivers nothing", "[peis][META-02][META-03]") {
  workshop p;
  p.declare();
  p.produce(p.first, "a");
  p.follow(p.consumer);
  p.point_at(p.first);
  const auto rewrite = [&](tuple_content content) {
    p.w.perform(p.consumer,
                p.w.at(p.consumer).tuples().set("mi-in", std::move(content), p.w.now()));
    p.w.run_for(200ms);
    p.produce(p.first, "lost");
    p.w.run_for(200ms);
  };
  auto broken = meta_content({});
  broken.value = text_content("(META nonsense)").value;
  SECTION("unset") {
    rewrite(meta_content({}));
    CHECK(p.w.at(p.consumer).counters().tuples.bad_meta_tuples == 0);
  }
  SECTION("broken") {
    rewrite(broken);
    CHECK(p.w.at(p.consumer).counters().tuples.bad_meta_tuples == 1);
  }
  SECTION("deleted") {
    p.w.perform(p.consumer, p.w.at(p.consumer).tuples().remove("mi-in", p.w.now()));
    p.w.run_for(200ms);
    p.produce(p.first, "lost");
    p.w.run_for(200ms);
  }
  CHECK(p.notified(p.consumer) == "2a ");
  CHECK(!p.w.at(p.first).reader().has_subscriber("out"));
  p.point_at(p.first);
  CHECK(p.notified(p.consumer) == "2a 2lost ");
}

TEST_CASE("reading and writing go through the reference", "[peis][META-02][TUP-24]") {
  workshop p;
  auto& kernel = p.w.at(p.consumer);
  const auto get = [&] {
    return kernel.meta_tuples().get_indirectly(p.consumer, "mi-in", read_mode::keep_old, p.w.now());
  };
  const auto set = [&](std::string_view text) {
    p.w.clear_logs();
    p.w.perform(p.consumer, kernel.meta_tuples().set_indirectly(
                                p.consumer, "mi-in", text_content(text), request_id{3}, p.w.now()));
    p.w.run_for(200ms);
    return p.w.all<outcome>(p.consumer).at(0).why;
  };
  CHECK(get().why == cause::bad_meta_tuple);
  CHECK(set("1") == cause::bad_meta_tuple);
  p.declare();
  CHECK(get().why == cause::none);
  CHECK(!get());
  CHECK(set("1") == cause::bad_meta_tuple);
  p.follow(p.consumer);
  p.point_at(p.first);
  CHECK(set("2") == cause::none);
  CHECK(p.w.at(p.first).reader().find(p.first, "out")->text() == "2");
  REQUIRE(get());
  CHECK(get().content->text() == "2");
  p.point_at(p.consumer); // its own tuple
  CHECK(set("3") == cause::none);
  CHECK(get().content->text() == "3");
  const auto refused = kernel.meta_tuples().set_reference(p.consumer, "mi-in", p.first, "out.*",
                                                          request_id{4}, p.w.now());
  CHECK(std::get<outcome>(refused.at(0)).why == cause::abstract);
}

TEST_CASE("an indirect callback sends no request and ends like others", "[peis][META-02][CB-04]") {
  workshop p;
  p.declare();
  p.point_at(p.first);
  auto& kernel = p.w.at(p.consumer);
  p.w.perform(p.consumer, kernel.subscriptions().register_indirect_callback(
                              p.consumer, "mi-in", subscription_id{5}, p.w.now()));
  p.produce(p.first, "a");
  p.w.run_for(200ms);
  CHECK(p.notified(p.consumer).empty());
  CHECK(!p.w.at(p.first).reader().has_subscriber("out"));
  p.point_at(p.consumer);
  p.produce(p.consumer, "b");
  CHECK(p.notified(p.consumer) == "1b ");
  const auto taken =
      kernel.subscriptions().subscribe(any_peer, "z", subscription_id{5}, p.w.now(), request_id{1});
  CHECK(std::get<outcome>(taken.at(0)).why == cause::bad_handle);
  p.w.perform(p.consumer,
              kernel.subscriptions().unsubscribe(subscription_id{5}, p.w.now(), request_id{2}));
  CHECK(p.w.all<outcome>(p.consumer).back().success);
  p.produce(p.consumer, "c");
  CHECK(p.notified(p.consumer) == "1b ");
  CHECK(kernel.counters().tuples.subscriptions == 0);
}

} // namespace rubicon::peis
