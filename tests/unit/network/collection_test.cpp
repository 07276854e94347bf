#include <map>
#include <set>
#include <string>
#include <vector>

#include "network/am.hpp"
#include "network/tree/collection.hpp"
#include "support/agenda.hpp"
#include "support/catch.hpp"
#include "support/mote_ids.hpp"

namespace rubicon::network {

namespace {

using test::id;
using test::the_sink;

/// Motes with given parents, over links that lose frames and acks; each unicast is tried four
/// times.
class given_tree {
public:
  explicit given_tree(double delivery, std::uint64_t seed = 1) : delivery_(delivery), rng_(seed) {
    add(the_sink, no_mote, 0);
  }

  void add(mote_id id, mote_id parent, int depth) {
    collection_config config;
    config.self = id;
    config.is_root = id == the_sink;
    motes_[id] = collection(config, random_stream(rng_.next()));
    parents_[id] = parent;
    if (!config.is_root)
      perform(id, motes_[id].on_route(parent, static_cast<etx_cost>(depth * etx_one), now_));
  }

  collection& at(mote_id id) { return motes_.at(id); }
  [[nodiscard]] instant now() const { return now_; }

  void perform(mote_id from, collection_outputs todo) {
    for (auto& x : todo) {
      if (auto* frame = std::get_if<hop>(&x))
        put_on_air(from, std::move(*frame));
      else
        arrived.emplace_back(from, std::move(std::get<collected>(x)));
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
      for (auto& [id, x] : motes_)
        perform(id, x.on_time(now_));
    });
  }

  [[nodiscard]] std::uint64_t sum(std::uint64_t collection_counters::*which) const {
    std::uint64_t all = 0;
    for (const auto& [id, x] : motes_)
      all += x.counters().*which;
    return all;
  }

  std::vector<std::pair<mote_id, collected>> arrived; ///< where, what
  std::set<std::pair<mote_id, mote_id>> cut;

private:
  void put_on_air(mote_id from, hop frame) {
    std::vector<mote_id> heard;
    bool acked = false;
    for (auto& [id, parent] : parents_) {
      const bool near = parent == from || parents_.at(from) == id;
      if (near && frame.next == broadcast_mote && reaches(from, id))
        heard.push_back(id);
    }
    for (int attempt = 0; attempt < 4 && frame.next != broadcast_mote && !acked; ++attempt) {
      if (!reaches(from, frame.next))
        continue;
      heard.push_back(frame.next);
      acked = reaches(frame.next, from);
    }
    const auto at = now_ + 5ms;
    for (const auto to : heard) {
      agenda_.add(at, [this, from, to, frame] {
        perform(to, motes_.at(to).on_frame(from, frame.am_type, frame.octets, now_));
      });
    }
    agenda_.add(at, [this, from, acked] { perform(from, motes_.at(from).on_sent(acked, now_)); });
  }

  [[nodiscard]] bool reaches(mote_id from, mote_id to) {
    return motes_.contains(to) && !cut.contains({from, to}) && rng_.chance(delivery_);
  }

  double delivery_;
  random_stream rng_;
  instant now_;
  std::map<mote_id, collection> motes_;
  std::map<mote_id, mote_id> parents_;
  test::agenda agenda_;
};

given_tree line_of(int length, double delivery, std::uint64_t seed = 1) {
  given_tree x(delivery, seed);
  for (int i = 2; i <= length; ++i)
    x.add(id(i), id(i - 1), i - 1);
  return x;
}

} // namespace

TEST_CASE("a packet waits for its turn, one in a slot does not", "[network][SYN-16]") {
  collection_config config;
  config.self = id(2);
  collection x(config, random_stream(1));
  const instant now;
  static_cast<void>(x.on_route(the_sink, etx_one, now));
  x.hold(instant{1s});
  CHECK(x.send_up({1}, now).empty());
  CHECK(x.deadline() == instant{1s});
  const auto hop_in = [](const collection_outputs& todo) {
    REQUIRE(todo.size() == 1);
    return std::get<hop>(todo[0]);
  };
  const auto vector = hop_in(x.send_up({2}, now, true)); // overtakes
  CHECK(vector.in_slot);
  CHECK(vector.octets.back() == 2);
  CHECK(x.on_sent(false, now).empty()); // its second round waits
  CHECK(x.deadline() == instant{1s});
  x.hold(instant{});
  const auto second = hop_in(x.on_time(instant{1s}));
  CHECK_FALSE(second.in_slot);
  CHECK(second.octets.back() == 2);
  CHECK(hop_in(x.on_sent(true, instant{1s})).octets.back() == 1);
}

TEST_CASE("a packet goes up ten hops of bad links and arrives once", "[network][NET-05]") {
  auto x = line_of(11, 0.9);
  for (std::uint8_t i = 0; i < 200; ++i) {
    x.perform(id(11), x.at(id(11)).send_up({i}, x.now()));
    x.run_for(500ms);
  }
  x.run_for(10s);
  std::multiset<std::uint8_t> seen;
  for (const auto& [where, what] : x.arrived) {
    CHECK(where == the_sink);
    CHECK(what.origin == id(11));
    seen.insert(what.content.at(0));
  }
  CHECK(seen.size() == 200);
  CHECK(std::set(seen.begin(), seen.end()).size() == 200);
  CHECK(x.sum(&collection_counters::repeated) > 0);
  CHECK(x.sum(&collection_counters::duplicates) > 0);
}

TEST_CASE("a sink reaches every mote whose packets it has received", "[network][NET-05]") {
  auto x = line_of(11, 0.9);
  CHECK_FALSE(x.at(the_sink).room_down(id(11)));
  for (int i = 2; i <= 11; ++i)
    x.perform(id(i), x.at(id(i)).send_up({0}, x.now()));
  x.run_for(5s);
  x.arrived.clear();
  CHECK(x.at(the_sink).room_down(id(11)) == 114 - 4 - 10);
  for (std::uint8_t i = 0; i < 100; ++i) {
    x.perform(the_sink, x.at(the_sink).send_down(id(11), {i}, x.now()));
    x.run_for(500ms);
  }
  x.run_for(5s);
  CHECK(x.arrived.size() == 100);
  for (const auto& [where, what] : x.arrived)
    CHECK(where == id(11));
}

TEST_CASE("every mote receives what is sent to all, once", "[network][ADR-05]") {
  auto x = line_of(6, 1);
  x.perform(id(4), x.at(id(4)).send_to_all({7}, x.now()));
  x.run_for(5s);
  std::set<mote_id> heard;
  for (const auto& [where, what] : x.arrived) {
    CHECK(what.by_flood);
    CHECK(what.origin == id(4));
    heard.insert(where);
  }
  CHECK(x.arrived.size() == 5);
  CHECK(heard == std::set{id(1), id(2), id(3), id(5), id(6)});
}

TEST_CASE("packets wait for a route up, then for a while only", "[network][NET-09]") {
  given_tree x(1);
  x.add(id(2), no_mote, 511);
  x.perform(id(2), x.at(id(2)).send_up({1}, x.now()));
  x.run_for(3300ms);
  CHECK(x.arrived.empty());
  x.perform(id(2), x.at(id(2)).on_route(the_sink, etx_one, x.now()));
  x.run_for(10ms);
  CHECK(x.arrived.size() == 1);
  x.perform(id(2), x.at(id(2)).on_route(no_mote, etx_infinite, x.now()));
  x.perform(id(2), x.at(id(2)).send_up({2}, x.now()));
  x.run_for(20s);
  CHECK(x.at(id(2)).counters().no_route == 1);
  CHECK(x.at(id(2)).queued() == 0);
}

TEST_CASE("a packet that no mote takes is given up and counted", "[network][NET-09]") {
  auto x = line_of(3, 1);
  x.cut.insert({id(2), the_sink});
  x.perform(id(3), x.at(id(3)).send_up({1}, x.now()));
  x.run_for(60s);
  CHECK(x.arrived.empty());
  CHECK(x.at(id(2)).counters().gave_up == 1);
  CHECK(x.at(id(2)).counters().repeated == 7);
}

TEST_CASE("a queue with too many octets drops what comes and counts it", "[network][NET-05]") {
  auto x = line_of(2, 1);
  for (std::uint8_t i = 0; i < 20; ++i)
    x.perform(id(2), x.at(id(2)).send_up(bytes(100, i), x.now()));
  CHECK(x.at(id(2)).counters().queue_full == 20 - 3); // of 352 octets, one packet in flight
  x.run_for(5s);
  CHECK(x.arrived.size() == 3);
}

TEST_CASE("a full queue drops what comes and counts it", "[network][NET-05]") {
  auto x = line_of(2, 1);
  for (std::uint8_t i = 0; i < 20; ++i)
    x.perform(id(2), x.at(id(2)).send_up({i}, x.now()));
  CHECK(x.at(id(2)).counters().queue_full == 20 - 1 - 8);
  x.run_for(5s);
  CHECK(x.arrived.size() == 9);
}

TEST_CASE("in a full queue the modules' own packets are dropped for what users send",
          "[network][NET-05]") {
  auto x = line_of(2, 1);
  for (std::uint8_t i = 0; i < 9; ++i) // one is in flight, and eight wait
    x.perform(id(2), x.at(id(2)).send_up({1, i}, x.now()));
  x.perform(id(2), x.at(id(2)).send_up({0, 42}, x.now()));
  x.perform(id(2), x.at(id(2)).send_up({1, 43}, x.now()));
  CHECK(x.at(id(2)).counters().queue_full == 2);
  x.run_for(5s);
  REQUIRE(x.arrived.size() == 9);
  CHECK(x.arrived.back().second.content == bytes{0, 42});
}

TEST_CASE("a loop is seen and left", "[network][NET-09]") {
  given_tree x(1);
  x.add(id(2), id(3), 5);
  x.add(id(3), id(2), 2);
  x.perform(id(3), x.at(id(3)).send_up({1}, x.now()));
  x.run_for(100ms);
  CHECK(x.at(id(2)).take_loop_seen());
  CHECK_FALSE(x.at(id(2)).take_loop_seen());
  x.run_for(20s);
  CHECK(x.sum(&collection_counters::too_far) == 1);
  CHECK(x.sum(&collection_counters::forwarded) == collection_config{}.hops_max - 1U);
  CHECK(x.at(id(2)).queued() + x.at(id(3)).queued() == 0);
}

TEST_CASE("copies over several parents are one packet to the root", "[network]") {
  collection_config config;
  config.self = the_sink;
  config.is_root = true;
  collection root(config, random_stream(1));
  const auto arrive = [&root](mote_id from, std::uint16_t sequence, std::uint8_t hops) {
    const up_packet x{id(5), id(2), sequence, 10, hops, {1}};
    return root.on_frame(from, am::up, encode(x), instant()).size();
  };
  CHECK(arrive(id(2), 7, 1) == 1);
  CHECK(arrive(id(3), 7, 2) == 0); // its acknowledgement was missed, and it went another way
  CHECK(arrive(id(3), 8, 2) == 1);
  CHECK(arrive(id(2), 7, 1) == 0);
  CHECK(root.counters().arrived == 2);
  CHECK(root.counters().duplicates == 2);
}

TEST_CASE("a sink knows no route where parents form a circle", "[network][NET-04]") {
  source_routes x(the_sink);
  x.learn(id(2), id(3));
  x.learn(id(3), id(2));
  CHECK_FALSE(x.route_to(id(2)));
  x.learn(id(3), the_sink);
  CHECK(x.route_to(id(2)) == std::vector{id(3), id(2)});
  for (int i = 4; i < 40; ++i)
    x.learn(id(i), id(i - 1));
  CHECK(x.route_to(id(34))->size() == 32);
  CHECK_FALSE(x.route_to(id(35)));
}

TEST_CASE("a sink that knows routes to many forgets the one that reported longest ago",
          "[network]") {
  source_routes x(the_sink, 3);
  for (int i = 2; i <= 4; ++i)
    x.learn(id(i), the_sink);
  x.learn(id(2), the_sink);
  x.learn(id(4), the_sink);
  CHECK(x.size() == 3); // who is known takes nobody's place
  x.learn(id(9), the_sink);
  CHECK(x.size() == 3);
  CHECK_FALSE(x.route_to(id(3)));
  for (int i : {2, 4, 9})
    CHECK(x.route_to(id(i)));
}

TEST_CASE("packets of the tree keep their layout", "[network][golden]") {
  const up_packet up{mote_id{0x0102}, mote_id{0x0304}, 0x0506, 0x0708, 9, {0xaa}};
  CHECK(encode(up) == bytes{1, 2, 3, 4, 5, 6, 7, 8, 9, 0xaa});
  CHECK(*decode_up(encode(up)) == up);
  const down_packet narrow{0x0102, 1, {id(3), id(255)}, {0xaa}};
  CHECK(encode(narrow) == bytes{1, 2, 0x82, 1, 3, 255, 0xaa});
  CHECK(*decode_down(encode(narrow)) == narrow);
  const down_packet wide{0x0102, 0, {id(3), id(256)}, {0xaa}};
  CHECK(encode(wide) == bytes{1, 2, 2, 0, 0, 3, 1, 0, 0xaa});
  CHECK(*decode_down(encode(wide)) == wide);
  CHECK(header_size(wide.hops) == 8);
  const flood_packet flood{mote_id{0x0102}, 0x0304, 5, {0xaa}};
  CHECK(encode(flood) == bytes{1, 2, 3, 4, 5, 0xaa});
  CHECK(*decode_flood(encode(flood)) == flood);
  CHECK(decode_down(bytes{0, 0, 0, 0}).error() == errc::bad_value);
  CHECK(decode_down(bytes{0, 0, 2, 2, 0, 1, 0, 2}).error() == errc::bad_value);
  CHECK(decode_down(bytes{0, 0, 2, 0, 0, 1, 0}).error() == errc::truncated);
  CHECK(decode_up(bytes{0, 0}).error() == errc::truncated);
}

} // namespace rubicon::network
