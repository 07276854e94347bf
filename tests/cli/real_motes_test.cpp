// Real motes: a base station on a pseudo-terminal beside a simulated sink, a cable that makes
// errors and is pulled.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "edge.hpp"
#include "serial/frame.hpp"
#include "serial/packet.hpp"
#include "serial/raw_packet.hpp"
#include "support/shell.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

constexpr std::uint8_t blink = 6;
constexpr std::uint32_t baud = 57600;

bytes said(std::uint16_t source, std::uint8_t am_type, const bytes& payload) {
  return serial::encode(serial::am_packet{serial::am_broadcast, source, 0x22, am_type, payload});
}

/// Of BlinkToRadio.
bytes blinks(std::uint16_t source, std::uint16_t count) {
  const auto high = [](std::uint16_t x) { return static_cast<std::uint8_t>(x >> 8); };
  const auto low = [](std::uint16_t x) { return static_cast<std::uint8_t>(x & 0xff); };
  return said(source, blink, bytes{high(source), low(source), high(count), low(count)});
}

/// Ecology, peer and proxies of a kitchen with simulated motes 2 and 3; what its real motes say is
/// to be added, and `[[island]]` is open.
std::string kitchen(const std::string& ecology) {
  return "[ecology]\nname = \"mixed\"\n" + ecology + R"(
[[peer]]
name = "pc"
id = 1
links = ["inproc://kitchen-gateway"]
[[peer.apps]]
app = "proxy_manager"
[[peer.apps]]
app = "rules"
retry = "0s"
rules = [
  { when = "kitchen.lamp.count", above = 5, write = "kitchen.fan-3.switch", then = "on" },
  { when = "kitchen.climate-2.temperature", above = 24, write = "kitchen.lamp.leds", then = "7", otherwise = "1" },
]
[mote_type.climate]
type = 101
transducers.temperature = { model = "sine", mean = 24, amplitude = 3, period = "10s", resolution = 0.1 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "1s" }]
[mote_type.fan]
type = 102
actuators = [{ name = "fan", kind = "relay", initial = "off" }]
apps = [{ app = "actuator", actuator = "fan" }]
[[proxy]]
name = "climate"
types = [101]
[[proxy.field]]
name = "temperature"
channel = 1
scale = 0.1
[[proxy]]
name = "fan"
types = [102]
[[proxy.field]]
name = "state"
channel = 2
encoding = "u8"
[[proxy.input]]
name = "switch"
channel = 2
words = { on = "01", off = "00" }
[[proxy]]
name = "blinker"
types = [901]
[[proxy.field]]
name = "count"
channel = 1
encoding = "u16"
offset = 2
decimals = 0
[[proxy.input]]
name = "leds"
channel = 2
encoding = "u16"
[[island]]
id = 20
name = "kitchen"
plain = [{ am_type = 6, type = 901, input = 2, input_form = "blink" }]
mote = [
  { id = 2, type = "climate", position_m = [1, 0] },
  { id = 3, type = "fan", position_m = [0, 1] },
]
)";
}

const json& island_of(const json& report) {
  return report["islands"].at(0);
}

std::uint64_t total(const json& by_cause) {
  std::uint64_t sum = 0;
  for (const auto& each : by_cause)
    sum += each.get<std::uint64_t>();
  return sum;
}

void check_real_balance(const json& real) {
  CHECK(real["packets"].get<std::uint64_t>() ==
        real["taken"].get<std::uint64_t>() + total(real["dropped"]));
  CHECK(real["inputs"].get<std::uint64_t>() == real["inputs_sent"].get<std::uint64_t>() +
                                                   total(real["inputs_failed"]) +
                                                   real["inputs_open"].get<std::uint64_t>());
}

const json& proxy_of(const json& report, const std::string& name) {
  for (const auto& each : report["proxies"])
    if (each["proxy"] == name)
      return each;
  FAIL("no proxy " + name);
  return report;
}

/// What has been recorded of a line.
std::vector<serial::recorded_frame> line_of(const edge& where, const std::string& name,
                                            const std::string& line, serial::direction towards) {
  auto all = where.recorded(name);
  std::erase_if(all, [&](const auto& x) { return x.island != line || x.towards != towards; });
  return all;
}

/// TinyOS's BaseStation, as its serial port shows it: says what motes send, takes what is for them.
class base_station {
public:
  base_station(edge& where, std::string link) : edge_(where), link_(std::move(link)) { plug(); }

  void plug() {
    auto found = io::pseudo_terminal::open(edge_.loop, link_, 1U << 20U);
    REQUIRE(std::holds_alternative<io::pseudo_terminal>(found));
    pty_.emplace(std::get<io::pseudo_terminal>(std::move(found)));
    pty_->start({[this](byte_view x) { on_octets(x); }, [this](bool x) { is_heard = x; }});
  }

  void unplug() {
    pty_.reset();
    is_heard = false;
  }

  void say(const bytes& packet) {
    write(serial::encode(serial::frame{serial::frame_type::packet, 0, packet}));
  }

  /// To the PC; one octet in `one_bad_in` is another then.
  void write(bytes octets) {
    if (!pty_)
      return;
    for (auto& x : octets)
      if (one_bad_in > 0 && rng_.below(one_bad_in) == 0)
        x = static_cast<std::uint8_t>(x ^ (1 + rng_.below(255)));
    const auto size = octets.size();
    if (pty_->send(payload(std::move(octets))))
      written += size;
  }

  [[nodiscard]] bool was_told(std::uint16_t mote, const std::string& hex) const {
    return std::ranges::any_of(
        told, [&](const auto& x) { return x.destination == mote && to_hex(x.payload) == hex; });
  }

  bool is_heard = false; ///< by a program
  bool acks = true;
  std::uint64_t one_bad_in = 0;        ///< 0: none
  std::uint64_t written = 0;           ///< octets
  std::vector<serial::am_packet> told; ///< active messages for motes
  std::vector<bytes> packets;          ///< all that has come

private:
  void on_octets(byte_view octets) {
    for (const auto octet : octets) {
      const auto x = decoder_.on_octet(octet);
      if (!x || x->type != serial::frame_type::packet_with_ack)
        continue;
      packets.push_back(x->packet);
      if (const auto message = serial::decode_any_packet(x->packet))
        told.push_back(*message);
      if (acks)
        write(serial::encode(serial::frame{serial::frame_type::ack, x->sequence, {}}));
    }
  }

  edge& edge_;
  std::string link_;
  std::optional<io::pseudo_terminal> pty_;
  serial::frame_decoder decoder_;
  random_stream rng_{11};
};

} // namespace

TEST_CASE("real motes from a recording and simulated ones are one island",
          "[cli][serial][GW-17][ACT-08]") {
  edge x;
  std::string recording = "# rubicon serial recording 1\n";
  const auto record = [&](int at, const bytes& packet) {
    recording += std::to_string(at) + ".0 kitchen/real up 45 " + to_hex(packet) + '\n';
  };
  for (int at = 3; at < 58; ++at) {
    record(at, blinks(100, static_cast<std::uint16_t>(at - 3)));
    record(at, blinks(199, 1000));
    record(at, serial::encode_raw({0xffff, 150, 0x22, blink, bytes{0, 150, 0, 9}}, 1));
    record(at, blinks(99, 1));                // one below the range
    record(at, blinks(200, 1));               // one above it
    record(at, blinks(2, 1));                 // a real mote with a simulated one's address
    record(at, said(100, 7, bytes{1}));       // of no rule
    record(at, bytes{0, 0xff, 0xff, 0, 100}); // cut off
    record(at, bytes{2, 5, 2, 0, 0x12});      // an acknowledgement of the radio
  }
  x.write("sink.txt", recording);
  x.write(
      "mixed.toml",
      kitchen("duration = \"60s\"\n") +
          "real = { replay = \"sink.txt\", first = 100, last = 199, mote = [{ id = 100, name = "
          "\"lamp\" }] }\n[[fault]]\nat = \"30500ms\"\nkind = \"unplug\"\nisland = \"kitchen\"\n"
          "for = \"5s\"\n");
  for (int seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const auto done =
        test::shell(binary + " run " + x.file("mixed.toml") + " --json --log off --seed " +
                    std::to_string(seed) + " --record-serial " + x.file("again.txt"));
    REQUIRE(done.status == 0);
    const auto report = json::parse(done.out);
    CHECK(report["violations"].empty());
    const auto& real = island_of(report)["real"];
    check_real_balance(real);
    // 55 times, less the five of the unplugged cable.
    CHECK(real["packets"] == 50 * 9);
    CHECK(real["taken"] == 50 * 3);
    CHECK(real["dropped"] ==
          json{{"malformed", 50}, {"no_data", 50}, {"no_rule", 50}, {"out_of_range", 150}});
    CHECK(proxy_of(report, "kitchen.lamp")["values"]["count"] == "54");
    CHECK(proxy_of(report, "kitchen.150")["values"]["count"] == "9");
    CHECK(proxy_of(report, "kitchen.199")["values"]["count"] == "1000");
    CHECK(proxy_of(report, "kitchen.fan-3")["values"]["state"] == "1.0");
    CHECK(proxy_of(report, "kitchen.fan-3")["actuations"]["acknowledged"] == 1);
    const auto& lamp = proxy_of(report, "kitchen.lamp")["actuations"];
    CHECK(lamp["sent"].get<int>() >= 8); // twice in each of six periods, less those of the cable
    CHECK(lamp["acknowledged"] == 0);
    CHECK(real["inputs_sent"] == lamp["sent"]);
    for (const auto& mote : island_of(report)["motes"])
      CHECK(mote["joined"] == true);
  }
  std::set<std::string> leds;
  for (const auto& each : line_of(x, "again", "kitchen/real", serial::direction::to_mote)) {
    const auto packet = serial::decode_any_packet(each.what.packet); // raw: it says such, too
    REQUIRE(packet);
    CHECK(packet->destination == 100);
    CHECK(packet->am_type == blink);
    leds.insert(to_hex(packet->payload));
  }
  CHECK(leds == std::set<std::string>{"00000001", "00000007"});
  for (const auto& each : line_of(x, "again", "kitchen", serial::direction::to_mote))
    if (const auto packet = serial::decode_am_packet(each.what.packet))
      CHECK((packet->destination < 100 || packet->destination > 199));
}

TEST_CASE("real motes are devices again after whatever fails beside them",
          "[cli][serial][GW-15][GW-17]") {
  edge x;
  std::string recording = "# rubicon serial recording 1\n";
  for (std::uint16_t at = 3; at < 58; ++at)
    for (const auto mote : std::initializer_list<std::uint16_t>{99, 100, 199, 200})
      recording += std::to_string(at) + ".0 kitchen/real up 45 " + to_hex(blinks(mote, at)) + '\n';
  x.write("sink.txt", recording);
  const auto octets = serial::encode(serial::frame{serial::frame_type::packet, 0, blinks(99, 1)});
  for (const std::string fault : {"kind = \"kill\"\npeer = \"kitchen-gateway\"\nfor = \"7s\"\n",
                                  "kind = \"crash\"\nsink = \"kitchen\"\nfor = \"7s\"\n",
                                  "kind = \"kill\"\npeer = \"pc\"\nfor = \"7s\"\n"}) {
    x.write("mixed.toml",
            kitchen("duration = \"60s\"\n") +
                "real = { replay = \"sink.txt\", first = 100, last = 199, mote = [{ id = 100, name "
                "= \"lamp\" }] }\n[[fault]]\nat = \"20500ms\"\n" +
                fault);
    const bool is_gateway = fault.find("gateway") != std::string::npos;
    for (int seed = 1; seed <= 20; ++seed) {
      CAPTURE(fault, seed);
      const auto done = test::shell(binary + " run " + x.file("mixed.toml") +
                                    " --json --log off --seed " + std::to_string(seed));
      REQUIRE(done.status == 0);
      const auto report = json::parse(done.out);
      CHECK(report["violations"].empty());
      const auto& real = island_of(report)["real"];
      check_real_balance(real);
      CHECK(real["packets"] == (is_gateway ? 48 : 55) * 4);
      CHECK(real["taken"] == (is_gateway ? 48 : 55) * 2);
      // What nobody could hear is known as well.
      const auto& lost = island_of(report)["serial"]["lost"];
      if (is_gateway)
        CHECK(lost["end_off_octets"].get<std::size_t>() >= 7 * 4 * octets.size());
      CHECK(proxy_of(report, "kitchen.lamp")["status"] == "active");
      CHECK(proxy_of(report, "kitchen.lamp")["values"]["count"] == "57");
      CHECK(proxy_of(report, "kitchen.199")["values"]["count"] == "57");
    }
  }
}

TEST_CASE("a base station is plugged in, pulled, and plugged in again beside a simulated sink",
          "[cli][serial][GW-15][GW-17]") {
  edge x;
  x.write("mixed.toml",
          kitchen("mode = \"wall\"\nduration = \"5min\"\n") + "real = { device = \"" +
              x.file("tty") +
              "\", first = 100, last = 199, mote = [{ id = 100, name = \"lamp\" }] }\n"
              "keep_alive = \"2s\"\n");
  const auto mixed = x.start("mixed"); // there is no base station yet
  base_station base(x, x.file("tty"));
  std::uint16_t count = 0;
  auto next = std::chrono::steady_clock::now();
  const auto blinks_until = [&](const std::function<bool()>& done) {
    run(x.loop, [&] {
      for (; std::chrono::steady_clock::now() >= next; next += 100ms) {
        base.say(blinks(100, count++));
        base.say(blinks(200, 1));
      }
      return done();
    });
  };
  const auto heard = [&] {
    return line_of(x, "mixed", "kitchen/real", serial::direction::to_pc).size();
  };
  blinks_until([&] { return heard() > 40 && base.was_told(100, "00000007"); });
  const auto before = heard();
  base.unplug();
  const auto pulled = std::chrono::steady_clock::now();
  run(x.loop, [&] { return std::chrono::steady_clock::now() >= pulled + 5s; });
  base.plug();
  next = std::chrono::steady_clock::now();
  const auto told = base.told.size();
  blinks_until([&] { return heard() > before + 40 && base.told.size() > told; });

  const auto report = mixed->report();
  CHECK(report["violations"].empty());
  const auto& real = island_of(report)["real"];
  check_real_balance(real);
  CHECK(real["packets"].get<std::size_t>() >= 70);
  CHECK(real["dropped"]["out_of_range"].get<std::size_t>() >= 35);
  CHECK(real["inputs_sent"].get<int>() >= 2);
  const auto& lamp = proxy_of(report, "kitchen.lamp");
  CHECK(lamp["status"] == "active");
  // It has joined once: who is behind a cable that is pulled has not left.
  std::size_t joins = 0;
  for (const auto& event : report["event_log"])
    joins += event.dump().find("kitchen/lamp") != std::string::npos ? 1 : 0;
  CHECK(joins == 1);
}

TEST_CASE("a noisy line to real motes brings what the noise left whole, and nothing else",
          "[cli][serial][GW-16][GW-17]") {
  edge x;
  x.write("mixed.toml",
          kitchen("mode = \"wall\"\nduration = \"5min\"\n") + "real = { device = \"" +
              x.file("tty") +
              "\", first = 100, last = 199, mote = [{ id = 100, name = \"lamp\" }] }\n");
  const auto mixed = x.start("mixed");
  base_station base(x, x.file("tty"));
  run(x.loop, [&] { return base.is_heard; });
  base.one_bad_in = 100;

  // As fast as the line: 10 bit times an octet.
  constexpr auto length = 8s;
  constexpr std::size_t line_octets = std::size_t{length.count()} * baud / 10;
  const auto begin = std::chrono::steady_clock::now();
  std::set<bytes> sent;
  std::uint64_t frames = 0;
  std::uint16_t count = 0;
  run(x.loop, [&] {
    const auto passed =
        std::min<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - begin, length);
    const auto due = static_cast<std::uint64_t>(passed.count()) * (baud / 10) / 1'000'000'000;
    while (base.written < due) {
      bytes rest(24);
      rest.insert(rest.begin(), {0, 100, static_cast<std::uint8_t>(count >> 8),
                                 static_cast<std::uint8_t>(count & 0xff)});
      ++count;
      ++frames;
      const auto packet = said(100, blink, rest);
      sent.insert(packet);
      base.say(packet);
    }
    return passed == length;
  });
  const auto whole = [&] {
    std::vector<bytes> all;
    for (auto& each : line_of(x, "mixed", "kitchen/real", serial::direction::to_pc))
      if (each.what.type == serial::frame_type::packet)
        all.push_back(std::move(each.what.packet));
    return all;
  };
  base.one_bad_in = 0;
  for (int i = 0; i < 2; ++i) // the first may end a frame that the noise has opened
    base.say(blinks(101, 1));
  run(x.loop, [&] {
    const auto all = whole();
    return !all.empty() && all.back() == blinks(101, 1);
  });

  const auto report = mixed->report();
  CHECK(report["violations"].empty());
  const auto& real = island_of(report)["real"];
  check_real_balance(real);
  const auto come = whole();
  const auto ours = static_cast<std::uint64_t>(
      std::ranges::count_if(come, [&](const auto& packet) { return sent.contains(packet); }));
  const auto strangers = std::ranges::count_if(
      come, [&](const auto& packet) { return !sent.contains(packet) && packet != blinks(101, 1); });
  CHECK(strangers == 0); // no corrupt frame is passed up
  CHECK(frames > 1000);
  CHECK(real["packets"] == come.size());
  // Octets in packets that have come, of those that the line could have carried in that time.
  CHECK(ours * (28 + 8 + 5) * 2 > line_octets);
  CHECK(ours < frames);
}

TEST_CASE("a cable with an error in a hundred octets carries more than half of its rate",
          "[cli][serial][GW-16]") {
  edge x;
  // Eight motes say more than the line can carry.
  std::string motes;
  for (int i = 2; i < 10; ++i)
    motes += "{ id = " + std::to_string(i) + ", type = \"climate\", position_m = [" +
             std::to_string(i % 3) + ", " + std::to_string(i / 3) + "] },";
  x.write("mote.toml", "[ecology]\nname = \"motes\"\nmode = \"wall\"\nduration = \"5min\"\n"
                       "[mote_type.climate]\ntype = 101\n"
                       "transducers.temperature = { model = \"constant\", value = 20 }\n"
                       "apps = [{ app = \"sampler\", transducers = [\"temperature\"], "
                       "every = \"250ms\" }]\n"
                       "[[island]]\nid = 20\nname = \"kitchen\"\n"
                       "serial = { baud = 4800, pty = \"" +
                           x.file("sink") + "\" }\nmote = [" + motes + "]\n");
  x.write_gateway("serial = { baud = 4800, device = \"" + x.file("tty") + "\" }\n");
  const auto motes_run = x.start("mote");
  bad_cable cable(x);
  cable.plug();
  const auto gateway = x.start("gateway");
  run(x.loop, [&] { return x.up("gateway") >= 40; }); // all have joined
  const auto first = x.up("mote");
  run(x.loop, [&] { return x.up("mote") >= first + 250; });
  const auto at_gateway = gateway->report();
  const auto at_motes = motes_run->report();
  CHECK(at_gateway["violations"].empty());
  CHECK(at_motes["violations"].empty());

  // What left the sink, from there on, by its own clock; and what of it came whole.
  const auto sent = x.packets("mote", serial::direction::to_pc);
  auto come = x.packets("gateway", serial::direction::to_pc);
  CHECK(strange(come, sent) == 0);
  std::multiset<bytes> whole(come.begin(), come.end());
  const auto all = line_of(x, "mote", "kitchen", serial::direction::to_pc);
  instant begin;
  instant end;
  std::size_t offered = 0;
  std::size_t arrived = 0;
  std::size_t number = 0;
  for (const auto& each : all) {
    if (each.what.packet.empty())
      continue;
    const auto size = serial::encode(each.what).size();
    if (++number < first)
      continue;
    if (number == first) {
      begin = each.at;
      continue;
    }
    end = each.at;
    offered += size;
    if (const auto found = whole.find(each.what.packet); found != whole.end()) {
      arrived += size;
      whole.erase(found);
    }
  }
  const auto seconds = std::chrono::duration<double>(end - begin).count();
  const auto line_octets = seconds * 480;
  CHECK(static_cast<double>(offered) > 0.7 * line_octets);
  CHECK(static_cast<double>(offered) < 1.1 * line_octets);
  CHECK(static_cast<double>(arrived) > 0.5 * line_octets);
}

TEST_CASE("after half a minute without a cable all goes on, and each message has its outcome",
          "[cli][serial][GW-15][GW-17]") {
  edge x;
  x.write("mote.toml", "[ecology]\nname = \"motes\"\nmode = \"wall\"\nduration = \"20min\"\n"
                       "[mote_type.climate]\ntype = 101\n"
                       "transducers.temperature = { model = \"constant\", value = 20 }\n"
                       "apps = [{ app = \"sampler\", transducers = [\"temperature\"], "
                       "every = \"1s\", reliable = true }]\n"
                       "[[island]]\nid = 20\nname = \"kitchen\"\nserial = { pty = \"" +
                           x.file("sink") +
                           "\" }\n"
                           "mote = [{ id = 2, type = \"climate\", position_m = [1, 0] }, "
                           "{ id = 3, type = \"climate\", position_m = [0, 1] }]\n");
  x.write_gateway("serial.device = \"" + x.file("tty") + "\"\n");
  const auto fast = [&](const std::string& name) {
    return std::make_unique<program>(
        x.loop, std::vector<std::string>{"run", x.file(name + ".toml"), "--json", "--log", "off",
                                         "--speed", "5", "--record-serial", x.file(name + ".txt")});
  };
  const auto gateway = fast("gateway");
  const auto motes = fast("mote");
  bad_cable cable(x, 0);
  cable.plug();
  run(x.loop, [&] { return x.up("gateway") >= 40; });
  const auto pulled_at = x.recorded("mote").back().at;
  cable.unplug();
  run(x.loop, [&] { return x.recorded("mote").back().at >= pulled_at + 32s; });
  const auto before = x.up("gateway");
  cable.plug();
  run(x.loop, [&] { return x.up("gateway") >= before + 60; });

  const auto at_motes = motes->report();
  const auto at_gateway = gateway->report();
  CHECK(at_gateway["violations"].empty());
  CHECK(at_motes["violations"].empty());
  const auto& messages = island_of(at_motes)["messages"];
  const auto count = [&](const char* key) { return messages[key].get<std::uint64_t>(); };
  CHECK(count("reliable_sent") ==
        count("reliable_acked") + count("reliable_failed") + count("reliable_open"));
  CHECK(count("reliable_failed") > 0); // those of the gap, and their motes know it
  CHECK(count("reliable_acked") > 30);
  CHECK(count("offered") == count("reliable_sent") + total(messages["refused"]));
  // Nobody has joined twice, or left.
  std::map<std::string, int> joined;
  for (const auto& event : at_gateway["event_log"]) {
    const auto text = event.dump();
    CHECK(text.find("left") == std::string::npos);
    if (text.find("joined") != std::string::npos)
      ++joined[text.substr(text.find("kitchen/"))];
  }
  CHECK(joined.size() == 2);
  for (const auto& [who, times] : joined)
    CHECK(times == 1);
}

TEST_CASE("frames of a base station that forwards them raw are shown as what they are",
          "[cli][serial][GW-17]") {
  edge x;
  base_station base(x, x.file("tty"));
  const auto listen = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"serial", "listen", x.file("tty"), "--count", "4"};
    words.insert(words.end(), more.begin(), more.end());
    program listener(x.loop, words);
    run(x.loop, [&] { return base.is_heard; });
    base.say(from_hex("020f418811 2200ffff03003f060001").value());
    base.say(from_hex("0205020012").value());
    base.say(from_hex("021b01cc05 2200 0102030405060708 2300 1112131415161718 aabb").value());
    base.say(from_hex("0210418811 2200ffff03003f060001").value()); // not as long as it says
    listener.await_end();
    CHECK(listener.end->status == 0);
    return listener.out;
  };
  const auto text = listen({});
  CHECK(text.find("3 -> all  802.15.4 data, sequence 17, pan 0x0022  type 6  group 0x22  0001  "
                  "count 1\n") != std::string::npos);
  CHECK(text.find("- -> -  802.15.4 ack, sequence 18\n") != std::string::npos);
  CHECK(
      text.find("0x1817161514131211 -> 0x0807060504030201  802.15.4 data, sequence 5, pan 0x0022, "
                "from pan 0x0023  aabb\n") != std::string::npos);
  CHECK(text.find("no active message  0210418811") != std::string::npos);
  const auto lines = listen({"--json"});
  const auto first = json::parse(lines.substr(0, lines.find('\n')));
  CHECK(first["dispatch"] == 2);
  CHECK(first["frame"] == "data");
  CHECK(first["sequence"] == 17);
  CHECK(first["destination"] == 0xffff);
  CHECK(first["destination_pan"] == 0x22);
  CHECK(first["source"] == 3);
  CHECK(first["asks_ack"] == false);
  CHECK(first["type"] == 6);
  CHECK(first["meaning"] == "count 1");
}
