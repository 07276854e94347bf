#include "explain/outcome.hpp"
#include "report/print/text_layout.hpp"
#include "support/catch.hpp"
#include "unit/explain/fixture.hpp"

using namespace rubicon;
using namespace rubicon::explain;
using namespace rubicon::test;

namespace {

/// The way of one segment from mote 7 to the gateway, and of the answer back.
struct delivery {
  explain_fixture& world;
  transport::segment segment;
  std::uint16_t sequence = 1;

  [[nodiscard]] explain_fixture::frame_of frame_up() const {
    return {
        near_mote, sink_actor,      7,
        1,         network::am::up, world.up(7, sequence, world.whole(world.packet_up(segment))),
        sequence};
  }
  [[nodiscard]] bytes serial_up() const {
    return world.serial({1, 7, 1, network::am::to_gateway, world.packet_up(segment)}, false);
  }
  [[nodiscard]] bytes serial_down(std::uint8_t number) const {
    return world.serial({7, 0, 1, network::am::from_gateway,
                         world.packet_down(world.answer_to(segment), mote_id{7})},
                        true, number);
  }

  std::uint64_t to_gateway(std::uint64_t cause) {
    const auto received = world.crosses_air(frame_up(), cause);
    world.writes(false, serial_up(), received);
    return world.line_gives(false, serial_up());
  }

  void answer(std::uint64_t cause) {
    world.writes(true, serial_down(9), cause);
    const auto at_sink = world.line_gives(true, serial_down(9));
    world.crosses_air(
        {sink_actor, near_mote, 1, 7, network::am::down,
         world.down(sequence, 7,
                    world.whole(world.packet_down(world.answer_to(segment), mote_id{7}))),
         100},
        at_sink);
  }
};

} // namespace

TEST_CASE("a message is followed to the gateway, and its acknowledgement back", "[explain]") {
  explain_fixture world;
  const auto cause = world.program_sends(near_mote, reading, true);
  delivery way{world, world.reliable(7, 5, reading)};
  const auto there = way.to_gateway(cause);
  world.sets(gateway_actor, gateway_kernel, "devices.7.output.2", "x", there);
  way.answer(there);
  const auto all = follow(world.x);
  REQUIRE(all.messages.size() == 1);
  const auto& m = all.messages.front();
  CHECK(m.name == "kitchen/near#1");
  CHECK(m.content == reading);
  CHECK(m.delivered == instant(6ms)); // 3 ms in the air, 1 ms until the line, 2 ms on it
  CHECK(m.acknowledged == instant(11ms));
  CHECK(m.sends == 1);
  const auto text = message_text(all, 0, wide);
  CHECK(contains(text, "sampler-1 sends 2 octets (00d7) to kitchen/gateway: AM type 2, reliable"));
  CHECK(contains(text, "kitchen/near → sink"));
  CHECK(contains(text, "kitchen/sink → gateway"));
  CHECK(contains(text, "sets devices.7.output.2 = x"));
  CHECK(contains(text, "kitchen/gateway → kitchen/near"));
  CHECK(contains(text, "delivered after 6.0 ms, acknowledged after 11.0 ms\n"));
}

TEST_CASE("the value of a tuple is followed back to the message that brought it", "[explain]") {
  explain_fixture world;
  delivery way{world, world.reliable(7, 5, reading)};
  const auto there = way.to_gateway(world.program_sends(near_mote, reading, true));
  world.sets(gateway_actor, gateway_kernel, "devices.7.output.2", "x", there);
  const auto all = follow(world.x);
  REQUIRE(all.tuples.size() == 1);
  const auto text = tuple_text(all, 0, {});
  CHECK(contains(text, "kitchen/near → sink"));
  CHECK(contains(text, "kitchen/sink → gateway"));
  CHECK(contains(text, "set at kitchen-gateway after 6.0 ms; no subscriber"));
}

TEST_CASE("repeats of a frame are one row with their reasons", "[explain]") {
  explain_fixture world;
  const auto cause = world.program_sends(near_mote, reading, true);
  const delivery way{world, world.reliable(7, 5, reading)};
  const auto frame = way.frame_up();
  world.asks_radio(frame, cause);
  world.on_air(frame, "collision");
  world.on_air(frame, "loss");
  world.on_air(frame, "delivered");
  world.radio_ends(frame, "sent");
  const auto all = follow(world.x);
  const auto y = outcome_of(all, all.messages.front());
  CHECK(y.retries.radio == 2);
  CHECK(contains(message_text(all, 0, wide),
                 "radio: received after 2 repeats (collision, lost on the radio link)"));
}

TEST_CASE("a message that no frame brings to the sink is lost there", "[explain]") {
  explain_fixture world;
  const auto cause = world.program_sends(far_mote, reading, true);
  const auto segment = world.reliable(8, 5, reading);
  for (std::uint16_t attempt = 1; attempt <= 2; ++attempt) {
    const explain_fixture::frame_of frame{
        far_mote, sink_actor,      8,
        1,        network::am::up, world.up(8, attempt, world.whole(world.packet_up(segment))),
        attempt};
    world.asks_radio(frame, world.attempt(cause));
    for (int i = 0; i < 4; ++i)
      world.on_air(frame, "out_of_reach");
    world.radio_ends(frame, "no_ack");
    world.now += 1s;
  }
  record failed;
  failed.id = 1;
  world.put(kind::send_ended, far_mote, "mote_app/kitchen/far/sampler-1", 0, failed);
  const auto all = follow(world.x);
  const auto y = outcome_of(all, all.messages.front());
  CHECK(y.status == message_status::lost);
  CHECK(y.where == "kitchen/far → sink");
  CHECK(y.why == "4 tries: 4 × out of range");
  CHECK(y.obstacle == "out of range");
  using groups = std::vector<std::pair<std::string, std::size_t>>;
  CHECK(loss_causes(all, {}) == groups{{"kitchen/far → sink: out of range", 1}});
  CHECK(y.retries.transport == 1);
  CHECK(y.retries.radio == 6);
  const auto text = message_text(all, 0, wide);
  CHECK(contains(text, "attempt 1 of 2: LOST, 4 tries: 4 × out of range"));
  CHECK(contains(text, "lost between kitchen/far → sink: 4 tries: 4 × out of range; "
                       "reported failed to the sender at 0:02.032; 6 radio repeats; "
                       "2 attempts end to end"));
  listing asked;
  asked.lost_only = true;
  CHECK(contains(list_text(all, asked, wide), "kitchen/far#1"));
  for (const auto& line : lines_of(list_text(all, asked, {100, false, 80})))
    CHECK(report::display_width(line) <= 80);
}

TEST_CASE("labels of those that an answer names are below it", "[explain]") {
  explain_fixture world;
  world.x.about.labels = {{"kitchen/far", "Küche / Fenster\nlinks"}, {"robot", "Putzhilfe"}};
  world.program_sends(far_mote, reading, true);
  const auto all = follow(world.x);
  const auto text = message_text(all, 0, wide);
  CHECK(contains(text, "\n  kitchen/far is Küche / Fenster\\nlinks\n"));
  CHECK(!contains(text, "Putzhilfe"));
  CHECK(contains(list_text(all, {}, wide), "\n  kitchen/far is Küche"));
  CHECK(contains(message_json(all, 0), "\"kitchen/far\": \"Küche / Fenster"));
  const auto again = read(encode(world.x.about));
  CHECK(!again.problem);
  CHECK(again.content.about == world.x.about);
}

TEST_CASE("an unplugged serial line is where a message ends", "[explain][GW-16]") {
  explain_fixture world;
  const auto cause = world.program_sends(near_mote, reading, true);
  const delivery way{world, world.reliable(7, 5, reading)};
  world.plug(false);
  const auto received = world.crosses_air(way.frame_up(), cause);
  world.writes(false, way.serial_up(), received);
  world.now += 90s;
  world.put(kind::event, "ecology/test", "", 0);
  const auto all = follow(world.x);
  const auto y = outcome_of(all, all.messages.front());
  CHECK(y.status == message_status::lost);
  CHECK(y.where == "kitchen/sink → gateway");
  CHECK(y.why == "cable unplugged");
}

TEST_CASE("octets that a serial line corrupts are not received", "[explain]") {
  explain_fixture world;
  const auto cause = world.program_sends(near_mote, reading, true);
  const delivery way{world, world.reliable(7, 5, reading)};
  const auto received = world.crosses_air(way.frame_up(), cause);
  auto octets = way.serial_up();
  world.writes(false, octets, received);
  octets[5] ^= 1;
  world.line_gives(false, octets);
  const auto all = follow(world.x);
  const auto y = outcome_of(all, all.messages.front());
  CHECK(y.status == message_status::in_flight); // it may be sent again
  CHECK(y.why == "octets corrupted");
}

TEST_CASE("a write that is repeated on the serial line is one hop", "[explain][GW-16]") {
  explain_fixture world;
  delivery way{world, world.reliable(7, 5, reading)};
  const auto there = way.to_gateway(world.program_sends(near_mote, reading, true));
  world.writes(true, way.serial_down(3), there);
  world.now += 100ms;
  world.writes(true, way.serial_down(3), there);
  world.line_gives(true, way.serial_down(3));
  const auto all = follow(world.x);
  CHECK(outcome_of(all, all.messages.front()).retries.serial == 1);
}

TEST_CASE("a new attempt of Transport is told from a repeat", "[explain]") {
  explain_fixture world;
  delivery way{world, world.reliable(7, 5, reading)};
  const auto cause = world.program_sends(near_mote, reading, true);
  const auto there = way.to_gateway(cause);
  static_cast<void>(there); // its answer never comes
  way.sequence = 2;
  way.answer(way.to_gateway(world.attempt(cause)));
  const auto all = follow(world.x);
  const auto& m = all.messages.front();
  CHECK(m.sends == 2);
  CHECK(m.delivered == instant(6ms));
  CHECK(m.acknowledged == instant(17ms));
  CHECK(contains(message_text(all, 0, wide), "attempt 2 of 2: received again"));
}

TEST_CASE("a message in fragments is there when all of them are", "[explain][NET-14]") {
  const auto lost = GENERATE(false, true);
  explain_fixture world;
  const bytes content(200, 0x5a);
  const auto cause = world.program_sends(near_mote, content, true);
  const auto packet = world.packet_up(world.reliable(7, 5, content));
  const auto fragments = *transport::cut(packet, 100, 4);
  REQUIRE(fragments.size() == 3);
  std::uint64_t received = 0;
  for (std::uint16_t i = 0; i < 3; ++i) {
    const explain_fixture::frame_of frame{
        near_mote, sink_actor,      7,
        1,         network::am::up, world.up(7, static_cast<std::uint16_t>(i + 1), fragments[i]),
        i + 1U};
    if (lost && i == 1) {
      world.asks_radio(frame, cause);
      world.on_air(frame, "collision");
      world.radio_ends(frame, "no_ack");
    } else {
      received = world.crosses_air(frame, cause);
    }
  }
  if (!lost) {
    const auto on_line = *transport::cut(packet, 114, 9);
    for (const auto& fragment : on_line)
      world.writes(false, world.serial({1, 7, 1, network::am::packet, fragment}, false), received);
    for (const auto& fragment : on_line)
      world.line_gives(false, world.serial({1, 7, 1, network::am::packet, fragment}, false));
  }
  const auto all = follow(world.x);
  REQUIRE(all.messages.size() == 1);
  const auto& m = all.messages.front();
  CHECK(m.delivered.has_value() == !lost);
  CHECK(contains(message_text(all, 0, wide), lost ? "radio, 3 fragments: LOST, 3 tries: collision"
                                                  : "serial line, 2 fragments"));
}

TEST_CASE("unreliable messages of equal content are told apart", "[explain]") {
  explain_fixture world;
  transport::segment plain;
  plain.source = mote_id{7};
  plain.am_type = 2;
  plain.payload = reading;
  for (std::uint16_t i = 1; i <= 3; ++i) {
    delivery way{world, plain, i};
    const auto cause = world.program_sends(near_mote, reading, false, i);
    if (i == 2) {
      world.asks_radio(way.frame_up(), cause);
      world.on_air(way.frame_up(), "weak");
      world.radio_ends(way.frame_up(), "no_ack");
    } else {
      way.to_gateway(cause);
    }
    world.now += 1s;
  }
  const auto all = follow(world.x);
  REQUIRE(all.messages.size() == 3);
  CHECK(outcome_of(all, all.messages[0]).status == message_status::delivered);
  CHECK(outcome_of(all, all.messages[1]).status == message_status::lost);
  CHECK(outcome_of(all, all.messages[1]).why == "too weak");
  CHECK(outcome_of(all, all.messages[2]).status == message_status::delivered);
}

TEST_CASE("equal messages of one moment are told apart, whatever overtakes what", "[explain]") {
  explain_fixture world;
  transport::segment plain;
  plain.source = mote_id{7};
  plain.am_type = 2;
  plain.payload = reading;
  const auto first = world.program_sends(near_mote, reading, false, 1);
  const auto second = world.program_sends(near_mote, reading, false, 2);
  delivery way_of_second{world, plain, 1};
  delivery way_of_first{world, plain, 2};
  const auto there = way_of_second.to_gateway(second);
  world.sets(gateway_actor, gateway_kernel, "devices.7.output.2", "x", there);
  world.asks_radio(way_of_first.frame_up(), first);
  world.on_air(way_of_first.frame_up(), "weak");
  world.radio_ends(way_of_first.frame_up(), "no_ack");
  const auto all = follow(world.x);
  REQUIRE(all.messages.size() == 2);
  CHECK(outcome_of(all, all.messages[0]).status == message_status::lost);
  CHECK(outcome_of(all, all.messages[0]).why == "too weak");
  CHECK(outcome_of(all, all.messages[1]).status == message_status::delivered);
  CHECK(contains(tuple_text(all, 0, wide), "kitchen/near → sink"));
}

TEST_CASE("a message from outside begins where it is seen first", "[explain]") {
  explain_fixture world;
  transport::segment plain;
  plain.source = mote_id{9};
  plain.am_type = 2;
  plain.payload = reading;
  delivery way{world, plain};
  world.writes(true, way.serial_down(1), 0); // an answer to nothing
  way.to_gateway(0);
  const auto all = follow(world.x);
  REQUIRE(all.messages.size() == 1);
  CHECK(all.messages.front().content == reading);
  CHECK(outcome_of(all, all.messages.front()).status == message_status::delivered);
}

TEST_CASE("the greeting before the first message is one row", "[explain]") {
  explain_fixture world;
  const auto cause = world.program_sends(near_mote, reading, true);
  auto hello = world.reliable(7, 4, {});
  hello.what = transport::segment::kind::hello;
  delivery greeting{world, hello};
  greeting.answer(greeting.to_gateway(cause));
  delivery way{world, world.reliable(7, 5, reading), 2};
  way.answer(way.to_gateway(world.attempt(cause)));
  const auto all = follow(world.x);
  REQUIRE(all.messages.size() == 1);
  CHECK(all.messages.front().sends == 1);
  CHECK(contains(message_text(all, 0, wide), "greets kitchen/gateway first: answered"));
}

TEST_CASE("a message can be asked for by name or by numbers", "[explain]") {
  explain_fixture world;
  world.program_sends(near_mote, reading, true, 1);
  world.program_sends(near_mote, reading, true, 2);
  const auto all = follow(world.x);
  for (const auto* name : {"kitchen/near#2", "Kitchen/NEAR#2", "1/7#2"}) {
    CAPTURE(name);
    const auto found = find(all, name);
    REQUIRE(std::holds_alternative<message_found>(found));
    CHECK(std::get<message_found>(found).index == 1);
  }
  for (const auto* name : {"kitchen/near#3", "kitchen/neat#1", "#", "kitchen/near#", "#1"}) {
    CAPTURE(name);
    const auto found = find(all, name);
    REQUIRE(std::holds_alternative<nothing_found>(found));
    CHECK(std::get<nothing_found>(found).known == std::vector<std::string>{"kitchen/near#1..2"});
  }
}

TEST_CASE("a message to its own mote is there at once", "[explain]") {
  explain_fixture world;
  record r;
  r.mote = {own_island, own_mote};
  r.octets = reading;
  world.put(kind::send_message, near_mote, near_mote, 0, r);
  const auto all = follow(world.x);
  REQUIRE(all.messages.size() == 1);
  CHECK(all.messages.front().name == "kitchen/near#1");
  CHECK(outcome_of(all, all.messages.front()).status == message_status::delivered);
}

TEST_CASE("a message that its mote refuses says so", "[explain]") {
  explain_fixture world;
  world.program_sends(near_mote, reading, true);
  record refused;
  refused.id = 1;
  refused.text = "refused";
  world.put(kind::send_ended, near_mote, "mote_app/kitchen/near/sampler-1", 1, refused);
  const auto all = follow(world.x);
  CHECK(outcome_of(all, all.messages.front()).status == message_status::refused);
  CHECK(contains(message_text(all, 0, wide), "refused: its mote did not accept it"));
}

TEST_CASE("a message that never left is not taken for the next one", "[explain]") {
  explain_fixture world;
  transport::segment plain;
  plain.source = mote_id{7};
  plain.am_type = 2;
  plain.payload = reading;
  world.program_sends(near_mote, reading, false, 1); // the mote knows no way
  world.now += 100s;
  delivery way{world, plain};
  way.to_gateway(world.program_sends(near_mote, reading, false, 2));
  const auto all = follow(world.x);
  REQUIRE(all.messages.size() == 2);
  CHECK(outcome_of(all, all.messages[0]).status == message_status::lost);
  CHECK(outcome_of(all, all.messages[0]).why == "it never left the sender");
  CHECK(outcome_of(all, all.messages[1]).status == message_status::delivered);
}

TEST_CASE("a packet that is lost before it leaves its mote is listed with its cause", "[explain]") {
  explain_fixture world;
  const auto kind_of_packet = GENERATE(as<std::string>{}, "channel", "tunnel");
  record begun;
  begun.text = kind_of_packet;
  const auto number = world.put(kind::begun, near_mote, "", 0, begun);
  SECTION("when it has ended") {
    record ended;
    ended.id = number;
    ended.text = "channel_full";
    world.put(kind::message_ended, near_mote, "", 0, ended);
    const auto all = follow(world.x);
    REQUIRE(all.messages.size() == 1);
    const auto became = outcome_of(all, all.messages[0]);
    CHECK(all.messages[0].is_accounted);
    CHECK(all.messages[0].is_on_channel == (kind_of_packet == "channel"));
    CHECK(all.messages[0].is_in_tunnel == (kind_of_packet == "tunnel"));
    CHECK(became.status == message_status::lost);
    CHECK(became.cause == "channel_full");
  }
  SECTION("and as in flight until then") {
    world.now += 100s;
    world.put(kind::event, near_mote, "", 0);
    const auto all = follow(world.x);
    REQUIRE(all.messages.size() == 1);
    CHECK(outcome_of(all, all.messages[0]).status == message_status::in_flight);
  }
}

TEST_CASE("a receiver that has started again turns a message away", "[explain][DIS-07]") {
  explain_fixture world;
  delivery way{world, world.reliable(7, 5, reading)};
  const auto cause = world.program_sends(near_mote, reading, true);
  const auto there = way.to_gateway(cause);
  auto refused = world.answer_to(way.segment);
  refused.what = transport::segment::kind::refused;
  const auto octets = world.serial(
      {7, 0, 1, network::am::from_gateway, world.packet_down(refused, mote_id{7})}, true, 1);
  world.writes(true, octets, there);
  SECTION("and it is lost") {
    record failed;
    failed.id = 1;
    world.put(kind::send_ended, near_mote, "mote_app/kitchen/near/sampler-1", 0, failed);
    const auto all = follow(world.x);
    CHECK(outcome_of(all, all.messages.front()).status == message_status::lost);
    CHECK(contains(outcome_of(all, all.messages.front()).why, "kitchen/gateway did not accept it"));
  }
  SECTION("and takes it under another number") {
    delivery again{world, world.reliable(7, 9, reading), 2};
    again.answer(again.to_gateway(world.attempt(cause)));
    const auto all = follow(world.x);
    REQUIRE(all.messages.size() == 1);
    CHECK(outcome_of(all, all.messages.front()).status == message_status::delivered);
    CHECK(all.messages.front().acknowledged);
  }
}

TEST_CASE("a record that grows tells at any time what there is so far", "[explain]") {
  explain_fixture world;
  const auto cause = world.program_sends(near_mote, reading, true);
  delivery way{world, world.reliable(7, 5, reading)};
  const auto before = world.x.records.size();
  way.answer(way.to_gateway(cause));
  record sample;
  sample.what = kind::sample;
  sample.text = "{}";
  world.x.records.push_back(sample);

  following bits(world.x.about, /*keeps_view=*/false);
  following all(world.x.about);
  CHECK(bits.so_far().messages.empty());
  for (std::size_t i = 0; i < world.x.records.size(); ++i) {
    if (i == before) {
      REQUIRE(bits.so_far().messages.size() == 1);
      CHECK(outcome_of(bits.so_far(), bits.so_far().messages[0]).status ==
            message_status::in_flight);
    }
    bits.take(world.x.records[i]);
    all.take(world.x.records[i]);
  }
  const auto whole = follow(world.x);
  CHECK(whole.samples.size() == 1);
  CHECK(all.so_far().samples.size() == 1);
  CHECK(bits.so_far().samples.empty());
  CHECK(message_text(bits.so_far(), 0, wide) == message_text(whole, 0, wide));
  CHECK(all.finish(/*cut_off=*/true).cut_off);
}
