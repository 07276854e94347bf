// Two processes with a cable between them, as a sink and its gateway: a pseudo-terminal, a relay
// that makes errors, a serial forwarder.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "edge.hpp"
#include "io/tcp/tcp_connect.hpp"
#include "serial/forwarder.hpp"
#include "serial/packet.hpp"
#include "support/shell.hpp"

using namespace rubicon;
using namespace rubicon::test;

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

TEST_CASE("a forwarder waits for its port, opens it again when it has gone, and keeps its clients",
          "[cli][serial][GW-15][GW-17]") {
  edge x;
  const auto port = std::to_string(free_port(x.loop));
  program forwarder(x.loop, {"serial", "forward", x.file("sink"), "127.0.0.1:" + port});
  program listener(x.loop, {"serial", "listen", "sf@127.0.0.1:" + port, "--json"});
  const auto heard = [&] { return std::ranges::count(listener.out, '\n'); };
  run(x.loop, [&] { return forwarder.err.find("; tries again\n") != std::string::npos; });
  auto motes = x.start("mote");
  run(x.loop, [&] { return heard() >= 5; });
  CHECK(motes->report()["violations"].empty());
  motes.reset();
  const auto before = heard();
  motes = x.start("mote");
  run(x.loop, [&] { return heard() >= before + 5; });
  CHECK(!listener.end);
  const auto has = "rubicon: has " + x.file("sink") + '\n';
  CHECK(forwarder.err.find(has) != forwarder.err.rfind(has)); // twice
  for (auto* each : {&listener, &forwarder}) {
    each->process->signal(SIGINT);
    each->await_end();
    CHECK(each->end->status == 130);
  }
}

TEST_CASE("a simulated base station says and takes what TinyOS's does", "[cli][serial][GW-17]") {
  edge x;
  x.write("mote.toml", "[ecology]\nname = \"motes\"\nmode = \"wall\"\nduration = \"5min\"\n"
                       "[[island]]\nid = 34\nname = \"kitchen\"\n"
                       "sink = { role = \"base_station\" }\nserial = { pty = \"" +
                           x.file("sink") +
                           "\" }\n[[island.mote]]\nid = 7\nposition_m = [1, 0]\n"
                           "transducers.light = { model = \"constant\", value = 20 }\n"
                           "apps = [{ app = \"oscilloscope\", transducer = \"light\", "
                           "every = \"20ms\" }]\n"
                           "[[island.mote]]\nid = 8\nposition_m = [0, 1]\n"
                           "apps = [{ app = \"blink\", every = \"100ms\" }]\n");
  const auto motes = x.start("mote");
  program listener(x.loop, {"serial", "listen", x.file("sink"), "--json", "--count", "20"});
  listener.await_end();
  CHECK(listener.end->status == 0);
  std::set<std::string> seen;
  std::istringstream lines(listener.out);
  for (std::string line; std::getline(lines, line);) {
    const auto packet = json::parse(line);
    CHECK(packet["group"] == 34);
    CHECK(packet["destination"] == 0xffff);
    seen.insert(packet["source"].dump() + ' ' + packet["type"].dump());
  }
  CHECK(seen == std::set<std::string>{"7 147", "8 6"});
  // An interval of 1 s with version 5, as Oscilloscope's program on a PC sends it.
  program sender(x.loop, {"serial", "send", x.file("sink"), "147",
                          "000503e800000000" + std::string(40, '0'), "--to", "65535"});
  sender.await_end();
  CHECK(sender.end->status == 0);
  const auto report = motes->report();
  CHECK(report["violations"].empty());
  bool took = false;
  for (const auto& each : report["modules"])
    took = took || (each["who"] == "kitchen/mote-7" &&
                    each["counters"].value("oscilloscope.settings", 0) == 1);
  CHECK(took);
}

TEST_CASE("who listens at a port that never comes is told, and so is who sends too much",
          "[cli][serial][GW-17]") {
  edge x;
  program listener(x.loop, {"serial", "listen", x.file("none"), "--for", "1500ms"});
  listener.await_end();
  CHECK(listener.end->status == 1);
  CHECK(listener.out.empty());
  CHECK(listener.err.find("none: No such file or directory") != std::string::npos);
  CHECK(std::ranges::count(listener.err, '\n') == 1); // once, though it has tried twice
  program sender(x.loop, {"serial", "send", x.file("none"), "6", std::string(58, '0')});
  sender.await_end();
  CHECK(sender.end->status == 1);
  CHECK(sender.err.find("more than 28 octets is refused") != std::string::npos);
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
  CHECK(report["serial"]["lost"]["forwarder_clients.bad_input"] == 1);
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
  CHECK(said("set_tuple(key=\"devices\", value=7b3130307d") != "0\n"); // {100}
  CHECK(said("kitchen.lamp.count\", value=37,") != "0\n");
  CHECK(said("kitchen.lamp.count\", value=38,") != "0\n");
  CHECK(said("devices.2.output") == "0\n"); // of no rule's range
  CHECK(test::shell("grep -c 'lamp' " + x.file("logs") + "/ecology.log").out != "0\n");
}
