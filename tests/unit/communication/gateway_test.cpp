// What is different at a gateway: it hears who joins, and its tuples show the motes.
#include <array>
#include <concepts>

#include "core/tuples/device_keys.hpp"
#include "gateway/gateway.hpp"
#include "mote/join/descriptor.hpp"
#include "network/am.hpp"
#include "support/catch.hpp"
#include "support/placements_fixture.hpp"

using namespace rubicon;
using test::placements_fixture;
using test::recorder;

namespace {

/// Whether a core can ask for one of the things that make tuples.
template <class Output, class... Wanted>
constexpr bool asks_for = (std::is_constructible_v<Output, Wanted> || ...);

template <class Output>
constexpr bool writes_tuples = asks_for<Output, gateway::publish, gateway::erase>;

static_assert(writes_tuples<gateway::output>);
static_assert(!writes_tuples<mote::node_output> && !writes_tuples<communication::layer_output> &&
              !writes_tuples<mote::sink_output>);

std::vector<std::uint16_t> motes_of(const recorder& x) {
  std::vector<std::uint16_t> all;
  for (const auto& [mote, description] : x.newcomers)
    all.push_back(mote);
  std::ranges::sort(all);
  return all;
}

} // namespace

TEST_CASE("a gateway's programs, and no others, are notified of each mote that joins its island",
          "[communication][MCK-15][DIS-03]") {
  const std::array places{mote_address{island_id{1}, no_mote}, mote_address{island_id{2}, no_mote},
                          mote_address{island_id{20}, no_mote},
                          mote_address{island_id{1}, mote_id{4}}};
  std::array<recorder, places.size()> programs;
  placements_fixture world;
  for (std::size_t i = 0; i < places.size(); ++i)
    world.attach(places[i], programs[i]);
  REQUIRE(world.settle());
  CHECK(motes_of(programs[0]) == std::vector<std::uint16_t>{2, 3, 4, 5, 6, 7});
  CHECK(motes_of(programs[1]) == std::vector<std::uint16_t>{2, 3});
  CHECK(programs[2].newcomers.empty());
  CHECK(programs[3].newcomers.empty());
  CHECK(programs[3].joins == std::vector{std::pair(places[3], true)});
  for (const auto& [mote, description] : programs[0].newcomers) {
    const auto said = mote::decode_descriptor(description);
    REQUIRE(said);
    CHECK(said->type == 301);
  }

  world.island(island_id{1}).kill(mote_id{7});
  world.island(island_id{1}).start(mote_id{7});
  world.run_for(2min);
  CHECK(motes_of(programs[0]) == std::vector<std::uint16_t>{2, 3, 4, 5, 6, 7, 7});
  CHECK(programs[1].newcomers.size() == 2);
}

TEST_CASE("a mote has no tuples; it shows in those of its own gateway alone",
          "[communication][PAR-04][GW-09]") {
  constexpr std::uint8_t am_type = 64;
  recorder at_pc;
  recorder at_mote;
  recorder at_other;
  placements_fixture world;
  REQUIRE(world.settle());
  const mote_address speaker{island_id{1}, mote_id{5}};
  const mote_address pc{island_id{20}, no_mote};
  const mote_address other{island_id{2}, mote_id{3}};
  world.attach(pc, at_pc);
  world.attach(speaker, at_mote);
  world.attach(other, at_other);
  REQUIRE(at_pc.layer->provide(am_type) == communication::SUCCESS);
  REQUIRE(at_other.layer->provide(am_type) == communication::SUCCESS);
  const auto send = [&](mote_address to) {
    const auto before = world.tuples.size();
    CHECK(world.act(speaker, [&] {
      return at_mote.layer->send_numbered(to, bytes{7}, true, am_type).has_value();
    }));
    world.run_for(10s);
    return world.tuples.size() - before;
  };
  CHECK(send(pc) == 0); // it arrives, and leaves no tuple
  CHECK(at_pc.messages.size() == 1);
  CHECK(send(other) == 0);
  CHECK(at_other.messages.size() == 1);
  CHECK(send({island_id{1}, no_mote}) == 1);
  CHECK(world.tuples.at({island_id{1}, device_output_key(speaker.mote, am_type)}) == bytes{7});

  CHECK(to_string(world.tuples.at({island_id{1}, "devices"})) == "{2,3,4,5,6,7}");
  CHECK(to_string(world.tuples.at({island_id{2}, "devices"})) == "{2,3}");
  for (const auto& [key, value] : world.tuples) {
    CAPTURE(key.second);
    const auto device = parse_device_key(key.second);
    if (key.second == devices_key)
      continue;
    REQUIRE(device);
    CHECK(device->mote.value <= (key.first == island_id{1} ? 7 : 3));
  }
}

TEST_CASE("communications of a gateway start while its sink answers",
          "[communication][MCK-13][GW-15]") {
  gateway::gateway_config config;
  config.island = island_id{1};
  gateway::gateway x(config, random_stream(1));
  recorder program;
  program.layer = x.attach(program);
  instant now;
  static_cast<void>(x.start(now));
  const auto init = [&] {
    x.begin(now);
    CHECK(program.layer->initCommunications() == communication::SUCCESS);
    static_cast<void>(x.flush());
    return program.inits.back();
  };
  CHECK_FALSE(init()); // it has said nothing yet
  static_cast<void>(x.on_packet(default_sink, network::am::sink_event,
                                encode(network::sink_event(network::sink_started{})), now));
  CHECK(init());
  now += config.line_silence_max;
  static_cast<void>(x.on_time(now));
  CHECK_FALSE(init());
}

TEST_CASE("a line to real motes does not stand for that of the sink",
          "[communication][MCK-13][GW-15][GW-17]") {
  gateway::gateway_config config;
  config.island = island_id{1};
  config.has_real_line = true;
  gateway::gateway x(config, random_stream(1));
  recorder program;
  program.layer = x.attach(program);
  instant now;
  static_cast<void>(x.start(now));
  const auto init = [&] {
    x.begin(now);
    CHECK(program.layer->initCommunications() == communication::SUCCESS);
    static_cast<void>(x.flush());
    return program.inits.back();
  };
  const auto real_mote_speaks = [&] {
    static_cast<void>(x.on_plain_packet(
        {mote_id{100}, network::am::sink_event,
         encode(network::sink_event(network::mote_joined{mote_id{100}, 1, 901, {}}))},
        now));
  };
  real_mote_speaks();
  CHECK_FALSE(init()); // one of the two is up
  static_cast<void>(x.on_packet(default_sink, network::am::sink_event,
                                encode(network::sink_event(network::sink_started{})), now));
  static_cast<void>(x.on_plain_line_lost(now));
  CHECK(init()); // the island's own radio and line are
  for (const auto end = now + config.line_silence_max; now < end; now += 1s)
    real_mote_speaks();
  static_cast<void>(x.on_time(now));
  CHECK_FALSE(init());
}
