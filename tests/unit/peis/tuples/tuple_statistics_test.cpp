// The kernel.* tuples that change while a kernel runs.
#include "support/catch.hpp"
#include "unit/peis/fixture.hpp"

namespace rubicon::peis {
namespace {

using test::world;

struct observed_pair {
  world w;
  peer_id a = w.add(1);
  peer_id b = w.add(2);
  link_id link = w.connect(a, b);

  observed_pair() { w.run_for(12s); }

  [[nodiscard]] std::string read(std::string_view name) {
    const auto x = w.at(a).reader().get(a, name, read_mode::keep_old, w.now());
    return x ? std::string(x.content->text()) : "none";
  }
  void subscribe(peer_id who, std::string_view name) {
    w.perform(who, w.at(who).subscriptions().subscribe(a, name, subscription_id{1}, w.now()));
    w.run_for(10ms);
  }
  [[nodiscard]] std::vector<std::string> notified(peer_id who) const {
    std::vector<std::string> all;
    for (const auto& x : w.all<tuple_changed>(who))
      all.emplace_back(x.content->text());
    return all;
  }
};

} // namespace

TEST_CASE("statistics have the formats of real kernels", "[peis][TUP-22]") {
  observed_pair p;
  CHECK(p.read("kernel.step-time") == "0.0000");
  const auto connections = p.read("kernel.connections");
  CHECK(connections.starts_with("((2 "));
  CHECK(connections.ends_with(" 0 0.00))"));
  const auto traffic = p.read("kernel.traffic");
  CHECK(traffic.front() == '(');
  CHECK(traffic != "(0.0 0.0)");
  CHECK(p.read("kernel.routingTable") == "(\n (   1  0   -1)\n (   2  2    2)\n)\n");
  CHECK(p.read("kernel.subscribers") == "(\n)\n");
  CHECK(p.read("kernel.all-keys") ==
        "(kernel.all-keys kernel.connections kernel.do-quit kernel.hostname kernel.id kernel.name "
        "kernel.routingTable kernel.step-time kernel.subscribers kernel.traffic kernel.user "
        "kernel.version)");
  p.subscribe(p.b, "kernel.n*me"); // a literal elsewhere, refused here
  p.subscribe(p.b, "Kernel.*");
  CHECK(p.read("kernel.subscribers") == "(\n  ( 2 1.Kernel.* )\n)\n");
}

TEST_CASE("looking at statistics computes them and sends nothing", "[peis][TUP-22][TUP-14]") {
  observed_pair p;
  p.w.packages.clear();
  const auto before = p.read("kernel.traffic");
  p.w.perform(p.a, p.w.at(p.a).tuples().set("later", text_content(""), p.w.now()));
  CHECK(p.read("kernel.all-keys").find("later") != std::string::npos);
  CHECK(p.read("kernel.traffic") == before); // not older than its period
  CHECK(p.w.packages.empty());
  result_set found;
  p.w.at(p.a).reader().get_all(prototype_of(any_peer, *key::parse("kernel.*")), found, p.w.now());
  CHECK(found.size() == 12);
  p.w.run_for(30s);
  CHECK(p.read("kernel.traffic") != before);
}

TEST_CASE("statistics are sent while there is a subscription", "[peis][TUP-22][SCH-06]") {
  observed_pair p;
  const auto who = GENERATE(peer_id{1}, peer_id{2});
  for (int i = 0; i < 100; ++i)
    p.w.at(p.a).note_step(4ms);
  p.subscribe(who, "kernel.step-time");
  CHECK(p.notified(who) == std::vector<std::string>{"0.0040"});
  p.w.at(p.a).note_step(104ms);
  p.w.run_for(20s);
  REQUIRE(p.notified(who).size() == 5); // each 5 s
  CHECK(p.notified(who)[1] == "0.0140");
  p.w.perform(who, p.w.at(who).subscriptions().unsubscribe(subscription_id{1}, p.w.now()));
  p.w.run_for(1s);
  const auto sets = p.w.at(p.a).counters().tuples.sets;
  p.w.run_for(60s);
  CHECK(p.w.at(p.a).counters().tuples.sets == sets);
}

TEST_CASE("all keys are sent when they change, at most once a second", "[peis][TUP-22]") {
  observed_pair p;
  p.subscribe(p.b, "kernel.all-keys");
  p.w.clear_logs();
  for (int i = 0; i < 50; ++i) {
    p.w.perform(p.a,
                p.w.at(p.a).tuples().set("k" + std::to_string(i), text_content(""), p.w.now()));
    p.w.run_for(50ms);
  }
  p.w.run_for(2s);
  const auto notified = p.notified(p.b);
  CHECK(notified.size() >= 3);
  CHECK(notified.size() <= 4);
  CHECK(notified.back().find(" k49 ") != std::string::npos);
  p.w.clear_logs();
  p.w.perform(p.a, p.w.at(p.a).tuples().remove("k49", p.w.now()));
  p.w.run_for(100ms);
  REQUIRE(p.notified(p.b).size() == 1); // at once after a quiet second
  CHECK(p.notified(p.b)[0].find(" k49 ") == std::string::npos);
}

TEST_CASE("statistics without a subscription wake no peer", "[peis][TUP-22]") {
  const instant start{100s};
  const p2p network(test::config_of(1).network, random_stream(1, "a"), start);
  tuple_space tuples({}, peer_id{1}, 1'000'000'000s);
  kernel_statistics x(start);
  const auto values = x.initial(network, tuples, start);
  CHECK(values.size() == 6);
  x.follow(tuples);
  CHECK(!x.deadline(tuples));
  CHECK(x.due(network, tuples, start + 60s).empty());
  const auto name = *key::parse("kernel.traffic");
  static_cast<void>(tuples.subscribe(prototype_of(any_peer, name), subscription_id{1},
                                     tuple_space::interest::callback, start));
  x.follow(tuples);
  CHECK(x.deadline(tuples) == start + 5s);
  CHECK(x.due(network, tuples, start + 5s).size() == 1);
  CHECK(x.deadline(tuples) == start + 10s);
  static_cast<void>(tuples.unsubscribe(subscription_id{1}));
  x.follow(tuples);
  CHECK(!x.deadline(tuples));
}

} // namespace rubicon::peis
