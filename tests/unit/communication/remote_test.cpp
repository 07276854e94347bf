// A program in an actor of its own and its node: the two sides of their messages.
#include <algorithm>
#include <string>

#include "communication/program_port.hpp"
#include "communication/remote_process.hpp"
#include "network/am.hpp"
#include "support/catch.hpp"
#include "support/programs.hpp"
#include "support/remote_program.hpp"
#include "support/segments.hpp"

using namespace rubicon;
using communication::FAIL;
using communication::SUCCESS;
using test::remote_program;
using test::user_am_type;

namespace {

constexpr mote_address self{island_id{3}, mote_id{7}};

/// Writes down the type that was refused too.
class program final : public test::recorder {
public:
  void receive(communication::island_octet, std::uint16_t, byte_view, std::uint8_t type,
               communication::status x) override {
    if (x == FAIL)
      refused.push_back(type);
  }

  std::vector<std::uint8_t> refused;
};

/// A node with nothing below its layer.
struct node {
  static communication::layer_config config() {
    communication::layer_config x;
    x.self = self.mote;
    x.transducer_mask = 0b1010;
    x.streams.streams_max = 6;
    x.synaptic.size_max = 4;
    return x;
  }

  communication::interface attach(communication::communication_events& x) { return core.attach(x); }
  [[nodiscard]] const communication::layer& above() const { return core; }

  void join() {
    core.on_initialised(true, now);
    core.on_joined(self.island, now);
  }

  communication::layer core{config(), random_stream(5)};
  instant now;
};

/// A node and programs beside it.
struct node_with_programs {
  explicit node_with_programs(std::size_t count = 1) : programs(count) {
    for (auto& x : programs) {
      sides.push_back(std::make_unique<remote_program>(here, x));
      x.layer = sides.back()->layer;
    }
  }

  communication::interface& api(std::size_t i = 0) { return *programs[i].layer; }

  /// What is in flight arrives, at the node and at the programs.
  void settle() {
    outputs = here.core.take_outputs();
    for (auto& x : sides) {
      x->exchange(here.now, [this](auto commands) {
        here.core.set_time(here.now);
        commands();
        for (auto& each : here.core.take_outputs())
          outputs.push_back(std::move(each));
      });
    }
  }

  node here;
  std::vector<program> programs;
  std::vector<std::unique_ptr<remote_program>> sides;
  communication::layer_outputs outputs; ///< of the last settle()
};

/// The same commands at a node and beside one; and the same happens to both nodes.
class twins {
public:
  explicit twins(std::uint64_t seed) : rng_(seed) {
    at_node_.layer = direct_.attach(at_node_);
    settle();
  }

  void step() {
    const auto what = rng_.below(24);
    if (what < 17)
      command(what);
    else
      happen(what);
    settle();
  }

  void compare() const {
    const auto& a = at_node_;
    const auto& b = beside_.programs[0];
    CHECK(a.openings == b.openings);
    REQUIRE(a.readings.size() == b.readings.size());
    for (std::size_t i = 0; i < a.readings.size(); ++i) {
      CHECK(a.readings[i].descriptor == b.readings[i].descriptor);
      CHECK(a.readings[i].record == b.readings[i].record);
      CHECK(a.readings[i].success == b.readings[i].success);
    }
    CHECK(a.acks == b.acks);
    CHECK(a.acks_of.size() == b.acks_of.size());
    CHECK(a.outs == b.outs);
    CHECK(a.ins == b.ins);
    CHECK(a.inputs == b.inputs);
    CHECK(a.failed == b.failed);
    CHECK(a.ticks == b.ticks);
    CHECK(a.joins == b.joins);
    CHECK(a.messages.size() == b.messages.size());
  }

  [[nodiscard]] const program& at_node() const { return at_node_; }
  [[nodiscard]] std::uint64_t refused_late() const {
    return beside_.sides[0]->port.counters().refused;
  }

private:
  /// Gives a command twice. What the two answer is the same.
  template <class Command>
  void both(Command give) {
    direct_.core.set_time(direct_.now);
    beside_.sides[0]->process.begin(beside_.here.now);
    const auto a = give(*at_node_.layer);
    const auto b = give(beside_.api());
    CHECK(a == b);
  }

  /// @param what 0..16
  void command(std::uint64_t what) {
    const auto desc = static_cast<int>(rng_.below(12));
    const auto name = static_cast<std::uint16_t>(rng_.below(3));
    const auto size = static_cast<std::uint8_t>(rng_.below(6));
    const mote_address other{self.island, mote_id(static_cast<std::uint16_t>(6 + rng_.below(3)))};
    const bytes octets(rng_.below(20), 7);
    switch (what) {
    case 0:
      return both([&](auto& x) { return x.open_remote(255, own_mote.value, name, 0, 0); });
    case 1:
      return both([&](auto& x) { return x.open_write_end(other, name, 0, 0, size * 4U); });
    case 2:
      return both([&](auto& x) { return x.open_sensor(size, 1000, stream::sampling::on_demand); });
    case 3:
      return both([&](auto& x) { return x.open_local(); });
    case 4:
      return both([&](auto& x) { return x.close(desc); });
    case 5:
    case 6:
      return both([&](auto& x) { return x.read(desc, size); });
    case 7:
    case 8:
      return both([&](auto& x) { return x.write(desc, octets); });
    case 9:
      return both([&](auto& x) { return x.create_syn_channel_out(other, size, {}); });
    case 10:
      return both([&](auto& x) { return x.create_syn_channel_in(other, size, {}); });
    case 11:
      return both([&](auto& x) { return x.dispose_syn_channel(desc); });
    case 12:
      return both([&](auto& x) { return x.start_syn_channel(desc); });
    case 13:
      return both([&](auto& x) { return x.stop_syn_channel(desc); });
    case 14:
      return both([&](auto& x) { return x.write_output(desc, size, static_cast<float>(name)); });
    case 15:
      return both(
          [&](auto& x) { return x.send(3, other.mote.value, octets, name == 0, user_am_type); });
    default:
      return both([&](auto& x) { return x.has_ended(desc) || x.address() == self; });
    }
  }

  template <class Input>
  void input(Input give) {
    give(direct_.core, direct_.now);
    give(beside_.here.core, beside_.here.now);
  }

  /// @param what 17..23
  void happen(std::uint64_t what) {
    const auto length = 1ms * rng_.below(2000);
    direct_.now += length;
    beside_.here.now += length;
    if (what == 17 && rng_.chance(0.2))
      return input([](auto& x, instant now) { x.on_left(now); });
    if (what == 18)
      return input([](auto& x, instant now) {
        x.on_initialised(true, now);
        x.on_joined(self.island, now);
      });
    if (what == 19 && channels_ > 0) {
      const stream::channel_handle gone{1 + static_cast<std::uint32_t>(rng_.below(channels_))};
      return input([gone](auto& x, instant now) { x.channels().on_closed(gone, now); });
    }
    if (what == 20)
      input([this](auto& x, instant now) { x.vectors().on_tick(tick_, now); });
    if (what == 21)
      ask_for_outputs();
    tick_ += what == 20 ? 1 : 0;
    input([](auto& x, instant now) { x.on_time(now); });
  }

  void ask_for_outputs() {
    const std::vector<communication::output_wanted> wanted{
        {static_cast<std::uint16_t>(rng_.below(9)), std::chrono::milliseconds(rng_.below(1000))}};
    constexpr auto request = network::am::outputs_wanted;
    input([&](auto& x, instant now) {
      x.on_packet(self.island, request, encode(test::plain(no_mote, request, encode(wanted))), now);
    });
  }

  /// What is asked of below is the same, and is answered the same.
  void settle() {
    for (bool again = true; again;) {
      const auto wanted = direct_.core.take_outputs();
      beside_.settle();
      REQUIRE(wanted.size() == beside_.outputs.size());
      again = false;
      for (const auto& each : wanted) {
        again = true;
        answer(each);
      }
    }
  }

  void answer(const communication::layer_output& x) {
    if (const auto* channel = std::get_if<communication::channel_wanted>(&x)) {
      const auto who = channel->request;
      if (rng_.chance(0.3))
        return input([who](auto& y, instant now) { y.channels().on_connect_failed(who, now); });
      const stream::channel_handle handle{++channels_};
      input([=](auto& y, instant now) { y.channels().on_connected(who, handle, now); });
    } else if (const auto* wanted = std::get_if<communication::sample_wanted>(&x)) {
      input([=](auto& y, instant now) {
        y.devices().on_sample(wanted->stream, {self, 1, 2}, now);
      });
    } else if (const auto* packet = std::get_if<communication::channel_packet>(&x)) {
      const auto name = stream::decode_message(packet->octets);
      const auto* open = name ? std::get_if<stream::open_message>(&*name) : nullptr;
      if (open != nullptr && rng_.chance(0.7))
        input([&](auto& y, instant now) {
          y.channels().on_octets(packet->channel, encode(stream::open_ack_message{open->name}),
                                 now);
        });
    }
  }

  random_stream rng_;
  node direct_;
  program at_node_;
  node_with_programs beside_;
  std::uint32_t channels_ = 0;
  std::uint32_t tick_ = 1;
};

} // namespace

TEST_CASE("a program beside its node gets the answers and hears the events of one at it",
          "[communication][PAR-05][AM-02][MCK-01][MCK-05][MCK-06][MCK-08][MCK-16]") {
  std::size_t opened = 0;
  std::size_t read = 0;
  std::size_t created = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    twins x(seed);
    for (int i = 0; i < 600; ++i)
      x.step();
    x.compare();
    CHECK(x.refused_late() == 0);
    opened += x.at_node().openings.size();
    read += x.at_node().readings.size();
    created += x.at_node().outs.size() + x.at_node().ins.size();
  }
  CHECK(opened > 150);
  CHECK(read > 200);
  CHECK(created > 200);
}

TEST_CASE("what only the node can refuse is reported by an event",
          "[communication][PAR-05][AM-05][MCK-02][MCK-07][MCK-10]") {
  node_with_programs x(2);
  x.here.join();
  x.settle();
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(x.api(i).open_remote(255, own_mote.value, 9, 0, 0) == SUCCESS);
    CHECK(x.api(i).open_sensor(1, 1000, stream::sampling::periodic) == 2);
    CHECK(x.api(i).read(2, 12) == SUCCESS);
    for (int k = 0; i == 0 && k < 4; ++k) // the node has room for six
      CHECK(x.api(i).open_local() > 0);
    CHECK(x.api(i).create_syn_channel_out({own_island, mote_id{8}}, 3, {}) > 0);
    CHECK(x.api(i).provide(user_am_type) == SUCCESS);
    for (int k = 0; k < 6; ++k) // the node has room for eight
      CHECK(x.api(i).send(3, 8, bytes{1}, true, user_am_type) == SUCCESS);
  }
  x.settle();
  const auto& first = x.programs[0];
  CHECK(first.openings.empty());
  CHECK(first.readings.empty());
  CHECK(first.outs.empty());
  CHECK(first.refused.empty());
  CHECK(first.acks.empty());
  const auto& second = x.programs[1];
  CHECK(second.openings == std::vector{test::recorder::opening{1, 9, false}});
  REQUIRE(second.readings.size() == 1);
  CHECK(second.readings[0].descriptor == 2);
  CHECK_FALSE(second.readings[0].success);
  CHECK(second.outs == std::vector{std::pair(1, false)});
  CHECK(second.refused == std::vector{user_am_type});
  CHECK(second.acks.empty()); // those of before are still in flight
  CHECK(second.acks_of.size() == 4);
  CHECK(x.sides[0]->port.counters().refused == 0);
  CHECK(x.sides[1]->port.counters().refused == 9);
  x.here.core.on_left(x.here.now);
  x.settle();
  CHECK(first.acks == std::vector<bool>(6, false));
  CHECK(second.acks == std::vector<bool>(6, false));
}

TEST_CASE("what is closed while its answer is in transit has failed, once",
          "[communication][PAR-05]") {
  node_with_programs x;
  x.here.join();
  x.settle();
  auto& side = *x.sides[0];
  CHECK(x.api().open_write_end(self, 9, 0, 0) == SUCCESS);
  CHECK(x.api().create_syn_channel_out(self, 3, {}) == 1);
  CHECK(x.api().create_syn_channel_in(self, 3, {}) == 2);
  side.port.on_commands(*side.process.flush());
  static_cast<void>(x.here.core.take_outputs());
  const auto opened = *side.port.take_events();
  CHECK(x.api().close(1) == SUCCESS);
  CHECK(x.api().dispose_syn_channel(1) == SUCCESS);
  side.process.on_events(opened, x.here.now);
  x.settle();
  const auto& program = x.programs[0];
  CHECK(program.openings == std::vector{test::recorder::opening{1, 9, false}});
  CHECK(program.outs == std::vector{std::pair(1, false)});
  CHECK(program.ins == std::vector{std::pair(2, true)});
  CHECK(program.failed == std::vector{2}); // its out end is no more
  CHECK(x.here.core.ports().streams.core().open_streams() == 0);
  CHECK(x.here.core.ports().synaptic.core().open_channels() == 1);
}

TEST_CASE("a write that the node refuses is reported as the end of the stream",
          "[communication][PAR-05]") {
  node_with_programs x;
  x.here.join();
  x.settle();
  CHECK(x.api().open_write_end(self, 9, 0, 0) == SUCCESS);
  CHECK(x.api().open_remote(255, own_mote.value, 9, 0, 0) == SUCCESS);
  x.settle();
  REQUIRE(x.programs[0].openings.size() == 2);
  CHECK(x.api().close(2) == SUCCESS);     // the read end,
  CHECK(x.api().write(1, bytes{1}) == 1); // which the program's side does not think of
  x.settle();
  REQUIRE(x.programs[0].readings.size() == 1);
  CHECK(x.programs[0].readings[0].descriptor == 1);
  CHECK_FALSE(x.programs[0].readings[0].success);
  CHECK(x.api().has_ended(1));
  CHECK(x.api().write(1, bytes{1}) == -1);
}

TEST_CASE("commands in flight are bounded; to close is always possible",
          "[communication][PAR-05][MCK-18]") {
  node here;
  program events;
  communication::program_port port(here);
  communication::remote_process process(port.limits(), 5); // the first is that it wants ticks
  events.layer = process.attach(events);
  CHECK(events.layer->open_local() == 1);
  CHECK(events.layer->open_local() == 2);
  CHECK(events.layer->write(1, bytes{1}) == 1);
  CHECK(events.layer->write(1, bytes{2}) == 1);
  CHECK(events.layer->write(1, bytes{3}) == -1);
  CHECK(events.layer->open_local() == -1);
  CHECK(process.counters().no_room == 2);
  CHECK(events.layer->close(2) == SUCCESS);
  const auto batch = process.flush();
  REQUIRE(batch);
  CHECK(batch->all.size() == 6);
  CHECK(process.commands_in_flight() == 6);
  CHECK(events.layer->read(1, 4) == FAIL); // not taken yet
  port.on_commands(*batch);
  process.on_events(*port.take_events(), here.now);
  CHECK(process.commands_in_flight() == 0);
  CHECK(events.layer->read(1, 4) == SUCCESS);
}

TEST_CASE("elements of a vector make one command, holds only what they come to",
          "[communication][PAR-05][SYN-08]") {
  node_with_programs x;
  x.here.join();
  x.settle();
  auto& process = x.sides[0]->process;
  CHECK(x.api().create_syn_channel_out(self, 3, {}) == 1);
  CHECK(x.api().create_syn_channel_in(self, 3, {}) == 2);
  CHECK(x.api().provide(user_am_type) == SUCCESS);
  x.settle();
  for (std::uint8_t k = 0; k < 3; ++k)
    CHECK(x.api().write_output(1, k, k) == SUCCESS);
  x.api().hold(user_am_type);
  x.api().release(user_am_type);
  const auto batch = process.flush();
  REQUIRE(batch);
  REQUIRE(batch->all.size() == 1);
  CHECK(std::get<communication::remote::set_outputs>(batch->all[0]).values ==
        std::vector<float>{0, 1, 2});
}

TEST_CASE("a program that takes no events gets no reliable messages and loses ticks",
          "[communication][MCK-18]") {
  node here;
  program events;
  communication::program_port port(here, 10);
  communication::remote_process process(port.limits());
  events.layer = process.attach(events);
  here.join();
  CHECK(events.layer->provide(user_am_type) == SUCCESS);
  port.on_commands(*process.flush());
  static_cast<void>(here.core.take_outputs());
  for (std::uint32_t tick = 1; tick <= 20; ++tick)
    here.core.vectors().on_tick(tick, here.now);
  const auto batch = port.take_events();
  REQUIRE(batch);
  CHECK(batch->all.size() == 10); // the join included
  CHECK(port.counters().dropped == 12);

  const auto send = [&] {
    CHECK(here.core.take_outputs().empty());
    CHECK(events.layer->send(3, 7, bytes{1}, true, user_am_type) == SUCCESS);
    port.on_commands(*process.flush());
    for (auto sent = here.core.take_outputs(); !sent.empty(); sent = here.core.take_outputs()) {
      for (const auto& each : sent) {
        const auto& packet = std::get<transport::to_network>(each);
        here.core.on_packet(island_id{3}, packet.channel, packet.segment, here.now);
      }
    }
  };
  process.on_events(
      {1, {communication::remote::initialised{true}, communication::remote::joined{self, true}}},
      here.now);
  send();
  CHECK(here.core.ports().messages.core().counters().throttled == 1);
  CHECK(here.core.ports().messages.core().counters().received == 0);
  process.on_events(*batch, here.now);
  port.on_commands(*process.flush());
  here.now += 5s;
  here.core.on_time(here.now);
  for (auto sent = here.core.take_outputs(); !sent.empty(); sent = here.core.take_outputs()) {
    for (const auto& each : sent) {
      const auto& packet = std::get<transport::to_network>(each);
      here.core.on_packet(island_id{3}, packet.channel, packet.segment, here.now);
    }
  }
  CHECK(here.core.ports().messages.core().counters().received == 1);
}

TEST_CASE("of a program that is gone nothing stays at its node",
          "[communication][PAR-05][ACT-03]") {
  node_with_programs x(2);
  x.here.join();
  x.settle();
  CHECK(x.api(0).open_local() == 1);
  CHECK(x.api(0).open_remote(255, own_mote.value, 9, 0, 0) == SUCCESS);
  CHECK(x.api(0).create_syn_channel_in({own_island, mote_id{8}}, 3, {}) == 1);
  CHECK(x.api(0).provide(user_am_type) == SUCCESS);
  x.api(0).hold(user_am_type);
  CHECK(x.api(0).send(3, 8, bytes{1}, true, user_am_type) == SUCCESS);
  x.settle();
  CHECK(x.here.core.ports().streams.core().open_streams() == 2);
  x.sides[0]->port.leave();
  x.sides.erase(x.sides.begin());
  CHECK(x.here.core.ports().streams.core().open_streams() == 0);
  CHECK(x.here.core.ports().synaptic.core().open_channels() == 0);
  x.here.core.on_left(x.here.now);
  x.here.core.on_joined(self.island, x.here.now);
  x.settle();
  CHECK(x.programs[0].acks.empty());
  CHECK(x.programs[0].joins.size() == 1);
  CHECK(x.api(1).provide(user_am_type) == SUCCESS);
  x.settle();
  CHECK(x.programs[1].refused.empty());

  program next; // begins as if it had been there
  x.sides.push_back(std::make_unique<remote_program>(x.here, next));
  next.layer = x.sides.back()->layer;
  x.settle();
  CHECK(next.inits == std::vector{true});
  CHECK(next.joins == std::vector{std::pair(self, true)});
  CHECK(next.layer->open_local() == 1);
  next.layer->leave();
  x.settle();
  CHECK(x.here.core.ports().streams.core().open_streams() == 0);

  program last; // takes its place, which is not closed a second time
  x.sides.push_back(std::make_unique<remote_program>(x.here, last));
  CHECK(x.sides.back()->layer.open_local() == 1);
  x.settle();
  x.sides[x.sides.size() - 2]->port.leave();
  CHECK(x.here.core.ports().streams.core().open_streams() == 1);
}
