// What a run counts is what happened: whatever crashes, is refused or is started again.
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "ecology/faults/recorded.hpp"
#include "ecology_files.hpp"
#include "explain/outcome.hpp"
#include "explain/traces.hpp"
#include "report/print/metrics.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

using verdict = report::expectation_report::verdict;

/// A line of motes 20 m apart, `m-2` next to the sink.
std::string line(int motes, const std::string& near, const std::string& far) {
  std::string toml = "[ecology]\nname = 'line'\nduration = '20min'\n[radio]\nrange = '24m'\n"
                     "[mote_type.m]\ntype = 1\n"
                     "transducers.temperature = { model = 'constant', value = 20 }\n"
                     "[[island]]\nname = 'a'\nid = 1\nkeep_alive = '30s'\n"
                     "sink.position_m = [0, 0]\n";
  for (int i = 0; i < motes; ++i)
    toml += "[[island.mote]]\nid = " + std::to_string(i + 2) + "\ntype = 'm'\nposition_m = [" +
            std::to_string(20 * (i + 1)) + ", 0]\napps = [" +
            (i == 0           ? near
             : i == motes - 1 ? far
                              : std::string()) +
            "]\n";
  return toml;
}

const report::mote_report& mote_of(const report::run_report& x, std::uint16_t id) {
  for (const auto& mote : x.islands.at(0).motes)
    if (mote.address.mote == mote_id{id})
      return mote;
  throw std::runtime_error("no such mote");
}

} // namespace

TEST_CASE("a message that is refused is counted as one that was offered", "[ecology][counters]") {
  const auto toml =
      line(4, "{ app = 'listener', am_type = 10 }",
           "{ app = 'messenger', to = 'a/m-2', text = 'x', every = '50ms' }") +
      "[[fault]]\nat = '5min'\nkind = 'battery_end'\nmote = 'a/m-3'\n"; // the way is cut for good
  const auto x = run(describe(toml));
  const auto& far = mote_of(x, 5).messages;
  CHECK(far.offered > 5'000);
  CHECK(far.refused.at("crowded") > 100);
  CHECK(far.offered == report::total(far.refused) + far.reliable_sent);
  CHECK(far.reliable_sent == far.reliable_acked + far.reliable_failed + far.reliable_open);
  CHECK(*far.delivery() < 0.9);
}

TEST_CASE("records that fell between two openings are missing", "[ecology][counters]") {
  const auto toml =
      line(5, "{ app = 'stream_reader', stream = 3, every = '1s' }",
           "{ app = 'stream_writer', transducer = 'temperature', stream = 3, every = '1s', "
           "to = 'a/m-2' }") +
      "[[fault]]\nevery = '41s'\nfrom = '2min'\nuntil = '15min'\nkind = 'crash'\nmote = 'a/m-4'\n"
      "[[fault]]\nat = '10min'\nkind = 'crash'\nmote = 'a/m-6'\n"
      "[[fault]]\nat = '11min'\nkind = 'crash'\nmote = 'a/m-2'\n";
  const auto x = run(describe(toml));
  REQUIRE(x.streams.size() == 1);
  const auto& stream = x.streams[0];
  CHECK(stream.from == "a/m-6");
  CHECK(stream.to == "a/m-2");
  CHECK(stream.openings > 5);
  CHECK(stream.missing > 20);
  CHECK(stream.produced == stream.read + stream.open + stream.missing);
  double records = 0;
  double missing = 0;
  double written = 0;
  for (const auto& program : x.programs)
    for (const auto& [name, value] : program.figures) {
      records += name == "records" ? value : 0;
      missing += name == "records missing" ? value : 0;
      written += name == "records written" ? value : 0;
    }
  CHECK(records == static_cast<double>(stream.read)); // in all lives of both
  CHECK(missing == static_cast<double>(stream.missing));
  CHECK(written == static_cast<double>(stream.written));
  CHECK(stream.written > 600);
  CHECK(stream.pause > 3s);
}

TEST_CASE("packets of channels are lost once, and the living alone are aligned",
          "[ecology][counters]") {
  const auto toml =
      line(3, "{ app = 'stream_reader', stream = 3, every = '1s' }",
           "{ app = 'stream_writer', transducer = 'temperature', stream = 3, every = '1s', "
           "to = 'a/m-2' }") +
      "[[fault]]\nevery = '60s'\nfrom = '2min'\nkind = 'crash'\nmote = 'a/m-3'\n";
  auto what = describe(toml);
  what.radio.loss = 0.3;
  const auto x = run(what);
  const auto& network = x.islands.at(0).network;
  const auto& packets = network.channel_packets;
  CHECK(packets.sent == packets.arrived + report::total(packets.lost) + packets.in_transit);
  CHECK(report::total(packets.lost) > 0);
  CHECK(!packets.lost.contains("unknown"));
  CHECK(network.aligned <= 3);
  CHECK(network.synchronised <= 3);
}

TEST_CASE("actuations survive the end of the PC that has asked for them", "[ecology][counters]") {
  auto what = example("home.toml");
  const auto before = run(what);
  const auto pc = std::ranges::find_if(what.peers, [](const auto& peer) {
    return std::ranges::any_of(peer.apps, [](const auto& app) {
      return std::holds_alternative<config::proxy_manager_app>(app);
    });
  });
  REQUIRE(pc != what.peers.end());
  std::uint64_t requested = 0;
  for (const auto& proxy : before.proxies)
    requested += proxy.actuations.requested;
  REQUIRE(requested > 0);
  what.faults.push_back({what.length - 30s, config::kill_fault{pc->id, 5s}});
  std::uint64_t kept = 0;
  for (const auto& proxy : run(what).proxies)
    kept += proxy.actuations.requested;
  CHECK(kept + 2 >= requested); // nearly all were asked for before
}

TEST_CASE("the report tells the tree and how strongly a parent is heard", "[ecology][counters]") {
  const auto x = run(describe(line(3, "", "")));
  CHECK(mote_of(x, 2).parent == default_sink);
  CHECK(mote_of(x, 3).parent == mote_id{2});
  CHECK(mote_of(x, 4).parent == mote_id{3});
  CHECK(mote_of(x, 4).hops == 3);
  REQUIRE(mote_of(x, 4).signal_dbm);
  CHECK(*mote_of(x, 4).signal_dbm < 0);
}

TEST_CASE("a run is judged by what its file expects", "[ecology][expect]") {
  auto toml = line(3, "{ app = 'listener' }",
                   "{ app = 'messenger', to = 'a/m-2', text = 'x', every = '10s' }");
  const auto expect = [&toml](const std::string& keys) { toml += "[[expect]]\n" + keys; };
  expect("kind = 'joined'\nwithin = '30s'\n");
  expect("kind = 'delivery'\nof = 'a/m-4'\nat_least = '99%'\n");
  expect("kind = 'clock'\nat_most = '1ms'\n");
  expect("kind = 'battery'\nat_least = '99%'\n");
  expect("kind = 'events'\nat_most = 10\n");
  expect("kind = 'joined'\nof = 'a/m-2'\nwithin = '1ms'\n");
  const auto x = run(describe(toml));
  REQUIRE(x.expectations.size() == 6);
  for (std::size_t i = 0; i < 4; ++i) {
    INFO(x.expectations[i].text << ": " << x.expectations[i].measured);
    CHECK(x.expectations[i].outcome == verdict::met);
  }
  CHECK(x.expectations[2].measured.find("samples") != std::string::npos);
  CHECK(x.expectations[4].outcome == verdict::unmet);
  CHECK(x.expectations[5].outcome == verdict::unmet);
  CHECK(x.expectations[5].at == instant{} + 1ms);
  REQUIRE(x.violations.size() == 2);
  CHECK(x.violations[0].invariant == "expected: events <= 10");
  CHECK(x.expectations[5].command == "rubicon run FILE --seed 1 --for 2ms --log info");
}

TEST_CASE("tuples are seen as programs set them", "[ecology][expect]") {
  std::string toml = "[ecology]\nname = 't'\nduration = '2min'\n"
                     "[[peer]]\nname = 'a'\nid = 1\n"
                     "apps = [{ app = 'goal', name = 'g', outputs = [{ name = 'n', value = 0, "
                     "every = '10s', step = 1 }] },\n"
                     "{ app = 'translate', rules = [{ from = 'g.n', to = 'g.twice', "
                     "value = '2 * x' }] }]\n";
  const auto expect = [&toml](const std::string& keys) {
    toml += "[[expect]]\nkind = 'tuple'\n" + keys;
  };
  expect("key = 'g.twice'\nabove = 6\nwithin = '1s'\nwhen = { key = 'g.n', equals = ['3'] }\n");
  expect("key = 'g.twice'\nabove = 100\nwithin = '1s'\nwhen = { key = 'g.n', equals = ['3'] }\n");
  expect("key = 'g.n'\nabove = 5\nwithin = '1min'\n");
  const auto x = run(describe(toml));
  REQUIRE(x.expectations.size() == 3);
  INFO(x.expectations[0].measured);
  CHECK(x.expectations[0].outcome == verdict::met);
  CHECK(x.expectations[1].outcome == verdict::unmet);
  CHECK(x.expectations[2].outcome == verdict::met);
}

TEST_CASE("vectors missed before a time do not count", "[ecology][expect]") {
  auto what = example("learning.toml");
  what.length = 4min;
  what.expectations.emplace_back(config::vectors_expectation{"*", 0, 2min});
  const auto x = run(what);
  REQUIRE(x.expectations.size() == 1);
  INFO(x.expectations[0].measured);
  CHECK(x.expectations[0].outcome == verdict::met);
  CHECK(x.expectations[0].measured.find("updated") != std::string::npos);
}

TEST_CASE("no loss is told that did not happen", "[ecology][explain]") {
  auto what = example("learning.toml");
  what.length = 1min;
  const auto run = run_recorded(what);
  const auto all = explain::follow(run.content);
  std::uint64_t lost = 0;
  std::uint64_t later = 0;
  for (const auto& x : all.messages) {
    if (explain::outcome_of(all, x).status != explain::message_status::lost)
      continue;
    ++lost;
    later += all.nodes[x.root].begin > instant{} + 2s ? 1 : 0; // channels are set up before
  }
  std::uint64_t counted = 0;
  for (const auto& x : run.report.losses)
    counted += x.count;
  CHECK(all.messages.size() > 1'000);
  CHECK(lost == counted);
  CHECK(later == 0);
}

namespace {

/// The counters of a run's metrics, by name and labels.
std::map<std::string, double> counters_of(const report::run_report& x) {
  std::map<std::string, double> counters;
  std::istringstream text(report::to_metrics(x, {.motes = true}));
  for (std::string line; std::getline(text, line);) {
    const auto name = line.substr(0, line.find_first_of("{ "));
    if (name.ends_with("_total"))
      counters[line.substr(0, line.rfind(' '))] = std::stod(line.substr(line.rfind(' ')));
  }
  return counters;
}

} // namespace

TEST_CASE("no counter of the metrics falls while its source lives", "[ecology][counters]") {
  const std::string folder = RUBICON_CONFIG_DIR;
  for (const auto* file :
       {"/home.toml", "/learning.toml", "/smepp-line.toml", "/scenarios/two-gateways.toml"}) {
    auto home = ecology::of_file(folder + file);
    std::map<std::string, double> before;
    for (int i = 0; i < 20; ++i) {
      home.run_for(20s);
      auto now = counters_of(home.report());
      for (const auto& [name, value] : before) {
        CAPTURE(file, i, name, value);
        if (!now.contains(name))
          CHECK(name.find("_total{peer=") !=
                std::string::npos); // counters of a life that has ended
        else if (name.find("_total{peer=") == std::string::npos)
          CHECK(now.at(name) >= value);
      }
      before = std::move(now);
    }
  }
}
