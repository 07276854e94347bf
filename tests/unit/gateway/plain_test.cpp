// Motes that run plain programs of TinyOS, at a gateway.
#include "core/numbers/random.hpp"
#include "gateway/gateway.hpp"
#include "gateway/plain/plain_line.hpp"
#include "gateway/plain/plain_motes.hpp"
#include "network/am.hpp"
#include "network/sink_event.hpp"
#include "serial/packet.hpp"
#include "serial/raw_packet.hpp"
#include "support/catch.hpp"
#include "support/start.hpp"

using namespace rubicon;
using namespace rubicon::gateway;
using test::start;

namespace {

constexpr std::uint8_t blink = 6;
constexpr std::uint8_t oscilloscope = 147;

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

/// The tuples that a gateway makes of what it receives.
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

/// The texts and octets that a gateway publishes.
std::vector<std::string> texts_of(const outputs& all) {
  std::vector<std::string> found;
  for (const auto& output : all)
    if (const auto* set = std::get_if<publish>(&output))
      found.push_back(set->key + '=' + (set->text ? to_string(set->value) : to_hex(set->value)));
  return found;
}

/// What a gateway with a line to real motes makes of them.
std::vector<std::string> texts_of_plain(gateway::gateway& to, const std::vector<sink_packet>& all,
                                        instant now) {
  std::vector<std::string> found;
  for (const auto& x : all)
    for (auto& text : texts_of(to.on_plain_packet(x, now)))
      found.push_back(std::move(text));
  return found;
}

/// What a line to motes 100 to 199 is given by a base station.
bytes said(std::uint16_t source, std::uint8_t am_type, bytes payload) {
  return serial::encode(
      serial::am_packet{serial::am_broadcast, source, 0x22, am_type, std::move(payload)});
}

plain_line real_line() {
  plain_line_config x;
  x.motes.rules = {
      {blink, 100, 149, 901, 1, 2, blink, plain_form::blink},
      {oscilloscope, 150, 198, 902, 3, 4, oscilloscope, plain_form::oscilloscope},
      {7, 199, 199, 903, 1, 5, 8, plain_form::octets},
  };
  x.range = address_range{100, 199};
  x.group = 0x22;
  return plain_line(x);
}

std::uint64_t sum(const std::map<std::string, std::uint64_t>& x) {
  std::uint64_t all = 0;
  for (const auto& [cause, count] : x)
    all += count;
  return all;
}

gateway::gateway beside(bool has_real_line) {
  gateway_config config;
  config.island = island_id{20};
  config.has_real_line = has_real_line;
  return {config, random_stream(1)};
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

TEST_CASE("what is written to a plain mote's input is a packet of its program",
          "[gateway][GW-17]") {
  auto line = real_line();
  const auto sent = [&](std::uint16_t mote, std::uint16_t channel, const bytes& octets) {
    const auto packet = line.on_input(mote_id{mote}, channel, octets);
    if (!packet)
      return std::string("refused");
    const auto x = serial::decode_am_packet(*packet);
    REQUIRE(x);
    CHECK(x->destination == mote);
    CHECK(x->group == 0x22);
    return std::to_string(x->am_type) + ' ' + to_hex(x->payload);
  };
  CHECK(sent(100, 2, bytes{0, 5}) == "6 00000005");
  CHECK(sent(149, 2, bytes{1, 0}) == "6 00000100");
  CHECK(sent(199, 5, bytes{1, 2, 3}) == "8 010203");
  CHECK(sent(199, 5, {}) == "8 ");
  CHECK(sent(100, 2, bytes{5}) == "refused"); // no number of 2 octets
  CHECK(sent(100, 2, bytes{0, 0, 5}) == "refused");
  CHECK(sent(100, 3, bytes{0, 5}) == "refused"); // no such input
  CHECK(sent(99, 2, bytes{0, 5}) == "refused");
  CHECK(sent(200, 5, bytes{0, 5}) == "refused");
  CHECK(sent(199, 5, bytes(114)).size() == 2 + 2 * 114); // whether that is too long the port says
  CHECK(sent(199, 5, bytes(115)) == "refused");          // longer than a packet
  CHECK(sent(150, 4, bytes{1, 0}) == "refused");         // its version is not known yet

  // The version of Oscilloscope's settings is one more than the mote has, and than was said.
  const auto zeros = std::string(2 * 24, '0');
  static_cast<void>(line.on_packet(said(150, oscilloscope, bytes{0, 9, 1, 0}), start));
  CHECK(sent(150, 4, bytes{1, 0xf4}) == "147 000a01f4" + zeros);
  CHECK(sent(150, 4, bytes{1, 0xf5}) == "147 000b01f5" + zeros);
  static_cast<void>(line.on_packet(said(150, oscilloscope, bytes{0, 10, 1, 0}), start));
  CHECK(sent(150, 4, bytes{1, 0xf6}) == "147 000c01f6" + zeros);
  static_cast<void>(line.on_packet(said(150, oscilloscope, bytes{0xff, 0xff, 1, 0}), start));
  CHECK(sent(150, 4, bytes{1, 0xf6}) == "refused"); // there is no newer one

  const auto& counted = line.counters();
  CHECK(counted.inputs == 16);
  CHECK(counted.inputs_failed.at("refused") == 8);
  line.on_sent();
  line.on_lost(serial::lost_cause::no_ack);
  line.on_lost(serial::lost_cause::too_long);
  CHECK(counted.inputs_sent == 1);
  CHECK(counted.inputs_failed.at("no_ack") == 1);
  CHECK(counted.inputs_failed.at("refused") == 9);
}

TEST_CASE("settings of MViz are as long as its packets", "[gateway][GW-17]") {
  plain_line_config config;
  config.motes.rules = {{oscilloscope, 1, 9, 902, 1, 4, oscilloscope, plain_form::mviz}};
  plain_line line(config);
  static_cast<void>(line.on_packet(said(7, oscilloscope, bytes{0, 9, 1, 0}), start));
  const auto packet = line.on_input(mote_id{7}, 4, bytes{1, 0xf4});
  REQUIRE(packet);
  CHECK(to_hex(serial::decode_am_packet(*packet)->payload) ==
        "000a01f4" + std::string(2 * 12, '0'));
}

TEST_CASE("a line to real motes takes packets of its range alone", "[gateway][GW-17]") {
  auto line = real_line();
  const auto taken = [&](const bytes& packet) { return line.on_packet(packet, start).has_value(); };
  CHECK(!taken(said(99, blink, bytes{1})));
  CHECK(taken(said(100, blink, bytes{1})));
  CHECK(taken(said(199, 7, bytes{1})));
  CHECK(!taken(said(200, 7, bytes{1})));
  CHECK(!taken(said(100, 7, bytes{1}))); // not what such motes send
  CHECK(!taken({}));
  CHECK(!taken(bytes{0, 1}));
  CHECK(!taken(bytes{1, 2, 3}));
  CHECK(!taken(from_hex("0205020012").value()));                      // an acknowledgement
  CHECK(!taken(from_hex("0210418811 2200ffff64003f060001").value())); // not as long as it says
  CHECK(taken(from_hex("020f418811 2200ffff64003f060001").value()));
  const auto& x = line.counters();
  CHECK(x.packets == 11);
  CHECK(x.taken == 3);
  CHECK(x.dropped == std::map<std::string, std::uint64_t>{
                         {"malformed", 4}, {"no_data", 1}, {"no_rule", 1}, {"out_of_range", 2}});
}

TEST_CASE("a base station that says raw frames is spoken to in raw frames", "[gateway][GW-17]") {
  auto line = real_line();
  static_cast<void>(line.on_packet(from_hex("020f418811 2200ffff64003f060001").value(), start));
  for (std::uint8_t i = 0; i < 3; ++i) {
    const auto packet = line.on_input(mote_id{100}, 2, bytes{0, i});
    REQUIRE(packet);
    const auto frame = serial::decode_raw_packet(*packet);
    REQUIRE(frame);
    CHECK(frame->sequence == i);
    CHECK(frame->destination == serial::raw_end{0x22, 100, false});
    CHECK(to_hex(serial::am_packet_in(*frame)->payload) == "0000000" + std::to_string(i));
  }
  static_cast<void>(line.on_packet(said(100, blink, bytes{1}), start)); // another one in its place
  CHECK(line.on_input(mote_id{100}, 2, bytes{0, 1})->front() == serial::am_dispatch);
}

TEST_CASE("each packet of a line to real motes is taken or dropped for a cause",
          "[gateway][GW-17]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    random_stream rng(seed);
    auto line = real_line();
    auto core = beside(true);
    static_cast<void>(core.start(start));
    std::uint64_t tuples = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto source = static_cast<std::uint16_t>(95 + rng.below(110));
      const auto type = std::array<std::uint8_t, 4>{blink, oscilloscope, 7, 9}[rng.below(4)];
      bytes payload(rng.below(30));
      auto packet = rng.below(2) == 0
                        ? said(source, type, payload)
                        : serial::encode_raw({0xffff, source, 0x22, type, payload}, 1);
      if (rng.below(4) == 0)
        packet[rng.below(packet.size())] = static_cast<std::uint8_t>(rng.below(256));
      if (rng.below(8) == 0)
        packet.resize(rng.below(packet.size() + 1));
      const auto now = start + std::chrono::milliseconds(10 * i);
      if (const auto all = line.on_packet(packet, now))
        for (const auto& text : texts_of_plain(core, *all, now))
          tuples += text.find(".output.") != std::string::npos ? 1 : 0;
    }
    const auto& x = line.counters();
    CHECK(x.packets == 2000);
    CHECK(x.taken + sum(x.dropped) == 2000);
    CHECK(x.taken > 100);
    CHECK(tuples == x.taken);
    for (const auto mote : core.devices())
      CHECK((mote.value >= 100 && mote.value <= 199));
  }
}

TEST_CASE("a mote's address may stand in the payload", "[gateway][GW-17]") {
  // Programs at a serial line leave the source 0 (docs/tinyos.md 1.2); of CTP it is the last hop.
  constexpr std::uint8_t ctp = 0x71;
  plain_line_config config;
  config.motes.rules = {
      {.am_type = oscilloscope, .first = 1, .last = 99, .type = 902, .id_offset = 4},
      {.am_type = oscilloscope, .first = 100, .last = 199, .type = 904, .channel = 2},
      {.am_type = ctp, .first = 1, .last = 99, .type = 903, .id_offset = 4},
      {.am_type = 137, .first = 0, .last = 0, .type = 905},
  };
  plain_line line(config);
  auto core = beside(false);
  static_cast<void>(core.start(start));
  const auto texts_of_packet = [&](const bytes& packet) {
    const auto all = line.on_packet(packet, start);
    return all ? texts_of_plain(core, *all, start) : std::vector<std::string>();
  };
  const auto osc = from_hex("0001 01f4 0007 0003 0001 0002").value();
  auto tuples = texts_of_packet(said(0, oscilloscope, osc));
  CHECK(has(tuples, "devices={7}"));
  CHECK(has(tuples, "devices.7.type=00000386"));
  CHECK(has(tuples, "devices.7.output.1=" + to_hex(osc)));
  // The second rule's mote, whose payload says nothing that the first one takes.
  CHECK(has(texts_of_packet(said(150, oscilloscope, bytes{1})), "devices.150.output.2=01"));
  // THL 2, ETX 300, origin 8, sequence 5, collection 0x93, over mote 3.
  const auto data = from_hex("0002 012c 0008 05 93 cafe").value();
  CHECK(has(texts_of_packet(serial::encode_raw({1, 3, 0x22, ctp, data}, 1)), "devices={7,8,150}"));
  CHECK(has(texts_of_packet(said(0, 137, bytes{0, 42})), "devices.0.output.1=002a"));
  CHECK(core.devices().front() == mote_id{0});

  // Too short for an address, nobody's, and of no mote of a rule.
  CHECK(texts_of_packet(said(0, oscilloscope, bytes{0, 1, 1, 0xf4, 0})).empty());
  CHECK(texts_of_packet(said(0, oscilloscope, from_hex("0001 01f4 ffff").value())).empty());
  CHECK(texts_of_packet(said(0, ctp, from_hex("0002 012c 0100").value())).empty());
  CHECK(texts_of_packet(said(5, 137, bytes{0, 42})).empty());
  CHECK(line.counters().packets == 8);
  CHECK(line.counters().taken == 4);
  CHECK(line.counters().dropped == std::map<std::string, std::uint64_t>{{"no_rule", 4}});
}

TEST_CASE("what no rule of a sink's line knows counts, but for what the sink itself says",
          "[gateway][GW-17]") {
  plain_line line; // without any rule
  CHECK(!line.on_packet(said(100, blink, bytes{1}), start));
  CHECK(!line.on_packet(serial::encode_raw({0xffff, 7, 0x22, 7, {}}, 1), start));
  for (const auto type : {network::am::sink_event, network::am::to_gateway, network::am::packet})
    CHECK(!line.on_packet(said(2, type, bytes{1}), start));
  CHECK(!line.on_packet(bytes{0, 1}, start)); // no packet: its port counts it
  CHECK(line.counters().packets == 2);
  CHECK(line.counters().dropped == std::map<std::string, std::uint64_t>{{"no_rule", 2}});
}

TEST_CASE("a range is of the addresses that the payload has", "[gateway][GW-17]") {
  plain_line_config config;
  config.motes.rules = {{.am_type = 7, .first = 100, .last = 199, .type = 1, .id_offset = 0}};
  config.range = address_range{100, 199};
  plain_line line(config);
  CHECK(line.on_packet(said(0, 7, bytes{0, 100}), start));
  CHECK(!line.on_packet(said(100, 7, bytes{0, 99}), start));
  CHECK(!line.on_packet(said(100, 8, bytes{0, 100}), start));
  CHECK(line.counters().dropped ==
        std::map<std::string, std::uint64_t>{{"no_rule", 1}, {"out_of_range", 1}});
}

TEST_CASE("a lost line to real motes leaves them listed, and nobody leaves because of it",
          "[gateway][GW-15][GW-17]") {
  auto line = real_line();
  auto core = beside(true);
  static_cast<void>(core.start(start));
  const auto first =
      texts_of_plain(core, *line.on_packet(said(100, blink, bytes{1}), start), start);
  CHECK(has(first, "devices.100.status=listed 0.000000"));
  line.on_presence(false, start + 5s);
  CHECK(has(texts_of(core.on_plain_line_lost(start + 5s)), "devices.100.status=stale 5.000000"));
  CHECK(!line.deadline());
  CHECK(line.on_time(start + 35s).empty());
  line.on_presence(true, start + 35s);
  CHECK(line.deadline() == start + 45s);
  const auto again = line.on_packet(said(100, blink, bytes{2}), start + 36s);
  REQUIRE(again);
  CHECK(again->size() == 1); // it does not join again
  CHECK(texts_of_plain(core, *again, start + 36s) ==
        std::vector<std::string>{"devices.100.status=listed 36.000000", "devices.100.output.1=02"});
  CHECK(core.devices() == std::vector{mote_id{100}});
  CHECK(line.on_time(start + 46s).size() == 1); // later it is silent
}

TEST_CASE("what a forwarder has taken is not sent while nothing comes from behind it",
          "[gateway][GW-15][GW-17]") {
  for (const bool is_forwarded : {false, true}) {
    CAPTURE(is_forwarded);
    auto line = real_line();
    gateway_config config;
    config.island = island_id{20};
    config.has_real_line = true;
    config.is_forwarded = is_forwarded;
    gateway::gateway core(config, random_stream(1));
    static_cast<void>(core.start(start));
    const auto hear = [&](instant now) {
      static_cast<void>(
          texts_of_plain(core, *line.on_packet(said(100, blink, bytes{1}), now), now));
    };
    std::uint64_t number = 0;
    const auto ends = [&](instant now) {
      static_cast<void>(core.on_input(mote_id{100}, 2, bytes{0, 7}, now));
      const auto all = texts_of(core.on_plain_done(++number, true, now));
      return all.at(0).substr(all.at(0).rfind(' ') + 1);
    };
    const std::string silent = is_forwarded ? "failed" : "sent";
    hear(start);
    CHECK(ends(start + 25s - 1ns) == "sent");
    CHECK(ends(start + 25s) == silent);
    hear(start + 40s);
    CHECK(ends(start + 40s) == "sent");
    CHECK(ends(start + 40s + 80s - 1ns) == "sent"); // twice as long as it has been silent before
    CHECK(ends(start + 40s + 80s) == silent);
  }
}

TEST_CASE("a sink and a line to real motes do not speak for each other",
          "[gateway][GW-15][GW-17]") {
  auto line = real_line();
  auto core = beside(true);
  static_cast<void>(core.start(start));
  const auto joined = [](std::uint16_t mote) {
    return sink_packet{
        mote_id{mote}, network::am::sink_event,
        encode(network::sink_event(network::mote_joined{mote_id{mote}, 1, 101, {}}))};
  };
  const auto from_sink = [&](const sink_packet& x, instant now) {
    return texts_of(core.on_packet(x.source, x.am_type, x.payload, now));
  };
  const auto real = texts_of_plain(core, *line.on_packet(said(100, blink, bytes{1}), start), start);
  CHECK(has(real, "devices={100}"));
  CHECK(!has(real, "devices.line=up 0.000000")); // the sink has sent nothing
  const auto simulated = from_sink(joined(2), start + 1s);
  CHECK(has(simulated, "devices={2,100}"));
  CHECK(has(simulated, "devices.line=up 1.000000"));

  // A roster without the real mote asks nothing about it.
  network::roster roster;
  roster.number = 1;
  roster.pages = 1;
  roster.entries = {{mote_id{2}, 1}};
  const auto after = core.on_packet(mote_id{1}, network::am::sink_event,
                                    encode(network::sink_event(roster)), start + 2s);
  for (const auto& output : after)
    CHECK(!std::holds_alternative<to_sink>(output));

  // The real motes go on, but the sink is silent: its motes are stale, they are not.
  instant now = start + 2s;
  for (; now < start + 30s; now += 1s) {
    static_cast<void>(texts_of_plain(core, *line.on_packet(said(100, blink, bytes{1}), now), now));
    const auto texts = texts_of(core.on_time(now));
    CHECK(!has(texts, "devices.100.status=stale " + to_text(now)));
    CHECK(has(texts, "devices.2.status=stale " + to_text(now)) == (now == start + 27s));
  }

  // Messages for a real mote go to no sink; they end by being sent.
  const auto asked = core.on_input(mote_id{100}, 2, bytes{0, 7}, now);
  CHECK(has(texts_of(asked), "devices.100.input.2.status=1 pending"));
  const auto found = std::find_if(asked.begin(), asked.end(), [](const auto& x) {
    return std::holds_alternative<to_plain>(x);
  });
  REQUIRE(found != asked.end());
  const auto& x = std::get<to_plain>(*found);
  CHECK(x.mote == mote_id{100});
  CHECK(x.channel == 2);
  CHECK(to_hex(x.octets) == "0007");
  CHECK(texts_of(core.on_plain_done(x.number, true, now)) ==
        std::vector<std::string>{"devices.100.input.2.status=1 sent"});
  CHECK(core.on_plain_done(x.number, true, now).empty()); // once
  static_cast<void>(core.on_input(mote_id{100}, 2, bytes{0, 8}, now));
  CHECK(texts_of(core.on_plain_done(x.number + 1, false, now)) ==
        std::vector<std::string>{"devices.100.input.2.status=2 failed"});
  CHECK(core.counters().plain_inputs == 2);
}

TEST_CASE("frames of another layout are messages by the octets that they have",
          "[gateway][GW-17]") {
  plain_line_config config;
  config.motes.rules = {
      {.type = 907, .channel = 4, .pattern = bytes{'t', '='}, .pattern_offset = 1},
      {.am_type = blink, .type = 901, .pattern = bytes{0xaa}},
  };
  plain_line line(config);
  auto core = beside(false);
  static_cast<void>(core.start(start));
  const auto texts_of_packet = [&](const bytes& packet) {
    const auto all = line.on_packet(packet, start);
    return all ? texts_of_plain(core, *all, start) : std::vector<std::string>();
  };
  // Data in one PAN, both addresses long, from mote 0x0007; its payload is `!t=21`.
  const auto from_long = [](const char* payload) {
    return serial::wrap_raw(
        from_hex(std::string("41dc 01 cdab ffffffffffffffff 0700070007000700") + payload).value());
  };
  const auto found = texts_of_packet(from_long("21743d3231"));
  CHECK(has(found, "devices.7.type=0000038b"));
  CHECK(has(found, "devices.7.output.4=21743d3231"));
  CHECK(texts_of_packet(from_long("743d3231")).empty());   // elsewhere
  CHECK(texts_of_packet(from_long("21743d")).size() == 1); // its last octet is the last
  CHECK(texts_of_packet(from_long("2174")).empty());
  CHECK(texts_of_packet(from_long("")).empty());
  // No source, and secured data.
  CHECK(texts_of_packet(serial::wrap_raw(from_hex("4118 01 cdab ffff 21743d").value())).empty());
  CHECK(
      texts_of_packet(serial::wrap_raw(from_hex("4988 01 cdab ffff 0800 21743d").value())).empty());
  // A packet of TinyOS needs its AM type as well as the pattern.
  CHECK(has(texts_of_packet(said(9, blink, bytes{0xaa, 1})), "devices.9.output.1=aa01"));
  CHECK(texts_of_packet(said(9, blink, bytes{0xab, 1})).empty());
  CHECK(texts_of_packet(said(9, 8, bytes{'!', 't', '='})).empty());
  CHECK(line.counters().taken == 3);
  CHECK(line.counters().dropped ==
        std::map<std::string, std::uint64_t>{{"no_data", 4}, {"no_rule", 2}});
}

TEST_CASE("frames of another layout do not change the form of packets to motes",
          "[gateway][GW-17]") {
  plain_line_config config;
  config.motes.rules = {{.type = 907, .pattern = bytes{1}},
                        {.am_type = 7, .type = 901, .input = 2, .input_am_type = 7}};
  plain_line line(config);
  REQUIRE(line.on_packet(said(5, 7, bytes{1}), start));
  REQUIRE(line.on_packet(serial::wrap_raw(from_hex("4188 01 cdab ffff 0600 01").value()), start));
  const auto packet = line.on_input(mote_id{5}, 2, bytes{9});
  REQUIRE(packet);
  CHECK(packet->front() == serial::am_dispatch);
}
