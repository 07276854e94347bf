// Two processes with a cable between them, as a sink and its gateway: a pseudo-terminal, a relay
// that makes errors, a serial forwarder.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/random.hpp"
#include "io/process.hpp"
#include "io/pseudo_terminal.hpp"
#include "io/serial_port.hpp"
#include "io/tcp_connect.hpp"
#include "io/tcp_listener.hpp"
#include "serial/forwarder.hpp"
#include "serial/packet.hpp"
#include "serial/recording.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/shell.hpp"

using namespace rubicon;
using nlohmann::json;

namespace {

const std::string binary = RUBICON_BINARY;

/// Runs the loop until something is so; far too long a wait is a failure.
void run(io::loop& loop, const std::function<bool()>& done) {
  const auto end = std::chrono::steady_clock::now() + 90s;
  while (!done() && std::chrono::steady_clock::now() < end)
    loop.wait_until(std::chrono::steady_clock::now() + 20ms);
  REQUIRE(done());
}

/// A rubicon and all that it says.
struct program {
  program(io::loop& where, std::vector<std::string> words) : loop(where) {
    words.insert(words.begin(), "rubicon");
    auto x = io::process::start(loop, {.program = binary, .words = std::move(words)},
                                {[this](io::process::output from, byte_view octets) {
                                   auto& to = from == io::process::output::out ? out : err;
                                   to += to_string(octets);
                                 },
                                 [this](io::process_end how) { end = how; }});
    if (const auto* why = std::get_if<std::string>(&x))
      FAIL(*why);
    process = std::make_unique<io::process>(std::get<io::process>(std::move(x)));
  }

  void await_end() {
    run(loop, [this] { return end.has_value(); });
  }

  /// Ends a run as Ctrl-C does.
  json report() {
    process->signal(SIGINT);
    await_end();
    INFO(err);
    CHECK(err.empty());
    REQUIRE(end->status == 130);
    return json::parse(out);
  }

  io::loop& loop;
  std::string out;
  std::string err;
  std::optional<io::process_end> end;
  std::unique_ptr<io::process> process;
};

/// The real world of a test: a folder, and a cable.
struct edge {
  edge() {
    write("mote.toml", "[ecology]\nname = \"motes\"\nmode = \"wall\"\nduration = \"5min\"\n"
                       "[mote_type.climate]\ntype = 101\n"
                       "transducers.temperature = { model = \"sine\", mean = 24, amplitude = 3, "
                       "period = \"40s\", resolution = 0.1 }\n"
                       "apps = [{ app = \"sampler\", transducers = [\"temperature\"], "
                       "every = \"200ms\" }]\n"
                       "[[island]]\nid = 20\nname = \"kitchen\"\nserial = { pty = \"" +
                           file("sink") +
                           "\" }\n"
                           "mote = [{ id = 2, type = \"climate\", position_m = [1, 0] }, "
                           "{ id = 3, type = \"climate\", position_m = [0, 1] }]\n");
  }

  [[nodiscard]] std::string file(const std::string& name) const { return folder.file(name); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(file(name)) << text;
  }

  void write_gateway(const std::string& how) const {
    write("gateway.toml", "[ecology]\nname = \"gateway\"\nmode = \"wall\"\nduration = \"5min\"\n"
                          "[[island]]\nid = 20\nname = \"kitchen\"\n" +
                              how);
  }

  std::unique_ptr<program> start(const std::string& name) {
    return std::make_unique<program>(
        loop, std::vector<std::string>{"run", file(name + ".toml"), "--json", "--log", "off",
                                       "--record-serial", file(name + ".txt")});
  }

  /// Whatever has been recorded so far.
  [[nodiscard]] std::vector<serial::recorded_frame> recorded(const std::string& name) const {
    std::vector<serial::recorded_frame> all;
    std::ifstream in(file(name + ".txt"));
    for (std::string line; std::getline(in, line) && !in.eof();)
      if (auto x = serial::read_recorded(line); std::holds_alternative<serial::recorded_frame>(x))
        all.push_back(std::get<serial::recorded_frame>(std::move(x)));
    return all;
  }

  [[nodiscard]] std::vector<bytes> packets(const std::string& name,
                                           serial::direction towards) const {
    std::vector<bytes> found;
    for (auto& x : recorded(name))
      if (x.towards == towards && !x.what.packet.empty())
        found.push_back(std::move(x.what.packet));
    return found;
  }

  [[nodiscard]] std::size_t up(const std::string& name) const {
    return packets(name, serial::direction::to_pc).size();
  }

  test::scratch_folder folder;
  io::loop loop;
};

/// Packets that have come though nobody has sent them.
std::size_t strange(const std::vector<bytes>& come, const std::vector<bytes>& sent) {
  const std::set<bytes> known(sent.begin(), sent.end());
  return static_cast<std::size_t>(
      std::ranges::count_if(come, [&](const bytes& x) { return !known.contains(x); }));
}

/// A cable that changes one octet in a hundred.
class bad_cable {
public:
  explicit bad_cable(edge& where) : edge_(where) {}

  void plug() {
    run(edge_.loop, [this] { return std::filesystem::is_symlink(edge_.file("sink")); });
    auto sink = io::serial_port::open(edge_.loop, edge_.file("sink"), 57600, room);
    auto pc = io::pseudo_terminal::open(edge_.loop, edge_.file("tty"), room);
    REQUIRE(std::holds_alternative<io::serial_port>(sink));
    REQUIRE(std::holds_alternative<io::pseudo_terminal>(pc));
    sink_.emplace(std::get<io::serial_port>(std::move(sink)));
    pc_.emplace(std::get<io::pseudo_terminal>(std::move(pc)));
    sink_->start({[this](byte_view x) { static_cast<void>(pc_->send(spoilt(x))); },
                  [](const std::string&) {}});
    pc_->start({[this](byte_view x) { static_cast<void>(sink_->send(spoilt(x))); }, [](bool) {}});
  }

  void unplug() {
    sink_.reset();
    pc_.reset();
  }

private:
  static constexpr std::size_t room = 4096;

  payload spoilt(byte_view octets) {
    auto out = to_bytes(octets);
    for (auto& x : out)
      if (rng_.below(100) == 0)
        x = static_cast<std::uint8_t>(x ^ (1 + rng_.below(255)));
    return out;
  }

  edge& edge_;
  random_stream rng_{7};
  std::optional<io::serial_port> sink_;
  std::optional<io::pseudo_terminal> pc_;
};

/// Free a moment ago.
std::uint16_t free_port(io::loop& loop) {
  const auto x =
      io::tcp_listener::open(loop, "127.0.0.1", 0, [](io::tcp_stream, const ipv4_address&) {});
  return std::get<io::tcp_listener>(x).port();
}

} // namespace

TEST_CASE(
    "two processes are an island with a bad cable between them, which is pulled and plugged in",
    "[cli][serial][GW-15][GW-16][GW-17][ACT-08]") {
  edge x;
  x.write_gateway("serial.device = \"" + x.file("tty") + "\"\n");
  const auto gateway = x.start("gateway"); // there is no port yet
  const auto motes = x.start("mote");
  bad_cable cable(x);
  cable.plug();
  run(x.loop, [&] { return x.up("gateway") >= 60; });
  cable.unplug();
  const auto lost_at = x.up("mote");
  run(x.loop, [&] { return x.up("mote") >= lost_at + 10; });
  const auto before = x.up("gateway");
  cable.plug();
  run(x.loop, [&] { return x.up("gateway") >= before + 60; });

  const auto at_gateway = gateway->report();
  const auto at_motes = motes->report();
  CHECK(at_gateway["violations"].empty());
  CHECK(at_motes["violations"].empty());
  using serial::direction;
  CHECK(strange(x.packets("gateway", direction::to_pc), x.packets("mote", direction::to_pc)) == 0);
  CHECK(strange(x.packets("mote", direction::to_mote), x.packets("gateway", direction::to_mote)) ==
        0);
  CHECK(at_gateway["serial"]["lost"]["gateway_crc"].get<int>() > 0);
  CHECK(at_motes["serial"]["lost"]["pty_nobody_octets"].get<int>() > 0);
  // Of packets of about 40 octets two thirds arrive.
  const auto& serial = at_gateway["serial"];
  CHECK(serial["frames_received"].get<int>() > serial["lost"]["gateway_crc"].get<int>());
}

TEST_CASE("a gateway has its sink behind a serial forwarder, and is one for others",
          "[cli][serial][GW-17]") {
  edge x;
  const auto inner = std::to_string(free_port(x.loop));
  const auto outer = std::to_string(free_port(x.loop));
  x.write_gateway("serial.forwarder = \"127.0.0.1:" + inner +
                  "\"\nexport.forwarder = \"127.0.0.1:" + outer + "\"\n");
  const auto motes = x.start("mote");
  const auto gateway = x.start("gateway"); // there is no forwarder yet
  run(x.loop, [&] { return std::filesystem::is_symlink(x.file("sink")); });
  program forwarder(x.loop, {"serial", "forward", x.file("sink"), "127.0.0.1:" + inner});
  run(x.loop, [&] { return x.up("gateway") >= 20; });

  program listener(x.loop, {"serial", "listen", "sf@127.0.0.1:" + outer, "--count", "5", "--json"});
  listener.await_end();
  CHECK(listener.end->status == 0);
  CHECK(std::ranges::count(listener.out, '\n') == 5);
  const auto first = json::parse(listener.out.substr(0, listener.out.find('\n')));
  CHECK(first["dispatch"] == 0);
  CHECK(first["group"] == 20);

  program sender(x.loop, {"serial", "send", "sf@127.0.0.1:" + outer, "0xc8", "cafe", "--to", "2"});
  sender.await_end();
  CHECK(sender.end->status == 0);
  serial::am_packet sent;
  sent.destination = 2;
  sent.am_type = 200;
  sent.payload = bytes{0xca, 0xfe};
  run(x.loop, [&] {
    const auto down = x.packets("mote", serial::direction::to_mote);
    return std::ranges::find(down, serial::encode(sent)) != down.end();
  });

  forwarder.process->signal(SIGKILL);
  forwarder.await_end();
  const auto before = x.up("gateway");
  program again(x.loop, {"serial", "forward", x.file("sink"), "127.0.0.1:" + inner});
  run(x.loop, [&] { return x.up("gateway") >= before + 20; });
  CHECK(gateway->report()["violations"].empty());
  again.process->signal(SIGINT);
  again.await_end();
  CHECK(again.end->status == 130);
  CHECK(motes->report()["violations"].empty());
}

TEST_CASE("a client that does not read, or says nonsense, is closed, and no other notices",
          "[cli][serial][GW-17]") {
  edge x;
  const auto port = free_port(x.loop);
  x.write_gateway("serial.device = \"" + x.file("sink") +
                  "\"\nexport.forwarder = \"127.0.0.1:" + std::to_string(port) + "\"\n");
  const auto motes = x.start("mote");
  const auto gateway = x.start("gateway");
  run(x.loop, [&] { return x.up("gateway") >= 5; });

  struct client {
    io::tcp_stream stream;
    bytes received;
    bool closed = false;
  };
  const auto connect = [&](client& to, bool reads) {
    bool there = false;
    const io::tcp_connect attempt(x.loop, "127.0.0.1", port, 10s, [&](auto found) {
      REQUIRE(std::holds_alternative<io::tcp_stream>(found));
      to.stream = std::get<io::tcp_stream>(std::move(found));
      there = true;
    });
    run(x.loop, [&] { return there; });
    to.stream.start({[&to](byte_view octets) {
                       to.received.insert(to.received.end(), octets.begin(), octets.end());
                     },
                     [](std::size_t) {}, [&to](const std::string&) { to.closed = true; }});
    to.stream.read(reads);
  };
  client good;
  client stalled;
  client rude;
  client silent;
  connect(good, true);
  connect(stalled, false);
  connect(rude, true);
  connect(silent, true);
  good.stream.send(serial::forwarder_greeting());
  stalled.stream.send(serial::forwarder_greeting());
  rude.stream.send(bytes{0x47, 0x45, 0x54, 0x20});
  run(x.loop, [&] { return rude.closed && good.received.size() > 200; });
  CHECK(!good.closed);
  CHECK(silent.received == serial::forwarder_greeting());
  serial::forwarder_decoder decoder;
  CHECK(decoder.on_octets(good.received).size() >= 5);

  const auto report = gateway->report();
  CHECK(report["violations"].empty());
  CHECK(report["serial"]["lost"]["forwarder_clients_rude"] == 1);
  CHECK(motes->report()["violations"].empty());
}

TEST_CASE("what a sink has said makes the same tuples when it is played again",
          "[cli][serial][ACT-08]") {
  edge x;
  const std::string peer =
      "[[peer]]\nname = \"pc\"\nid = 1\nlinks = [\"inproc://kitchen-gateway\"]\n"
      "apps = [{ app = \"collector\", keys = [\"devices.*.output.*\"] }]\n";
  x.write("live.toml", "[ecology]\nname = \"live\"\nduration = \"2min\"\n" + peer +
                           "[mote_type.climate]\ntype = 101\n"
                           "transducers.temperature = { model = \"sine\", mean = 24, "
                           "amplitude = 3, period = \"40s\", resolution = 0.1 }\n"
                           "apps = [{ app = \"sampler\", transducers = [\"temperature\"], "
                           "every = \"1s\" }]\n"
                           "[[island]]\nid = 20\nname = \"kitchen\"\n"
                           "mote = [{ id = 2, type = \"climate\", position_m = [1, 0] }]\n");
  x.write("replay.toml", "[ecology]\nname = \"live\"\nduration = \"2min\"\n" + peer +
                             "[[island]]\nid = 20\nname = \"kitchen\"\n"
                             "serial = { replay = \"sink.txt\" }\n");
  const auto record = x.file("sink.txt");
  const auto run_it = [&](const std::string& name, const std::string& more) {
    return test::shell(binary + " run " + x.file(name) + " --json --log off --debug-dir " +
                       x.file(name + ".d") + ' ' + more);
  };
  CHECK(run_it("live.toml", "--record-serial " + record).status == 0);
  CHECK(run_it("replay.toml", "--record-serial " + x.file("again.txt")).status == 0);
  const auto ups = [&](const std::string& file) {
    return test::shell("grep ' up 45 ' " + file + " | cut -d' ' -f2-");
  };
  const auto first = ups(record);
  CHECK(first.out.size() > 1000);
  CHECK(ups(x.file("again.txt")).out == first.out);
  const auto tuples = [&](const std::string& name) {
    return test::shell("grep -o 'set_tuple.*' " + x.file(name + ".d") + "/gateway.log");
  };
  const auto set = tuples("live.toml").out;
  CHECK(set.size() > 1000);
  CHECK(tuples("replay.toml").out == set);
}

TEST_CASE("a mote with a plain program of TinyOS gets a proxy", "[cli][serial][GW-17]") {
  edge x;
  x.write("plain.txt", "# rubicon serial recording 1\n"
                       "1.0 kitchen up 45 00ffff006404220600640007\n"
                       "2.0 kitchen up 45 00ffff006404220600640008\n"
                       "3.0 kitchen up 45 00ffff00020422060002ffff\n");
  x.write("plain.toml", "[ecology]\nname = \"plain\"\nduration = \"20s\"\n"
                        "[[peer]]\nname = \"pc\"\nid = 1\n"
                        "links = [\"inproc://kitchen-gateway\"]\n"
                        "apps = [{ app = \"proxy_manager\" }]\n"
                        "[[proxy]]\nname = \"blinker\"\ntypes = [901]\n"
                        "[[proxy.field]]\nname = \"count\"\nchannel = 1\nencoding = \"u16\"\n"
                        "offset = 2\ndecimals = 0\n"
                        "[[island]]\nid = 20\nname = \"kitchen\"\n"
                        "serial = { replay = \"plain.txt\" }\n"
                        "mote = [{ id = 100, name = \"lamp\" }]\n"
                        "plain = [{ am_type = 6, first = 100, last = 199, type = 901 }]\n");
  CHECK(test::shell(binary + " run " + x.file("plain.toml") + " --json --log off --debug-dir " +
                    x.file("logs"))
            .status == 0);
  const auto said = [&](const std::string& what) {
    return test::shell("grep -c '" + what + "' " + x.file("logs") + "/peis_peer.log").out;
  };
  CHECK(said("set_tuple(\"devices\", payload(7B3130307D)") != "0\n"); // {100}
  CHECK(said("kitchen.lamp.count\", payload(37)") != "0\n");
  CHECK(said("kitchen.lamp.count\", payload(38)") != "0\n");
  CHECK(said("devices.2.output") == "0\n"); // of no rule's range
  CHECK(test::shell("grep -c 'lamp' " + x.file("logs") + "/ecology.log").out != "0\n");
}
