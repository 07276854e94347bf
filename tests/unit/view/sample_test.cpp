#include <limits>

#include "support/catch.hpp"
#include "view/sample_json.hpp"

using namespace rubicon;
using report::mote_sample;
using report::run_sample;

namespace {

run_sample sample_of_two() {
  run_sample x{instant(1500ms), {{island_id(1), {{"radio", {{"collision", 7}}}}}}, {}};
  mote_sample first;
  first.address = {island_id(1), mote_id(2)};
  first.alive = true;
  first.joined = true;
  first.radio_on = true;
  first.used_mah = 0.25;
  first.battery_mah = 2500;
  first.parent = mote_id(1);
  first.hops = 1;
  first.signal_dbm = -71;
  first.etx = 1.5;
  first.queued = 3;
  first.originated = 12;
  first.forwarded = 5;
  first.delivery = 0.75;
  first.energy = {0.01, 0.1, 0.02, 0.03, 0.09};
  first.neighbours = {{mote_id(1), 1.5}, {mote_id(3), std::nullopt}};
  mote_sample second;
  second.address = {island_id(1), mote_id(3)};
  second.battery_mah = std::numeric_limits<double>::infinity();
  x.motes = {first, second};
  x.peers = {{"a/\"b\"", true, {{peer_id(7), 3}, {any_peer, 0}}, 2}, {"pc", false, {}, {}}};
  return x;
}

} // namespace

TEST_CASE("a sample is what it was when it is read again", "[view]") {
  const auto text = view::encode(sample_of_two());
  const auto again = view::decode_sample(text);
  REQUIRE(again);
  CHECK(view::encode(*again) == text);
  CHECK(again->at == instant(1500ms));
  REQUIRE(again->motes.size() == 2);
  const auto& mote = again->motes[0];
  CHECK(mote.address == mote_address{island_id(1), mote_id(2)});
  CHECK(mote.signal_dbm == -71);
  CHECK(mote.etx == 1.5);
  CHECK(mote.delivery == 0.75);
  CHECK(mote.forwarded == 5);
  CHECK(mote.energy.processor == 0.09);
  REQUIRE(mote.neighbours.size() == 2);
  CHECK(mote.neighbours[0].mote == mote_id(1));
  CHECK_FALSE(mote.neighbours[1].etx);
  CHECK(again->motes[1].battery_mah == std::numeric_limits<double>::infinity());
  CHECK_FALSE(again->motes[1].signal_dbm);
  REQUIRE(again->peers.size() == 2);
  CHECK(again->peers[0].name == "a/\"b\"");
  CHECK(again->peers[0].runs);
  REQUIRE(again->peers[0].links.size() == 2);
  CHECK(again->peers[0].links[0].to == peer_id(7));
  CHECK(again->peers[0].links[0].queued == 3);
  CHECK(again->peers[0].to_sink == 2U);
  CHECK_FALSE(again->peers[1].runs);
  CHECK_FALSE(again->peers[1].to_sink);
  CHECK(again->islands.at(0).lost.at("radio").at("collision") == 7);
}

TEST_CASE("what is no sample is none", "[view]") {
  for (const auto* text : {"", "{", "[]", "{}", "17", R"({"at_ns":0})",
                           R"({"at_ns":0,"lost":{"x":{}},"islands":[],"motes":{}})",
                           R"({"at_ns":0,"lost":{},"islands":[1],"motes":{"mote":[]}})",
                           R"({"at_ns":0,"lost":{},"islands":{"a":1},"motes":[]})"})
    CHECK_FALSE(view::decode_sample(text));
  auto text = view::encode(sample_of_two());
  for (std::size_t i = 0; i < text.size(); ++i)
    static_cast<void>(view::decode_sample(std::string_view(text).substr(0, i)));
}

TEST_CASE("of many motes neighbours are left out of the text", "[view]") {
  auto x = sample_of_two();
  while (x.motes.size() <= view::motes_with_neighbours_max) {
    auto next = x.motes[0];
    next.address.mote = mote_id(static_cast<std::uint16_t>(x.motes.size() + 2));
    x.motes.push_back(next);
  }
  const auto again = view::decode_sample(view::encode(x));
  REQUIRE(again);
  CHECK(again->motes.size() == x.motes.size());
  CHECK(again->motes[0].neighbours.empty());
}
