#include <map>
#include <set>

#include "mote/join/descriptor.hpp"
#include "mote/join/registrar.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"

using namespace rubicon;
using namespace rubicon::mote;
using network::mote_joined;
using network::mote_left;

namespace {

constexpr mote_id newcomer{7};

bytes description(std::uint32_t type = 301, std::uint32_t keep_alive_ms = 3000) {
  return encode(descriptor{type, 0, 1, keep_alive_ms});
}

registrar make_registrar() {
  registrar_config config;
  config.island = island_id{1};
  return registrar(config);
}

/// Events of kind T among the outputs.
template <class T>
std::vector<T> events(const registrar_outputs& out) {
  return test::pick<T>(test::pick<network::sink_event>(out));
}

registrar_outputs request(registrar& x, instant now, std::uint32_t incarnation = 0,
                          mote_id mote = newcomer, std::uint16_t sequence = 1) {
  return x.on_frame(mote, encode(join_request{sequence, incarnation, description()}), now);
}

registrar_outputs confirm(registrar& x, instant now, std::uint32_t incarnation = 0,
                          mote_id mote = newcomer) {
  return x.on_frame(mote, encode(join_confirm{1, incarnation, description()}), now);
}

} // namespace

TEST_CASE("a sink answers a request and announces the mote once it confirms",
          "[mote][DIS-03][DIS-08]") {
  auto x = make_registrar();
  const auto out = request(x, instant{2s});
  REQUIRE(test::pick<to_mote>(out).size() == 1);
  CHECK(std::get<join_reply>(test::pick<to_mote>(out)[0].message) ==
        join_reply{1, island_id{1}, newcomer, 2000, {}});
  CHECK(events<mote_joined>(out).empty());
  CHECK(x.members() == 0);
  const auto in = events<mote_joined>(confirm(x, instant{2s}));
  REQUIRE(in.size() == 1);
  CHECK(in[0] == mote_joined{newcomer, 0, 301, description()});
  CHECK(x.members() == 1);
  CHECK(events<mote_joined>(confirm(x, instant{3s})).empty());
}

TEST_CASE("a reply is repeated until confirmed, five times at most", "[mote][DIS-08]") {
  auto x = make_registrar();
  static_cast<void>(request(x, instant{}));
  int replies = 1;
  while (x.deadline())
    replies += static_cast<int>(test::pick<to_mote>(x.on_time(*x.deadline())).size());
  CHECK(replies == 5);
  CHECK(x.members() == 0);
}

TEST_CASE("any frame of a mote with our reply confirms it", "[mote][DIS-08]") {
  auto x = make_registrar();
  static_cast<void>(request(x, instant{}));
  CHECK(events<mote_joined>(x.on_received(newcomer, instant{1s})).size() == 1);
}

TEST_CASE("a silent mote leaves after its window, one that sends stays", "[mote][DIS-06]") {
  auto x = make_registrar();
  static_cast<void>(request(x, instant{}));
  static_cast<void>(confirm(x, instant{}));
  CHECK(x.on_time(instant{9999ms}).empty());
  CHECK(x.on_received(newcomer, instant{9999ms}).empty());
  CHECK(x.on_time(instant{19998ms}).empty());
  const auto left = events<mote_left>(x.on_time(instant{19999ms}));
  REQUIRE(left.size() == 1);
  CHECK(left[0] == mote_left{newcomer, network::leave_cause::silence});
  CHECK(x.members() == 0);
}

TEST_CASE("a silent mote has left for the reason that it has sent last", "[mote][DIS-06][IF-13]") {
  using network::leave_cause;
  const auto cause_after = [](std::vector<keep_alive> sent) {
    auto x = make_registrar();
    static_cast<void>(request(x, instant{}));
    static_cast<void>(confirm(x, instant{}));
    for (const auto& each : sent)
      static_cast<void>(x.on_frame(newcomer, encode(each), instant{1s}));
    return events<mote_left>(x.on_time(instant{11s})).at(0).cause;
  };
  constexpr mote_condition low{true, false};
  constexpr mote_condition weak{false, true};
  CHECK(cause_after({}) == leave_cause::silence);
  CHECK(cause_after({{0, low}}) == leave_cause::battery);
  CHECK(cause_after({{0, weak}}) == leave_cause::out_of_range);
  CHECK(cause_after({{0, {true, true}}}) == leave_cause::battery);
  CHECK(cause_after({{0, weak}, {0, {}}}) == leave_cause::silence);
  CHECK(cause_after({{7, weak}}) == leave_cause::silence); // of another life
}

TEST_CASE("what a mote has sent of itself ends when it joins anew", "[mote][DIS-06][IF-13]") {
  auto x = make_registrar();
  static_cast<void>(request(x, instant{}));
  static_cast<void>(confirm(x, instant{}));
  static_cast<void>(x.on_frame(newcomer, encode(keep_alive{0, {true, false}}), instant{1s}));
  static_cast<void>(request(x, instant{2s}, 1)); // with another battery
  static_cast<void>(confirm(x, instant{2s}, 1));
  const auto left = events<mote_left>(x.on_time(instant{12s}));
  REQUIRE(left.size() == 1);
  CHECK(left[0].cause == network::leave_cause::silence);
}

TEST_CASE("a mote that was never announced leaves no trace", "[mote][DIS-06][GW-15]") {
  auto x = make_registrar();
  static_cast<void>(request(x, instant{}));
  const auto roster = events<network::roster>(x.on_describe(broadcast_mote, instant{}));
  REQUIRE(roster.size() == 1);
  CHECK(roster[0].entries.empty());
  CHECK(x.on_frame(newcomer, encode(leave_notice{}), instant{1s}).empty());
}

TEST_CASE("a mote that reports rarely has three of its periods", "[mote][DIS-06]") {
  auto x = make_registrar();
  static_cast<void>(
      x.on_frame(newcomer, encode(join_request{1, 0, description(101, 31'000)}), instant{}));
  static_cast<void>(confirm(x, instant{}));
  CHECK(events<mote_left>(x.on_time(instant{92'999ms})).empty());
  CHECK(events<mote_left>(x.on_time(instant{93s})).size() == 1);
}

TEST_CASE("a mote that says goodbye leaves at once", "[mote][DIS-06]") {
  auto x = make_registrar();
  static_cast<void>(request(x, instant{}));
  static_cast<void>(confirm(x, instant{}));
  const auto left = events<mote_left>(x.on_frame(newcomer, encode(leave_notice{}), instant{1s}));
  REQUIRE(left.size() == 1);
  CHECK(left[0].cause == network::leave_cause::notice);
  CHECK(x.on_frame(newcomer, encode(leave_notice{}), instant{1s}).empty());
}

TEST_CASE("a rebooted mote is announced again without ever leaving", "[mote][DIS-07]") {
  auto x = make_registrar();
  static_cast<void>(x.start(instant{}));
  static_cast<void>(request(x, instant{}));
  static_cast<void>(confirm(x, instant{}));
  static_cast<void>(request(x, instant{9900ms}, 1));
  const auto rosters = events<network::roster>(x.on_time(instant{10s}));
  REQUIRE(rosters.size() == 1);
  CHECK(rosters[0].entries.size() == 1); // still a member while it joins again
  const auto in = events<mote_joined>(confirm(x, instant{10s}, 1));
  REQUIRE(in.size() == 1);
  CHECK(in[0].incarnation == 1);
}

TEST_CASE("a member that reboots and then dies is reported to have left", "[mote][DIS-06]") {
  auto x = make_registrar();
  static_cast<void>(request(x, instant{}));
  static_cast<void>(confirm(x, instant{}));
  static_cast<void>(request(x, instant{1s}, 1));
  std::vector<mote_left> left;
  while (x.deadline()) {
    for (const auto& event : events<mote_left>(x.on_time(*x.deadline())))
      left.push_back(event);
  }
  REQUIRE(left.size() == 1);
  CHECK(left[0].mote == newcomer);
}

TEST_CASE("an unknown mote is asked to join, not more than once a second", "[mote][GW-15]") {
  auto x = make_registrar();
  const auto prompts = [&](duration t) {
    return test::pick<to_mote>(x.on_received(newcomer, instant{t})).size();
  };
  CHECK(prompts(0s) == 1);
  CHECK(prompts(999ms) == 0);
  CHECK(prompts(1s) == 1);
  CHECK(test::pick<to_mote>(x.on_frame(newcomer, encode(keep_alive{}), instant{2s})).size() == 1);
}

TEST_CASE("the roster names every member, in pages that fit", "[mote][GW-15]") {
  auto x = make_registrar();
  static_cast<void>(x.start(instant{}));
  for (std::uint16_t i = 2; i < 42; ++i) {
    static_cast<void>(request(x, instant{}, 0, mote_id{i}));
    static_cast<void>(confirm(x, instant{9s}, 0, mote_id{i}));
  }
  std::vector<network::roster> pages;
  for (const auto t : {10'000ms, 10'250ms, 10'500ms}) {
    CHECK(x.on_time(instant{t - 1ns}).empty());
    const auto page = events<network::roster>(x.on_time(instant{t}));
    REQUIRE(page.size() == 1); // a serial line holds few packets
    CHECK(page[0].page == pages.size());
    pages.push_back(page[0]);
  }
  CHECK(events<network::roster>(x.on_time(instant{20s - 1ns})).empty());
  CHECK(events<network::roster>(x.on_time(instant{20s})).size() == 1);
  std::vector<mote_id> named;
  for (const auto& page : pages) {
    CHECK(page.pages == 3);
    CHECK(page.number == pages[0].number);
    for (const auto& entry : page.entries)
      named.push_back(entry.mote);
  }
  CHECK(named.size() == 40);
  CHECK(std::is_sorted(named.begin(), named.end()));
}

TEST_CASE("a roster that takes longer than its period is completed before the next begins",
          "[mote][GW-15]") {
  auto x = make_registrar();
  static_cast<void>(x.start(instant{}));
  for (std::uint16_t i = 2; i < 1002; ++i) {
    static_cast<void>(request(x, instant{}, 0, mote_id{i}));
    static_cast<void>(confirm(x, instant{9s}, 0, mote_id{i}));
  }
  std::map<std::uint16_t, std::set<mote_id>> named;
  std::map<std::uint16_t, unsigned> pages;
  instant now{9s};
  while (named.size() < 3) {
    const auto before = now;
    now = *x.deadline();
    for (std::uint16_t i = 2; i < 1002; ++i)
      static_cast<void>(x.on_received(mote_id{i}, now));
    for (const auto& page : events<network::roster>(x.on_time(now))) {
      CHECK((pages.empty() || now - before >= 250ms));
      ++pages[page.number];
      for (const auto& entry : page.entries)
        named[page.number].insert(entry.mote);
    }
  }
  CHECK(pages[1] == 56);
  CHECK(named[1].size() == 1000);
  CHECK(named[2].size() == 1000);
}

TEST_CASE("the gateway's question about a mote is answered in either case", "[mote][GW-15]") {
  auto x = make_registrar();
  CHECK(events<mote_left>(x.on_describe(newcomer, instant{})).size() == 1);
  static_cast<void>(request(x, instant{}));
  CHECK(x.on_describe(newcomer, instant{}).empty());
  static_cast<void>(confirm(x, instant{}));
  CHECK(events<mote_joined>(x.on_describe(newcomer, instant{})).size() == 1);
}

TEST_CASE("a gateway that was started may ask for the roster at once", "[mote][GW-15]") {
  auto x = make_registrar();
  for (std::uint16_t mote = 10; mote < 30; ++mote) {
    static_cast<void>(request(x, instant{}, 0, mote_id{mote}));
    static_cast<void>(confirm(x, instant{}, 0, mote_id{mote}));
  }
  const auto first = events<network::roster>(x.on_describe(broadcast_mote, instant{1s}));
  REQUIRE(first.size() == 1);
  CHECK(first[0].page == 0);
  CHECK(first[0].pages == 2);
  const auto again = events<network::roster>(x.on_describe(broadcast_mote, instant{1s + 100ms}));
  REQUIRE(again.size() == 1);
  CHECK(again[0].page == 0); // who asks anew has not seen the first
  CHECK(again[0].number != first[0].number);
  const auto second = events<network::roster>(x.on_time(instant{1s + 350ms}));
  REQUIRE(second.size() == 1);
  CHECK(second[0].page == 1);
  CHECK(second[0].number == again[0].number);
  CHECK(events<network::roster>(x.on_time(instant{11s})).empty()); // the period begins anew
}

TEST_CASE("a member that sends vectors gets a slot for a while after it says so",
          "[mote][SYN-16]") {
  auto x = make_registrar();
  x.set_slot_room(400);
  const auto notice = [&x](std::uint16_t units, network::slot_run has, instant now) {
    std::vector<slot_grant> grants;
    for (const auto& each :
         test::pick<to_mote>(x.on_frame(newcomer, encode(slot_notice{units, has}), now)))
      if (const auto* grant = std::get_if<slot_grant>(&each.message))
        grants.push_back(*grant);
    return grants;
  };
  CHECK(notice(30, {}, instant{}).empty()); // a stranger is asked to join
  CHECK(x.slots().used() == 0);
  static_cast<void>(request(x, instant{1s}));
  static_cast<void>(confirm(x, instant{1s}));
  CHECK(notice(30, {}, instant{2s}) == std::vector{slot_grant{{0, 30}}});
  CHECK(notice(30, {0, 30}, instant{60s}).empty()); // it knows
  for (auto now = instant{60s}; now < instant{260s}; now += 2s) {
    static_cast<void>(x.on_received(newcomer, now));
    static_cast<void>(x.on_time(now));
    CHECK(x.slots().used() == 30);
  }
  CHECK(*x.deadline() <= instant{260s});
  static_cast<void>(x.on_time(instant{260s}));
  CHECK(x.slots().used() == 0);
  CHECK(notice(8, {0, 30}, instant{260s}) == std::vector{slot_grant{{0, 8}}});
  static_cast<void>(x.on_frame(newcomer, encode(leave_notice{}), instant{261s}));
  CHECK(x.slots().used() == 0);
}

TEST_CASE("a sink takes no more members than it has room for", "[mote]") {
  registrar_config config;
  config.members_max = 2;
  registrar x(config);
  CHECK(test::pick<to_mote>(request(x, instant{}, 0, mote_id{2})).size() == 1);
  CHECK(test::pick<to_mote>(request(x, instant{}, 0, mote_id{3})).size() == 1);
  CHECK(request(x, instant{}, 0, mote_id{4}).empty());
  CHECK(x.counters().refused == 1);
  CHECK(x.on_frame(newcomer, bytes{0xff}, instant{}).empty());
  CHECK(x.on_frame(newcomer, encode(join_request{1, 0, bytes{9}}), instant{}).empty());
  CHECK(x.counters().malformed == 2);
}

TEST_CASE("a full list loses who has been silent for long", "[mote]") {
  registrar_config config;
  config.members_max = 2;
  registrar x(config);
  for (const auto mote : {mote_id{2}, mote_id{3}}) { // who promise to send once a month
    static_cast<void>(
        x.on_frame(mote, encode(join_request{1, 0, description(301, 2'592'000'000)}), instant{}));
    static_cast<void>(x.on_frame(mote, encode(join_confirm{1, 0, {}}), instant{}));
  }
  static_cast<void>(x.on_received(mote_id{2}, instant{9s}));
  CHECK(request(x, instant{9s}, 0, mote_id{4}).empty());
  const auto out = request(x, instant{10s}, 0, mote_id{4});
  REQUIRE(events<mote_left>(out).size() == 1);
  CHECK(events<mote_left>(out)[0].mote == mote_id{3});
  CHECK(test::pick<to_mote>(out).size() == 1);
  // Should it live, it is asked to join again.
  CHECK(test::pick<to_mote>(x.on_received(mote_id{3}, instant{11s})).size() == 1);
}

TEST_CASE("what somebody else has said about a mote does not last", "[mote][DIS-03]") {
  const auto prompts = [](const registrar_outputs& out) {
    return std::ranges::count_if(test::pick<to_mote>(out), [](const to_mote& y) {
      return y.mote == newcomer && std::holds_alternative<rejoin_prompt>(y.message);
    });
  };
  auto x = make_registrar();
  static_cast<void>(request(x, instant{}));
  static_cast<void>(confirm(x, instant{}));
  SECTION("a life that it does not live") {
    static_cast<void>(request(x, instant{20s}, 77));
    CHECK(events<mote_joined>(confirm(x, instant{20s}, 77)).size() == 1);
    CHECK(prompts(x.on_frame(newcomer, encode(keep_alive{0, {}}), instant{21s})) == 1);
    CHECK(prompts(x.on_frame(newcomer, encode(keep_alive{0, {}}), instant{21500ms})) == 0);
    static_cast<void>(request(x, instant{22s}));
    CHECK(events<mote_joined>(confirm(x, instant{22s})).at(0).incarnation == 0);
    CHECK(prompts(x.on_frame(newcomer, encode(keep_alive{0, {}}), instant{24s})) == 0);
  }
  SECTION("a descriptor that is not its own") {
    CHECK(prompts(x.on_frame(newcomer, encode(join_request{9, 0, description(5)}), instant{20s})) ==
          1);
    CHECK(prompts(request(x, instant{22s})) == 1); // now this one contradicts
    CHECK(prompts(request(x, instant{24s})) == 0);
    CHECK(events<mote_joined>(x.on_describe(newcomer, instant{25s})).at(0).type == 301);
  }
}

TEST_CASE(
    "a second mote with a member's id is refused and reported once, the member's next life is not",
    "[mote][ADR-04][DIS-07]") {
  const auto of_device = [](std::uint32_t device) {
    return encode(descriptor{301, 0, 1, 3000, device});
  };
  const auto ask = [&](registrar& x, std::uint32_t device, std::uint32_t life, instant now) {
    return x.on_frame(newcomer, encode(join_request{9, life, of_device(device)}), now);
  };
  const auto refusals = [](const registrar_outputs& out) {
    return std::ranges::count_if(test::pick<to_mote>(out), [](const to_mote& y) {
      return y.mote == newcomer && y.message == management(join_refusal{9});
    });
  };
  auto x = make_registrar();
  static_cast<void>(ask(x, 0xa1, 3, instant{}));
  const auto joined = events<mote_joined>(
      x.on_frame(newcomer, encode(join_confirm{9, 3, of_device(0xa1)}), instant{}));
  REQUIRE(joined.size() == 1);

  SECTION("refused while the member sends, whatever life it claims") {
    const auto out = ask(x, 0xb2, 3, instant{5s});
    CHECK(refusals(out) == 1);
    REQUIRE(test::pick<double_refused>(out).size() == 1);
    CHECK(test::pick<double_refused>(out)[0].device == 0xb2);
    const auto again = ask(x, 0xb2, 77, instant{6s});
    CHECK(refusals(again) == 1);
    CHECK(test::pick<double_refused>(again).empty());
    CHECK(x.counters().doubles == 2);
    CHECK(x.members() == 1);
    // It did not keep the member alive either.
    CHECK(events<mote_left>(x.on_time(instant{10s})).size() == 1);
    CHECK(refusals(ask(x, 0xb2, 3, instant{11s})) == 0);
  }
  SECTION("the member's own next life is taken at once, an earlier one never") {
    static_cast<void>(ask(x, 0xb2, 9, instant{5s}));
    CHECK(refusals(ask(x, 0xa1, 4, instant{6s})) == 0);
    const auto reborn = events<mote_joined>(
        x.on_frame(newcomer, encode(join_confirm{9, 4, of_device(0xa1)}), instant{6s}));
    REQUIRE(reborn.size() == 1);
    CHECK(reborn[0].incarnation == 4);
    CHECK(ask(x, 0xa1, 3, instant{7s}).empty()); // it was in transit for long
    CHECK(x.counters().outdated == 1);
    CHECK(events<mote_joined>(x.on_describe(newcomer, instant{8s})).at(0).incarnation == 4);
  }
  SECTION("a second one that has been a member is asked to join, and refused then") {
    const auto out = x.on_frame(newcomer, encode(keep_alive{3, {}, 0xb2}), instant{5s});
    CHECK(test::pick<double_refused>(out).size() == 1);
    REQUIRE(test::pick<to_mote>(out).size() == 1);
    CHECK(std::holds_alternative<rejoin_prompt>(test::pick<to_mote>(out)[0].message));
    CHECK(test::pick<to_mote>(x.on_frame(newcomer, encode(keep_alive{3, {}, 0xa1}), instant{6s}))
              .empty());
  }
  SECTION("who does not name its device is taken for the member, as before") {
    CHECK(refusals(ask(x, 0, 4, instant{5s})) == 0);
  }
}
