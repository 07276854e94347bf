// The parts of a gateway's core, each by itself.
#include <string>
#include <utility>
#include <vector>

#include "gateway/island_motes.hpp"
#include "gateway/mote_inputs.hpp"
#include "gateway/plain/plain_silence.hpp"
#include "gateway/sink_port.hpp"
#include "network/am.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"

using namespace rubicon;
using gateway::island_motes;
using gateway::line_changed;
using gateway::member_changed;
using gateway::mote_inputs;
using gateway::publish;
using gateway::relay_to;
using gateway::sink_port;
using gateway::to_sink;
using test::pick;

namespace {

/// The occasions of a part, and what has come of them since the last take().
struct calls {
  gateway::outputs out;
  gateway::gateway_counters counters;

  gateway::occasion at(duration when, bool of_plain = false) {
    return {instant{when}, out, counters, of_plain};
  }
  gateway::outputs take() { return std::exchange(out, {}); }
};

std::string last_text(const gateway::outputs& out) {
  const auto all = pick<publish>(out);
  return all.empty() ? std::string() : to_string(all.back().value);
}

} // namespace

TEST_CASE("the list of an island's motes has room for so many", "[gateway][GW-03]") {
  calls x;
  island_motes motes({.motes_max = 1});
  REQUIRE(motes.on_joined({mote_id{1}, 0, 301, {}}, x.at(1s)));
  CHECK(!motes.on_joined({mote_id{2}, 0, 301, {}}, x.at(1s)));
  CHECK(motes.on_joined({mote_id{1}, 1, 301, {}}, x.at(2s))->restarted);
  CHECK(x.counters.devices_refused == 1);
  CHECK(motes.all() == std::vector{mote_id{1}});
  CHECK(pick<member_changed>(x.take()).size() == 2); // listed, and started again
  CHECK(motes.on_left({mote_id{1}, {}}, x.at(3s)));
  CHECK(!motes.on_left({mote_id{1}, {}}, x.at(3s)));
}

TEST_CASE("a roster without a listed mote is a question about it", "[gateway][GW-03]") {
  calls x;
  island_motes motes({.rejoin_wait = 10s});
  REQUIRE(motes.on_joined({mote_id{1}, 0, 301, {}}, x.at(1s)));
  REQUIRE(motes.on_joined({mote_id{2}, 0, 301, {}}, x.at(1s, true))); // no sink knows this one
  x.take();
  motes.on_sink_started(x.at(2s));
  motes.on_roster({1, 0, 1, {}}, x.at(3s));
  CHECK(pick<to_sink>(x.take()).empty()); // it may join again
  motes.on_roster({2, 0, 1, {}}, x.at(12s));
  const auto questions = pick<to_sink>(x.take());
  REQUIRE(questions.size() == 1);
  CHECK(questions[0].mote == mote_id{1});
}

TEST_CASE("the port to a sink is silent until a packet, and again after a pause",
          "[gateway][GW-15]") {
  calls x;
  sink_port port(5s);
  CHECK(!port.deadline());
  CHECK(port.on_packet(x.at(1s)));
  CHECK(!port.on_packet(x.at(2s)));
  CHECK(port.deadline() == instant{7s});
  CHECK(!port.on_time(x.at(6999ms)));
  CHECK(port.on_time(x.at(7s)));
  CHECK(!port.is_up());
  x.take();
  CHECK(port.on_packet(x.at(9s)));
  const auto changes = pick<line_changed>(x.take());
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].silence == 7s);
}

TEST_CASE("each write to an input has one outcome", "[gateway][GW-05][GW-12]") {
  calls x;
  gateway::gateway_config config{island_id{1}};
  config.input_channels_max = 2;
  config.inputs_outstanding_max = 1;
  config.relay_wait = 10s;
  mote_inputs inputs(config);
  const auto first = inputs.begin(mote_id{7}, 2, x.at(1s));
  const auto second = inputs.begin(mote_id{7}, 3, x.at(1s));
  REQUIRE((first && second));
  CHECK(!inputs.begin(mote_id{7}, 4, x.at(1s))); // no room for another channel
  CHECK(x.counters.inputs_refused == 1);
  x.take();

  SECTION("of its message to the mote") {
    inputs.sent(5, *first);
    inputs.on_outcome({5, true}, x.at(2s));
    CHECK(last_text(x.take()) == "1 acknowledged");
    inputs.on_outcome({5, true}, x.at(2s));
    CHECK(x.take().empty());
  }

  SECTION("of its gateway that leads, or of waiting for it") {
    inputs.pass_on(*first, peer_id{20}, bytes{1}, x.at(1s));
    CHECK(pick<relay_to>(x.take()).size() == 1);
    inputs.pass_on(*second, peer_id{20}, bytes{1}, x.at(1s)); // no room
    CHECK(last_text(x.take()) == "1 failed");
    CHECK(inputs.deadline() == instant{11s});
    inputs.on_time(x.at(11s));
    CHECK(last_text(x.take()) == "1 failed");
    CHECK(!inputs.deadline());
  }

  SECTION("failed, when it cannot be known any more") {
    inputs.sent(5, *first);
    inputs.pass_on(*second, peer_id{20}, bytes{1}, x.at(1s));
    x.take();
    inputs.fail_all(x.at(2s));
    CHECK(pick<publish>(x.take()).size() == 2);
  }
}

TEST_CASE("a forwarder is silent after twice the longest pause so far", "[gateway]") {
  gateway::plain_silence x(10s);
  CHECK(x.is_silent(instant{}));
  x.on_packet(instant{1s});
  CHECK(!x.is_silent(instant{10999ms}));
  CHECK(x.is_silent(instant{11s}));
  x.on_packet(instant{21s});
  CHECK(!x.is_silent(instant{60s}));
  CHECK(x.is_silent(instant{61s}));
}
