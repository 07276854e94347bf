// Samples of a run, and what they change: nothing.
#include <algorithm>
#include <map>
#include <set>

#include "ecology_files.hpp"
#include "report/history.hpp"
#include "report/report_parts.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

struct seen_run {
  report::run_report report;
  std::vector<report::run_sample> samples;
  std::vector<report::tuple_write> tuples;
};

seen_run look_at_run(config::ecology_description ecology, duration every, unsigned threads = 1) {
  seen_run x;
  run_options options;
  options.threads = threads;
  options.look_every = every;
  options.on_sample = [&x](const report::run_sample& y) { x.samples.push_back(y); };
  options.on_tuple = [&x](const report::tuple_write& y) { x.tuples.push_back(y); };
  x.report = run_ecology(std::move(ecology), options);
  return x;
}

} // namespace

TEST_CASE("looking at a run changes nothing", "[ecology][ACT-05]") {
  for (const auto* file :
       {"home.toml", "learning.toml", "scenarios/churn.toml", "intel-lab.toml"}) {
    auto ecology = example(file);
    ecology.length = std::min<duration>(ecology.length, 6min);
    CAPTURE(file);
    const auto without = run_ecology(ecology, {});
    for (const unsigned threads : {1U, 3U}) {
      const auto with = look_at_run(ecology, 777ms, threads);
      CHECK(with.report.trace_hash == without.trace_hash);
      CHECK(with.report.events == without.events);
      CHECK(with.report.used_mah() == without.used_mah());
    }
  }
}

TEST_CASE("samples tell which peers run, and what waits in them", "[ecology]") {
  auto home = example("home.toml");
  home.length = 40s;
  home.faults = {{25s, config::kill_fault{peer_id{2}, 5s}}};
  const auto x = look_at_run(home, 9s);
  const auto gateway_at = [&x](std::size_t sample) {
    const auto& peers = x.samples.at(sample).peers;
    REQUIRE(std::ranges::is_sorted(peers, {}, &report::peer_sample::name));
    const auto found = std::ranges::find(peers, "bedroom-gateway", &report::peer_sample::name);
    REQUIRE(found != peers.end());
    return *found;
  };
  CHECK(gateway_at(1).runs);
  CHECK(gateway_at(1).to_sink == 0U);
  CHECK_FALSE(gateway_at(2).runs); // 27 s
  CHECK(gateway_at(2).links.empty());
  CHECK(gateway_at(3).runs);
  for (const auto& peer : x.report.peers) {
    const auto& last = x.samples.back().peers;
    const auto found = std::ranges::find(last, peer.name, &report::peer_sample::name);
    REQUIRE(found != last.end());
    CHECK(found->runs == peer.alive);
    CHECK(found->links.size() == peer.links);
    CHECK(found->to_sink.has_value() == peer.name.ends_with("gateway"));
  }
}

TEST_CASE("samples are taken at multiples of their interval and at the end", "[ecology]") {
  auto home = example("home.toml");
  home.length = 35s;
  const auto x = look_at_run(home, 10s);
  REQUIRE(x.samples.size() == 4);
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(x.samples[i].at == instant{static_cast<int>(i + 1) * 10s});
  CHECK(x.samples[3].at == instant{35s});
}

TEST_CASE("the last sample tells what the report does", "[ecology]") {
  const auto x = look_at_run(example("home.toml"), 1min);
  const auto& last = x.samples.back();
  CHECK(last.at == instant{12min});
  REQUIRE(last.motes.size() == x.report.motes_configured());
  for (const auto& island : x.report.islands) {
    for (const auto& mote : island.motes) {
      const auto found = std::ranges::find(last.motes, mote.address, &report::mote_sample::address);
      REQUIRE(found != last.motes.end());
      CAPTURE(mote.name);
      CHECK(found->alive == mote.alive);
      CHECK(found->used_mah == Approx(mote.energy.used_mah).margin(1e-6));
      CHECK(found->battery_mah == mote.energy.battery_mah);
      if (mote.alive) {
        CHECK(found->parent == mote.parent);
        CHECK(found->hops == mote.hops);
        CHECK(found->signal_dbm == mote.signal_dbm);
        CHECK(found->etx.value_or(0) >= 1);
      }
    }
    const auto told = std::ranges::find(last.islands, island.id, &report::island_sample::island);
    REQUIRE(told != last.islands.end());
    CHECK(told->lost.at("radio") == report::really_lost(island.radio));
    CHECK(told->lost.at("mac") == island.radio.mac_failed);
    for (const auto& [cause, count] : told->lost.at("network"))
      CHECK(count == island.network.lost.at(cause));
    CHECK(told->lost.at("serial") == island.serial.lost);
    auto messages = island.messages.lost;
    messages["in_transit"] = island.messages.in_transit;
    CHECK(told->lost.at("messages") == messages);
  }
}

TEST_CASE("losses and energy never go back", "[ecology]") {
  const auto x = look_at_run(example("home.toml"), 5s);
  std::map<mote_address, double> used;
  std::map<std::string, std::uint64_t> lost;
  for (const auto& sample : x.samples) {
    for (const auto& mote : sample.motes) {
      CHECK(mote.used_mah >= used[mote.address] - 1e-6);
      used[mote.address] = mote.used_mah;
    }
    for (const auto& island : sample.islands)
      for (const auto& [layer, causes] : island.lost)
        for (const auto& [cause, count] : causes) {
          if (cause == "in_transit") // which is no loss yet
            continue;
          auto& before = lost[to_string(island.island) + layer + cause];
          CHECK(count >= before);
          before = count;
        }
  }
}

TEST_CASE("writes of tuples are told with who wrote them, whose they are, and when", "[ecology]") {
  const auto x = look_at_run(example("home.toml"), 1min);
  const auto told = [&x](const std::string& peer, const std::string& owner, const std::string& key,
                         const std::string& value) {
    return std::ranges::any_of(x.tuples, [&](const report::tuple_write& y) {
      return y.peer == peer && y.owner == owner && y.key == key && y.value == value;
    });
  };
  CHECK(told("kitchen-pc", "kitchen-pc", "kitchen.fan.switch.outcome", "on acknowledged"));
  CHECK(told("care-pc", "kitchen-pc", "kitchen.fan.switch", "on"));
  CHECK(std::ranges::is_sorted(x.tuples, {}, &report::tuple_write::at));
  std::set<std::string> temperatures;
  for (const auto& y : x.tuples)
    if (y.key == "kitchen.climate-7.temperature")
      temperatures.insert(y.value);
  CHECK(temperatures.size() > 20);
}
