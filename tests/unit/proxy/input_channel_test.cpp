#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/numbers/random.hpp"
#include "proxy/classes/input_channel.hpp"
#include "support/catch.hpp"
#include "support/start.hpp"

using namespace rubicon;
using namespace rubicon::proxy;
using test::start;

namespace {

request ask(std::string word, std::size_t input = 0) {
  bytes octets(word.begin(), word.end());
  return {input, std::move(word), std::move(octets), {}};
}

/// `>on` for a write, `on acknowledged` for an outcome.
std::vector<std::string> lines_of(const input_channel::outputs& outputs) {
  std::vector<std::string> list;
  for (const auto& x : outputs) {
    if (const auto* const work = std::get_if<submit>(&x))
      list.push_back('>' + std::string(work->octets.begin(), work->octets.end()));
    if (const auto* const end = std::get_if<finished>(&x))
      list.push_back(std::string(end->word).append(1, ' ').append(to_string(end->outcome)));
  }
  return list;
}

using lines = std::vector<std::string>;

lines status(input_channel& channel, std::uint64_t sequence, input_outcome outcome,
             instant now = start) {
  return lines_of(channel.on_status({sequence, outcome}, now));
}

constexpr auto pending = input_outcome::pending;
constexpr auto acked = input_outcome::acknowledged;
constexpr auto failed = input_outcome::failed;
constexpr auto unreachable = input_outcome::unreachable;

} // namespace

TEST_CASE("a request is written and ends with the gateway's word",
          "[proxy][PXY-12][GW-12][IF-07]") {
  for (const auto& [word, text] :
       std::vector<std::pair<input_outcome, std::string>>{{acked, "on acknowledged"},
                                                          {failed, "on failed"},
                                                          {unreachable, "on unreachable"},
                                                          {input_outcome::sent, "on sent"}}) {
    input_channel channel;
    CHECK_FALSE(channel.deadline());
    CHECK(lines_of(channel.add(ask("on"), start)) == lines{">on"});
    CHECK(channel.open() == 1);
    CHECK(status(channel, 1, pending).empty());
    CHECK(status(channel, 1, word) == lines{text});
    CHECK(channel.open() == 0);
    CHECK_FALSE(channel.deadline());
    CHECK(status(channel, 1, word).empty()); // reported once
  }
}

TEST_CASE("one request waits, and a newer one takes its place", "[proxy][PXY-12]") {
  input_channel channel;
  CHECK(lines_of(channel.add(ask("on"), start)) == lines{">on"});
  CHECK(lines_of(channel.add(ask("off"), start)).empty());
  CHECK(channel.open() == 2);
  CHECK(lines_of(channel.add(ask("dim"), start)) == lines{"off superseded"});
  CHECK(channel.open() == 2);
  CHECK(status(channel, 1, pending).empty());
  CHECK(status(channel, 1, failed) == lines{"on failed", ">dim"});
  CHECK(status(channel, 2, pending).empty());
  CHECK(status(channel, 2, acked) == lines{"dim acknowledged"});
}

TEST_CASE("inputs that share a channel wait in order and do not supersede each other",
          "[proxy][PXY-12]") {
  input_channel channel;
  CHECK(lines_of(channel.add(ask("a", 0), start)) == lines{">a"});
  CHECK(lines_of(channel.add(ask("b", 1), start)).empty());
  CHECK(lines_of(channel.add(ask("c", 2), start)).empty());
  CHECK(lines_of(channel.add(ask("d", 1), start)) == lines{"b superseded"});
  CHECK(channel.open() == 3);
  status(channel, 1, pending);
  CHECK(status(channel, 1, acked) == lines{"a acknowledged", ">c"});
  status(channel, 2, pending);
  CHECK(status(channel, 2, acked) == lines{"c acknowledged", ">d"});
}

TEST_CASE("a gateway that never answers is given up at the deadline", "[proxy][PXY-12][IF-07]") {
  input_channel channel(5s);
  static_cast<void>(channel.add(ask("on"), start + 1s));
  static_cast<void>(channel.add(ask("off"), start + 3s));
  CHECK(channel.deadline() == start + 6s);
  CHECK(channel.on_time(start + 6s - 1ns).empty());
  CHECK(lines_of(channel.on_time(start + 6s)) == lines{"on timeout", ">off"});
  CHECK(channel.deadline() == start + 11s);
  status(channel, 2, pending, start + 7s);
  CHECK(channel.deadline() == start + 11s); // pending is no outcome
  CHECK(lines_of(channel.on_time(start + 20s)) == lines{"off timeout"});
  CHECK(channel.on_time(start + 30s).empty());
  CHECK(status(channel, 2, acked, start + 31s).empty()); // too late
}

TEST_CASE("a request's time counts from when it was asked for", "[proxy][IF-07]") {
  input_channel channel(5s);
  static_cast<void>(channel.add(ask("a", 0), start));
  static_cast<void>(channel.add(ask("b", 1), start + 1s));
  CHECK(lines_of(channel.on_time(start + 5s)) == lines{"a timeout", ">b"});
  static_cast<void>(channel.on_status({1, pending}, start + 6s));
  const auto out = channel.on_status({1, acked}, start + 8s);
  REQUIRE(out.size() == 1);
  CHECK(std::get<finished>(out[0]).after == 7s);
}

TEST_CASE("an older write's outcome is not taken for the request's", "[proxy][PXY-12]") {
  input_channel channel;
  SECTION("a status from before the proxy started") {
    static_cast<void>(channel.add(ask("on"), start));
    CHECK(status(channel, 4, acked).empty());
    CHECK(status(channel, 5, pending).empty());
    CHECK(status(channel, 5, failed) == lines{"on failed"});
  }
  SECTION("the same status delivered again") {
    CHECK(status(channel, 4, acked).empty());
    static_cast<void>(channel.add(ask("on"), start));
    CHECK(status(channel, 4, acked).empty());
    CHECK(status(channel, 5, acked) == lines{"on acknowledged"}); // its `pending` was missed
  }
  SECTION("a late answer to a request that was given up") {
    static_cast<void>(channel.add(ask("on"), start));
    status(channel, 1, pending);
    CHECK(lines_of(channel.on_time(start + 20s)) == lines{"on timeout"});
    static_cast<void>(channel.add(ask("off"), start + 20s));
    CHECK(status(channel, 1, acked).empty());
    status(channel, 2, pending);
    CHECK(status(channel, 1, failed).empty());
    CHECK(status(channel, 2, acked) == lines{"off acknowledged"});
  }
  SECTION("a later write of somebody else") {
    static_cast<void>(channel.add(ask("on"), start));
    status(channel, 1, pending);
    CHECK(status(channel, 2, pending).empty());
    CHECK(status(channel, 2, failed).empty());
    CHECK(status(channel, 1, acked) == lines{"on acknowledged"});
  }
}

TEST_CASE("a gateway that counts anew is followed", "[proxy][PXY-12][PXY-15]") {
  const std::uint64_t last = GENERATE(1U, 2U, 9U);
  input_channel channel;
  static_cast<void>(channel.on_status({last, acked}, start));
  static_cast<void>(channel.add(ask("on"), start));
  CHECK(status(channel, 1, pending).empty());
  CHECK(status(channel, 1, acked) == lines{"on acknowledged"});
  static_cast<void>(channel.add(ask("off"), start));
  status(channel, 2, pending);
  CHECK(status(channel, 2, acked) == lines{"off acknowledged"});
}

TEST_CASE("what waits ends when the mote is lost, what was written waits for its outcome",
          "[proxy][PXY-12][PXY-16]") {
  input_channel channel;
  CHECK(channel.drop_waiting(start).empty());
  static_cast<void>(channel.add(ask("on"), start));
  static_cast<void>(channel.add(ask("off"), start));
  CHECK(lines_of(channel.drop_waiting(start)) == lines{"off unreachable"});
  status(channel, 1, pending);
  CHECK(status(channel, 1, unreachable) == lines{"on unreachable"});
}

TEST_CASE("with answers lost and repeated, outcomes are single and true",
          "[proxy][PXY-12][IF-07]") {
  const auto seed = GENERATE(range(1, 21));
  random_stream rng(static_cast<std::uint64_t>(seed));
  input_channel channel(5s);
  std::map<std::string, int> outcomes;           // word -> times reported
  std::map<std::string, input_outcome> verdicts; // word -> what the gateway decided
  std::deque<std::pair<instant, input_status>> pipe;
  std::uint64_t writes = 0;
  int requests = 0;
  int untrue = 0;
  int answered = 0;
  const auto carry_out = [&](const input_channel::outputs& outputs, instant now) {
    for (const auto& x : outputs) {
      if (const auto* const work = std::get_if<submit>(&x)) {
        if (rng.chance(0.1))
          continue; // the write never reaches the gateway
        const auto verdict = rng.chance(0.7) ? acked : failed;
        verdicts.emplace(std::string(work->octets.begin(), work->octets.end()), verdict);
        ++writes;
        pipe.emplace_back(now + 50ms, input_status{writes, pending});
        pipe.emplace_back(now + 1s, input_status{writes, verdict});
      }
      if (const auto* const end = std::get_if<finished>(&x)) {
        ++outcomes[end->word];
        if (end->outcome == request_outcome::acknowledged ||
            end->outcome == request_outcome::failed) {
          ++answered;
          const auto verdict = verdicts.find(end->word);
          if (verdict == verdicts.end() || to_string(verdict->second) != to_string(end->outcome))
            ++untrue;
        }
      }
    }
  };
  for (instant now = start; now < start + 2000s; now += 50ms) {
    if (now < start + 1900s && rng.chance(0.03))
      carry_out(channel.add(ask(std::to_string(requests++)), now), now);
    while (!pipe.empty() && pipe.front().first <= now) {
      const auto arriving = pipe.front().second;
      pipe.pop_front();
      if (rng.chance(0.2))
        continue;
      carry_out(channel.on_status(arriving, now), now);
      if (rng.chance(0.2))
        carry_out(channel.on_status(arriving, now), now);
    }
    carry_out(channel.on_time(now), now);
    REQUIRE(channel.open() <= 2);
  }
  CHECK(untrue == 0);
  CHECK(answered > requests / 4);
  CHECK(channel.open() == 0);
  CHECK(outcomes.size() == static_cast<std::size_t>(requests));
  for (const auto& [word, times] : outcomes)
    CHECK(times == 1);
}

TEST_CASE("what has failed is written again, for so long", "[proxy][PXY-12]") {
  input_channel channel(20s, 30s);
  CHECK(lines_of(channel.add(ask("on"), start)) == lines{">on"});
  CHECK(status(channel, 1, pending).empty());
  CHECK(status(channel, 1, failed, start + 10s).empty());
  CHECK(channel.open() == 1);
  CHECK(channel.deadline() == start + 11s);
  CHECK(channel.on_time(start + 11s - 1ns).empty());
  CHECK(lines_of(channel.on_time(start + 11s)) == lines{">on"});
  CHECK(status(channel, 1, failed, start + 11s).empty()); // of the first write
  CHECK(status(channel, 2, pending, start + 11s).empty());
  CHECK(status(channel, 2, unreachable, start + 12s).empty());
  CHECK(lines_of(channel.on_time(start + 13s)) == lines{">on"});
  CHECK(channel.on_time(start + 32s).empty());
  // 30 s after the first write is no time left for another.
  CHECK(lines_of(channel.on_time(start + 33s)) == lines{"on timeout"});
  CHECK(channel.open() == 0);
}

TEST_CASE("a write that succeeds ends its request", "[proxy][PXY-12]") {
  input_channel channel(20s, 30s);
  static_cast<void>(channel.add(ask("on"), start));
  static_cast<void>(channel.on_status({1, pending}, start));
  static_cast<void>(channel.on_status({1, failed}, start));
  SECTION("the second") {
    CHECK(lines_of(channel.on_time(start + 1s)) == lines{">on"});
    CHECK(status(channel, 2, pending).empty());
    CHECK(status(channel, 2, acked, start + 2s) == lines{"on acknowledged"});
  }
  SECTION("the first, after it was given up") {
    CHECK(status(channel, 1, acked) == lines{"on acknowledged"});
  }
  CHECK_FALSE(channel.deadline());
}

TEST_CASE("a write that was given up and then fails does not end its request", "[proxy][PXY-12]") {
  input_channel channel(20s, 30s);
  static_cast<void>(channel.add(ask("on"), start));
  static_cast<void>(channel.on_status({1, pending}, start));
  CHECK(channel.on_time(start + 20s).empty());
  CHECK(status(channel, 1, failed, start + 20s).empty());
  CHECK(status(channel, 1, pending, start + 20s).empty());
  CHECK(channel.open() == 1);
  CHECK(lines_of(channel.on_time(start + 21s)) == lines{">on"});
}

TEST_CASE("a request that waits to be written again yields", "[proxy][PXY-12]") {
  input_channel channel(20s, 30s);
  static_cast<void>(channel.add(ask("on"), start));
  static_cast<void>(channel.on_status({1, pending}, start));
  static_cast<void>(channel.on_status({1, failed}, start));
  SECTION("to a newer one of its input") {
    CHECK(lines_of(channel.add(ask("off"), start)) == lines{"on superseded", ">off"});
  }
  SECTION("not to one of another input") {
    CHECK(lines_of(channel.add(ask("red", 1), start)).empty());
    CHECK(lines_of(channel.on_time(start + 1s)) == lines{">on"});
    CHECK(channel.open() == 2);
  }
  SECTION("when the mote has left") {
    CHECK(lines_of(channel.drop_waiting(start)) == lines{"on unreachable"});
    CHECK(channel.open() == 0);
  }
}
