// Motes that run plain programs of TinyOS, at a gateway.
#include "gateway/gateway.hpp"
#include "gateway/plain_motes.hpp"
#include "network/am.hpp"
#include "network/sink_event.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::gateway;

namespace {

constexpr std::uint8_t blink = 6;
constexpr std::uint8_t oscilloscope = 147;
constexpr instant start{};

plain_motes two_rules() {
  plain_config x;
  x.rules = {{blink, 100, 199, 901, 1}, {oscilloscope, 1, mote_id_max, 902, 3}};
  x.keep_alive = 10s;
  return plain_motes(x);
}

network::sink_event event_in(const sink_packet& x) {
  REQUIRE(x.am_type == network::am::sink_event);
  const auto found = network::decode_sink_event(x.payload);
  REQUIRE(found);
  return *found;
}

/// The tuples that a gateway makes of what it is told.
std::vector<std::string> tuples_of(gateway::gateway& to, const std::vector<sink_packet>& all,
                                   instant now) {
  std::vector<std::string> found;
  for (const auto& x : all)
    for (const auto& output : to.on_packet(x.source, x.am_type, x.payload, now)) {
      if (const auto* set = std::get_if<publish>(&output))
        found.push_back(set->key + '=' + (set->text ? to_string(set->value) : to_hex(set->value)));
      else if (const auto* gone = std::get_if<erase>(&output))
        found.push_back(gone->key + " gone");
    }
  return found;
}

bool has(const std::vector<std::string>& all, const std::string& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

} // namespace

TEST_CASE("a mote that a rule knows is a device, and its packets are messages of it",
          "[gateway][GW-17]") {
  auto motes = two_rules();
  gateway_config config;
  config.island = island_id{20};
  gateway::gateway core(config, random_stream(1));
  static_cast<void>(core.start(start));

  const auto first = motes.on_packet(mote_id{100}, blink, bytes{0, 100, 0, 7}, start);
  REQUIRE(first);
  auto tuples = tuples_of(core, *first, start);
  CHECK(has(tuples, "devices={100}"));
  CHECK(has(tuples, "devices.100.type=00000385"));
  CHECK(has(tuples, "devices.100.output.1=00640007"));
  const auto second = motes.on_packet(mote_id{100}, blink, bytes{0, 100, 0, 8}, start + 1s);
  REQUIRE(second);
  CHECK(second->size() == 1);
  CHECK(has(tuples_of(core, *second, start + 1s), "devices.100.output.1=00640008"));
  const auto other = motes.on_packet(mote_id{7}, oscilloscope, bytes{1}, start + 1s);
  REQUIRE(other);
  tuples = tuples_of(core, *other, start + 1s);
  CHECK(has(tuples, "devices={7,100}"));
  CHECK(has(tuples, "devices.7.output.3=01"));
}

TEST_CASE("packets that no rule knows are those of the sink's own program", "[gateway][GW-17]") {
  auto motes = two_rules();
  CHECK(!motes.on_packet(mote_id{99}, blink, bytes{1}, start)); // not of that range
  CHECK(!motes.on_packet(mote_id{200}, blink, bytes{1}, start));
  CHECK(!motes.on_packet(mote_id{100}, network::am::sink_event, bytes{1}, start));
  CHECK(!motes.knows(mote_id{100}));
  CHECK(!motes.deadline());
  CHECK(!plain_motes().on_packet(mote_id{100}, blink, bytes{1}, start));
}

TEST_CASE("a plain mote that is silent has left, and joins again in another life",
          "[gateway][GW-17]") {
  auto motes = two_rules();
  static_cast<void>(motes.on_packet(mote_id{100}, blink, bytes{1}, start));
  static_cast<void>(motes.on_packet(mote_id{101}, blink, bytes{1}, start + 5s));
  CHECK(motes.deadline() == start + 10s);
  CHECK(motes.on_time(start + 10s - 1ns).empty());
  const auto left = motes.on_time(start + 10s);
  REQUIRE(left.size() == 1);
  CHECK(event_in(left[0]) ==
        network::sink_event(network::mote_left{mote_id{100}, network::leave_cause::silence}));
  CHECK(motes.deadline() == start + 15s);
  CHECK(motes.on_time(start + 10s).empty());
  CHECK(motes.knows(mote_id{100}));
  const auto again = motes.on_packet(mote_id{100}, blink, bytes{1}, start + 20s);
  REQUIRE(again);
  REQUIRE(again->size() == 2);
  CHECK(event_in(again->at(0)) ==
        network::sink_event(network::mote_joined{mote_id{100}, 2, 901, {}}));
}

TEST_CASE("the table of plain motes is full at a thousand", "[gateway][GW-17]") {
  plain_config x;
  x.rules = {{blink, 1, mote_id_max, 901, 1}};
  plain_motes motes(x);
  for (std::uint16_t i = 1; i <= plain_motes::motes_max; ++i)
    CHECK(motes.on_packet(mote_id{i}, blink, bytes{1}, start)->size() == 2);
  CHECK(motes.on_packet(mote_id{2000}, blink, bytes{1}, start)->empty());
  CHECK(motes.on_packet(mote_id{1}, blink, bytes{1}, start)->size() == 1);
}
