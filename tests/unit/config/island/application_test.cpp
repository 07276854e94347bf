// Programs that use the Mockup interface, in files.
#include <memory>
#include <string>

#include "apps/application.hpp"
#include "apps/tables.hpp"
#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// A mote with one app, in line 19.
std::string mote_running(const std::string& app) {
  return mote_head + "apps = [{ app = " + app + " }]\n";
}

/// A peer, called pc, with one app, in line 6.
std::string peer_with(const std::string& app) {
  return std::string(head) + "apps = [{ app = " + app + " }]\n";
}

template <class App>
App on_mote(const std::string& text) {
  return std::get<App>(
      std::get<apps::app_config>(good(mote_running(text)).islands.at(0).motes.at(0).apps.at(0)));
}

template <class App>
App on_peer(const std::string& text) {
  return std::get<App>(std::get<apps::app_config>(good(peer_with(text)).peers.at(0).apps.at(0)));
}

} // namespace

TEST_CASE("an average has streams to read and others to write", "[config][STR-22]") {
  const auto x = on_mote<apps::average_config>("\"average\", streams = [1, 2, 3], every = \"2s\", "
                                               "outputs = [{ to = \"k/c-2\", stream = 8 }, "
                                               "{ to = \"k-gateway\", stream = 9 }]");
  CHECK(x.streams == std::vector<std::uint16_t>{1, 2, 3});
  CHECK(x.every == 2s);
  REQUIRE(x.outputs.size() == 2);
  CHECK(x.outputs[0].to == mote_address{island_id{1}, mote_id{2}});
  CHECK(x.outputs[0].stream == 8);
  CHECK(x.outputs[1].to == mote_address{island_id{1}, no_mote}); // programs run there too
  CHECK(x.outputs[1].stream == 9);
}

TEST_CASE("a switch has two thresholds and a mote that it commands", "[config][DIS-02]") {
  const auto x = on_mote<apps::stream_switch_config>(
      "\"stream_switch\", on_at = 200, off_at = 250.5, to = \"k/c-2\"");
  CHECK(x.stream == 1);
  CHECK(x.every == 1s);
  CHECK(x.on_at == 200);
  CHECK(x.off_at == 250.5);
  CHECK(x.to == mote_address{island_id{1}, mote_id{2}});
  CHECK(x.channel == 2);
}

TEST_CASE("a program of a mote may have an actor of its own", "[config][PAR-05]") {
  const std::string plain = "\"stream_writer\", transducer = \"temperature\", to = \"k-gateway\"";
  on_mote<apps::stream_writer_config>(plain + ", place = \"mote\"");
  const auto all = good(mote_running(plain + ", place = \"actor\", stream = 4"));
  const auto& app = std::get<separate_app>(all.islands.at(0).motes.at(0).apps.at(0));
  CHECK(std::get<apps::stream_writer_config>(app.program).stream == 4);
  CHECK(problem_in(mote_running("\"stream_writer\", transducer = \"light\", to = \"k-gateway\", "
                                "place = \"actor\""))
            .find("no transducer `light`") != std::string::npos);
  CHECK(problem_in(mote_running(plain + ", place = \"moon\"")).starts_with("19:"));
  CHECK(problem_in(peer_with("\"stream_reader\", place = \"actor\"")).find("unknown key `place`") !=
        std::string::npos);
}

TEST_CASE("recorders run on peers and gateways", "[config]") {
  const auto x = on_peer<apps::recorder_config>("\"recorder\", streams = [4], file = \"out.csv\"");
  CHECK(x.streams == std::vector<std::uint16_t>{4});
  CHECK(x.file == "out.csv");
  const auto all =
      good(std::string(island_head) +
           "gateway.apps = [{ app = \"recorder\", streams = [4], file = \"out.csv\" }]\n");
  REQUIRE(all.islands.at(0).gateway_apps.size() == 1);
  CHECK(std::get<apps::recorder_config>(all.islands[0].gateway_apps[0]).file == "out.csv");
  CHECK(summary(all).find("gateway of k, recorder") != std::string::npos);
}

TEST_CASE("programs that cannot work are told", "[config]") {
  CHECK(problem_in(mote_running("\"average\", streams = [1], outputs = []")).starts_with("19:"));
  CHECK(problem_in(
            mote_running("\"average\", streams = [1, 2, 1], outputs = [{ to = \"pc\", stream = "
                         "3 }]"))
            .find("stream 1 is already listed") != std::string::npos);
  const auto to_self = problem_in(
      mote_running("\"average\", streams = [1, 2], outputs = [{ to = \"k/c-2\", stream = 2 }]"));
  CHECK(to_self.find("stream 2 is read by this average") != std::string::npos);
  CHECK(problem_in(mote_running("\"stream_switch\", on_at = 3, off_at = 3, to = \"k/c-2\""))
            .find("`off_at` must not be equal to `on_at`") != std::string::npos);
  CHECK(problem_in(mote_running("\"recorder\", streams = [1], file = \"a.csv\""))
            .find("not \"recorder\"") != std::string::npos);
  const std::string twice = "apps = [{ app = \"recorder\", streams = [1], file = \"a.csv\" }, "
                            "{ app = \"recorder\", streams = [2], file = \"a.csv\" }]\n";
  CHECK(problem_in(std::string(head) + twice).find("file `a.csv` is already written") !=
        std::string::npos);
  const std::string many = "count = 2\napps = [{ app = \"recorder\", streams = [1], file = "
                           "\"a.csv\" }]\n";
  CHECK(problem_in(std::string(head) + many).find("a file has one recorder, not 2") !=
        std::string::npos);
}

TEST_CASE("two ends of one name at a node are told: one would never open", "[config][MCK-01]") {
  const auto said = [](const std::string& toml) { return problem_in(toml); };
  const std::string writer = "{ app = \"stream_writer\", transducer = \"temperature\", ";
  const auto on = [](const std::string& apps) { return mote_head + "apps = [" + apps + "]\n"; };
  CHECK(said(on(writer + "to = \"k-gateway\", stream = 4 }, " + writer +
                "to = \"k/c-2\", stream = 4 }"))
            .find("the write end of stream 4 at this node is already taken") != std::string::npos);
  CHECK(said(on("{ app = \"stream_reader\", stream = 5 }, { app = \"average\", streams = [4, 5], "
                "outputs = [{ to = \"k-gateway\" }] }"))
            .find("the read end of stream 5 at this node is already taken") != std::string::npos);
  CHECK(said(on("{ app = \"reservoir\", from = [{ node = \"k-gateway\" }] }, "
                "{ app = \"readout\", from = [{ node = \"k-gateway\" }] }"))
            .find("the channel from 1/65533 of this node is already taken") != std::string::npos);
  CHECK(said(std::string(head) + "apps = [{ app = \"stream_reader\", stream = 5 }, "
                                 "{ app = \"recorder\", streams = [5], file = \"a.csv\" }]\n")
            .find("the read end of stream 5 at this node is already taken") != std::string::npos);
  // Both ends of one stream, and one stream to several nodes, are different names.
  CHECK(said(on(writer + "to = \"k/c-2\", stream = 4 }, { app = \"stream_reader\", stream = 4 }, " +
                writer + "to = \"k-gateway\", stream = 5 }")) == "none");
}

TEST_CASE("vectors that a tick has no time for are told, with the numbers", "[config][SYN-16]") {
  const auto island = [](int motes, int size, const std::string& more = "") {
    auto toml = std::string(island_head) + more;
    std::string to;
    for (int i = 0; i < motes; ++i) {
      const auto id = std::to_string(2 + i);
      toml += "[[island.mote]]\nid = " + id + "\ntype = \"c\"\nposition_m = [1, 2]\n";
      to += "{ node = \"k/c-" + id + "\", size = " + std::to_string(size) + " }, ";
    }
    return toml +
           "[[island.mote]]\nid = 90\ntype = \"c\"\nposition_m = [1, 2]\n"
           "apps = [{ app = \"reservoir\", to = [" +
           to + "] }]\n";
  };
  CHECK(problem_in(island(32, 16)) == "none");
  CHECK(problem_in(island(20, 64)) == "none");
  const auto many = problem_in(island(40, 64));
  CHECK(many.find("the synaptic channels of a mote take 689 ms of its radio's time at each tick "
                  "(120 packets of 10960 octets), but a tick is 500 ms") != std::string::npos);
  const auto to_gateway = [&](const std::string& baud) {
    return island(1, 1, "serial.baud = " + baud + "\n") +
           "[[island.mote]]\nid = 91\ntype = \"c\"\nposition_m = [1, 2]\n"
           "apps = [{ app = \"reservoir\", to = [{ node = \"k-gateway\", size = 64 }] }]\n";
  };
  CHECK(problem_in(to_gateway("9600")) == "none");
  CHECK(problem_in(to_gateway("4800"))
            .find("synaptic vectors take 871 ms of the serial line at each tick (6 packets of 322 "
                  "octets at 4800 baud), but a tick is 500 ms") != std::string::npos);
}

TEST_CASE("applications that the binary brings along have the keys that they list",
          "[config][GEN-04][PAR-05]") {
  class idle final : public apps::application {
    void on_start(instant) override {}
  };
  extensions known;
  apps::application_kind kind;
  kind.name = "guard";
  kind.keys = {{.name = "below", .otherwise = 0.0, .required = true, .min = -40, .max = 60},
               {.name = "loud", .otherwise = false},
               {.name = "word", .otherwise = std::string("frost")},
               {.name = "every", .otherwise = duration(10s)}};
  kind.make = [](const apps::settings&, random_stream) { return std::make_unique<idle>(); };
  kind.streams = 20;
  CHECK(known.applications.add(kind));
  CHECK_FALSE(known.applications.add(kind));
  const auto load = [&known](const std::string& text) {
    return load_text(text, "test", {}, {}, {}, known);
  };
  const auto problem = [&load](const std::string& text) {
    const auto x = load(text);
    return x.problems.size() == 1 ? to_string(x.problems[0]) : std::to_string(x.problems.size());
  };

  const auto x = load(mote_running("\"guard\", below = 3, loud = true, every = \"2s\""));
  REQUIRE(x.ecology);
  const auto& app = std::get<apps::app_config>(x.ecology->islands.at(0).motes.at(0).apps.at(0));
  CHECK(kind_of(app) == "guard");
  const auto& values = std::get<apps::custom_config>(app).values;
  CHECK(values.get<double>("below") == 3);
  CHECK(values.get<bool>("loud"));
  CHECK(values.get<std::string>("word") == "frost");
  CHECK(values.get<duration>("every") == 2s);
  CHECK(apps::make_application(app, random_stream(1)) != nullptr);
  CHECK(apps::ends_max(4, {app}) == 20);

  CHECK(load(peer_with("\"guard\", below = 3")).ecology);
  const auto beside = load(mote_running("\"guard\", below = 3, place = \"actor\""));
  REQUIRE(beside.ecology);
  CHECK(std::holds_alternative<separate_app>(beside.ecology->islands.at(0).motes.at(0).apps.at(0)));
  CHECK(problem(mote_running("\"guard\"")).find("`below`") != std::string::npos);
  CHECK(problem(mote_running("\"guard\", below = 61")).starts_with("test:19:"));
  CHECK(problem(mote_running("\"guard\", below = 3, above = 4")).find("`above`") !=
        std::string::npos);
  CHECK(problem_in(mote_running("\"guard\", below = 3")).find("guard") != std::string::npos);
}
