// Motes that are shared libraries in C.
#include <map>
#include <string>

#include "ecology/ecology_files.hpp"
#include "firmware/program_config.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

std::string library(std::string_view name) {
  return std::string("firmware = \"" RUBICON_FIRMWARES "/").append(name) + ".so\"\n";
}

/// Six motes in a row, of which the last is five hops from the first and six from the sink.
std::string row_of_motes(const std::string& more = {}) {
  return "[ecology]\nname = \"flood\"\nduration = \"30s\"\n"
         "[radio.propagation]\nmodel = \"unit_disk\"\nrange = \"12m\"\n"
         "[[peer]]\nname = \"robot\"\nid = 300\nlinks = [\"inproc://hall-gateway\"]\n"
         "[[peer.apps]]\napp = \"proxy_manager\"\n"
         "[[proxy]]\nname = \"far\"\ntypes = [906]\n"
         "field = [{ name = \"round\", channel = 1, encoding = \"u16\", offset = 2, decimals = 0 "
         "},\n"
         "{ name = \"hops\", channel = 1, encoding = \"u16\", offset = 4, decimals = 0 },\n"
         "{ name = \"reading\", channel = 1, encoding = \"u16\", offset = 6, decimals = 0 }]\n"
         "[mote_type.flooder]\ntype = 9\n" +
         library("flood") +
         "transducers.temperature = { model = \"constant\", value = 21, resolution = 0.1 }\n"
         "[[island]]\nid = 20\nname = \"hall\"\n"
         "sink = { id = 100, role = \"base_station\", position_m = [0, 0] }\n"
         "plain = [{ am_type = 66, type = 906, id_offset = 0 }]\n"
         "[[island.group]]\ncount = 6\nfirst = 1\ntype = \"flooder\"\nprefix = \"node\"\n"
         "layout = \"line\"\nspacing = \"10m\"\norigin = [10, 0]\n" +
         more;
}

std::map<std::string, report::cause_counts> modules_of(const report::run_report& x) {
  std::map<std::string, report::cause_counts> all;
  for (const auto& each : x.modules)
    all[each.who] = each.counters;
  return all;
}

} // namespace

TEST_CASE("a reading of firmware floods over five hops and reaches a robot",
          "[ecology][firmware]") {
  ecology x(row_of_motes());
  x.run_for(100ms); // until the robot has started
  REQUIRE(x.run_until([&] { return x.tuple("robot", "hall.node-6.hops").has_value(); }, 20s));
  CHECK(x.tuple("robot", "hall.node-6.hops") == "5");
  CHECK(x.tuple("robot", "hall.node-6.reading") == "210");
  const auto report = x.finish();
  CHECK(report.violations.empty());
  CHECK(report.actors.failures.empty());
  auto modules = modules_of(report);
  CHECK(modules["hall/node-6"]["firmware.frames"] >= 29);
  CHECK(modules["hall/node-1"]["firmware.frames"] >= 27); // copies of variables would be one mote's
  CHECK(modules["hall/node-1"]["firmware.absent_sensors"] == 0);
}

TEST_CASE("firmware does the same in each run, and on several threads", "[ecology][firmware]") {
  const auto hash = [](unsigned threads) {
    run_options options;
    options.threads = threads;
    return run_ecology(describe(row_of_motes()), options).trace_hash;
  };
  const auto once = hash(1);
  CHECK(hash(1) == once);
  CHECK(hash(2) == once);
  CHECK(hash(8) == once);
}

TEST_CASE("firmware begins anew when its mote is back", "[ecology][firmware][ACT-03]") {
  ecology x(row_of_motes("[[fault]]\nat = \"10s\"\nkind = \"crash\"\nmote = \"hall/node-6\"\n"
                         "for = \"5s\"\n"));
  x.run_for(10s);
  CHECK(x.tuple("robot", "hall.node-6.round") == "9");
  x.run_for(8s);
  const auto round = x.tuple("robot", "hall.node-6.round"); // its variables are new
  REQUIRE(round);
  CHECK(std::stoi(*round) <= 3);
  CHECK(x.finish().violations.empty());
}

TEST_CASE("firmware sends frames of other layouts, is acknowledged, and switches its radio",
          "[ecology][firmware]") {
  ecology x("[ecology]\nname = \"pair\"\nduration = \"9700ms\"\n"
            "[[island]]\nid = 20\nname = \"hall\"\nstack = \"mac\"\n"
            "sink = { id = 100, position_m = [50, 50] }\n"
            "[[island.mote]]\nid = 1\nname = \"one\"\nposition_m = [0, 0]\n" +
            library("pair") + "[[island.mote]]\nid = 2\nname = \"two\"\nposition_m = [5, 0]\n" +
            library("pair"));
  const auto report = x.finish();
  CHECK(report.violations.empty());
  auto modules = modules_of(report);
  CHECK(modules["hall/one"]["firmware.frames"] == 19);
  CHECK(modules["hall/one"]["firmware.unsent"] == 0);
  CHECK(modules["hall/one"]["firmware.absent_sensors"] == 1);
  CHECK(modules["hall/two"]["firmware.received"] == 19);
  CHECK(modules["hall/two"]["firmware.serial_octets"] > 300);
}

TEST_CASE("firmware in a process of its own does the same", "[ecology][firmware]") {
  auto isolated = describe(row_of_motes());
  isolated.length = 5s;
  const auto plain = run(isolated);
  for (auto& mote : isolated.islands.at(0).motes)
    for (auto& app : mote.apps.edit())
      std::get<firmware::program_config>(app).isolate = true;
  const auto report = run(isolated);
  CHECK(report.violations.empty());
  CHECK(report.trace_hash == plain.trace_hash);
}

TEST_CASE("firmware that fails in a process of its own costs its mote only",
          "[ecology][firmware][ACT-03]") {
  const auto* const name = GENERATE("loops", "crashes", "wants_memory");
  CAPTURE(name);
  ecology x("[ecology]\nname = \"failing\"\nduration = \"4800ms\"\n"
            "[[island]]\nid = 20\nname = \"hall\"\nstack = \"mac\"\n"
            "sink = { id = 100, position_m = [50, 50] }\n"
            "[[island.mote]]\nid = 1\nname = \"one\"\nposition_m = [0, 0]\n" +
            library("pair") + "[[island.mote]]\nid = 2\nname = \"two\"\nposition_m = [5, 0]\n" +
            library("pair") +
            "[[island.mote]]\nid = 3\nname = \"three\"\nposition_m = [9, 0]\n"
            "firmware = { file = \"" RUBICON_FIRMWARES "/" +
            name + ".so\", isolate = true }\n");
  const auto report = x.finish();
  REQUIRE(!report.actors.failures.empty());
  for (const auto& each : report.actors.failures) {
    CAPTURE(each);
    CHECK(each.find("hall/three: the firmware failed: its process") != std::string::npos);
  }
  auto modules = modules_of(report);
  CHECK(modules["hall/one"]["firmware.frames"] == 9);
  CHECK(modules["hall/two"]["firmware.received"] == 9);
}

TEST_CASE("firmware of Contiki-NG runs by an adapter, with acknowledgements of the radio",
          "[ecology][firmware]") {
  ecology x("[ecology]\nname = \"contiki\"\nduration = \"9500ms\"\n"
            "[[island]]\nid = 20\nname = \"hall\"\nstack = \"mac\"\n"
            "sink = { id = 100, position_m = [50, 50] }\n"
            "[[island.mote]]\nid = 1\nname = \"one\"\nposition_m = [0, 0]\n" +
            library("contiki") + "[[island.mote]]\nid = 2\nname = \"two\"\nposition_m = [5, 0]\n" +
            library("contiki"));
  const auto report = x.finish();
  CHECK(report.violations.empty());
  CHECK(report.actors.failures.empty());
  auto modules = modules_of(report);
  CHECK(modules["hall/one"]["firmware.frames"] == 9);
  CHECK(modules["hall/one"]["firmware.unsent"] == 0);
  CHECK(modules["hall/two"]["firmware.received"] == 9);
  CHECK(modules["hall/two"]["firmware.frames"] == 0); // the radio acknowledges
  // "starts 1", and "acknowledged N" for each frame
  CHECK(modules["hall/one"]["firmware.serial_octets"] == 9 + 9 * 15);
  CHECK(modules["hall/two"]["firmware.serial_octets"] == 9 + 9 * 11);
}

TEST_CASE("an application of TinyOS runs by an adapter, each mote as one node of its library",
          "[ecology][firmware]") {
  const auto text = [](const std::string& firmware) {
    return "[ecology]\nname = \"tinyos\"\nduration = \"9500ms\"\n"
           "[[island]]\nid = 20\nname = \"hall\"\nstack = \"mac\"\n"
           "sink = { id = 100, position_m = [50, 50] }\n"
           "[[island.mote]]\nid = 1\nname = \"one\"\nposition_m = [0, 0]\n" +
           firmware + "[[island.mote]]\nid = 2\nname = \"two\"\nposition_m = [5, 0]\n" + firmware;
  };
  const auto report = run(describe(text(library("tinyos"))));
  CHECK(report.violations.empty());
  CHECK(report.actors.failures.empty());
  auto modules = modules_of(report);
  CHECK(modules["hall/one"]["firmware.frames"] == 9);
  CHECK(modules["hall/one"]["firmware.unsent"] == 0); // each was acknowledged
  CHECK(modules["hall/one"]["firmware.received"] == 9);
  CHECK(modules["hall/two"]["firmware.frames"] == 9);
  // "boots 1 0", and "sent 1 3" and "answer 1 N" for each frame
  CHECK(modules["hall/one"]["firmware.serial_octets"] == 10 + 9 * (9 + 11));
  CHECK(modules["hall/two"]["firmware.serial_octets"] == 10 + 9 * (10 + 9));
  const auto isolated = run(describe(
      text("firmware = { file = \"" RUBICON_FIRMWARES "/tinyos.so\", isolate = true }\n")));
  CHECK(isolated.trace_hash == report.trace_hash);
}

TEST_CASE("a reading in frames of another layout reaches a robot by the octets that begin it",
          "[ecology][firmware][GW-17]") {
  ecology x("[ecology]\nname = \"patterns\"\nduration = \"30s\"\n"
            "[[peer]]\nname = \"robot\"\nid = 300\nlinks = [\"inproc://hall-gateway\"]\n"
            "[[peer.apps]]\napp = \"proxy_manager\"\n"
            "[[proxy]]\nname = \"ping\"\ntypes = [907]\n"
            "field = [{ name = \"first\", channel = 1, encoding = \"u16\", decimals = 0 }]\n"
            "[[island]]\nid = 20\nname = \"hall\"\n"
            "sink = { id = 100, role = \"base_station\", position_m = [0, 5] }\n"
            "plain = [{ pattern = \"70696e67\", type = 907 }]\n" // "ping", from a long address
            "[[island.mote]]\nid = 1\nname = \"one\"\nposition_m = [0, 0]\n" +
            library("pair") + "[[island.mote]]\nid = 2\nname = \"two\"\nposition_m = [5, 0]\n" +
            library("pair"));
  x.run_for(100ms);
  REQUIRE(x.run_until([&] { return x.tuple("robot", "hall.one.first").has_value(); }, 20s));
  CHECK(x.tuple("robot", "hall.one.first") == std::to_string(0x7069));
  const auto report = x.finish();
  CHECK(report.violations.empty());
  CHECK(report.actors.failures.empty());
}
