// What p2p is put together of, each part alone.
#include "peis/link/stranger_table.hpp"
#include "peis/link/traffic_meter.hpp"
#include "peis/overlay/id_rivalry.hpp"
#include "peis/overlay/route_probes.hpp"
#include "support/catch.hpp"
#include "unit/peis/ids.hpp"

namespace rubicon::peis {
namespace {

using test::start;

constexpr peer_id left_peer{11};
constexpr peer_id right_peer{12};

host_record other_with(std::int32_t magic, bool marked = true) {
  host_record x;
  x.full_name = "other@somewhere!1";
  x.magic = magic;
  x.marked = marked;
  return x;
}

/// Two signs of another peer, the second when it is to be judged. @returns how long we stay away
duration stays_away(id_rivalry& x, const host_record& other, instant from, instant until) {
  static_cast<void>(x.note(other, from));
  static_cast<void>(x.note(other, until));
  for (const auto& output : x.on_time(until)) {
    if (const auto* const taken = std::get_if<id_taken>(&output))
      return taken->stays_away;
  }
  return duration(0);
}

outgoing_package package(peer_id to, std::uint16_t port, std::size_t length) {
  outgoing_package x;
  x.header.destination = to;
  x.header.port = port;
  x.content = std::make_shared<const message_octets>(message_octets{bytes(length, 1), {}});
  return x;
}

} // namespace

TEST_CASE("of two newcomers the higher magic number leaves first, and who cannot leave stays",
          "[peis][RTE-08]") {
  const auto [magic, marked, leaves] = GENERATE(
      table<std::int32_t, bool, duration>({{1, true, 2s}, {99, true, 8s}, {99, false, 2s}}));
  const auto other = other_with(magic, marked);
  id_rivalry early(50, start);
  CHECK(stays_away(early, other, start, start + leaves - 1ms) == 0s);
  id_rivalry x(50, start);
  static_cast<void>(x.note(other, start));
  CHECK(x.deadline() == start + leaves);
  CHECK(stays_away(x, other, start, start + leaves) == 15s);
  CHECK(x.is_away());
  CHECK(x.deadline() == start + leaves + 15s);
}

TEST_CASE("who has long been there leaves late to a lower magic number, and never to a higher one",
          "[peis][RTE-08]") {
  const auto later = start + 30s;
  id_rivalry high(50, start);
  CHECK(stays_away(high, other_with(1), later, later + 15s - 1ms) == 0s);
  CHECK(stays_away(high, other_with(1), later, later + 15s) == 15s);
  id_rivalry low(50, start);
  CHECK(stays_away(low, other_with(99), later, later + 1min) == 0s);
}

TEST_CASE("a rival that gives no more signs is forgotten, and one that does is told once",
          "[peis][RTE-08]") {
  id_rivalry x(50, start);
  REQUIRE(x.note(other_with(1), start).size() == 1);
  CHECK(x.note(other_with(1), start).empty());
  CHECK(x.on_time(start + 2s).empty()); // one sign is not enough
  CHECK(x.deadline() == start + 10s);
  CHECK(x.on_time(start + 10s).empty());
  CHECK(!x.deadline());
  CHECK(x.note(other_with(2), start + 11s).size() == 1); // another incarnation
  x.end();
  CHECK(!x.deadline());
}

TEST_CASE("who has left its id comes back, and stays away longer if it must leave again",
          "[peis][RTE-08]") {
  id_rivalry x(50, start);
  auto now = start;
  for (const auto away : {15s, 30s, 60s, 120s, 120s}) {
    CHECK(stays_away(x, other_with(1), now, now + 2s) == away);
    now += 2s + away;
    CHECK(x.on_time(now - 1ms).empty());
    const auto back = x.on_time(now);
    REQUIRE(back.size() == 1);
    CHECK(std::holds_alternative<id_regained>(back[0]));
    CHECK(!x.is_away());
  }
  CHECK(stays_away(x, other_with(1), now, now + 2s) == 120s);
  static_cast<void>(x.note(other_with(1), now + 121s)); // it is still there
  CHECK(x.deadline() == now + 136s);
}

TEST_CASE("traffic to a host is smoothed, and that of services does not count", "[peis][CM-02]") {
  traffic_meter x(1, start);
  x.count(package(left_peer, 30, 1000 - header_size));
  x.count(package(left_peer, port::trace, 1000));
  x.count(package(right_peer, 30, 1000)); // there is no room for it
  CHECK(x.octets_per_second(left_peer) == 0);
  x.measure(start + 1s);
  CHECK(x.octets_per_second(left_peer) == Approx(300));
  CHECK(x.octets_per_second(right_peer) == 0);
  x.measure(start + 2s);
  CHECK(x.octets_per_second(left_peer) == Approx(210));
  x.forget(left_peer);
  x.count(package(right_peer, 30, 1000));
  x.measure(start + 3s);
  CHECK(x.octets_per_second(right_peer) > 0);
  for (int i = 4; i < 60; ++i)
    x.measure(start + std::chrono::seconds(i));
  CHECK(x.octets_per_second(right_peer) == 0); // and it is forgotten: there is room again
  x.count(package(left_peer, 30, 1000));
  x.measure(start + 60s);
  CHECK(x.octets_per_second(left_peer) > 0);
}

TEST_CASE("a stranger is asked about at once, then ever more rarely", "[peis][RTE-08]") {
  stranger_table x(5s);
  x.note(right_peer, false, start);
  x.note(left_peer, true, start);
  x.note(left_peer, false, start + 1s); // known already
  auto now = start;
  for (const auto wait : {1s, 2s, 4s, 5s, 5s}) {
    REQUIRE(x.next() == std::pair(now, left_peer));
    CHECK(x.ask(left_peer, now).misled);
    x.forget(right_peer);
    now += wait;
  }
  REQUIRE(x.next() == std::pair(now, left_peer));
  CHECK(x.ask(left_peer, now).before == 5);
  x.forget(left_peer);
  CHECK(!x.contains(left_peer));
  CHECK(!x.next());
}

TEST_CASE("a stranger about whom somebody is wrong is asked about anew, once", "[peis][RTE-08]") {
  stranger_table x(10s);
  x.note(left_peer, false, start);
  CHECK(!x.ask(left_peer, start).misled);
  x.mislead(left_peer, start + 100ms);
  CHECK(x.next() == std::pair(start + 100ms, left_peer));
  const auto asked = x.ask(left_peer, start + 100ms);
  CHECK(asked.misled);
  CHECK(asked.before == 1);
  x.mislead(left_peer, start + 200ms);
  CHECK(x.next() == std::pair(start + 2100ms, left_peer));
  x.mislead(right_peer, start); // no stranger
  CHECK(!x.contains(right_peer));
}

TEST_CASE("a way is probed until there is a sign of life, or the time is over", "[peis][RTE-08]") {
  route_probes x(2, 1500ms);
  x.begin(left_peer, start);
  x.begin(left_peer, start + 100ms);
  x.begin(right_peer, start);
  x.begin(peer_id{13}, start); // one too many
  const auto probed = x.on_time(start);
  REQUIRE(probed.size() == 2);
  CHECK(std::get<probe_host>(probed[0]).host == left_peer);
  CHECK(std::get<probe_host>(probed[1]).host == right_peer);
  CHECK(x.deadline() == start + 200ms);
  CHECK(x.on_time(start + 199ms).empty());
  x.end(right_peer);
  for (std::size_t attempt = 1; attempt <= 7; ++attempt) { // 1400 ms
    const auto again = x.on_time(start + static_cast<duration::rep>(attempt) * 200ms);
    REQUIRE(again.size() == 1);
    CHECK(std::get<probe_host>(again[0]).attempt == attempt);
  }
  CHECK(x.deadline() == start + 1500ms);
  const auto end = x.on_time(start + 1500ms);
  REQUIRE(end.size() == 1);
  CHECK(std::get<way_disproved>(end[0]).host == left_peer);
  CHECK(std::get<way_disproved>(end[0]).since == start);
  CHECK(!x.deadline());
}

TEST_CASE("a way that has come while its host is probed is given the whole time",
          "[peis][RTE-07]") {
  route_probes x(2, 1500ms);
  x.extend(left_peer, start);
  CHECK(x.on_time(start).size() == 1);
  x.begin(right_peer, start + 1s);
  x.extend(left_peer, start + 1s);
  CHECK(x.on_time(start + 1500ms).size() == 2);
  std::vector<way_disproved> silent;
  for (auto now = start + 1500ms; now <= start + 2500ms; now += 100ms) {
    for (const auto& each : x.on_time(now)) {
      if (const auto* found = std::get_if<way_disproved>(&each))
        silent.push_back(*found);
    }
    CHECK(silent.empty() == (now < start + 2500ms));
  }
  REQUIRE(silent.size() == 2);
  CHECK(silent[0].since == start); // silent since it was first asked
  CHECK(silent[1].since == start + 1s);
}

} // namespace rubicon::peis
