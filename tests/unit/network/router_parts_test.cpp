#include <vector>

#include "network/am.hpp"
#include "network/channels/known_places.hpp"
#include "network/channels/place_questions.hpp"
#include "network/clock/period_requests.hpp"
#include "network/clock/round_relay.hpp"
#include "network/clock/time_answers.hpp"
#include "network/frames/direct_packets.hpp"
#include "network/frames/frame_tokens.hpp"
#include "network/own_beacons.hpp"
#include "network/places/place_reports.hpp"
#include "network/router_message.hpp"
#include "network/silence_watch.hpp"
#include "network/tree/collection_packet.hpp"
#include "network/tree/route_help.hpp"
#include "support/catch.hpp"

namespace rubicon::network {

namespace {

constexpr virtual_coordinates near_place{1, 2, 3};
constexpr virtual_coordinates far_place{4, 5, 6};
constexpr mote_id far_mote{9};

awaited_channel channel_to(mote_id destination, std::uint16_t number) {
  awaited_channel x;
  x.channel = {mote_id{5}, number};
  x.destination = destination;
  return x;
}

} // namespace

TEST_CASE("a round is relayed soon, and again until others have done so", "[network][CLK-01]") {
  random_stream rng(1);
  round_relay x(relay_config{});
  CHECK_FALSE(x.due());
  x.on_round(instant{1s}, rng);
  REQUIRE(x.due());
  CHECK(*x.due() <= instant{1s} + relay_config().spread);
  const auto due = *x.due();
  x.hasten(instant{5s}, rng); // it is due already
  CHECK(x.due() == due);
  x.clear();
  x.on_relayed(instant{2s}, rng);
  CHECK(*x.due() >= instant{2s} + relay_config().pause / 2);
  x.clear();
  x.on_relayed(instant{4s}, rng);
  CHECK(x.due());
  x.clear();
  x.on_relayed(instant{6s}, rng); // the third one
  CHECK_FALSE(x.due());
}

TEST_CASE("a round is not relayed when enough copies were received", "[network][CLK-01]") {
  for (const bool is_urgent : {false, true}) {
    random_stream rng(1);
    round_relay x(relay_config{});
    x.on_round(instant{1s}, rng);
    x.on_copy(is_urgent);
    CHECK(x.due());
    x.on_copy(is_urgent);
    CHECK(x.due().has_value() == is_urgent);
    x.clear();
    x.on_relayed(instant{2s}, rng);
    CHECK_FALSE(x.due());
    x.on_own_round();
    x.on_relayed(instant{3s}, rng);
    CHECK(x.due());
  }
}

TEST_CASE("a request for the time is answered as often as it needs", "[network][CLK-04]") {
  random_stream rng(1);
  time_answers x({.spread = 30ms, .gap = 40ms, .each = 2}, instant{});
  CHECK(x.on_request(true, instant{1s}, rng));
  CHECK_FALSE(x.on_request(true, instant{1s}, rng)); // an answer is due
  REQUIRE(x.due());
  CHECK(x.is_due(instant{1s} + 30ms));
  x.on_beacon(instant{2s});
  CHECK(x.due() == instant{2s} + 40ms);
  x.on_beacon(instant{3s});
  CHECK_FALSE(x.due());
  CHECK(x.on_request(false, instant{4s}, rng));
  x.on_beacon(instant{4s});
  CHECK_FALSE(x.due()); // nobody has asked
  CHECK_FALSE(x.on_request(true, instant{4s} + 39ms, rng));
}

TEST_CASE("an answer is not sent when enough others have answered", "[network][CLK-04]") {
  random_stream rng(1);
  time_answers x({.spread = 30ms, .gap = 40ms, .each = 2}, instant{});
  x.on_answer();
  x.on_answer(); // before the request: they do not count
  CHECK(x.on_request(true, instant{1s}, rng));
  x.on_answer();
  CHECK(x.due());
  x.on_answer();
  CHECK_FALSE(x.due());
  x.on_beacon(instant{2s});
  CHECK_FALSE(x.due());
}

TEST_CASE("unicasts that fail in three windows show silence", "[network][CLK-04]") {
  silence_watch x(10s);
  CHECK_FALSE(x.on_unicast(false, instant{1s}));
  CHECK_FALSE(x.on_unicast(false, instant{2s})); // in the same window
  CHECK_FALSE(x.on_unicast(false, instant{11s}));
  CHECK(x.on_unicast(false, instant{21s}));
  CHECK_FALSE(x.on_unicast(false, instant{31s})); // once
  for (const bool acked : {true, false}) {
    silence_watch y(10s);
    CHECK_FALSE(y.on_unicast(false, instant{1s}));
    CHECK_FALSE(y.on_unicast(false, instant{11s}));
    if (acked)
      CHECK_FALSE(y.on_unicast(true, instant{12s}));
    else
      y.on_received();
    CHECK_FALSE(y.on_unicast(false, instant{21s}));
  }
}

TEST_CASE("more rounds are requested while they are too rare, once in a minute",
          "[network][CLK-01]") {
  random_stream rng(1);
  period_requests x(instant{});
  x.on_round(instant{10s});
  CHECK_FALSE(x.on_time(20s, instant{10s}, rng)); // one round has no period
  CHECK_FALSE(x.deadline());
  x.on_round(instant{70s});
  CHECK_FALSE(x.on_time(std::nullopt, instant{70s}, rng));
  CHECK_FALSE(x.on_time(48s, instant{70s}, rng)); // 60 s are near enough
  CHECK_FALSE(x.deadline());
  CHECK_FALSE(x.on_time(20s, instant{70s}, rng));
  REQUIRE(x.deadline());
  CHECK(*x.deadline() <= instant{70s} + period_requests::spread);
  const auto first = *x.deadline();
  CHECK(x.on_time(20s, first, rng) == duration(20s));
  CHECK_FALSE(x.on_time(20s, first, rng));
  CHECK(*x.deadline() >= first + period_requests::gap);
  x.on_round(instant{80s}); // another mote's was answered
  CHECK_FALSE(x.on_time(20s, instant{200s}, rng));
  CHECK_FALSE(x.deadline());
}

TEST_CASE("what a mote does for those without a route is limited in rate", "[network]") {
  route_help x(route_help_config{}, instant{});
  CHECK(x.may_seek(instant{30s} - 1ns));
  CHECK_FALSE(x.may_seek(instant{30s}));
  x.on_lost(instant{60s});
  CHECK(x.may_seek(instant{89s}));
  CHECK(x.take_help(instant{}));
  CHECK_FALSE(x.take_help(instant{2s} - 1ns));
  CHECK(x.take_help(instant{2s}));
  CHECK(x.take_sequence(instant{1s}));
  CHECK_FALSE(x.take_sequence(instant{21s} - 1ns));
  CHECK(x.take_sequence(instant{21s}));
}

TEST_CASE("a place is reported after a change, the more rarely the more changes", "[network]") {
  random_stream rng(1);
  place_reports x(instant{});
  CHECK(x.due(std::nullopt, no_mote) == instant{} + place_reports::period);
  CHECK(x.due(near_place, mote_id{2}) == instant{} + place_reports::gap);
  auto now = instant{5s};
  x.on_packet(mote_id{2});
  x.on_report(near_place, false, now, rng);
  CHECK(x.due(near_place, mote_id{2}) == now + place_reports::period);
  CHECK(x.due(far_place, mote_id{2}) == now + 2 * place_reports::gap);
  CHECK(x.due(near_place, mote_id{3}) == now + 2 * place_reports::gap);
  now += 10s;
  x.on_report(far_place, false, now, rng);
  CHECK(x.due(near_place, mote_id{2}) == now + 4 * place_reports::gap);
  now += place_reports::period;
  x.on_report(far_place, false, now, rng);
  CHECK(x.due(near_place, mote_id{2}) == now + place_reports::gap); // it was at rest
  x.on_report(far_place, true, now, rng);
  CHECK(x.due(far_place, mote_id{2}) <= now + place_reports::period);
}

TEST_CASE("a channel waits for the answer of the sink, which is asked twice", "[network]") {
  place_questions x(2);
  x.add(channel_to(far_mote, 1), true, instant{3s});
  x.add(channel_to(mote_id{8}, 2), false, instant{4s});
  CHECK(x.is_full());
  CHECK(x.deadline() == instant{3s});
  CHECK(x.take_unasked(instant{5s}) == std::vector{mote_id{8}});
  CHECK(x.take_unasked(instant{5s}).empty());
  CHECK(x.on_time(false, instant{6s}, instant{2s}).empty());
  auto overdue = x.on_time(false, instant{6s}, instant{3s});
  REQUIRE(overdue.size() == 1);
  CHECK(overdue[0].is_asked);
  CHECK(overdue[0].what.destination == far_mote);
  overdue = x.on_time(false, instant{9s}, instant{6s});
  REQUIRE(overdue.size() == 2);
  CHECK_FALSE(overdue[0].is_asked); // its second request has not been answered
  CHECK(overdue[1].is_asked);
  CHECK_FALSE(x.is_full());
  CHECK(x.on_answer(far_mote, false, instant{7s}).empty());
  CHECK(x.on_answer(mote_id{8}, false, instant{7s}).size() == 1);
  CHECK_FALSE(x.deadline());
}

TEST_CASE("in a crowd an answer of no use leads to another request", "[network]") {
  place_questions x(2);
  x.add(channel_to(far_mote, 1), true, instant{3s});
  CHECK(x.on_answer(far_mote, true, instant{1s}).empty());
  CHECK(x.deadline() == instant{1s} + place_questions::gap);
  CHECK(x.on_time(true, instant{9s}, instant{6s})[0].is_asked);
  CHECK(x.on_time(true, instant{12s}, instant{9s})[0].is_asked); // asks_in_crowd_max
  CHECK(x.on_answer(far_mote, true, instant{10s}).size() == 1);
}

TEST_CASE("a channel that is given up does not wait any more", "[network]") {
  place_questions x(2);
  const auto given_up = channel_to(far_mote, 1);
  x.add(given_up, true, instant{3s});
  x.remove(given_up.channel);
  CHECK_FALSE(x.deadline());
  CHECK(x.on_answer(far_mote, false, instant{1s}).empty());
}

TEST_CASE("places are learnt from packets that pass, but not our own", "[network]") {
  known_places x(coordinates(), place_cache(6, 10min), mote_id{5});
  CHECK_FALSE(x.find(far_mote, instant{}));
  x.learn(mote_id{5}, far_place, instant{});
  CHECK_FALSE(x.find_old(mote_id{5}));
  down_packet packet;
  packet.hops = {mote_id{5}};
  packet.content = encode(place_answer{far_mote, far_place});
  x.learn_from(am::down, encode(packet), instant{});
  CHECK(x.find(far_mote, instant{}) == far_place);
  CHECK_FALSE(x.find(far_mote, instant{} + 11min));
  CHECK(x.find_old(far_mote) == far_place);
  x.learn_from(am::down, bytes{1, 2, 3}, instant{}); // malformed: of no use
  x.learn_from(am::local, encode(packet), instant{});
}

TEST_CASE("a beacon that repeats the last one has its number", "[network]") {
  own_beacons x(trickle({}, random_stream(1), instant{}));
  CHECK_FALSE(x.has_sent());
  CHECK(x.begin(false) == 1);
  CHECK(x.is_in_flight());
  x.on_sent();
  CHECK(x.has_sent());
  CHECK_FALSE(x.is_in_flight());
  CHECK(x.begin(true) == 1);
  CHECK(x.begin(false) == 2);
  CHECK_FALSE(x.is_due());
  x.on_time(x.timer().deadline());
  CHECK(x.is_due());
  x.clear();
  x.request();
  CHECK(x.is_due());
}

TEST_CASE("a token says what its frame was, and to whom", "[network]") {
  frame_tokens x;
  const auto beacon = x.issue(frame_purpose::beacon);
  const auto direct = x.issue(frame_purpose::direct);
  CHECK(beacon != direct);
  CHECK(frame_tokens::purpose_of(beacon) == frame_purpose::beacon);
  CHECK(frame_tokens::purpose_of(direct) == frame_purpose::direct);
  x.on_unicast(direct, far_mote);
  CHECK(x.on_sent(direct) == far_mote);
  CHECK_FALSE(x.on_sent(direct));
  CHECK_FALSE(x.on_sent(beacon));
}

TEST_CASE("content for neighbours is bounded, and leaves in order", "[network]") {
  direct_packets x(2);
  x.add({1, far_mote, am::local, bytes{7}, std::nullopt}, bytes{7});
  CHECK_FALSE(x.is_full());
  x.add({5, mote_id{8}, am::local, bytes{8}, std::nullopt}, bytes{8});
  CHECK(x.is_full());
  CHECK(x.has_waiting());
  const auto frames = x.take_waiting();
  REQUIRE(frames.size() == 2);
  CHECK(frames[0].token == 1);
  CHECK(frames[1].next_hop == mote_id{8});
  CHECK_FALSE(x.has_waiting());
  CHECK(x.is_full()); // until they have been sent
  const auto sent = x.on_sent(5);
  REQUIRE(sent);
  CHECK(sent->to == mote_id{8});
  CHECK(sent->content == bytes{8});
  CHECK_FALSE(x.on_sent(5));
  CHECK_FALSE(x.is_full());
}

} // namespace rubicon::network
