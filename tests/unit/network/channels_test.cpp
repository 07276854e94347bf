#include <algorithm>
#include <map>
#include <queue>
#include <set>
#include <vector>

#include "network/channels/channels.hpp"
#include "support/agenda.hpp"
#include "support/catch.hpp"

namespace rubicon::network {

namespace {

/// A grid of motes that hear the four next to them, with the coordinates that VCap would give them.
class grid {
public:
  grid(int width, int height, double delivery, std::uint64_t seed = 1, std::set<int> holes = {},
       channels_config config = {})
      : width_(width), delivery_(delivery), rng_(seed), config_(config) {
    for (int i = 0; i < width * height; ++i) {
      if (!holes.contains(i))
        start(id(i));
    }
    const auto x = hops_from(motes_.begin()->first);
    const auto y = hops_from(motes_.rbegin()->first);
    const auto z = hops_from(id(width - 1));
    for (const auto& [mote, unused] : motes_)
      places_[mote] = {hop(x, mote), hop(y, mote), hop(z, mote)};
  }

  [[nodiscard]] static mote_id id(int i) { return mote_id{static_cast<std::uint16_t>(i + 1)}; }
  channels& at(mote_id x) { return motes_.at(x); }
  [[nodiscard]] instant now() const { return now_; }
  [[nodiscard]] virtual_coordinates place(mote_id x) const { return places_.at(x); }

  [[nodiscard]] std::vector<mote_id> motes() const {
    std::vector<mote_id> all;
    for (const auto& [mote, unused] : motes_)
      all.push_back(mote);
    return all;
  }

  void start(mote_id x) {
    auto config = config_;
    config.self = x;
    motes_[x] = channels(config, random_stream(rng_.next()));
  }

  void kill(mote_id x) { motes_.erase(x); }

  /// Opens a channel and waits. @returns its id; whether it opened tells `connected`
  channel_id connect(mote_id from, mote_id to, duration expiry = 0s, channel_schedule when = {}) {
    const auto id = motes_.at(from).next_id();
    perform(from,
            motes_.at(from).connect(id, to, places_.at(to), when, expiry, around(from), now_));
    run_for(12s);
    return id;
  }

  void perform(mote_id from, channels_outputs todo) {
    for (auto& x : todo) {
      if (auto* frame = std::get_if<channel_hop>(&x))
        put_on_air(from, std::move(*frame));
      else if (const auto* open = std::get_if<channel_connected>(&x))
        connected.insert(open->channel);
      else if (const auto* opened = std::get_if<channel_accepted>(&x))
        accepted[opened->channel] = from;
      else if (auto* packet = std::get_if<channel_received>(&x))
        received[packet->channel].push_back(std::move(packet->content));
      else if (const auto* over = std::get_if<channel_ended>(&x))
        ended[{over->channel, from}] = over->why;
      else if (const auto* need = std::get_if<channel_reserved>(&x))
        reserved[{need->channel, from}] = need->schedule;
    }
  }

  void run_for(duration length) {
    const auto end = now_ + length;
    const auto next = [&] {
      auto due = end;
      for (const auto& [id, x] : motes_)
        due = std::min(due, x.deadline().value_or(end));
      return due;
    };
    agenda_.run(now_, end, next, [this] {
      for (auto& [id, x] : motes_) {
        perform(id, x.on_time(now_));
        if (x.is_looking())
          perform(id, x.look(std::nullopt, around(id), now_));
      }
    });
  }

  /// Motes whose table has the channel, ascending.
  [[nodiscard]] std::vector<mote_id> path(channel_id x) const {
    std::vector<mote_id> all;
    for (const auto& [mote, y] : motes_) {
      const auto table = y.table();
      if (std::ranges::find(table, x) != table.end())
        all.push_back(mote);
    }
    return all;
  }

  [[nodiscard]] std::size_t entries() const {
    std::size_t all = 0;
    for (const auto& [mote, x] : motes_)
      all += x.table().size();
    return all;
  }

  [[nodiscard]] std::uint64_t sum(std::uint64_t channels_counters::*which) const {
    std::uint64_t all = 0;
    for (const auto& [mote, x] : motes_)
      all += x.counters().*which;
    return all;
  }

  [[nodiscard]] std::map<mote_id, int> hops_from(mote_id from) const {
    std::map<mote_id, int> hops{{from, 0}};
    std::queue<mote_id> next({from});
    for (; !next.empty(); next.pop()) {
      for (const auto x : next_to(next.front())) {
        if (hops.emplace(x, hops.at(next.front()) + 1).second)
          next.push(x);
      }
    }
    return hops;
  }

  std::set<channel_id> connected;
  std::map<channel_id, mote_id> accepted;
  std::map<channel_id, std::vector<bytes>> received;
  std::map<std::pair<channel_id, mote_id>, channel_end> ended;
  std::map<std::pair<channel_id, mote_id>, channel_schedule> reserved;

private:
  [[nodiscard]] static hop_distance hop(const std::map<mote_id, int>& hops, mote_id x) {
    const auto found = hops.find(x);
    return found == hops.end() ? hops_unknown : static_cast<hop_distance>(found->second);
  }

  [[nodiscard]] std::vector<mote_id> next_to(mote_id x) const {
    const auto i = x.value - 1;
    std::vector<mote_id> all;
    for (const auto j : {i - 1, i + 1, i - width_, i + width_}) {
      const bool same_row = j / width_ == i / width_ || j % width_ == i % width_;
      if (j >= 0 && same_row && motes_.contains(id(j)))
        all.push_back(id(j));
    }
    return all;
  }

  [[nodiscard]] surroundings around(mote_id x) const {
    surroundings all;
    all.own_place = places_.at(x);
    for (const auto y : next_to(x))
      all.motes.push_back({y, places_.at(y)});
    return all;
  }

  void put_on_air(mote_id from, channel_hop frame) {
    std::vector<mote_id> heard;
    bool acked = false;
    const auto near = next_to(from);
    if (frame.next == broadcast_mote) {
      for (const auto x : near) {
        if (rng_.chance(delivery_))
          heard.push_back(x);
      }
    }
    const bool reachable = std::ranges::find(near, frame.next) != near.end();
    for (int attempt = 0; attempt < 4 && reachable && !acked; ++attempt) {
      if (!rng_.chance(delivery_))
        continue;
      if (heard.empty())
        heard.push_back(frame.next);
      acked = rng_.chance(delivery_);
    }
    const auto when = now_ + 5ms;
    for (const auto to : heard) {
      agenda_.add(when, [this, from, to, frame] {
        if (motes_.contains(to))
          perform(to, motes_.at(to).on_frame(from, frame.octets, around(to), now_));
      });
    }
    agenda_.add(when, [this, from, acked] {
      if (motes_.contains(from))
        perform(from, motes_.at(from).on_sent(acked, around(from), now_));
    });
  }

  int width_;
  double delivery_;
  random_stream rng_;
  channels_config config_;
  instant now_;
  std::map<mote_id, channels> motes_;
  std::map<mote_id, virtual_coordinates> places_;
  test::agenda agenda_;
};

std::vector<mote_id> next_of(const channels_outputs& todo) {
  std::vector<mote_id> next;
  for (const auto& output : todo)
    if (const auto* hop = std::get_if<channel_hop>(&output))
      next.push_back(hop->next);
  return next;
}

/// Of the mote that a connect message has come to, by the radio or to be sent on.
struct relay_fixture {
  static constexpr mote_id source{2};
  static constexpr mote_id destination{9};
  static constexpr mote_id a{5};
  static constexpr channel_id id{source, 3};

  relay_fixture() {
    channels_config config;
    config.self = mote_id{1};
    x = channels(config, random_stream(1));
    around.own_place = virtual_coordinates{3, 3, 3};
    around.motes = {{source, virtual_coordinates{4, 4, 4}}, {a, virtual_coordinates{2, 2, 2}}};
  }

  std::vector<mote_id> connect(instant now) {
    connect_message wish;
    wish.destination = destination;
    wish.place = virtual_coordinates{0, 0, 0};
    wish.hops = 1;
    return hear(source, {id, wish}, now);
  }

  std::vector<mote_id> hear(mote_id from, const channel_message& message, instant now) {
    return next_of(x.on_frame(from, encode(message), around, now));
  }

  /// All rounds of what is in flight end without an acknowledgement. @returns what goes next
  std::vector<mote_id> lose(instant now) {
    for (int i = 0; i < 5; ++i) {
      static_cast<void>(x.on_sent(false, around, now));
      static_cast<void>(x.on_time(now + 60ms));
    }
    return next_of(x.on_sent(false, around, now));
  }

  channels x;
  surroundings around;
};

/// A wall with a gap at one end: greedy forwarding runs against it.
const std::set<int> wall{42, 43, 44, 45, 46, 47, 48, 52, 62, 72, 58};

} // namespace

TEST_CASE("a channel reserves at the motes of its path and nowhere else",
          "[network][NET-02][NET-03]") {
  grid x(5, 5, 1);
  const auto id = x.connect(grid::id(0), grid::id(14));
  CHECK(x.connected.contains(id));
  CHECK(x.accepted.at(id) == grid::id(14));
  const auto path = x.path(id);
  CHECK(path.size() == 7); // 6 hops, greedily straight
  CHECK(path.front() == grid::id(0));
  CHECK(path.back() == grid::id(14));
  CHECK(x.entries() == 7);
  CHECK(x.sum(&channels_counters::floods) == 0);
}

TEST_CASE("packets go over a channel, in either direction", "[network][NET-05][NET-06]") {
  grid x(5, 5, 1);
  const auto id = x.connect(grid::id(0), grid::id(24));
  for (std::uint8_t i = 0; i < 50; ++i) {
    auto out = x.at(grid::id(0)).send(id, {i}, departure::in_turn, x.now());
    REQUIRE(out.has_value());
    x.perform(grid::id(0), *std::move(out));
    x.run_for(20ms);
  }
  x.run_for(1s);
  CHECK(x.received.at(id).size() == 50);
  CHECK(x.received.at(id).back() == bytes{49});
  x.received.clear();
  x.perform(grid::id(24), *x.at(grid::id(24)).send(id, {77}, departure::in_turn, x.now()));
  x.run_for(1s);
  CHECK(x.received.at(id) == std::vector<bytes>{{77}});
  CHECK_FALSE(x.at(grid::id(1)).send(id, {1}, departure::in_turn, x.now()).has_value());
}

TEST_CASE("where slots are in use, only vectors in them and what passes do not wait",
          "[network][SYN-16]") {
  grid x(3, 1, 1);
  const auto id = x.connect(grid::id(0), grid::id(2));
  auto& source = x.at(grid::id(0));
  auto& relay = x.at(grid::id(1));
  const auto now = x.now();
  source.hold(now + 1s);
  relay.hold(now + 1s);
  const auto hops = [](const std::optional<channels_outputs>& todo) {
    REQUIRE(todo.has_value());
    std::vector<channel_hop> all;
    for (const auto& each : *todo)
      all.push_back(std::get<channel_hop>(each));
    return all;
  };
  const auto vector = hops(source.send(id, {2}, departure::in_slot, now));
  REQUIRE(vector.size() == 1);
  CHECK(vector[0].in_slot);
  const auto passed = hops(relay.on_frame(grid::id(0), vector[0].octets, {}, now));
  REQUIRE(passed.size() == 1);
  CHECK(passed[0].next == grid::id(2));
  CHECK_FALSE(passed[0].in_slot);
  CHECK(hops(relay.on_sent(false, {}, now)).empty()); // its second round waits
  CHECK(relay.deadline() == now + 1s);

  CHECK(hops(source.on_sent(false, {}, now)).empty());
  CHECK(source.deadline() == now + 1s);
  source.hold(instant{});
  auto later = now + 1s;
  for (int round = 2; round <= 3; ++round, later += 1s) { // the first, in the slot, is not counted
    const auto again = hops(source.on_time(later));
    REQUIRE(again.size() == 1);
    CHECK(again[0].octets == vector[0].octets);
    CHECK_FALSE(again[0].in_slot);
    CHECK(source.counters().packets_lost == 0);
    CHECK(hops(source.on_sent(false, {}, later)).empty());
  }
  CHECK(source.counters().packets_lost == 1);

  source.hold(later + 1s);
  CHECK(hops(source.send(id, {3}, departure::in_turn, later)).empty());
  CHECK(source.deadline() == later + 1s);
  CHECK(hops(source.send(id, {4}, departure::in_slot, later)).size() == 1); // overtakes
}

TEST_CASE("control messages that find no room are counted", "[network]") {
  channels_config config;
  config.self = mote_id{1};
  config.queue_max = 1;
  channels x(config, random_stream(1));
  x.hold(instant{1s});
  for (std::uint16_t i = 0; i < 3; ++i) // each would be answered: no such channel is here
    static_cast<void>(x.on_frame(
        mote_id{2}, encode(channel_message{{mote_id{2}, i}, data_message{1, {1}}}), {}, {}));
  CHECK(x.counters().crowded_out == 1);
}

TEST_CASE("sending says nothing of delivery: on bad links packets are lost and counted",
          "[network][NET-05]") {
  channels_config config;
  config.data_rounds_max = 1;
  config.losses_max = 100;
  grid x(6, 1, 0.5, 1, {}, config);
  const auto id = x.connect(grid::id(0), grid::id(5));
  REQUIRE(x.connected.contains(id));
  int sent = 0;
  for (int i = 0; i < 300; ++i) {
    if (auto out = x.at(grid::id(0)).send(id, {1}, departure::in_turn, x.now())) {
      ++sent;
      x.perform(grid::id(0), *std::move(out));
    }
    x.run_for(200ms);
  }
  CHECK(sent == 300);
  const auto arrived = x.received.at(id).size();
  CHECK(arrived < 300);
  CHECK(arrived > 150);
  CHECK(arrived + x.sum(&channels_counters::packets_lost) >= 300);
}

TEST_CASE("disconnecting frees all of the path, from either end", "[network][NET-07]") {
  grid x(5, 5, 1);
  const auto a = x.connect(grid::id(0), grid::id(24));
  const auto b = x.connect(grid::id(4), grid::id(20));
  x.perform(grid::id(0), x.at(grid::id(0)).disconnect(a, x.now()));
  x.perform(grid::id(20), x.at(grid::id(20)).disconnect(b, x.now()));
  x.run_for(1s);
  CHECK(x.entries() == 0);
  CHECK(x.ended.size() == 2);
  CHECK(x.ended.at({a, grid::id(24)}) == channel_end::disconnected);
  CHECK(x.ended.at({b, grid::id(4)}) == channel_end::disconnected);
}

TEST_CASE("a full table on the path refuses, and nothing stays reserved", "[network][NET-04]") {
  channels_config config;
  config.entries_max = 1;
  grid x(6, 1, 1, 1, {}, config);
  const auto first = x.connect(grid::id(3), grid::id(4));
  const auto second = x.connect(grid::id(0), grid::id(5));
  CHECK(x.connected.contains(first));
  CHECK_FALSE(x.connected.contains(second));
  CHECK(x.ended.at({second, grid::id(0)}) == channel_end::no_room);
  CHECK(x.path(second).empty());
  CHECK(x.entries() == 2);
}

TEST_CASE("a destination may refuse", "[network][NET-04]") {
  grid x(3, 1, 1);
  const auto id = x.connect(grid::id(0), grid::id(2));
  x.perform(grid::id(2), x.at(grid::id(2)).refuse(id, x.now()));
  x.run_for(1s);
  CHECK(x.ended.at({id, grid::id(0)}) == channel_end::no_room);
  CHECK(x.entries() == 0);
}

TEST_CASE("a destination that is not there is reported", "[network][NET-04]") {
  grid x(4, 4, 1);
  x.kill(grid::id(15));
  const auto id = x.connect(grid::id(0), grid::id(15));
  CHECK(x.ended.at({id, grid::id(0)}) == channel_end::unreachable);
  x.run_for(20s);
  CHECK(x.entries() == 0);
}

TEST_CASE("channel ids of all motes are distinct", "[network][NET-01]") {
  grid x(10, 10, 1);
  std::set<channel_id> ids;
  for (int i = 0; i < 100; ++i) {
    for (int k = 0; k < 3; ++k)
      CHECK(ids.insert(x.connect(grid::id(i), grid::id((i + 1) % 100))).second);
    for (const auto id : x.at(grid::id(i)).table())
      x.perform(grid::id(i), x.at(grid::id(i)).disconnect(id, x.now()));
    x.run_for(1s);
  }
  CHECK(ids.size() == 300);
}

TEST_CASE("greedy forwarding takes the neighbour nearest to the destination", "[network][NET-10]") {
  grid x(9, 9, 1);
  random_stream rng(2);
  for (int i = 0; i < 40; ++i) {
    const auto from = grid::id(static_cast<int>(rng.below(81)));
    const auto to = grid::id(static_cast<int>(rng.below(81)));
    if (from == to)
      continue;
    const auto id = x.connect(from, to);
    REQUIRE(x.connected.contains(id));
    CHECK(x.path(id).size() == static_cast<std::size_t>(x.hops_from(from).at(to)) + 1);
    x.perform(from, x.at(from).disconnect(id, x.now()));
    x.run_for(1s);
  }
  CHECK(x.sum(&channels_counters::floods) == 0);
}

TEST_CASE("behind a wall every pair still connects, and fallbacks are counted",
          "[network][NET-12]") {
  grid x(10, 10, 0.95, 3, wall);
  random_stream rng(4);
  const auto motes = x.motes();
  int pairs = 0;
  for (int i = 0; i < 150; ++i) {
    const auto from = motes[rng.below(motes.size())];
    const auto to = motes[rng.below(motes.size())];
    if (from == to || !x.hops_from(from).contains(to))
      continue;
    ++pairs;
    const auto id = x.connect(from, to);
    REQUIRE(x.connected.contains(id));
    x.perform(from, x.at(from).disconnect(id, x.now()));
    x.run_for(15s);
    REQUIRE(x.entries() == 0);
  }
  CHECK(pairs > 100);
  CHECK(x.sum(&channels_counters::backtracks) > 0);
  CHECK(x.sum(&channels_counters::floods) > 0);
  CHECK(x.sum(&channels_counters::floods) < static_cast<std::uint64_t>(pairs) / 2);
}

TEST_CASE("a mote that dies on the path is noticed and the source notified", "[network][NET-09]") {
  grid x(5, 1, 1);
  const auto id = x.connect(grid::id(0), grid::id(4));
  x.kill(grid::id(2));
  for (int i = 0; i < 4; ++i) {
    CHECK(x.ended.empty());
    x.perform(grid::id(0), *x.at(grid::id(0)).send(id, {1}, departure::in_turn, x.now()));
    x.run_for(1s);
  }
  CHECK(x.ended.at({id, grid::id(0)}) == channel_end::broken);
  CHECK(x.sum(&channels_counters::broken) == 1);
}

TEST_CASE("channels that are not used any more expire on all of the path", "[network][NET-08]") {
  grid x(5, 1, 1);
  const auto id = x.connect(grid::id(0), grid::id(4), 30s);
  x.kill(grid::id(0));
  x.run_for(40s);
  CHECK(x.entries() == 0);
  CHECK(x.ended.at({id, grid::id(4)}) == channel_end::expired);
}

TEST_CASE("each mote of the path knows when packets are due, later ones later",
          "[network][NRG-01][NRG-03]") {
  grid x(5, 1, 1);
  const channel_schedule when{island_time(std::chrono::seconds(60)),
                              std::chrono::milliseconds(1000), 20};
  const auto id = x.connect(grid::id(0), grid::id(4), 0s, when);
  for (int i = 0; i < 5; ++i) {
    const auto here = x.reserved.at({id, grid::id(i)});
    CHECK(here.interval == when.interval);
    CHECK(here.size == 20);
    const auto hops_behind = std::max(i - 1, 0); // the first hop is on the source's time
    CHECK(here.first == when.first + hops_behind * channel_slot);
  }
  x.perform(grid::id(0), x.at(grid::id(0)).disconnect(id, x.now()));
  x.run_for(1s);
  CHECK(x.reserved.at({id, grid::id(3)}).interval == std::chrono::milliseconds(0));
}

TEST_CASE("over bad links all connects end, and no table keeps anything", "[network][NET-04]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    grid x(6, 6, 0.6, seed);
    random_stream rng(seed);
    std::vector<std::pair<mote_id, channel_id>> all;
    for (int i = 0; i < 8; ++i) {
      const auto from = grid::id(static_cast<int>(rng.below(36)));
      const auto to = grid::id(static_cast<int>(rng.below(36)));
      if (from != to)
        all.emplace_back(from, x.connect(from, to));
    }
    for (const auto& [from, id] : all) {
      CHECK((x.connected.contains(id) || x.ended.contains({id, from})));
      x.perform(from, x.at(from).disconnect(id, x.now()));
    }
    x.run_for(60s);
    CHECK(x.entries() <= 2); // whose end message was lost on all rounds; they would expire
  }
}

TEST_CASE(
    "who does not answer is left for another: the destination, in a crowd, or a nearer neighbour",
    "[network][NET-10][NET-12]") {
  const bool is_crowd = GENERATE(true, false);
  channels_config config;
  config.self = mote_id{1};
  channels x(config, random_stream(1));
  const mote_id destination{9};
  const mote_id nearer{5};
  surroundings around;
  around.own_place = virtual_coordinates{1, 1, 1};
  around.motes = {{nearer, virtual_coordinates{2, 2, 1}}};
  around.is_crowd = is_crowd;
  instant now;
  auto todo =
      x.connect(x.next_id(), destination, virtual_coordinates{2, 2, 2}, {}, 0s, around, now);
  std::vector<mote_id> tried;
  for (bool over = false; !over;) {
    for (const auto& each : todo) {
      over = over || std::holds_alternative<channel_ended>(each);
      if (const auto* hop = std::get_if<channel_hop>(&each); hop && !over)
        tried.push_back(hop->next);
    }
    todo = x.on_sent(false, around, now); // nobody answers
    if (todo.empty())
      todo = x.on_time(now = *x.deadline());
    if (todo.empty() && x.is_looking())
      todo = x.look(std::nullopt, around, now);
  }
  tried.erase(std::unique(tried.begin(), tried.end()), tried.end());
  CHECK(tried == (is_crowd ? std::vector{destination, nearer, destination, nearer, broadcast_mote}
                           : std::vector{nearer, broadcast_mote})); // each twice, then a flood
}

TEST_CASE("a set-up floods only where no mote is left that may be nearer, and says why",
          "[network][NET-10][NET-12]") {
  const mote_id destination{9};
  const mote_id a{5};
  const mote_id b{6};
  const virtual_coordinates here{3, 3, 3};
  const virtual_coordinates near{1, 1, 2};
  const virtual_coordinates nearer{1, 1, 1};
  const virtual_coordinates far{4, 4, 4};
  struct row {
    const char* what;
    std::optional<virtual_coordinates> place;
    std::optional<virtual_coordinates> own_place;
    std::vector<nearby_mote> motes;
    std::vector<nearby_mote> heard;
    mote_id parent;
    mote_id next;
    std::uint64_t place_unknown = 0;
    std::uint64_t self_unknown = 0;
    std::uint64_t dead_end = 0;
  };
  const std::optional<virtual_coordinates> target{{0, 0, 0}};
  const row rows[] = {
      {"place unknown", {}, here, {{a, near}}, {}, a, broadcast_mote, 1, 0, 0},
      {"both unknown", {}, {}, {}, {}, a, broadcast_mote, 1, 0, 0},
      {"it is a neighbour", {}, {}, {}, {{destination, {}}}, a, destination, 0, 0, 0},
      {"alone", target, {}, {}, {}, no_mote, broadcast_mote, 0, 1, 0},
      {"only the parent", target, {}, {{b, {}}}, {}, a, a, 0, 0, 0},
      {"neighbours know", target, {}, {{a, near}, {b, far}}, {}, b, a, 0, 0, 0},
      {"a good one is nearer", target, here, {{a, near}}, {{b, nearer}}, b, a, 0, 0, 0},
      {"another is nearer", target, here, {{a, far}}, {{b, near}}, a, b, 0, 0, 0},
      {"one is as far", target, here, {{b, far}}, {{a, here}}, b, a, 0, 0, 0},
      {"nobody is nearer", target, here, {{a, far}}, {{b, far}}, a, broadcast_mote, 0, 0, 1},
  };
  for (const auto& each : rows) {
    CAPTURE(each.what);
    channels_config config;
    config.self = mote_id{1};
    channels x(config, random_stream(1));
    surroundings around;
    around.own_place = each.own_place;
    around.motes = each.motes;
    around.heard = each.heard;
    around.parent = each.parent;
    const auto next =
        next_of(x.connect(x.next_id(), destination, each.place, {}, 0s, around, instant{}));
    const bool waits = each.place && each.next == broadcast_mote;
    CHECK(next == (waits ? std::vector<mote_id>{} : std::vector{each.next}));
    CHECK(x.is_looking() == waits);
    if (waits) {
      CHECK(x.counters().floods == 0);
      CHECK(x.deadline() == instant{around.beacon_wait});
      CHECK(next_of(x.look(std::nullopt, around, instant{around.beacon_wait})) ==
            std::vector{broadcast_mote});
      CHECK_FALSE(x.is_looking());
    }
    CHECK(x.counters().floods_place_unknown == each.place_unknown);
    CHECK(x.counters().floods_self_unknown == each.self_unknown);
    CHECK(x.counters().floods_dead_end == each.dead_end);
    CHECK(x.counters().floods == each.place_unknown + each.self_unknown + each.dead_end);
  }
}

TEST_CASE("a mote that has just started waits for one that does not answer, until it beacons",
          "[network][NET-09][NET-12]") {
  relay_fixture here;
  here.around.is_new = true;
  CHECK(here.connect(instant{}) == std::vector{here.a});
  CHECK(here.lose(instant{1s}).empty());
  CHECK(here.x.is_looking());
  CHECK(next_of(here.x.look(here.source, here.around, instant{1500ms})).empty()); // not that one
  CHECK(next_of(here.x.look(here.a, here.around, instant{1600ms})) == std::vector{here.a});
  CHECK_FALSE(here.x.is_looking());
  CHECK(here.lose(instant{2500ms}) == std::vector{here.source}); // it has waited long enough
  CHECK(here.x.counters().backtracks == 1);
}

TEST_CASE("a dead end turns a set-up back at once, but not at a mote that has just started",
          "[network][NET-12]") {
  relay_fixture here;
  here.around.motes.pop_back();
  here.around.is_new = GENERATE(false, true);
  const auto turned_back = std::vector{here.source};
  const auto next = here.connect(instant{});
  if (!here.around.is_new) {
    CHECK(next == turned_back);
    CHECK(here.x.table().empty());
    return;
  }
  CHECK(next.empty());
  const bool is_heard = GENERATE(false, true);
  if (is_heard) {
    here.around.heard = {{here.a, virtual_coordinates{2, 2, 2}}};
    CHECK(next_of(here.x.look(here.a, here.around, instant{500ms})) == std::vector{here.a});
  } else {
    CHECK(next_of(here.x.look(std::nullopt, here.around, instant{1s})) == turned_back);
  }
  CHECK(here.x.counters().floods == 0);
}

TEST_CASE("after all its neighbours a mote sends a set-up back, and refuses it when it comes again",
          "[network][NET-12]") {
  relay_fixture here;
  constexpr mote_id b{6};
  here.around.motes.push_back({b, virtual_coordinates{2, 2, 3}});
  const channel_message dead_end{here.id, dead_end_message{}};
  CHECK(here.connect(instant{}) == std::vector{here.a});
  static_cast<void>(here.x.on_sent(true, here.around, instant{}));
  CHECK(here.hear(here.a, dead_end, instant{10ms}) == std::vector{b});
  static_cast<void>(here.x.on_sent(true, here.around, instant{}));
  CHECK(here.hear(b, dead_end, instant{20ms}) == std::vector{here.source});
  static_cast<void>(here.x.on_sent(true, here.around, instant{}));
  CHECK(here.connect(instant{30ms}) == std::vector{here.source}); // a dead end
  static_cast<void>(here.x.on_sent(true, here.around, instant{}));
  static_cast<void>(here.x.on_time(instant{20ms} + here.around.beacon_wait));
  CHECK(here.connect(instant{2s}) == std::vector{here.a});
  CHECK(here.x.counters().floods == 0);
}

TEST_CASE("in an open grid each set-up finds its destination, and few flood",
          "[network][NET-10][NET-12]") {
  grid x(6, 6, 0.95, 3);
  for (const auto from : x.motes()) {
    for (const auto to : x.motes()) {
      if (from == to)
        continue;
      const auto id = x.connect(from, to);
      CHECK(x.connected.contains(id));
      x.perform(from, x.at(from).disconnect(id, x.now()));
      x.run_for(5s);
    }
  }
  CHECK(x.entries() == 0);
  CHECK(x.sum(&channels_counters::floods) <= 12); // of 1 260
}

TEST_CASE("a set-up that a neighbour has forgotten goes there again", "[network][NET-09]") {
  relay_fixture here;
  CHECK(here.connect(instant{}) == std::vector{here.a});
  CHECK(next_of(here.x.on_sent(true, here.around, instant{10ms})).empty());
  CHECK(next_of(here.x.on_restarted(here.source, here.around, instant{1s})).empty());
  CHECK(next_of(here.x.on_restarted(here.a, here.around, instant{1s})) == std::vector{here.a});
}

TEST_CASE("in a crowd a flood that has been received often is not relayed", "[network][NET-12]") {
  const bool is_crowd = GENERATE(true, false);
  const int copies = GENERATE(2, 3);
  channels_config config;
  config.self = mote_id{1};
  channels x(config, random_stream(1));
  surroundings around;
  around.is_crowd = is_crowd;
  connect_message wish;
  wish.destination = mote_id{9};
  wish.flooded = true;
  const auto octets = encode(channel_message{{mote_id{7}, 3}, wish});
  std::size_t passed_on = 0;
  const auto count = [&](const channels_outputs& todo) {
    for (const auto& each : todo)
      passed_on += std::holds_alternative<channel_hop>(each) ? 1 : 0;
  };
  for (int i = 0; i < copies; ++i)
    count(x.on_frame(mote_id{static_cast<std::uint16_t>(20 + i)}, octets, around, instant{}));
  CHECK(passed_on == 0);
  count(x.on_time(instant{60ms}));
  CHECK(passed_on == (is_crowd && copies == 3 ? 0 : 1));
}

TEST_CASE("a flood is said again until somebody passes it on", "[network][NET-12]") {
  const bool is_passed_on = GENERATE(true, false);
  channels_config config;
  config.self = mote_id{1};
  channels x(config, random_stream(1));
  connect_message wish;
  wish.destination = mote_id{9};
  wish.flooded = true;
  wish.hops = 3;
  const auto heard = [&](std::uint16_t from, std::uint8_t hops, instant now) {
    auto copy = wish;
    copy.hops = hops;
    return x.on_frame(mote_id{from}, encode(channel_message{{mote_id{7}, 3}, copy}), {}, now);
  };
  static_cast<void>(heard(20, 3, instant{}));
  int said = 0;
  for (instant now{}; now < instant{2s}; now += 10ms) {
    auto todo = x.on_time(now);
    while (!todo.empty()) {
      ++said;
      todo = x.on_sent(false, {}, now);
      if (said == 1) // the one we have it from says it again, too: that proves nothing
        static_cast<void>(heard(20, 3, now));
      if (said == 1 && is_passed_on)
        static_cast<void>(heard(21, 5, now));
    }
  }
  CHECK(said == (is_passed_on ? 2 : 5));
}

TEST_CASE("a mote on the path that begins anew breaks its channels for both ends",
          "[network][NET-09]") {
  grid x(5, 1, 1);
  const auto id = x.connect(grid::id(0), grid::id(4));
  x.start(grid::id(2));
  x.perform(grid::id(1), x.at(grid::id(1)).on_restarted(grid::id(2), {}, x.now()));
  x.perform(grid::id(3), x.at(grid::id(3)).on_restarted(grid::id(2), {}, x.now()));
  x.run_for(1s);
  CHECK(x.ended.at({id, grid::id(0)}) == channel_end::broken);
  CHECK(x.ended.at({id, grid::id(4)}) == channel_end::broken);
  CHECK(x.entries() == 0);
}

TEST_CASE("channel messages keep their layout", "[network][golden]") {
  connect_message wish;
  wish.destination = mote_id{0x0708};
  wish.place = {9, 10, 11};
  wish.hops = 12;
  wish.expiry_s = 0x0d0e;
  wish.schedule = {island_time(std::chrono::microseconds(0x0f1011121314)),
                   std::chrono::milliseconds(0x15161718), 0x19};
  wish.delay_us = 0x1a1b1c1d;
  const channel_message x{{mote_id{0x0102}, 0x0304}, wish};
  const auto octets = encode(x);
  CHECK(octets == bytes{1,    1,    2,    3,    4,    7,    8,    1,    9,    10,
                        11,   12,   0x0d, 0x0e, 0x0f, 0x10, 0x11, 0x12, 0x13, 0x14,
                        0x15, 0x16, 0x17, 0x18, 0x19, 0x1a, 0x1b, 0x1c, 0x1d});
  CHECK(*decode_channel_message(octets) == x);
  const channel_message data{{mote_id{1}, 2}, data_message{7, {0xaa}}};
  CHECK(encode(data) == bytes{5, 0, 1, 0, 2, 7, 0xaa});
  CHECK(*decode_channel_message(encode(data)) == data);
  CHECK(decode_channel_message(bytes{3, 0, 1, 0, 2, 9}).error() == errc::bad_value);
  const channel_message ack{{mote_id{1}, 2}, connect_ack_message{9}};
  CHECK(encode(ack) == bytes{2, 0, 1, 0, 2, 9});
  CHECK(*decode_channel_message(encode(ack)) == ack);
  CHECK(decode_channel_message(bytes{2, 0, 1, 0, 2, 9, 9}).error() == errc::too_long);
  CHECK(decode_channel_message(bytes{2, 0, 1, 0, 2}).error() == errc::truncated);
  CHECK(decode_channel_message(bytes{6, 0, 1, 0, 2}).error() == errc::unsupported);
  CHECK(decode_channel_message(bytes{1, 0, 1, 0, 2}).error() == errc::truncated);
}

} // namespace rubicon::network
