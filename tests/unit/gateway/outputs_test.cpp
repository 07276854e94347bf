#include <map>

#include "core/numbers/random.hpp"
#include "gateway/output_requests.hpp"
#include "support/catch.hpp"
#include "unit/gateway/fixture.hpp"

using namespace rubicon;
using communication::any_channel;
using gateway::output_requests;
using test::fan;
using wanted = output_requests::wanted;

namespace {

constexpr mote_id lamp{8};

struct fixture {
  explicit fixture(bool restarted = false) : core({}, restarted, {}) {}

  void subscribe(const std::vector<std::string>& keys) { core.on_subscribers(keys, now); }

  /// Goes on to the next request.
  std::vector<output_requests::request> next() {
    REQUIRE(core.deadline());
    now = *core.deadline();
    return core.due(now);
  }

  output_requests core;
  instant now;
};

} // namespace

TEST_CASE("a mote is asked for an output channel when the first subscribes, and told to stop after "
          "the last",
          "[gateway][GW-10]") {
  fixture x;
  x.core.on_listed(fan, 0, x.now);
  CHECK(!x.core.deadline()); // nothing is wanted of it, and it knows
  x.subscribe({"devices.7.output.2"});
  auto requests = x.next();
  REQUIRE(requests.size() == 1);
  CHECK(requests[0].mote == fan);
  CHECK(requests[0].outputs == wanted{{2, 0ms}});
  CHECK(!x.core.deadline());
  x.core.on_outcome(fan, true, x.now);
  CHECK(!x.core.deadline());
  x.subscribe({"devices.7.output.2", "devices.8.output.2"}); // no other mote is listed
  CHECK(!x.core.deadline());
  x.subscribe({});
  requests = x.next();
  REQUIRE(requests.size() == 1);
  CHECK(requests[0].outputs.empty());
}

TEST_CASE("patterns that name devices count, others do not", "[gateway][GW-10]") {
  fixture x;
  x.core.on_listed(fan, 0, x.now);
  const auto of = [&](const char* key) {
    x.subscribe({key});
    return x.core.wanted_of(fan);
  };
  CHECK(of("devices.7.output.*") == wanted{{any_channel, 0ms}});
  CHECK(of("devices.*.output.3") == wanted{{3, 0ms}});
  CHECK(of("devices.*.*.*") == wanted{{any_channel, 0ms}});
  for (const auto* key :
       {"devices", "devices.*", "devices.*.type", "devices.7.input.2", "devices.7.output.2.period",
        "devices.8.output.2", "devices.7.output", "devices.7.output.x", "devices.7.output.*.*", "",
        "*.7.output.2", "devices..output.2"})
    CHECK(of(key).empty());
}

TEST_CASE("the rate of an output channel is the one asked for last", "[gateway][IF-04]") {
  fixture x;
  x.core.on_listed(fan, 0, x.now);
  x.core.on_period(fan, 2, 250ms, x.now);
  CHECK(x.core.wanted_of(fan).empty()); // nobody subscribes to it
  x.subscribe({"devices.7.output.2"});
  CHECK(x.next()[0].outputs == wanted{{2, 250ms}});
  x.core.on_outcome(fan, true, x.now);
  x.core.on_period(fan, 2, 1s, x.now);
  CHECK(x.next()[0].outputs == wanted{{2, 1s}});
  x.core.on_outcome(fan, true, x.now);
  x.core.on_period(fan, 2, 0ms, x.now);
  CHECK(x.next()[0].outputs == wanted{{2, 0ms}});
  x.subscribe({"devices.7.output.*"});
  x.core.on_period(fan, 2, 1s, x.now);
  CHECK(x.core.wanted_of(fan) == wanted{{2, 1s}, {any_channel, 0ms}});
}

TEST_CASE("a mote is asked for every channel when there are more than it can remember",
          "[gateway][GW-10][IF-04]") {
  fixture x;
  x.core.on_listed(fan, 0, x.now);
  x.subscribe({"devices.7.output.1", "devices.7.output.2", "devices.7.output.3",
               "devices.7.output.4", "devices.7.output.5"});
  x.core.on_period(fan, 4, 250ms, x.now);
  CHECK(x.core.wanted_of(fan) == wanted{{4, 250ms}, {communication::any_channel, 0ms}});
  for (const int channel : {1, 2, 3, 5})
    x.core.on_period(fan, static_cast<std::uint16_t>(channel), 1s, x.now);
  CHECK(x.core.wanted_of(fan) ==
        wanted{{1, 1s}, {2, 1s}, {3, 1s}, {communication::any_channel, 0ms}});
}

TEST_CASE("a request that fails is repeated; one that has become wrong is followed by another",
          "[gateway][GW-10]") {
  fixture x;
  x.core.on_listed(fan, 0, x.now);
  x.subscribe({"devices.7.output.2"});
  static_cast<void>(x.next());
  const auto failed = x.now;
  x.core.on_outcome(fan, false, failed);
  CHECK(x.next().size() == 1);
  CHECK(x.now == failed + 10s);
  x.subscribe({"devices.7.output.3"});
  CHECK(!x.core.deadline()); // one at a time
  x.core.on_outcome(fan, true, x.now);
  CHECK(x.next()[0].outputs == wanted{{3, 0ms}});
}

TEST_CASE("a mote that has started again knows no requests; one that was only away does",
          "[gateway][GW-10][DIS-07]") {
  fixture x;
  x.core.on_listed(fan, 0, x.now);
  x.subscribe({"devices.7.output.2"});
  static_cast<void>(x.next());
  x.core.on_outcome(fan, true, x.now);
  x.core.on_unlisted(fan);
  x.core.on_listed(fan, 0, x.now);
  CHECK(!x.core.deadline());
  x.core.on_listed(fan, 1, x.now);
  CHECK(x.next()[0].outputs == wanted{{2, 0ms}});
  x.core.on_listed(fan, 2, x.now); // it has started again since it was asked
  x.core.on_outcome(fan, true, x.now);
  CHECK(x.next()[0].outputs == wanted{{2, 0ms}});
}

TEST_CASE("after a restart of the gateway motes hear what is wanted once subscribers are back",
          "[gateway][GW-10][GW-15]") {
  fixture x(true);
  x.core.on_listed(fan, 3, x.now);
  x.core.on_listed(lamp, 0, x.now);
  x.now += 2s;
  x.subscribe({"devices.7.output.2"});
  const auto requests = x.next();
  CHECK(x.now == instant{5s});
  REQUIRE(requests.size() == 2);
  CHECK(requests[0].outputs == wanted{{2, 0ms}});
  CHECK(requests[1].outputs.empty()); // it may still be sending for somebody of old
}

TEST_CASE("not all motes are asked at once", "[gateway][GW-10]") {
  fixture x;
  for (std::uint16_t i = 1; i <= 100; ++i)
    x.core.on_listed(mote_id{i}, 0, x.now);
  x.subscribe({"devices.*.output.1"});
  std::map<mote_id, unsigned> asked;
  while (x.core.deadline()) {
    const auto requests = x.next();
    CHECK(requests.size() <= 16);
    CHECK(x.core.due(x.now).empty());
    for (const auto& each : requests) {
      ++asked[each.mote];
      x.core.on_outcome(each.mote, true, x.now);
    }
  }
  CHECK(asked.size() == 100);
  for (const auto& [mote, times] : asked)
    CHECK(times == 1);
}

TEST_CASE("whatever happens, a mote that stays knows in the end what is wanted",
          "[gateway][GW-10]") {
  random_stream rng(5);
  for (auto run = 0; run < 200; ++run) {
    fixture x(run % 2 == 1);
    std::map<mote_id, wanted> known;
    std::map<mote_id, std::uint32_t> lives;
    const std::vector<mote_id> motes{mote_id{1}, mote_id{2}, mote_id{3}};
    std::vector<std::pair<output_requests::request, std::uint32_t>> in_flight; // to which life
    const auto ask = [&](std::vector<output_requests::request> requests) {
      for (auto& each : requests)
        in_flight.emplace_back(each, lives[each.mote]);
    };
    const auto deliver = [&](bool loses) {
      for (auto& [each, life] : std::exchange(in_flight, {})) {
        const auto outcome = loses ? rng.below(3) : 2;
        if (outcome > 0 && life == lives[each.mote])
          known[each.mote] = each.outputs; // its acknowledgement may be lost
        x.core.on_outcome(each.mote, outcome == 2, x.now);
      }
    };
    for (auto step = 0; step < 30; ++step) {
      x.now += rng.between(0s, 3s);
      const auto mote = motes[rng.below(3)];
      switch (rng.below(5)) {
      case 0:
        x.subscribe(rng.below(2) == 0
                        ? std::vector<std::string>{}
                        : std::vector<std::string>{"devices.2.output.1", "devices.*.output.4"});
        break;
      case 1:
        x.core.on_listed(mote, lives[mote], x.now);
        break;
      case 2:
        x.core.on_unlisted(mote);
        break;
      case 3:
        known.erase(mote);
        x.core.on_listed(mote, ++lives[mote], x.now);
        break;
      default:
        deliver(true);
      }
      ask(x.core.due(x.now));
    }
    for (const auto mote : motes)
      x.core.on_listed(mote, lives[mote], x.now);
    for (auto last = 0; last < 20 && (x.core.deadline() || !in_flight.empty()); ++last) {
      deliver(false);
      if (x.core.deadline())
        ask(x.next());
    }
    for (const auto mote : motes)
      CHECK(known[mote] == x.core.wanted_of(mote));
  }
}
