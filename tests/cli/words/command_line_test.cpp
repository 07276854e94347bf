#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "cli/options/parse_command_line.hpp"
#include "cli/words/condition.hpp"
#include "cli/words/hint.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::cli;

namespace {

command parse(std::vector<const char*> words) {
  words.insert(words.begin(), "rubicon");
  return parse_command_line(words);
}

run_command parse_run(std::vector<const char*> words) {
  words.insert(words.begin(), {"run", "home.toml"});
  const auto x = parse(words);
  REQUIRE(std::holds_alternative<run_command>(x));
  return std::get<run_command>(x);
}

/// What is said about a command line that is refused; empty if it is not.
std::string refusal(std::vector<const char*> words) {
  const auto x = parse(std::move(words));
  const auto* refused = std::get_if<refused_command>(&x);
  return refused == nullptr ? "" : refused->text;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("without options the file decides", "[cli]") {
  const auto x = parse_run({});
  CHECK(x.file == "home.toml");
  CHECK(!x.options.length);
  CHECK(!x.options.seed);
  CHECK(!x.options.mode);
  CHECK(x.options.speed == 0);
  CHECK(x.options.debug_folder.empty()); // NFR-01: off by default
  CHECK(x.options.pcap_folder.empty());
  CHECK(!x.options.pcap_lost);
  CHECK(x.instead.topology.empty());
  CHECK(x.instead.noise_trace.empty());
  CHECK(!x.instead.seed);
  CHECK(x.options.handle_signals);
  CHECK(x.log_level == "warn");
  CHECK(!x.json);
  CHECK(!x.check_determinism);
}

TEST_CASE("each option of run reaches the run", "[cli][GEN-07][NFR-01]") {
  CHECK(parse_run({"--for", "10min"}).options.length == 10min);
  CHECK(parse_run({"--for=1.5s"}).options.length == 1500ms);
  CHECK(parse_run({"--seed", "18446744073709551615"}).options.seed == 18446744073709551615U);
  CHECK(parse_run({"--mode", "wall"}).options.mode == config::run_mode::wall);
  CHECK(parse_run({"--mode", "virtual"}).options.mode == config::run_mode::virtual_time);
  CHECK(parse_run({"--speed", "2.5"}).options.speed == 2.5);
  CHECK(parse_run({"--debug-dir", "logs"}).options.debug_folder == "logs");
  CHECK(parse_run({"--debug-dir", "logs"}).options.debug_of == std::vector<std::string>{"*"});
  CHECK(parse_run({"--debug-dir", "logs", "--debug-of", "mote/kitchen", "--debug-of", "sink"})
            .options.debug_of == std::vector<std::string>{"mote/kitchen", "sink"});
  CHECK(parse_run({"--log", "debug"}).log_level == "debug");
  CHECK(parse_run({"--pcap", "captures"}).options.pcap_folder == "captures");
  CHECK(!parse_run({"--pcap", "captures"}).options.pcap_lost);
  CHECK(parse_run({"--pcap-lost", "--pcap", "captures"}).options.pcap_lost);
  CHECK(parse_run({"--reseed", "0s:0"}).options.reseed == reseeding::settings{instant(), 0});
  CHECK(parse_run({"--reseed", "1.5min:7"}).options.reseed == reseeding::settings{instant(90s), 7});
  CHECK(parse_run({"--topology", "grid.txt"}).instead.topology == "grid.txt");
  CHECK(parse_run({"--noise-trace", "meyer.txt"}).instead.noise_trace == "meyer.txt");
  CHECK(parse_run({"--seed", "7"}).instead.seed == 7U);
  CHECK(parse_run({"--json"}).json);
  CHECK(parse_run({"--check-determinism"}).check_determinism);
}

TEST_CASE("a reseeding is a time and a number, in virtual time", "[cli]") {
  for (const auto* wrong : {"90s", "90s:", ":1", "soon:1", "90s:-1", "90s:x"})
    CHECK(contains(refusal({"run", "a.toml", "--reseed", wrong}), "not a time and a number"));
  CHECK(contains(refusal({"run", "a.toml", "--reseed", "1s:1", "--host", "kitchen"}),
                 "only virtual runs"));
}

TEST_CASE("explain takes what --when needs with it alone", "[cli][explain]") {
  const auto x = parse({"explain", "--when", "a.rec", "every mote", "--futures", "40", "--within",
                        "1us", "--jobs", "3", "--timeout", "9s", "--json"});
  REQUIRE(std::holds_alternative<when_command>(x));
  const auto& when = std::get<when_command>(x);
  CHECK(when.record == "a.rec");
  CHECK(when.what == "every mote");
  CHECK(when.futures == 40);
  CHECK(when.within == 1ms); // the finest
  CHECK(when.jobs == 3U);
  CHECK(when.timeout == 9s);
  CHECK(when.json);
  CHECK(contains(refusal({"explain", "a.rec", "--futures", "40"}), "--when"));
  CHECK(contains(refusal({"explain", "--when", "a.rec", "--futures", "0"}), "not a number"));
  CHECK(contains(refusal({"explain", "--when", "a.rec", "--lost"}), "not with --when"));
  CHECK(contains(refusal({"explain", "--when", "a.rec", "x", "--all"}), "not with --when"));
}

TEST_CASE("what decides what runs is repeated, in any order", "[cli]") {
  using words = std::vector<std::string>;
  CHECK(parse_run({}).deciding.empty());
  CHECK(
      parse_run({"--seed", "3", "--for", "10s", "--record", "x", "--log", "off"}).deciding.empty());
  CHECK(parse_run({"--speed", "5", "--mode=wall", "--seed", "3"}).deciding ==
        words{"--mode", "wall", "--speed", "5"});
  CHECK(parse_run({"--noise-trace", "a b.txt", "--topology", "grid.txt"}).deciding ==
        words{"--topology", "grid.txt", "--noise-trace", "a b.txt"});
  CHECK(parse_run({"--host", "kitchen", "--starts", "n"}).deciding ==
        words{"--host", "kitchen", "--starts", "n"});
  CHECK(parse_run({"--reseed", "1500ms:3"}).deciding == words{"--reseed", "1500ms:3"});
}

TEST_CASE("what only shows a run, or is set anew, is not repeated", "[cli]") {
  CHECK(parse_run({"--threads",  "2",           "--full",
                   "--report",   "p.html",      "--csv",
                   "d",          "--csv-every", "1s",
                   "--view",     "8080",        "--control",
                   "--strict",   "--debug-dir", "l",
                   "--debug-of", "sink",        "--pcap",
                   "c",          "--pcap-lost", "--record-serial",
                   "s"})
            .deciding.empty());
  CHECK(parse_run({"--reload"}).deciding.empty());
  CHECK(parse_run({"--check-determinism", "--json"}).deciding.empty());
}

TEST_CASE("a page has further names, in lower case", "[cli]") {
  const auto x = parse_run({"--view-host", "House.Example", "--view", "8080", "--view-host", "b"});
  REQUIRE(x.watch.view);
  CHECK(x.watch.view->hosts == std::vector<std::string>{"house.example", "b"});
  CHECK(x.deciding.empty());
  const auto view = parse({"view", "home.rec", "--view-host", "house.example"});
  CHECK(std::get<view_command>(view).where.hosts.size() == 1);
  CHECK(contains(refusal({"run", "a.toml", "--view-host", "house.example"}), "--view"));
  for (const auto* wrong : {"house.example:80", "http://house", "*", "a b"})
    CHECK(contains(refusal({"run", "a.toml", "--view", "0", "--view-host", wrong}),
                   "not the name of a host"));
}

TEST_CASE("a brief report is text, and not a full one", "[cli]") {
  CHECK(parse_run({"--brief"}).brief);
  CHECK_FALSE(parse_run({}).brief);
  CHECK(parse_run({"--brief"}).deciding.empty());
  CHECK(contains(refusal({"run", "a.toml", "--brief", "--full"}), "excludes"));
  CHECK(contains(refusal({"run", "a.toml", "--json", "--brief"}), "excludes"));
}

TEST_CASE("help shows that the port of a page may be left out", "[cli]") {
  const auto x = parse({"run", "--help"});
  REQUIRE(std::holds_alternative<show_command>(x));
  CHECK(contains(std::get<show_command>(x).text, "--view [PORT] "));
}

TEST_CASE("the name of a host is a name", "[cli]") {
  CHECK(contains(refusal({"host", "--name", "a b"}), "1 to 32 letters, digits, - and _"));
}

TEST_CASE("a failure of the operating system is followed by a cure", "[cli]") {
  CHECK(
      with_hint("cannot write a/b: No such file or directory") ==
      "cannot write a/b: No such file or directory; correct the path, or create its folder first");
  CHECK(with_hint("it does not fit") == "it does not fit");
}

TEST_CASE("check takes the files that run takes", "[cli]") {
  const auto x = parse({"check", "a.toml", "--topology", "grid.txt", "--noise-trace", "m.txt"});
  REQUIRE(std::holds_alternative<check_command>(x));
  CHECK(std::get<check_command>(x).file == "a.toml");
  CHECK(std::get<check_command>(x).instead.topology == "grid.txt");
  CHECK(std::get<check_command>(x).instead.noise_trace == "m.txt");
  CHECK_FALSE(std::get<check_command>(x).is_strict);
  CHECK(std::get<check_command>(parse({"check", "a.toml", "--strict"})).is_strict);
  CHECK(std::get<check_command>(parse({"check", "b.toml", "--changes-from", "a.toml"}))
            .changes_from == "a.toml");
  CHECK(std::get<check_command>(parse({"check", "b.toml", "--changes-from", "-"})).changes_from ==
        "-");
  CHECK(contains(refusal({"check", "-", "--changes-from", "-"}),
                 "--changes-from: standard input is FILE already"));
  CHECK(parse_run({"--strict"}).is_strict);
}

TEST_CASE("a key is explained instead of checking a file", "[cli]") {
  const auto x = parse({"check", "--explain", "island.*.jitter"});
  REQUIRE(std::holds_alternative<explain_key_command>(x));
  CHECK(std::get<explain_key_command>(x).key == "island.*.jitter");
  CHECK(contains(refusal({"check", "a.toml", "--explain", "seed"}), "--explain"));
  CHECK(contains(refusal({"check"}), "FILE is required"));
}

TEST_CASE("new takes a template, a file and --force, none of which is required", "[cli]") {
  const auto parse_new = [](std::vector<const char*> words) {
    words.insert(words.begin(), "new");
    const auto x = parse(words);
    REQUIRE(std::holds_alternative<new_command>(x));
    return std::get<new_command>(x);
  };
  CHECK(parse_new({}).name.empty());
  CHECK(parse_new({"home"}).name == "home");
  CHECK(parse_new({"home"}).file.empty());
  CHECK_FALSE(parse_new({"home"}).is_forced);
  CHECK(parse_new({"home", "my.toml", "--force"}).file == "my.toml");
  CHECK(parse_new({"home", "--force"}).is_forced);
}

TEST_CASE("completion is for known shells, and pages have a date", "[cli]") {
  const auto x = parse({"completion", "fish"});
  REQUIRE(std::holds_alternative<completion_command>(x));
  CHECK(std::get<completion_command>(x).shell == "fish");
  CHECK(contains(refusal({"completion", "csh"}), "SHELL"));
  const auto pages = parse({"help", "--pages", "man", "--date", "2026-11-28"});
  REQUIRE(std::holds_alternative<pages_command>(pages));
  CHECK(std::get<pages_command>(pages).folder == "man");
  CHECK(std::get<pages_command>(pages).date == "2026-11-28");
  CHECK(contains(refusal({"help", "--pages", "man", "--date", "today\n.so x"}), "not a date"));
}

TEST_CASE("each option of explain reaches it, and none without meaning", "[cli][explain]") {
  const auto parse_explain = [](std::vector<const char*> words) {
    words.insert(words.begin(), {"explain", "home.rec"});
    const auto x = parse(words);
    REQUIRE(std::holds_alternative<explain_command>(x));
    return std::get<explain_command>(x);
  };
  CHECK(parse_run({"--record", "home.rec"}).options.record_file == "home.rec");
  CHECK(parse_run({}).options.record_file.empty());
  const auto list = parse_explain({"--lost", "--from", "kitchen", "--limit", "3", "--json"});
  CHECK(list.record == "home.rec");
  CHECK(list.what.empty());
  CHECK(list.list.lost_only);
  CHECK(list.list.from == "kitchen");
  CHECK(list.list.limit == 3);
  CHECK(list.json);
  CHECK(parse_explain({}).list.limit == 20);
  CHECK(parse_explain({"a.b", "--at", "3min12s"}).at == duration(192s));
  CHECK(parse_explain({"a.b", "--at", "3:12"}).at == duration(192s));
  CHECK(parse_explain({"a.b", "--at", "0:03:12.250"}).at == duration(192'250ms));
  CHECK(parse_explain({"a.b", "--at", "100:00.000"}).at == duration(100min));
  CHECK(parse_explain({"a.b", "--at", "87600:00:00"}).at == duration(87600h));
  for (const auto* wrong : {"3", "3:", ":3", "3:60", "3:-1", "-3:01", "1:60:00", "1:2:3:4", "3:1s",
                            "3:12.0000000001", "99999999999999999999:00", "5300000:00", ""})
    CHECK(contains(refusal({"explain", "x", "a.b", "--at", wrong}), "1:30)"));
  CHECK(parse_explain({"a.b", "--all"}).all);
  CHECK(contains(refusal({"explain"}), "RECORD"));
  CHECK(contains(refusal({"explain", "x", "--at", "3s"}), "--at: of which tuple?"));
  CHECK(contains(refusal({"explain", "x", "--all"}), "--all: of which tuple?"));
  CHECK(contains(refusal({"explain", "x", "a.b", "--all", "--at", "3s"}), "--at"));
  CHECK(contains(refusal({"explain", "x", "a.b", "--lost"}), "--lost"));
  CHECK(contains(refusal({"explain", "x", "--limit", "-1"}), "--limit"));
  CHECK(contains(refusal({"run", "x.toml", "--check-determinism", "--record", "y"}),
                 "--check-determinism"));
}

TEST_CASE("each option of swarm reaches the swarm", "[cli]") {
  const auto parse_swarm = [](std::vector<const char*> words) {
    words.insert(words.begin(), {"swarm", "home.toml"});
    const auto x = parse(words);
    REQUIRE(std::holds_alternative<swarm_command>(x));
    return std::get<swarm_command>(x);
  };
  const auto x = parse_swarm({"--seeds", "3..10"});
  CHECK(x.file == "home.toml");
  CHECK(x.seeds.first == 3);
  CHECK(x.seeds.last == 10);
  CHECK(!x.jobs);
  CHECK(x.length.empty());
  CHECK(x.timeout == 300s);
  CHECK(!x.json);
  const auto y = parse_swarm({"--seeds", "0..18446744073709551615", "--jobs", "3", "--for", "10min",
                              "--timeout", "90s", "--json"});
  CHECK(y.seeds.last == 18446744073709551615U);
  CHECK(y.jobs == 3U);
  CHECK(y.length == "10min");
  CHECK(y.timeout == 90s);
  CHECK(y.json);
  CHECK(parse_swarm({"--seeds", "7"}).seeds.last == 7); // one seed is a range too
}

TEST_CASE("a swarm without sensible seeds, jobs or times is refused", "[cli]") {
  CHECK(contains(refusal({"swarm", "a.toml"}), "--seeds"));
  const auto seeds = GENERATE(as<const char*>{}, "", "..", "1..", "..3", "3..1", "1-3", "1..3..5",
                              "1...3", "0..18446744073709551616", " 1..2");
  CAPTURE(seeds);
  CHECK(contains(refusal({"swarm", "a.toml", "--seeds", seeds}), "--seeds"));
  CHECK(contains(refusal({"swarm", "a.toml", "--seeds", "1..2", "--jobs", "0"}), "--jobs: not"));
  CHECK(contains(refusal({"swarm", "a.toml", "--seeds", "1..2", "--jobs", "1025"}), "1025"));
  CHECK(contains(refusal({"swarm", "a.toml", "--seeds", "1..2", "--for", "soon"}), "--for: not"));
  CHECK(contains(refusal({"swarm", "a.toml", "--seeds", "1..2", "--timeout", "0s"}),
                 "--timeout: not a length of time: '0s'"));
}

TEST_CASE("each option of serial reaches its command", "[cli][serial]") {
  const auto of = [](std::vector<const char*> words) {
    words.insert(words.begin(), "serial");
    const auto x = parse(words);
    REQUIRE(std::holds_alternative<serial_command>(x));
    return std::get<serial_command>(x);
  };
  const auto heard =
      of({"listen", "/dev/ttyUSB0", "--baud", "telosb", "--count", "3", "--for", "2s", "--json"});
  CHECK(heard.device == "/dev/ttyUSB0");
  CHECK(heard.baud == 115200);
  CHECK(std::get<listen_serial>(heard.what).count == 3);
  CHECK(std::get<listen_serial>(heard.what).length == 2s);
  CHECK(std::get<listen_serial>(heard.what).json);
  const auto sent = of({"send", "sf@host:9003", "0x93", "00ff", "--to", "7", "--group", "0x7d"});
  CHECK(sent.device.empty());
  CHECK(sent.host == "host");
  CHECK(sent.port == 9003);
  const auto& message = std::get<send_serial>(sent.what);
  CHECK(message.am_type == 0x93);
  CHECK(message.payload == bytes{0, 0xff});
  CHECK(message.destination == 7);
  CHECK(message.group == 0x7d);
  CHECK(of({"send", "/dev/ttyS0", "6", "--baud", "38400"}).baud == 38400);
  CHECK(of({"listen", "sf@host"}).port == 9002);
  CHECK(of({"send", "x", "6"}).payload_max == 28);
  CHECK(of({"send", "x", "6", "--payload", "114"}).payload_max == 114);
  CHECK(of({"forward", "x", "0.0.0.0:9004", "--payload", "40"}).payload_max == 40);
  const auto forwarded = of({"forward", "/dev/ttyS0", "0.0.0.0:9004"});
  CHECK(std::get<forward_serial>(forwarded.what).address == "0.0.0.0");
  CHECK(std::get<forward_serial>(forwarded.what).port == 9004);
}

TEST_CASE("a command of serial that makes no sense is refused", "[cli][serial]") {
  CHECK(contains(refusal({"serial", "listen"}), "SOURCE"));
  CHECK(contains(refusal({"serial", "listen", "sf@"}), "not sf@HOST:PORT"));
  CHECK(contains(refusal({"serial", "listen", "sf@host:0"}), "not a number from 1 to 65535"));
  CHECK(contains(refusal({"serial", "listen", "x", "--baud", "fast"}), "neither a platform"));
  CHECK(contains(refusal({"serial", "send", "x", "256"}), "not a number from 0 to 255"));
  CHECK(contains(refusal({"serial", "send", "x", "6", "0"}), "octets in hexadecimal"));
  CHECK(contains(refusal({"serial", "send", "x", "6", std::string(230, '0').c_str()}),
                 "up to 114 octets"));
  CHECK(contains(refusal({"serial", "send", "x", "6", "--payload", "115"}), "from 1 to 114"));
  CHECK(contains(refusal({"serial", "forward", "x", "localhost:9002"}), "IPv4 address"));
}

TEST_CASE("each option of certs reaches its command", "[cli]") {
  const auto parse_certs = [](std::vector<const char*> words) {
    words.insert(words.begin(), "certs");
    const auto x = parse(words);
    REQUIRE(std::holds_alternative<certs_command>(x));
    return std::get<certs_command>(x);
  };
  const auto init = parse_certs({"init"});
  CHECK(init.folder == "certs");
  CHECK(std::get<io::new_authority>(init.what).name == "rubicon");
  CHECK(std::get<io::new_authority>(init.what).days == 3652);
  const auto named = parse_certs({"init", "--dir", "x", "--name", "flat", "--days", "36500"});
  CHECK(named.folder == "x");
  CHECK(std::get<io::new_authority>(named.what).name == "flat");
  CHECK(std::get<io::new_authority>(named.what).days == 36500);
  const auto plain = std::get<io::new_certificate>(parse_certs({"add", "kitchen", "--host"}).what);
  CHECK(plain.use == io::certificate_use::host);
  CHECK(plain.host == "kitchen");
  CHECK(plain.addresses.empty());
  CHECK(plain.days == 825);
  const auto added =
      std::get<io::new_certificate>(parse_certs({"add", "--address", "a.b", "kitchen",
                                                 "--address=::1", "--coordinator", "--days", "1"})
                                        .what);
  CHECK(added.use == io::certificate_use::coordinator);
  CHECK(added.host == "kitchen");
  CHECK(added.addresses == std::vector<std::string>{"a.b", "::1"});
  CHECK(added.days == 1);
  const auto same = std::get<io::renewal>(parse_certs({"renew", "kitchen"}).what);
  CHECK(same.host == "kitchen");
  CHECK(same.days == 825);
  CHECK(!same.new_key);
  CHECK(same.use == io::certificate_use::any);
  const auto other = std::get<io::renewal>(
      parse_certs({"renew", "kitchen", "--new-key", "--host", "--days", "9"}).what);
  CHECK(other.new_key);
  CHECK(other.use == io::certificate_use::host);
  CHECK(other.days == 9);
  CHECK(std::get<revoke_host>(parse_certs({"revoke", "kitchen"}).what).host == "kitchen");
  CHECK(!std::get<list_certificates>(parse_certs({"list"}).what).json);
  CHECK(parse_certs({"list", "--dir", "x"}).folder == "x");
  CHECK(std::get<list_certificates>(parse_certs({"list", "--json"}).what).json);
}

TEST_CASE("a command of certs that makes no sense is refused", "[cli]") {
  CHECK(!refusal({"certs"}).empty());
  for (const auto* each : {"add", "renew", "revoke"}) {
    CHECK(contains(refusal({"certs", each}), "HOST"));
    CHECK(!refusal({"certs", each, "kitchen", "attic"}).empty());
  }
  CHECK(!refusal({"certs", "add", "kitchen", "--host", "--coordinator"}).empty());
  CHECK(!refusal({"certs", "renew", "kitchen", "--host", "--coordinator"}).empty());
  CHECK(contains(refusal({"certs", "init", "--dir", ""}), "--dir"));
  const auto days = GENERATE(as<const char*>{}, "0", "-1", "36501", "1.5", "ten", "");
  CAPTURE(days);
  CHECK(contains(refusal({"certs", "init", "--days", days}), "--days"));
  CHECK(contains(refusal({"certs", "add", "kitchen", "--host", "--days", days}), "--days"));
}

TEST_CASE("options may stand before the file", "[cli]") {
  const auto x = parse({"run", "--json", "--seed", "3", "home.toml"});
  REQUIRE(std::holds_alternative<run_command>(x));
  CHECK(std::get<run_command>(x).file == "home.toml");
}

TEST_CASE("a command line that makes no sense is refused with its reason", "[cli]") {
  const auto line = GENERATE(
      std::vector<const char*>{"fly"}, std::vector<const char*>{"run"},
      std::vector<const char*>{"check"}, std::vector<const char*>{"run", "a.toml", "b.toml"},
      std::vector<const char*>{"run", "a.toml", "--nope"},
      std::vector<const char*>{"check", "a.toml", "--seed", "1"},
      std::vector<const char*>{"run", "a.toml", "--for"},
      std::vector<const char*>{"run", "a.toml", "--for", "soon"},
      std::vector<const char*>{"run", "a.toml", "--for", "0s"},
      std::vector<const char*>{"run", "a.toml", "--for=-3s"},
      std::vector<const char*>{"run", "a.toml", "--seed=-1"},
      std::vector<const char*>{"run", "a.toml", "--seed", "18446744073709551616"},
      std::vector<const char*>{"run", "a.toml", "--seed", "1.5"},
      std::vector<const char*>{"run", "a.toml", "--mode", "fast"},
      std::vector<const char*>{"run", "a.toml", "--speed", "0"},
      std::vector<const char*>{"run", "a.toml", "--speed", "nan"},
      std::vector<const char*>{"run", "a.toml", "--speed", "inf"},
      std::vector<const char*>{"run", "a.toml", "--log", "loud"},
      std::vector<const char*>{"run", "a.toml", "--pcap"},
      std::vector<const char*>{"run", "a.toml", "--pcap="},
      std::vector<const char*>{"run", "a.toml", "--pcap-lost"},
      std::vector<const char*>{"run", "a.toml", "--topology", ""},
      std::vector<const char*>{"check", "a.toml", "--pcap", "x"},
      std::vector<const char*>{"run", "a.toml", "--check-determinism", "--mode", "wall"});
  const auto text = refusal(line);
  CAPTURE(line, text);
  CHECK(text.starts_with("rubicon: "));
  const bool is_command = std::string_view(line[0]) != "fly";
  CHECK(text.ends_with("\nSee rubicon " + (is_command ? line[0] + std::string(" ") : "") +
                       "--help.\n"));
}

TEST_CASE("a refusal names the option and what was wrong with it", "[cli]") {
  CHECK(contains(refusal({"run", "a.toml", "--nope"}), "--nope"));
  CHECK(
      contains(refusal({"run", "a.toml", "--for", "soon"}), "--for: not a length of time: 'soon'"));
  CHECK(contains(refusal({"run", "a.toml", "--seed=-1"}), "'-1'"));
  CHECK(contains(refusal({"run"}), "FILE"));
}

TEST_CASE("who mistypes a command or an option is told what was meant", "[cli]") {
  const auto meant = [](const std::string& what, const std::string& command) {
    return "rubicon: " + what + "\nSee rubicon " + command + "--help.\n";
  };
  CHECK(refusal({"rnu", "a.toml"}) == meant("there is no command `rnu`: did you mean `run`?", ""));
  CHECK(refusal({"help", "rnu"}) == meant("there is no command `rnu`: did you mean `run`?", ""));
  CHECK(refusal({"run", "a.toml", "--sed", "3"}) ==
        meant("there is no option `--sed`: did you mean `--seed`?", "run "));
  CHECK(refusal({"swarm", "a.toml", "--seed=1..3"}) ==
        meant("there is no option `--seed`: did you mean `--seeds`?", "swarm "));
  CHECK(refusal({"tuples", "set", "lamp"}).ends_with("\nSee rubicon tuples set --help.\n"));
  CHECK(refusal({"tuples", "gte"})
            .starts_with("rubicon: there is no command `gte`: did you mean `get`?"));
  CHECK(refusal({"frobnicate"}).starts_with("rubicon: there is no command `frobnicate`: "));
  CHECK(refusal({"swarm", "-", "--seeds", "1..3"}).find("standard input") != std::string::npos);
}

TEST_CASE("help names every role and every exit status", "[cli][GEN-01]") {
  const auto x = parse({"--help"});
  REQUIRE(std::holds_alternative<show_command>(x));
  const auto& text = std::get<show_command>(x).text;
  for (const auto* role :
       {"mote", "sink", "gateway", "PEIS peer", "proxy", "proxy manager", "init"}) {
    CAPTURE(role);
    CHECK(contains(text, "\n  " + std::string(role) + ' '));
  }
  CHECK(contains(text, "Exit status: 0 success; 1"));
}

TEST_CASE("version and a command's help are shown, not refused", "[cli]") {
  const auto version = parse({"--version"});
  REQUIRE(std::holds_alternative<show_command>(version));
  CHECK(std::get<show_command>(version).text.starts_with("rubicon "));
  CHECK(std::holds_alternative<show_command>(parse({"run", "--help"})));
}

TEST_CASE("help of a command is what its --help shows, and of none the overview", "[cli]") {
  const auto shown = [](std::vector<const char*> words) {
    const auto x = parse(std::move(words));
    REQUIRE(std::holds_alternative<show_command>(x));
    return std::get<show_command>(x).text;
  };
  CHECK(shown({}) == shown({"--help"}));
  CHECK(shown({"help"}) == shown({"--help"}));
  CHECK(shown({"help", "run"}) == shown({"run", "--help"}));
  CHECK(contains(shown({"help", "--help"}), "Show the help of a command"));
  CHECK(shown({"help", "help"}) == shown({"help", "--help"}));
  CHECK(shown({"help", "tuples", "set"}) == shown({"tuples", "set", "--help"}));
}

TEST_CASE("a condition compares numbers as numbers, and all else as text", "[cli][SVC-08]") {
  const auto holds = [](const char* condition, const char* value) {
    const auto x = parse_condition(condition);
    REQUIRE(x);
    return x->holds(value);
  };
  CHECK(holds("on", "on"));
  CHECK_FALSE(holds("on", "ON"));
  CHECK(holds("= on", "on"));
  CHECK(holds("=on", "on"));
  CHECK(holds("!= on", "off"));
  CHECK_FALSE(holds("!= on", "on"));
  CHECK(holds("21", "21.0"));
  CHECK_FALSE(holds("!= 21", "21.0"));
  CHECK(holds("> 20", "20.5"));
  CHECK_FALSE(holds("> 20", "20"));
  CHECK(holds(">= 20", "20"));
  CHECK(holds("<-3.5", "-4"));
  CHECK(holds("<= 20", "20"));
  CHECK_FALSE(holds("< 20", "20"));
  CHECK_FALSE(holds("< 20", "unknown"));
  CHECK(holds("!= 20", "unknown"));
  CHECK(holds("", ""));
  CHECK(holds("= = 1", "= 1"));
  CHECK_FALSE(parse_condition("> warm"));
  CHECK_FALSE(parse_condition("<="));
}

TEST_CASE("a host serves metrics only on request", "[cli][ACT-06]") {
  const auto host = [](std::vector<const char*> words) {
    words.insert(words.begin(), {"host", "--name", "west"});
    const auto x = parse(words);
    REQUIRE(std::holds_alternative<host_command>(x));
    return std::get<host_command>(x);
  };
  CHECK_FALSE(host({}).metrics);
  const auto local = host({"--metrics", "9464"});
  REQUIRE(local.metrics);
  CHECK(local.metrics->at.address == "127.0.0.1");
  CHECK(local.metrics->at.port == 9464);
  CHECK_FALSE(local.metrics->motes);
  const auto others = host({"--metrics-of-motes", "--metrics", "192.168.1.5:0"});
  REQUIRE(others.metrics);
  CHECK(others.metrics->at.address == "192.168.1.5");
  CHECK(others.metrics->motes);
  CHECK(contains(refusal({"host", "--name", "west", "--metrics-of-motes"}), "--metrics"));
  CHECK(contains(refusal({"host", "--name", "west", "--metrics", "web"}), "--metrics"));
}

TEST_CASE("an import may name its sink and its format", "[cli]") {
  const auto x = parse({"import", "hall.k7.gz", "-", "--sink", "3", "--format", "k7"});
  REQUIRE(std::holds_alternative<import_command>(x));
  const auto& import = std::get<import_command>(x);
  CHECK(import.sink == "3");
  CHECK(import.to == "-");
  CHECK(import.format == imports::format::k7);
  CHECK(contains(refusal({"import", "a", "--format", "k8"}), "there is no format 'k8'"));
}

TEST_CASE("settings are kept in their order, and repeated", "[cli]") {
  const std::vector<std::string> all{"radio.loss=0.2", "island.*.sink.position_m=[3, 4]"};
  const auto run = parse_run({"--set", all[0].c_str(), "--set", all[1].c_str()});
  CHECK(run.instead.settings == all);
  CHECK(run.deciding == std::vector<std::string>{"--set", "radio.loss=0.2", "--set",
                                                 "island.*.sink.position_m=[3, 4]"});
  const auto check = parse({"check", "a.toml", "--set", all[1].c_str()});
  REQUIRE(std::holds_alternative<check_command>(check));
  CHECK(std::get<check_command>(check).instead.settings == std::vector{all[1]});
  const auto swarm = parse({"swarm", "a.toml", "--set", all[0].c_str(), "--seeds", "1..2"});
  REQUIRE(std::holds_alternative<swarm_command>(swarm));
  CHECK(std::get<swarm_command>(swarm).settings == std::vector{all[0]});
}

TEST_CASE("a sweep has variations, seeds and a database", "[cli]") {
  const auto x = parse({"sweep", "a.toml", "--vary", "loss=0,0.1", "--vary", "range=15m..25m/5",
                        "--seeds", "1..30", "--out", "study.db", "--set", "radio.queue=3"});
  REQUIRE(std::holds_alternative<sweep_command>(x));
  const auto& sweep = std::get<sweep_command>(x);
  REQUIRE(sweep.variations.size() == 2);
  CHECK(sweep.variations[0].path == "loss");
  CHECK(sweep.variations[1].values == std::vector<std::string>{"15m", "20m", "25m"});
  CHECK(sweep.seeds.last == 30);
  CHECK(sweep.database == "study.db");
  CHECK(contains(refusal({"sweep", "a.toml", "--vary", "loss=1..2", "--seeds", "1", "--out", "d"}),
                 "'loss=1..2' is not a range"));
  CHECK(contains(refusal({"sweep", "-", "--vary", "loss=1", "--seeds", "1", "--out", "d"}),
                 "not from standard input"));
  CHECK(contains(refusal({"sweep", "a.toml", "--vary", "loss=1", "--out", "d"}), "--seeds"));
}

TEST_CASE("the database of a sweep is named after its file, unless it has a name of its own",
          "[cli]") {
  const auto x = parse({"sweep", "config/room.v2.toml", "--vary", "loss=1", "--seeds", "1"});
  REQUIRE(std::holds_alternative<sweep_command>(x));
  CHECK(std::get<sweep_command>(x).database == "room.v2.db");
}

TEST_CASE("a sweep until a figure is precise has a rule", "[cli]") {
  const std::vector<const char*> words{"sweep",   "a.toml",         "--vary",     "loss=0,0.1",
                                       "--seeds", "1..30",          "--out",      "d.db",
                                       "--until", "events ci < 1%", "--quantile", "0.9"};
  const auto x = parse(words);
  REQUIRE(std::holds_alternative<sweep_command>(x));
  REQUIRE(std::get<sweep_command>(x).until.has_value());
  CHECK(std::get<sweep_command>(x).until->figure == "events");
  CHECK(std::get<sweep_command>(x).quantile == 0.9);
  CHECK(contains(refusal({"sweep", "a.toml", "--vary", "loss=0", "--seeds", "1", "--out", "d",
                          "--until", "events"}),
                 "'events' needs a figure"));
  CHECK(contains(refusal({"sweep", "a.toml", "--vary", "loss=0", "--seeds", "1", "--out", "d",
                          "--quantile", "90"}),
                 "'90' is no number from 0 to 1"));
}

TEST_CASE("two things are compared over seeds", "[cli]") {
  const auto x = parse({"compare", "a.toml", "b.toml"});
  REQUIRE(std::holds_alternative<compare_command>(x));
  CHECK(std::get<compare_command>(x).a == "a.toml");
  CHECK(std::get<compare_command>(x).b == "b.toml");
  CHECK(std::get<compare_command>(x).seeds.first == 1);
  CHECK(std::get<compare_command>(x).seeds.last == 20);
  const auto y = parse(
      {"compare", "old", "new", "--file", "a.toml", "--seeds", "3..4", "--of", "events", "--full"});
  REQUIRE(std::holds_alternative<compare_command>(y));
  CHECK(std::get<compare_command>(y).file == "a.toml");
  CHECK(std::get<compare_command>(y).scalars == std::vector<std::string>{"events"});
  CHECK(contains(refusal({"compare", "a.toml"}), "B is required"));
}

TEST_CASE("a file is shrunk under one seed", "[cli]") {
  const auto x = parse({"shrink", "a.toml", "--seed", "7", "--set", "radio.queue=3"});
  REQUIRE(std::holds_alternative<shrink_command>(x));
  CHECK(std::get<shrink_command>(x).seed == 7);
  CHECK(std::get<shrink_command>(x).out.empty());
  CHECK(contains(refusal({"shrink", "a.toml"}), "--seed"));
  CHECK(contains(refusal({"shrink", "-", "--seed", "1"}), "not from standard input"));
  CHECK(contains(refusal({"compare", "a", "b", "--file", "-"}), "not from standard input"));
}
