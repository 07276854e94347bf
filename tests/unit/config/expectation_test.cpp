#include <string>

#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

template <class Expectation>
Expectation only_expectation(std::string_view keys) {
  const auto all = good(mote_head + "[[expect]]\n" + std::string(keys)).expectations;
  REQUIRE(all.size() == 1);
  return std::get<Expectation>(all[0]);
}

std::string wrong(std::string_view keys) {
  return problem_in(mote_head + "[[expect]]\n" + std::string(keys));
}

} // namespace

TEST_CASE("expectations about motes name all, an island or one", "[config][expect]") {
  const auto all =
      only_expectation<delivery_expectation>("kind = \"delivery\"\nat_least = \"99%\"\n");
  CHECK(all.at_least == 0.99);
  CHECK(all.of.contains({island_id{9}, mote_id{9}}));
  const auto island = only_expectation<delivery_expectation>(
      "kind = \"delivery\"\nof = \"k\"\nat_least = \"99%\"\n");
  CHECK(island.of.name == "k");
  CHECK(island.of.contains({island_id{1}, mote_id{9}}));
  CHECK_FALSE(island.of.contains({island_id{2}, mote_id{9}}));
  const auto mote =
      only_expectation<battery_expectation>("kind = \"battery\"\nof = \"k/c-2\"\nat_least = 0.8\n");
  CHECK(mote.of.contains({island_id{1}, mote_id{2}}));
  CHECK_FALSE(mote.of.contains({island_id{1}, mote_id{3}}));
  CHECK(only_expectation<acknowledged_expectation>("kind = \"acknowledged\"\nat_least = 1\n")
            .at_least == 1);
  CHECK(only_expectation<radio_expectation>("kind = \"radio\"\nat_most = \"5%\"\n").at_most ==
        0.05);
  CHECK(only_expectation<joined_expectation>("kind = \"joined\"\nwithin = \"20s\"\n").within ==
        20s);
  CHECK_FALSE(only_expectation<members_expectation>("kind = \"members\"\n").at_least);
  CHECK(only_expectation<members_expectation>("kind = \"members\"\nat_least = 3\n").at_least == 3);
}

TEST_CASE("expectations about streams, tuples, clocks and the run arrive with their keys",
          "[config][expect]") {
  const auto stream = only_expectation<stream_expectation>(
      "kind = \"stream\"\nstream = 7\nto = \"k/c-2\"\nat_least = \"99.9%\"\n");
  CHECK(stream.stream == 7);
  CHECK(stream.to == mote_address{island_id{1}, mote_id{2}});
  CHECK(stream.to_name == "k/c-2");
  CHECK_FALSE(stream.pause);
  const auto tuple = only_expectation<tuple_expectation>(
      "kind = \"tuple\"\nkey = \"a.lamp\"\nequals = [\"on\"]\nwithin = \"5s\"\n"
      "when = { key = \"a.door\", above = 1, below = 2 }\n");
  CHECK(tuple.then.key == "a.lamp");
  CHECK(tuple.then.equals == std::vector<std::string>{"on"});
  REQUIRE(tuple.when);
  CHECK(tuple.when->above == 1);
  CHECK(tuple.when->below == 2);
  CHECK(tuple.within == 5s);
  const auto clock = only_expectation<clock_expectation>(
      "kind = \"clock\"\nat_most = \"1ms\"\nshare = \"99.9%\"\nfrom = \"2min\"\nevery = \"1s\"\n");
  CHECK(clock.at_most == 1ms);
  CHECK(clock.share == Approx(0.999));
  CHECK(clock.from == 2min);
  CHECK(clock.every == 1s);
  const auto vectors = only_expectation<vectors_expectation>(
      "kind = \"vectors\"\nnode = \"k/c-2\"\nmissed = 3\nfrom = \"2min\"\n");
  CHECK(vectors.node == "k/c-2");
  CHECK(vectors.missed == 3);
  const auto actuations = only_expectation<actuations_expectation>(
      "kind = \"actuations\"\nproxy = \"k.fan\"\ncount = 60\nat_least = \"99%\"\n");
  CHECK(actuations.proxy == "k.fan");
  CHECK(actuations.count == 60);
  CHECK(only_expectation<events_expectation>("kind = \"events\"\nat_most = 1000\n").at_most ==
        1000);
  const auto log = only_expectation<event_log_expectation>(
      "kind = \"event_log\"\ntext = \"left\"\nwho = \"k/\"\nat_least = 0\nat_most = 0\n");
  CHECK(log.at_least == 0);
  CHECK(log.at_most == 0);
}

TEST_CASE("a situation is a line, a condition on a tuple, or both", "[config][expect]") {
  const auto all = only_expectation<sometimes_expectation>(
      "kind = \"sometimes\"\nname = \"n\"\ntext = \"restarts\"\nwho = \"k/\"\n"
      "during = { key = \"a.lamp\", equals = [\"on\"] }\n"
      "after = { text = \"opens\", who = \"q\" }\nwithin = \"2s\"\n");
  CHECK(all.name == "n");
  CHECK(all.line.text == "restarts");
  CHECK(all.line.who == "k/");
  REQUIRE(all.during);
  CHECK(all.during->key == "a.lamp");
  REQUIRE(all.after);
  CHECK(all.after->text == "opens");
  CHECK(all.after->who == "q");
  CHECK(all.within == 2s);
  const auto tuple = only_expectation<sometimes_expectation>(
      "kind = \"sometimes\"\nname = \"n\"\nduring = { key = \"a.lamp\", above = 1 }\n");
  CHECK(tuple.line.text.empty());
  CHECK(wrong("kind = \"sometimes\"\nname = \"n\"\n") ==
        "19:1: a situation needs `text` of a line of the event log, or `during`");
  CHECK(wrong("kind = \"sometimes\"\ntext = \"x\"\n").starts_with("19:1: `name` is missing"));
  CHECK(wrong("kind = \"sometimes\"\nname = \"n\"\ntext = \"x\"\nwithin = \"1s\"\n") ==
        "23:10: `within` has no effect without `after`");
  CHECK(wrong("kind = \"sometimes\"\nname = \"n\"\nwho = \"x\"\n"
              "during = { key = \"a.lamp\", above = 1 }\n") ==
        "22:7: `who` has no effect without `text`");
}

TEST_CASE("mistakes in expectations are told with their places", "[config][expect]") {
  CHECK(wrong("kind = \"delivry\"\nat_least = 1\n").find("did you mean \"delivery\"?") !=
        std::string::npos);
  CHECK(wrong("kind = \"delivery\"\nof = \"kk\"\nat_least = 1\n") ==
        "21:6: no island is named `kk`: did you mean `k`?");
  CHECK(wrong("kind = \"delivery\"\nof = \"k/c-3\"\nat_least = 1\n") ==
        "21:6: no mote of island `k` is named `c-3`: did you mean `c-2`?");
  CHECK(wrong("kind = \"delivery\"\nof = 1\nat_least = 1\n") ==
        "21:6: `of` must be an island, a mote as in \"kitchen/fan\", or \"*\", not 1");
  CHECK(wrong("kind = \"delivery\"\n") ==
        "19:1: `at_least` is missing in [[expect]] kind = \"delivery\"");
  CHECK(wrong("kind = \"delivery\"\nat_least = 1\nat_most = 1\n")
            .starts_with("22:1: unknown key `at_most` in [[expect]] kind = \"delivery\""));
  CHECK(wrong("kind = \"joined\"\nwithin = \"2h\"\n") ==
        "21:10: `within` is after the end of the run, which is at 1 h");
  CHECK(wrong("kind = \"tuple\"\nkey = \"a.b\"\nwithin = \"1s\"\n") ==
        "19:1: a condition needs either `equals`, or `above`, `below` or both");
  CHECK(wrong("kind = \"tuple\"\nkey = \"a.b\"\nabove = 2\nbelow = 2\nwithin = \"1s\"\n") ==
        "23:9: `below` must be more than `above`, which is 2");
  CHECK(wrong("kind = \"tuple\"\nkey = \"a.*\"\nabove = 2\nwithin = \"1s\"\n") != "none");
  CHECK(wrong("kind = \"vectors\"\nnode = \"nobody\"\n")
            .starts_with("21:8: no peer or gateway is named `nobody`"));
  CHECK(wrong("kind = \"event_log\"\ntext = \"x\"\nat_most = 0\n") ==
        "22:11: `at_most` must not be less than `at_least`, which is 1");
}
