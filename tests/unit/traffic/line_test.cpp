// Programs of motes in a line over a MAC that does what it likes, tells the truth about it, and
// keeps counters of its own.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/numbers/random.hpp"
#include "support/catch.hpp"
#include "support/mote_ids.hpp"
#include "traffic/packet.hpp"
#include "traffic/program.hpp"

using namespace rubicon;
using namespace rubicon::traffic;
using test::id;

namespace {

using flow_key = std::pair<mote_id, mote_id>;

struct mac_habits {
  double refused = 0.05;   ///< on the spot
  double arrives = 0.85;   ///< of the rest
  double ack_lost = 0.2;   ///< of those that arrive
  unsigned copies_max = 3; ///< of those that arrive
  duration slowest = 20ms;
};

sender_config sender(arrivals pattern, int to, std::optional<int> via, duration every) {
  sender_config x;
  x.to = id(to);
  if (via)
    x.via = id(*via);
  x.pattern = pattern;
  x.every = every;
  x.stop = 60s;
  return x;
}

class line {
public:
  line(std::uint64_t seed, const mac_habits& habits) : habits_(habits), rng_(seed) {}

  void add(int mote, program_config config) {
    configs_[id(mote)] = std::move(config);
    boot(id(mote));
  }

  /// Power off. Of the requests that are open, those whose packet has arrived or is on the air are
  /// answered late; the others never are, and never arrive.
  void crash(int mote) {
    const auto x = id(mote);
    motes_.at(x).stop(now_);
    off_.insert(x);
    for (auto& [key, open] : open_) {
      if (key.first == x && !open.on_air)
        open.dropped = true;
    }
  }

  void reboot(int mote) {
    off_.erase(id(mote));
    retire(id(mote));
    boot(id(mote));
  }

  void run_until(duration end) {
    for (;;) {
      auto next = events_.empty() ? instant::max() : events_.begin()->first;
      std::optional<mote_id> waking;
      for (auto& [mote, x] : motes_) {
        if (const auto due = x.deadline(); due && *due < next) {
          next = *due;
          waking = mote;
        }
      }
      if (next > instant(end))
        break;
      now_ = next;
      if (waking) {
        perform(*waking, motes_.at(*waking).on_time(now_));
      } else {
        const auto todo = std::move(events_.begin()->second);
        events_.erase(events_.begin());
        todo();
      }
    }
    now_ = instant(end);
  }

  /// What all motes in all their lives say about each flow.
  [[nodiscard]] std::map<flow_key, part> flows() const {
    auto sum = retired_;
    for (const auto& [mote, x] : motes_)
      add_up(sum, x.parts(now_));
    return sum;
  }

  [[nodiscard]] std::size_t open() const {
    std::size_t sum = 0;
    for (const auto& [mote, x] : motes_)
      sum += x.open();
    return sum;
  }

  /// Different packets that the MAC has handed to their target, and requests it was asked for.
  [[nodiscard]] std::uint64_t handed_over(flow_key x) const {
    const auto found = handed_over_.find(x);
    return found == handed_over_.end() ? 0 : found->second.size();
  }
  [[nodiscard]] std::uint64_t repeats() const { return repeats_; }

private:
  struct request {
    bool on_air = false;
    bool dropped = false;
  };

  void boot(mote_id mote) {
    motes_.insert_or_assign(
        mote, program(configs_.at(mote), {island_id{1}, mote}, random_stream(rng_.next())));
    perform(mote, motes_.at(mote).start(now_));
  }

  void retire(mote_id mote) { add_up(retired_, motes_.at(mote).parts(now_)); }

  static void add_up(std::map<flow_key, part>& sum, const std::vector<part>& parts) {
    for (const auto& x : parts)
      sum[{x.from.mote, x.to.mote}] += x;
  }

  void perform(mote_id mote, outputs todo) {
    for (auto& x : todo)
      attempt(mote, std::move(x));
  }

  void attempt(mote_id mote, transmit x) {
    const auto token = x.token;
    if (rng_.chance(habits_.refused)) {
      perform(mote, motes_.at(mote).on_done(token, {false, false, "queue_full", 0}, now_));
      return;
    }
    const auto key = std::pair(mote, token);
    open_[key] = {};
    after(rng_.between(1us, habits_.slowest), [this, key, x = std::move(x)] {
      if (!open_.at(key).dropped)
        put_on_air(key, x);
    });
  }

  void put_on_air(std::pair<mote_id, std::uint64_t> key, const transmit& x) {
    open_.at(key).on_air = true;
    const auto arrives = !off_.contains(x.next_hop) && rng_.chance(habits_.arrives);
    const auto copies = arrives ? 1 + rng_.below(habits_.copies_max) : 0;
    const auto acked = arrives && !rng_.chance(habits_.ack_lost);
    for (std::uint64_t i = 0; i < copies; ++i)
      after(rng_.between(0s, habits_.slowest), [this, key, x] { deliver(key.first, x); });
    after(rng_.between(0s, habits_.slowest), [this, key, arrives, copies, acked] {
      const outcome end{acked, arrives, acked ? "" : "no_ack", static_cast<unsigned>(copies) + 1};
      perform(key.first, motes_.at(key.first).on_done(key.second, end, now_));
    });
  }

  void deliver(mote_id source, const transmit& x) {
    const auto packet = decode_packet(x.payload);
    REQUIRE(packet);
    auto& target = motes_.at(x.next_hop);
    if (packet->target == x.next_hop &&
        !handed_over_[{packet->origin, packet->target}].insert(packet->number).second)
      ++repeats_;
    perform(x.next_hop, target.on_packet(source, x.payload, now_));
  }

  void after(duration x, std::function<void()> todo) {
    events_.emplace(now_ + x, std::move(todo)); // equal times keep their order
  }

  mac_habits habits_;
  random_stream rng_;
  instant now_;
  std::map<mote_id, program_config> configs_;
  std::map<mote_id, program> motes_;
  std::set<mote_id> off_;
  std::map<std::pair<mote_id, std::uint64_t>, request> open_;
  std::multimap<instant, std::function<void()>> events_;
  std::map<flow_key, part> retired_;
  std::map<flow_key, std::set<std::uint64_t>> handed_over_;
  std::uint64_t repeats_ = 0;
};

std::uint64_t lost(const part& x) {
  std::uint64_t sum = 0;
  for (const auto& [cause, count] : x.lost)
    sum += count;
  return sum;
}

/// Motes 1 to 5; everybody passes on to the next, 5 receives. 1, 3 and 5 send.
void populate(line& x) {
  x.add(5, {{sender(arrivals::poisson, 4, {}, 50ms)}, {}, true});
  x.add(4, {{}, relay_config{id(5)}, true});
  x.add(3, {{sender(arrivals::periodic, 5, 4, 40ms)}, relay_config{id(4)}, false});
  x.add(2, {{}, relay_config{id(3)}, false});
  x.add(
      1,
      {{sender(arrivals::poisson, 5, 2, 30ms), sender(arrivals::saturated, 4, 2, 1s)}, {}, false});
}

} // namespace

TEST_CASE("every packet that was sent is delivered, lost or in flight", "[traffic]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    INFO("seed " << seed);
    line x(seed, {});
    populate(x);
    for (auto now = 0s; now < 60s; now += 7s) {
      x.run_until(now);
      for (const auto& [key, flow] : x.flows())
        CHECK(flow.sent >= flow.delivered + lost(flow));
    }
    x.run_until(62s); // all is over
    CHECK(x.open() == 0);
    CHECK(x.repeats() > 100);
    const auto flows = x.flows();
    REQUIRE(flows.size() == 4);
    for (const auto& [key, flow] : flows) {
      INFO(to_string(key.first) << " to " << to_string(key.second));
      CHECK(flow.sent > 1000);
      CHECK(flow.delivered > 0);
      CHECK(flow.sent == flow.delivered + lost(flow));
      CHECK(flow.delivered == x.handed_over(key));
      CHECK(flow.delay.count() == flow.delivered);
      CHECK(flow.octets == 20 * flow.delivered);
      CHECK(flow.active > 59s);
      CHECK(flow.active <= 60s);
    }
  }
}

TEST_CASE("the share delivered over several hops is the product of theirs", "[traffic]") {
  const mac_habits habits{0.1, 0.9, 0.5, 3, 5ms};
  line x(11, habits);
  populate(x);
  x.run_until(62s);
  const auto flows = x.flows();
  const std::map<flow_key, int> hops{
      {{id(1), id(4)}, 3}, {{id(1), id(5)}, 4}, {{id(3), id(5)}, 2}, {{id(5), id(4)}, 1}};
  for (const auto& [key, count] : hops) {
    const auto& flow = flows.at(key);
    const auto expected = std::pow((1 - habits.refused) * habits.arrives, count);
    const auto sent = static_cast<double>(flow.sent);
    const auto deviation = std::sqrt(expected * (1 - expected) / sent);
    CHECK(static_cast<double>(flow.delivered) / sent == Approx(expected).margin(4 * deviation));
  }
}

TEST_CASE("over a perfect MAC everything arrives", "[traffic]") {
  line x(12, {0, 1, 0, 1, 2ms});
  populate(x);
  x.run_until(62s);
  for (const auto& [key, flow] : x.flows()) {
    CHECK(flow.delivered == flow.sent);
    CHECK(flow.lost.empty());
  }
}

TEST_CASE("the counters balance over power failures of every mote", "[traffic]") {
  for (std::uint64_t seed = 21; seed <= 30; ++seed) {
    INFO("seed " << seed);
    random_stream rng(seed);
    line x(seed, {});
    populate(x);
    auto now = 0ns;
    for (int i = 0; i < 10; ++i) {
      const auto mote = 1 + static_cast<int>(rng.below(5));
      now += rng.between(1s, 4s);
      x.run_until(now);
      x.crash(mote);
      now += rng.between(100ms, 1s); // longer than a copy is on its way
      x.run_until(now);
      x.reboot(mote);
    }
    x.run_until(65s);
    CHECK(x.open() == 0);
    std::uint64_t aborted = 0;
    for (const auto& [key, flow] : x.flows()) {
      INFO(to_string(key.first) << " to " << to_string(key.second));
      CHECK(flow.sent == flow.delivered + lost(flow));
      if (const auto found = flow.lost.find("aborted"); found != flow.lost.end())
        aborted += found->second;
    }
    CHECK(aborted > 0);
  }
}

TEST_CASE("the same seed gives the same counts", "[traffic]") {
  const auto run = [](std::uint64_t seed) {
    line x(seed, {});
    populate(x);
    x.run_until(20s);
    std::vector<std::pair<std::uint64_t, std::uint64_t>> counts;
    for (const auto& [key, flow] : x.flows())
      counts.emplace_back(flow.sent, flow.delivered);
    return counts;
  };
  CHECK(run(31) == run(31));
  CHECK(run(31) != run(32));
}
