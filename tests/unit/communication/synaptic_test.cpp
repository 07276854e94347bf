// Synaptic channels between motes and PCs, wherever they are (PAR-01).
#include <cmath>

#include "support/catch.hpp"
#include "support/placements_fixture.hpp"

using namespace rubicon;
using test::placement;
using test::placements_fixture;
using test::recorder;

namespace {

constexpr std::uint8_t size = 3;

struct synaptic_fixture {
  explicit synaptic_fixture(const placement& placed) : x(placed) {
    REQUIRE(world.settle());
    attach(world, x, source, sink);
  }

  /// D1.1's call: the other end's island is in the parameters.
  communication::status create_out(std::uint8_t elements = size) {
    return world.act(x.from, [&] {
      return source.layer->create_syn_channel_out(x.to.mote.value, elements, island_of(x.to));
    });
  }
  communication::status create_in(std::uint8_t elements = size) {
    return world.act(x.to, [&] {
      return sink.layer->create_syn_channel_in(x.from.mote.value, elements, island_of(x.from));
    });
  }

  void create_both(bool in_first) {
    REQUIRE((in_first ? create_in() : create_out()) == communication::SUCCESS);
    world.run_for(3s);
    REQUIRE((in_first ? create_out() : create_in()) == communication::SUCCESS);
    world.run_for(5s);
    REQUIRE(source.outs.size() == 1);
    REQUIRE(sink.ins.size() == 1);
    REQUIRE(source.outs[0].second);
    REQUIRE(sink.ins[0].second);
  }

  template <class Command>
  communication::status out_end(Command command) {
    return world.act(x.from, [&] { return command(*source.layer, out()); });
  }

  /// At each tick the elements are the tick's number, and 1 and 2 more.
  void write_ticks() {
    source.on_tick = [this](std::uint32_t tick) {
      for (std::uint8_t k = 0; k < size; ++k)
        static_cast<void>(source.layer->write_output(out(), k, static_cast<float>(tick + k)));
    };
  }

  [[nodiscard]] int out() const { return source.outs[0].first; }
  [[nodiscard]] int in() const { return sink.ins[0].first; }

  [[nodiscard]] static std::array<std::uint8_t, communication::DIM_SYNCHANNEL_PARAM>
  island_of(mote_address x) {
    return synaptic::encode(synaptic::parameters{.island = x.island});
  }

  recorder source;
  recorder sink;
  placement x;
  placements_fixture world;
};

const auto start = [](auto& layer, int channel) { return layer.start_syn_channel(channel); };
const auto stop = [](auto& layer, int channel) { return layer.stop_syn_channel(channel); };
const auto dispose = [](auto& layer, int channel) { return layer.dispose_syn_channel(channel); };

} // namespace

TEST_CASE("a vector comes at every tick over a channel created in either order, in all placements",
          "[communication][PAR-01][PAR-05][GEN-09][SYN-01][SYN-02][SYN-03][SYN-04][SYN-06][SYN-07]"
          "[SYN-08][SYN-10][SYN-13]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  const bool in_first = GENERATE(true, false);
  CAPTURE(placed.name, in_first);
  synaptic_fixture s(placed);
  s.create_both(in_first);
  s.write_ticks();
  s.world.run_until([&, n = s.source.ticks.size()] { return s.source.ticks.size() > n; }, 1s);
  const auto first = s.source.ticks.back().first + 1;
  CHECK(s.out_end(start) == communication::SUCCESS);
  const auto& counters = s.world.layer_of(s.x.from).ports().synaptic.core().counters();
  s.world.run_until([&] { return counters.sent == 20; }, 12s);
  CHECK(s.out_end(stop) == communication::SUCCESS);
  CHECK(s.out_end(stop) == communication::FAIL);
  s.world.run_for(5s);
  CHECK(s.sink.missed == 0);
  CHECK(s.sink.updated == 20 * size);
  REQUIRE(s.sink.inputs.size() == 20 * size);
  CHECK(s.sink.inputs.front() == static_cast<float>(first));
  for (std::size_t i = 0; i < s.sink.inputs.size(); ++i)
    CHECK(s.sink.inputs[i] == s.sink.inputs[0] + static_cast<float>(i / size + i % size));
  CHECK(s.sink.failed.empty());
  CHECK(counters.sent == 20);
}

TEST_CASE("each end takes its own commands only, in all placements",
          "[communication][SYN-01][SYN-06][SYN-07][SYN-08][SYN-09]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  synaptic_fixture s(placed);
  s.create_both(true);
  CHECK(s.create_out() == communication::FAIL); // already open
  CHECK(s.create_in() == communication::FAIL);
  CHECK(s.out_end(stop) == communication::FAIL); // not started
  CHECK(s.source.layer->write_output(s.out(), size, 1) == communication::FAIL);
  CHECK(s.source.layer->write_output(s.out(), size - 1, 1) == communication::SUCCESS);
  CHECK(s.sink.layer->write_output(s.in(), 0, 1) == communication::FAIL);
  CHECK(s.sink.layer->read_input(s.in(), 0) == 0);
  CHECK(std::isnan(s.sink.layer->read_input(s.in(), size)));
  CHECK(std::isnan(s.source.layer->read_input(s.out(), 0)));
  CHECK(s.world.act(s.x.to, [&] { return s.sink.layer->start_syn_channel(s.in()); }) ==
        communication::FAIL);
}

TEST_CASE("the in end hears that the out end is disposed of, which may be created anew, in all "
          "placements",
          "[communication][SYN-05][SYN-17]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  synaptic_fixture s(placed);
  s.create_both(true);
  CHECK(s.out_end(start) == communication::SUCCESS);
  s.world.run_for(5s);
  CHECK(s.out_end(dispose) == communication::SUCCESS);
  CHECK(s.out_end(dispose) == communication::FAIL);
  s.world.run_for(3s);
  CHECK(s.sink.failed == std::vector{s.in()});
  CHECK(s.sink.missed == 0);
  CHECK(std::isnan(s.sink.layer->read_input(s.in(), 0)));
  CHECK(s.world.act(s.x.to, [&] { return s.sink.layer->dispose_syn_channel(s.in()); }) ==
        communication::SUCCESS);
  CHECK(s.world.layer_of(s.x.from).ports().synaptic.core().open_channels() == 0);
  CHECK(s.world.layer_of(s.x.to).ports().synaptic.core().open_channels() == 0);
  s.source.outs.clear();
  s.sink.ins.clear();
  s.create_both(false);
}

TEST_CASE("sizes that differ fail both ends, in all placements", "[communication][SYN-15]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  synaptic_fixture s(placed);
  REQUIRE(s.create_in(size) == communication::SUCCESS);
  REQUIRE(s.create_out(size + 1) == communication::SUCCESS);
  s.world.run_for(10s);
  REQUIRE(s.source.outs.size() == 1);
  REQUIRE(s.sink.ins.size() == 1);
  CHECK_FALSE(s.source.outs[0].second);
  CHECK_FALSE(s.sink.ins[0].second);
  CHECK(s.world.layer_of(s.x.from).ports().synaptic.core().open_channels() == 0);
  CHECK(s.world.layer_of(s.x.to).ports().synaptic.core().open_channels() == 0);
}

TEST_CASE("the death of the out end is reported as missed vectors and then as failure, in all "
          "placements",
          "[communication][SYN-10][SYN-17]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  synaptic_fixture s(placed);
  s.create_both(true);
  CHECK(s.out_end(start) == communication::SUCCESS);
  s.world.run_for(5s);
  CHECK(s.sink.missed == 0);
  s.world.kill(s.x.from);
  s.world.run_for(15s);
  CHECK(s.sink.missed == 20 * size);
  CHECK(s.sink.failed == std::vector{s.in()});
  s.world.run_for(1min);
  CHECK(s.sink.missed == 20 * size); // no more
  CHECK(s.sink.failed.size() == 1);
  CHECK(s.world.layer_of(s.x.to).ports().channels.tunnels().size() == 0);
}

TEST_CASE("the out end hears that the in end has died, in all placements",
          "[communication][SYN-17]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  synaptic_fixture s(placed);
  s.create_both(true);
  CHECK(s.out_end(start) == communication::SUCCESS);
  s.world.run_for(5s);
  s.world.kill(s.x.to);
  s.world.run_for(40s);
  CHECK(s.source.failed == std::vector{s.out()});
  CHECK(s.out_end(start) == communication::FAIL);
  CHECK(s.out_end(dispose) == communication::SUCCESS);
  CHECK(s.world.layer_of(s.x.from).ports().synaptic.core().open_channels() == 0);
  CHECK(s.world.layer_of(s.x.from).ports().channels.tunnels().size() == 0);
}
