#include "support/catch.hpp"
#include "view/timeline.hpp"

using namespace rubicon;
using view::timeline;

namespace {

report::run_sample sample_at(duration at, std::size_t motes = 1) {
  report::run_sample x;
  x.at = instant(at);
  for (std::size_t i = 0; i < motes; ++i) {
    report::mote_sample mote;
    mote.address = {island_id(1), mote_id(static_cast<std::uint16_t>(i + 1))};
    mote.neighbours = {{mote_id(1), 1.0}};
    x.motes.push_back(mote);
  }
  return x;
}

report::tuple_write write(duration at, std::string key, std::string value, bool deleted = false) {
  return {instant(at), "pc", "pc", std::move(key), std::move(value), deleted};
}

} // namespace

TEST_CASE("a moment is the newest sample that is not later", "[view]") {
  timeline x;
  CHECK(x.at(instant(1h)) == nullptr);
  for (int i = 1; i <= 5; ++i)
    x.add(sample_at(i * 10s));
  CHECK(x.at(instant(9s)) == nullptr);
  CHECK(x.at(instant(10s))->at == instant(10s));
  CHECK(x.at(instant(39s))->at == instant(30s));
  CHECK(x.at(instant(1h))->at == instant(50s));
}

TEST_CASE("samples of a long run are thinned evenly, and the newest stays", "[view]") {
  timeline x;
  constexpr int count = 100'000;
  for (int i = 0; i < count; ++i)
    x.add(sample_at(i * 1s));
  const auto all = x.all_samples();
  CHECK(all.size() <= timeline::samples_max + 1);
  CHECK(all.size() >= timeline::samples_max / 2);
  CHECK(all.front()->at == instant{});
  CHECK(all.back()->at == instant((count - 1) * 1s));
  duration widest{};
  for (std::size_t i = 1; i < all.size(); ++i)
    widest = std::max(widest, all[i]->at - all[i - 1]->at);
  CHECK(widest <= count * 1s / 100);
}

TEST_CASE("of many motes few samples are kept, and neighbours of the newest alone", "[view]") {
  timeline x;
  for (int i = 0; i < 60; ++i)
    x.add(sample_at(i * 1s, 50'000));
  const auto all = x.all_samples();
  std::size_t motes = 0;
  for (const auto& each : all)
    motes += each->motes.size();
  CHECK(motes <= timeline::mote_samples_max + 50'000);
  CHECK_FALSE(x.newest()->motes[0].neighbours.empty());
  CHECK(all.front()->motes[0].neighbours.empty());
}

TEST_CASE("a tuple has at each moment the value that it had", "[view]") {
  timeline x;
  x.add(write(1s, "a", "one"));
  x.add(write(3s, "a", "three"));
  x.add(write(5s, "a", "", true));
  x.add(write(2s, "a", "two")); // told late
  const auto value_at = [&x](duration at) {
    const auto then = x.tuples_at(instant(at));
    return then.tuples.empty() ? std::string() : then.tuples[0].second.value;
  };
  CHECK(value_at(500ms).empty());
  CHECK(value_at(1s) == "one");
  CHECK(value_at(2500ms) == "two");
  CHECK(value_at(4s) == "three");
  CHECK(value_at(5s).empty());
}

TEST_CASE("tuples are bounded in number, length and history", "[view]") {
  timeline x;
  for (std::size_t i = 0; i < timeline::tuples_max + 10; ++i)
    x.add(write(1s, std::to_string(i), "x"));
  CHECK(x.tuples_at(instant(1s)).tuples.size() == timeline::tuples_max);
  CHECK(x.tuples_at(instant(1s)).left_out == 10);
  x.add(write(2s, "1", std::string(100'000, 'x')));
  CHECK(x.values_of({"pc", "1"}).back().value.size() < 600);
  timeline y;
  for (std::size_t i = 0; i < 3 * timeline::values_max; ++i)
    y.add(write(1ms * i, "a", std::to_string(i)));
  CHECK(y.values_of({"pc", "a"}).size() <= timeline::values_max);
  CHECK(y.values_of({"pc", "a"}).back().value == std::to_string(3 * timeline::values_max - 1));
}

TEST_CASE("what changes rarely keeps its history beside what changes often", "[view]") {
  timeline x;
  x.add(write(1s, "door", "closed"));
  x.add(write(2s, "door", "open"));
  x.add(write(3s, "door", "", true));
  x.add(write(4s, "door", "closed"));
  for (std::size_t i = 0; i < 2 * timeline::values_max; ++i)
    x.add(write(1ms * i, "light", std::to_string(i)));
  CHECK(x.values_of({"pc", "light"}).size() <= timeline::values_max);
  const auto values = x.values_of({"pc", "door"});
  REQUIRE(values.size() == 4);
  CHECK(values[1].value == "open");
  CHECK(values[2].deleted);
}

TEST_CASE("a value that is set again is the same value", "[view]") {
  timeline x;
  for (int i = 0; i < 10; ++i)
    x.add(write(i * 1s, "a", "same"));
  CHECK(x.values_of({"pc", "a"}).size() == 1);
  CHECK(x.tuples_at(instant(9s)).tuples.at(0).second.since == instant{});
}

TEST_CASE("events are numbered, the oldest go", "[view]") {
  timeline x;
  for (std::size_t i = 0; i < timeline::events_max + 1; ++i)
    x.add(view::listed_event{instant(1s * i), "a", "b"});
  CHECK(x.events() == timeline::events_max + 1);
  CHECK(x.events_from(0).events.size() <= timeline::events_max);
  CHECK(x.events_from(0).next == timeline::events_max + 1);
  CHECK(x.events_from(timeline::events_max).events.size() == 1);
  CHECK(x.events_from(timeline::events_max + 1).events.empty());
  CHECK(x.events_from(timeline::events_max + 5).events.empty());
  CHECK_FALSE(x.event_after(instant(1s * timeline::events_max)));
  x.add(view::listed_event{instant(7s), "invariant", "violated", "violation"});
  CHECK(x.event_after(instant(1s * (timeline::events_max - 1)))->at ==
        instant(1s * timeline::events_max));
}
