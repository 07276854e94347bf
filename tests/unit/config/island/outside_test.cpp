// Islands with a real sink, or with a gateway of another program.
#include <string>

#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// Ends in line 9, in [[island]].
constexpr std::string_view outside_head = "[ecology]\nname = \"t\"\nmode = \"wall\"\n"
                                          "[[peer]]\nname = \"pc\"\nid = 300\n"
                                          "[[island]]\nname = \"k\"\nid = 1\n";

std::string outside_with(const std::string& rest) {
  return std::string(outside_head) + rest;
}

/// What a file with such a recording beside it is read as.
loaded with_recording(const std::string& toml, const std::string& recording) {
  return load_text(toml, "folder/file.toml", {},
                   [recording](const std::string& path, std::size_t) -> file_text {
                     if (path == "folder/sink.txt")
                       return {recording, {}};
                     return {std::nullopt, "cannot be opened"};
                   });
}

struct row_text {
  std::string toml;
  std::string problem;
};

std::string places_of_problems(const loaded& x) {
  std::string text;
  for (const auto& each : x.problems)
    text += each.file + ':' + std::to_string(each.line) + ": " + each.message + '\n';
  return text;
}

} // namespace

TEST_CASE("an island may have a real sink, and then no air", "[config][GW-17]") {
  const auto x =
      good(outside_with("serial = { device = \"/dev/ttyUSB0\", baud = \"telosb\" }\n"
                        "[[island.mote]]\nid = 2\nname = \"stove\"\nposition_m = [900, 0]\n"));
  const auto& island = x.islands.at(0);
  CHECK(island.outside.device == "/dev/ttyUSB0");
  CHECK(island.outside.has_sink());
  CHECK(island.serial.baud == 115200);
  CHECK(x.airs.empty());
  CHECK(summary(x).find("real sink at /dev/ttyUSB0, 115200 baud") != std::string::npos);

  const auto behind = good(outside_with("serial.forwarder = \"localhost:9002\"\n"
                                        "export.forwarder = \"127.0.0.1:9003\"\n"));
  CHECK(behind.islands.at(0).outside.forwarder == "localhost:9002");
  CHECK(behind.islands.at(0).exported.forwarder == "127.0.0.1:9003");
}

TEST_CASE("an export to other computers has a warning unless it says to which",
          "[config][security]") {
  const auto warnings = [](const std::string& more) {
    const auto x = load_text(
        outside_with("serial.forwarder = \"localhost:9002\"\n[island.export]\n" + more), "t");
    REQUIRE(x.ecology);
    return x.warnings.size();
  };
  CHECK(warnings("forwarder = \"127.0.0.1:9003\"\n") == 0);
  CHECK(warnings("forwarder = \"0.0.0.0:9003\"\n") == 1);
  CHECK(warnings("forwarder = \"0.0.0.0:9003\"\nnetworks = [\"10.0.0.0/8\"]\n") == 0);
  const auto listed =
      good(outside_with("serial.forwarder = \"localhost:9002\"\n"
                        "export = { forwarder = \"10.0.0.1:9003\", networks = [\"10.0.0.7\"] }\n"));
  CHECK(listed.islands.at(0).exported.networks.size() == 1);
}

TEST_CASE("an island may leave its gateway to another program", "[config][GW-17]") {
  const auto x = good(outside_with("serial = { pty = \"run/sink\", octet_error = 0.01 }\n"
                                   "[[island.mote]]\nid = 2\ntype = 1\nposition_m = [1, 2]\n"));
  CHECK(x.islands.at(0).outside.has_gateway());
  CHECK(!x.islands.at(0).outside.has_sink());
  CHECK(x.airs.size() == 1);
  CHECK(summary(x).find("at pty run/sink") != std::string::npos);
  CHECK(summary(x).find("gateway of k") == std::string::npos);
}

TEST_CASE("motes behind a real sink may run plain programs", "[config][GW-17]") {
  const auto x =
      good(outside_with("serial = { device = \"/dev/ttyUSB0\", payload = 28 }\n"
                        "[[island.plain]]\nam_type = 6\nfirst = 100\nlast = 199\ntype = 901\n"
                        "[[island.plain]]\nam_type = 147\ntype = 902\nchannel = 3\n"));
  const auto& island = x.islands.at(0);
  CHECK(island.outside.payload == 28);
  CHECK(good(outside_with("serial.device = \"/dev/ttyUSB0\"\n")).islands.at(0).outside.payload ==
        0);
  REQUIRE(island.plain.size() == 2);
  CHECK(island.plain[0].am_type == 6);
  CHECK(island.plain[0].first == 100);
  CHECK(island.plain[0].last == 199);
  CHECK(island.plain[0].type == 901);
  CHECK(island.plain[0].channel == 1);
  CHECK(island.plain[1].last == mote_id_max);
  CHECK(island.plain[1].channel == 3);
  const auto rule = [](const std::string& rest) {
    return problem_after(outside_head, "serial.device = \"/dev/ttyS0\"\n[[island.plain]]\n" + rest);
  };
  CHECK(rule("am_type = 6\n") == "11:1: `type` is missing in [[island.plain]]");
  CHECK(rule("am_type = 6\ntype = 1\nfirst = 9\nlast = 8\n") ==
        "15:8: `last` must not be below `first`, which is 9");
  CHECK(problem_after(outside_head, "[[island.plain]]\nam_type = 6\ntype = 1\n") ==
        "10:1: `plain` has no effect without a real sink, a base station or `real`");
  CHECK(rule("am_type = 6\ntype = 1\ninput_form = \"blink\"\n") ==
        "14:14: `input_form` has no effect without `input`");
  CHECK(rule("am_type = 6\ntype = 1\ninput_am_type = 7\n") ==
        "14:17: `input_am_type` has no effect without `input`");
  CHECK(rule("am_type = 6\ntype = 1\ninput = 0\n").find("14:9: ") == 0);
  CHECK(rule("am_type = 6\ntype = 1\nid_offset = 113\n").find("14:13: ") == 0);
  CHECK(rule("type = 1\n") == "12:8: `am_type` or `pattern` is missing in [[island.plain]]");
  CHECK(rule("type = 1\npattern = \"c0\"\ninput = 2\n") ==
        "14:9: `input` needs `input_am_type` where `am_type` is missing");
  CHECK(rule("am_type = 6\ntype = 1\npattern_offset = 2\n") ==
        "14:18: `pattern_offset` has no effect without `pattern`");
  CHECK(rule("type = 1\npattern = \"c\"\n").find("13:11: ") == 0);
  const auto frames =
      good(outside_with("serial.device = \"/dev/ttyS0\"\n[[island.plain]]\ntype = 1\n"
                        "pattern = \"c0ff\"\npattern_offset = 2\n"));
  const auto& by_pattern = frames.islands.at(0).plain.at(0);
  CHECK(!by_pattern.am_type);
  CHECK(by_pattern.pattern == bytes{0xc0, 0xff});
  CHECK(by_pattern.pattern_offset == 2);
  const auto base = good(
      outside_with("serial.device = \"/dev/ttyUSB0\"\nmote = [{ id = 0, name = \"base\" }]\n"
                   "plain = [{ am_type = 137, type = 9, first = 0, last = 0, id_offset = 4 }]\n"));
  CHECK(base.islands.at(0).plain.at(0).first == 0);
  CHECK(base.islands.at(0).plain.at(0).id_offset == 4);
  CHECK(base.islands.at(0).motes.at(0).id == mote_id{0});
  CHECK(!problem_after(outside_head, "[[island.mote]]\nid = 0\nposition_m = [1, 0]\n").empty());
  CHECK(problem_after(outside_head, "serial.payload = 28\n") ==
        "10:18: `payload` has no effect without a real sink");
}

TEST_CASE("an input of a plain mote becomes packets of a type and a form", "[config][GW-17]") {
  const auto x = good(outside_with("serial.device = \"/dev/ttyUSB0\"\n"
                                   "[[island.plain]]\nam_type = 6\ntype = 901\ninput = 2\n"
                                   "[[island.plain]]\nam_type = 147\ntype = 902\ninput = 3\n"
                                   "input_am_type = 148\ninput_form = \"oscilloscope\"\n"));
  const auto& rules = x.islands.at(0).plain;
  CHECK(rules.at(0).input == 2);
  CHECK(rules.at(0).input_am_type == 6);
  CHECK(rules.at(0).input_form == gateway::plain_form::octets);
  CHECK(rules.at(1).input_am_type == 148);
  CHECK(rules.at(1).input_form == gateway::plain_form::oscilloscope);
}

TEST_CASE("an island may have real motes beside simulated ones", "[config][GW-17]") {
  const auto real = [](const std::string& motes) {
    return good(
        outside_with("real = { device = \"/dev/ttyUSB0\", baud = \"telosb\", first = 100, last = "
                     "199, payload = 28, mote = [{ id = 100, name = \"lamp\" }, { id = 199, name = "
                     "\"desk\" }] }\nplain = [{ am_type = 6, type = 901 }, { am_type = 7, type = "
                     "902, first = 199 }]\n" +
                     motes));
  };
  const auto x = real("[[island.mote]]\nid = 99\ntype = 1\nposition_m = [1, 0]\n"
                      "[[island.mote]]\nid = 200\ntype = 1\nposition_m = [0, 1]\n");
  const auto& island = x.islands.at(0);
  CHECK(!island.outside.has_sink());
  REQUIRE(island.real.is_there());
  CHECK(island.real.outside.device == "/dev/ttyUSB0");
  CHECK(island.real.outside.payload == 28);
  CHECK(island.real.serial.baud == 115200);
  CHECK(island.serial.baud == 57600);
  CHECK(island.real.motes.first == 100);
  CHECK(island.real.motes.last == 199);
  CHECK(island.plain.at(0).first == 100);
  CHECK(island.plain.at(0).last == 199);
  CHECK(island.plain.at(1).first == 199);
  CHECK(island.plain.at(1).last == 199);
  CHECK(island.real.names == std::vector<std::pair<mote_id, std::string>>{{mote_id{100}, "lamp"},
                                                                          {mote_id{199}, "desk"}});
  CHECK(x.airs.size() == 1);
  CHECK(summary(x).find("real motes 100 to 199 at /dev/ttyUSB0") != std::string::npos);

  // A group takes ids that are not theirs.
  const auto group = real("[[island.group]]\ncount = 150\ntype = 1\n"
                          "layout = \"disk\"\nradius = \"9m\"\n");
  CHECK(group.islands.at(0).motes.front().id == mote_id{200});
}

TEST_CASE("what a line to real motes cannot have is refused", "[config][GW-17]") {
  const std::string plain = "plain = [{ am_type = 6, type = 901 }]\n";
  const std::string line = "real = { device = \"/dev/ttyS0\", first = 100, last = 199 }\n";
  const auto mote = [](const std::string& id) {
    return "[[island.mote]]\nid = " + id + "\ntype = 1\nposition_m = [1, 0]\n";
  };
  const row_text rows[] = {
      {line + plain + mote("99"), "none"},
      {line + plain + mote("200"), "none"},
      {line + plain + mote("100"),
       "13:6: mote id 100 is in the range of `real`, whose motes are not simulated"},
      {line + plain + mote("199"),
       "13:6: mote id 199 is in the range of `real`, whose motes are not simulated"},
      {line + plain +
           "[[island.group]]\ncount = 2\nfirst = 99\ntype = 1\n"
           "layout = \"disk\"\nradius = \"9m\"\n",
       "14:9: mote id 100 is in the range of `real`, whose motes are not simulated"},
      {"real = { device = \"/dev/ttyS0\", first = 1, last = 9 }\n" + plain + "sink.id = 9\n",
       "10:41: the range of `real` has mote 9, which is the simulated sink"},
      {"real = { device = \"/dev/ttyS0\", first = 9, last = 8 }\n" + plain,
       "10:51: `last` must not be below `first`, which is 9"},
      {"real = { device = \"/dev/ttyS0\", last = 9 }\n" + plain,
       "10:8: `first` is missing in [island.real]"},
      {"real = { first = 100, last = 199 }\n" + plain,
       "10:8: `device`, `forwarder` or `replay` is missing in [island.real]"},
      {line, "10:8: `real` has no effect without `plain`, which describes what its motes send"},
      {line + "plain = [{ am_type = 6, type = 901, first = 99 }]\n",
       "11:45: mote 99 is not in the range of `real`, which is 100 to 199"},
      {line + "plain = [{ am_type = 6, type = 901, last = 200 }]\n",
       "11:44: mote 200 is not in the range of `real`, which is 100 to 199"},
      {line + plain + "serial.device = \"/dev/ttyS1\"\n",
       "10:8: `real` has no effect in an island with a real sink"},
      {line + plain + "[[island.alias]]\nid = 21\n",
       "10:8: `real` has no effect in an island with several gateways: it belongs to one gateway"},
      {"serial.pty = \"run/sink\"\n" + line,
       "11:8: `real` has no effect with `pty`: the program that opens it is the gateway"},
      {"stack = \"mac\"\n" + line, "11:8: `real` has no effect in an island with stack = \"mac\""},
  };
  for (const auto& [toml, problem] : rows) {
    CAPTURE(toml);
    CHECK(problem_after(outside_head, toml) == problem);
  }
  const auto named = [&](const std::string& id, const std::string& name) {
    return problem_after(outside_head, "real = { device = \"/dev/ttyS0\", first = 100, last = 199, "
                                       "mote = [{ id = " +
                                           id + ", name = \"" + name + "\" }] }\n" + plain +
                                           "[[island.mote]]\nid = 2\nname = \"stove\"\ntype = 1\n"
                                           "position_m = [1, 0]\n");
  };
  CHECK(named("100", "lamp") == "none");
  CHECK(named("200", "lamp") == "10:73: mote 200 is not in the range of `real`");
  CHECK(named("100", "stove").find("mote name") != std::string::npos);
  for (const std::string key : {"pty = \"run/x\"", "octet_error = 0.1", "latency = \"1ms\""})
    CHECK(
        problem_after(outside_head, "real = { device = \"/dev/ttyS0\", first = 100, last = 199, " +
                                        key + " }\n" + plain)
            .find("unknown key `" + key.substr(0, key.find(' ')) + "` in [island.real]") !=
        std::string::npos);
  CHECK(problem_after(island_head, line + plain).find("needs mode = \"wall\"") !=
        std::string::npos);
}

TEST_CASE("rates may be called as TinyOS's tools call them", "[config][GW-01]") {
  const auto rate = [](const std::string& name) {
    return good(outside_with("serial.baud = \"" + name + "\"\n")).islands.at(0).serial.baud;
  };
  CHECK(rate("micaz") == 57600);
  CHECK(rate("iris") == 57600);
  CHECK(rate("tmote") == 115200);
  CHECK(rate("mica2dot") == 19200);
  CHECK(rate("38400baud") == 38400);
}

TEST_CASE("what means nothing beside a real end of a cable is refused", "[config][GW-17]") {
  const row rows[] = {
      {"serial = { device = \"/dev/ttyS0\", pty = \"run/sink\" }\n",
       "10:41: `pty` has no effect with `device`: a cable has one sink and one gateway"},
      {"serial = { forwarder = \"localhost\" }\n",
       "10:24: expected HOST:PORT with a port from 1 to 65535, as in \"localhost:9002\""},
      {"serial = { forwarder = \"localhost:0\" }\n",
       "10:24: expected HOST:PORT with a port from 1 to 65535, as in \"localhost:9002\""},
      {"serial = { device = \"/dev/ttyS0\", octet_error = 0.1 }\n",
       "10:49: `octet_error` has no effect with `device`: a real cable makes errors of its own"},
      {"serial = { device = \"/dev/ttyS0\", speed = 2 }\n",
       "10:43: `speed` has no effect without `replay`"},
      {"serial.pty = \"run/sink\"\nexport.forwarder = \"127.0.0.1:9002\"\n",
       "11:1: `export` has no effect with `pty`: the program that opens it is the gateway"},
      {"serial.pty = \"run/sink\"\n[[island.alias]]\nid = 21\n",
       "11:1: `alias` has no effect with `pty`: the program that opens it is the gateway"},
      {"serial.device = \"/dev/ttyS0\"\n[[island.alias]]\nid = 21\n",
       "11:1: `alias` has no effect in an island with a real sink"},
      {"export.forwarder = \"localhost:9002\"\n",
       "10:20: expected ADDRESS:PORT with an IPv4 address of this computer, as in "
       "\"127.0.0.1:9002\""},
      {"serial.device = \"/dev/ttyS0\"\n[[fault]]\nat = \"1s\"\nkind = \"crash\"\nsink = \"k\"\n",
       "14:8: that island has a real sink: its motes and radio medium are not simulated, so they "
       "cannot fail"},
      {"serial.device = \"/dev/ttyS0\"\n[[air]]\nname = \"house\"\nislands = [\"k\"]\n",
       "13:12: island `k` has a real sink: its motes use real radios"},
      {"serial.device = \"/dev/ttyS0\"\n[[fault]]\nat = \"1s\"\nkind = \"unplug\"\nisland = "
       "\"k\"\n",
       "none"},
      {"serial.pty = \"run/sink\"\n[[fault]]\nat = \"1s\"\nkind = \"kill\"\npeer = \"k-gateway\"\n",
       nullptr},
  };
  for (const auto& [toml, problem] : rows) {
    CAPTURE(toml);
    if (problem != nullptr)
      CHECK(problem_after(outside_head, toml) == problem);
    else
      CHECK(problem_after(outside_head, toml) != "none");
  }
}

TEST_CASE("in virtual time there is nobody outside", "[config][GW-17]") {
  for (const std::string key : {"device", "forwarder", "pty"}) {
    CAPTURE(key);
    const auto problem = problem_after(island_head, "serial." + key + " = \"localhost:9002\"\n");
    CHECK(problem.find('`' + key + "` needs mode = \"wall\"") != std::string::npos);
  }
}

TEST_CASE("a recording of a sink is read with the file that names it", "[config][ACT-08]") {
  const auto toml = std::string(island_head) + "serial = { replay = \"sink.txt\", speed = 2 }\n";
  const std::string title = "# rubicon serial recording 1\n";
  const auto x = with_recording(toml, title + "1.0 k up 45 0001\n");
  REQUIRE(x.ecology);
  CHECK(x.ecology->islands.at(0).outside.recorded != nullptr);
  CHECK(x.ecology->islands.at(0).outside.speed == 2);
  CHECK(places_of_problems(with_recording(toml, title + "1.0 k up 45 0001\n1.0 k up\n")) ==
        "folder/sink.txt:3: expected the type of a frame, 43, 44, 45 or ff\n");
  CHECK(places_of_problems(with_recording(toml, title + "1.0 attic up 45 0001\n"))
            .find("has no recording of an island named `k`") != std::string::npos);
  const auto real = std::string(island_head) +
                    "real = { replay = \"sink.txt\", first = 100, last = 199 }\n"
                    "plain = [{ am_type = 6, type = 901 }]\n";
  CHECK(places_of_problems(with_recording(real, title + "1.0 k/real up 45 0001\n")).empty());
  CHECK(places_of_problems(with_recording(real, title + "1.0 k up 45 0001\n"))
            .find("has no recording of an island named `k/real`") != std::string::npos);
  const auto missing = std::string(island_head) + "serial = { replay = \"other.txt\" }\n";
  CHECK(places_of_problems(with_recording(missing, title)).find("folder/other.txt") !=
        std::string::npos);
}
