#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/network/top_text.hpp"
#include "report/print/text_layout.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::cli;

namespace {

peis::tuple_pointer tuple_of(int owner, const std::string& key, const std::string& value) {
  auto x = std::make_shared<peis::tuple>();
  x->owner = x->creator = peer_id{owner};
  x->name = *peis::key::from_wire(key);
  x->value = payload(peis::text_content(value).value);
  return x;
}

/// The kitchen's gateway 7, and the PC 11 with proxies of its motes.
std::vector<peis::tuple_pointer> kitchen() {
  return {tuple_of(7, "devices", "{2,7,9}"),
          tuple_of(7, "devices.line", "up 0.500000"),
          tuple_of(7, "devices.2.status", "listed 1.000000"),
          tuple_of(7, "devices.7.status", "stale 9.000000"),
          tuple_of(7, "devices.12.status", "left silence 3.000000"),
          tuple_of(7, "kernel.name", "gateway"),
          tuple_of(11, "kitchen.climate-7.status", "active"),
          tuple_of(11, "kitchen.climate-7.status.since", "1.0"),
          tuple_of(11, "kitchen.climate-7.class", "climate"),
          tuple_of(11, "kitchen.climate-7.id", "kitchen/7"),
          tuple_of(11, "kitchen.climate-7.description", "air"),
          tuple_of(11, "kitchen.climate-7.temperature", "22.3"),
          tuple_of(11, "kitchen.climate-7.temperature.unit", "C"),
          tuple_of(11, "kitchen.climate-7.window", "open"),
          tuple_of(11, "kitchen.fan.status", "lost"),
          tuple_of(11, "kitchen.fan.status.cause", "silence"),
          tuple_of(11, "kitchen.fan.class", "fan"),
          tuple_of(11, "kitchen.fan.id", "kitchen/12"),
          tuple_of(11, "robot.status", "busy")};
}

std::map<peer_id, top_host> kitchen_hosts() {
  return {{peer_id{7}, {"gateway@pc!1", 1, 2}},
          {peer_id{11}, {"kitchen-pc@pc!1", 2, std::nullopt}},
          {peer_id{30}, {"robot@r2!1", std::nullopt, std::nullopt}}};
}

top_picture kitchen_picture(top_observer& seen) {
  for (int i = 0; i < 4; ++i)
    seen.on_change(*tuple_of(11, "kitchen.climate-7.temperature", "22.3"));
  seen.on_change(*tuple_of(7, "devices.7.output.1", "x"));
  seen.on_change(*tuple_of(7, "kernel.traffic", "x"));
  auto x = seen.look(kitchen_hosts(), kitchen(), 2s);
  x.network = "home";
  x.via = "tcp://127.0.0.1:8000";
  x.time = "12:00:00";
  return x;
}

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

} // namespace

TEST_CASE("a picture has peers, gateways and proxies, the liveliest first", "[cli][SVC-07]") {
  top_observer seen;
  const auto x = kitchen_picture(seen);
  CHECK(x.changes_per_s == 2.5); // without kernel.*
  REQUIRE(x.peers.size() == 3);
  CHECK(x.peers[0].id == peer_id{11});
  CHECK(x.peers[0].changes_per_s == 2);
  CHECK(x.peers[1].id == peer_id{7});
  CHECK(x.peers[1].tuples == 5);
  CHECK(x.peers[2].name == "robot@r2!1"); // without a way to it, and tuples
  REQUIRE(x.gateways.size() == 1);
  CHECK(x.gateways[0].line == "up");
  CHECK(x.gateways[0].motes == std::vector<std::uint32_t>{2, 7, 9});
  CHECK(x.gateways[0].stale == 1);
  CHECK(x.gateways[0].left == 1);
  CHECK(x.gateways[0].changes_per_s == 0.5);
  REQUIRE(x.proxies.size() == 2); // robot.status is none
  CHECK(x.proxies[0].prefix == "kitchen.climate-7");
  CHECK(x.proxies[0].values == std::vector<std::pair<std::string, std::string>>{
                                   {"temperature", "22.3 C"}, {"window", "open"}});
  CHECK(x.proxies[1].status == "lost: silence");
}

TEST_CASE("a rate is that of the last seconds, and fades", "[cli][SVC-07]") {
  top_observer seen;
  const auto first = kitchen_picture(seen);
  const auto later = seen.look(kitchen_hosts(), kitchen(), 1s);
  CHECK(later.changes_per_s < first.changes_per_s);
  CHECK(later.changes_per_s == Approx(2.5 * std::exp(-0.2)));
  CHECK(later.peers[0].id == peer_id{11}); // where it was
  CHECK(later.proxies[0].changes_per_s == Approx(2 * std::exp(-0.2)));
  auto last = later;
  for (int i = 0; i < 30; ++i)
    last = seen.look(kitchen_hosts(), kitchen(), 1s);
  CHECK(last.changes_per_s == 0);
  CHECK(last.proxies[0].changes_per_s == 0);
}

TEST_CASE("who is nearly as lively as another keeps his place", "[cli][SVC-07]") {
  const auto order_of = [](int of_30, int of_40) {
    top_observer seen;
    for (int i = 0; i < of_30; ++i)
      seen.on_change(*tuple_of(30, "a", "x"));
    for (int i = 0; i < of_40; ++i)
      seen.on_change(*tuple_of(40, "a", "x"));
    const auto x = seen.look({}, {tuple_of(30, "a", "x"), tuple_of(40, "a", "x")}, 1s);
    return std::pair(x.peers[0].id, x.peers[1].id);
  };
  const std::pair ascending(peer_id{30}, peer_id{40});
  CHECK(order_of(10, 11) == ascending);
  CHECK(order_of(11, 10) == ascending);
  CHECK(order_of(10, 30) == std::pair(peer_id{40}, peer_id{30}));
  CHECK(order_of(0, 1) == std::pair(peer_id{40}, peer_id{30}));
  CHECK(order_of(0, 0) == ascending);
}

TEST_CASE("what was there before does not count", "[cli][SVC-07]") {
  top_observer seen;
  seen.on_change(*tuple_of(11, "a", "x"));
  seen.restart();
  CHECK(seen.look(kitchen_hosts(), kitchen(), 1s).changes_per_s == 0);
  CHECK(seen.look(kitchen_hosts(), kitchen(), 0s).changes_per_s == 0);
}

TEST_CASE("more changed keys than are counted apart still count for their owner", "[cli]") {
  top_observer seen;
  for (std::size_t i = 0; i < top_observer::keys_max + 50; ++i)
    seen.on_change(*tuple_of(11, 'k' + std::to_string(i), "x"));
  CHECK(seen.look({}, {tuple_of(11, "a", "x")}, 1s).changes_per_s ==
        static_cast<double>(top_observer::keys_max + 50));
}

TEST_CASE("a picture fits its screen, however small", "[cli][SVC-07]") {
  top_observer seen;
  auto x = kitchen_picture(seen);
  for (int i = 0; i < 500; ++i) {
    x.peers.push_back({peer_id{1000 + i}, "peer with a rather long name@computer!77", 3, 1, 12, 0});
    x.proxies.push_back({peer_id{11},
                         "room.sensor-" + std::to_string(i),
                         "room/1",
                         "active",
                         {{"temperature", "21.0 C"}, {"humidity", "45 %"}},
                         0});
  }
  for (std::size_t height = 13; height < 60; height += 7)
    for (const std::size_t width : {20, 60, 80, 160}) {
      CAPTURE(height, width);
      const auto text = top_text(x, width, height, false);
      CHECK(lines_of(text) <= height);
      for (std::size_t from = 0; from < text.size();) {
        const auto end = text.find('\n', from);
        CHECK(report::display_width(text.substr(from, end - from)) <= width);
        from = end + 1;
      }
    }
  const auto cut = top_text(x, 100, 40, false);
  CHECK(cut.find("… and ") != std::string::npos);
  CHECK(cut.find("kitchen.climate-7") != std::string::npos);
  CHECK(lines_of(top_text(x, 100, std::nullopt, false)) > 1000);
}

TEST_CASE("nothing is there yet: a picture says so in one line", "[cli]") {
  top_observer seen;
  auto x = seen.look({}, {}, 1s);
  x.network = "home";
  CHECK(top_text(x, 80, 24, false).find("home  0 peers  0 tuples  0.0 changes/s") !=
        std::string::npos);
}

TEST_CASE("a picture as JSON can be read back", "[cli][SVC-07]") {
  top_observer seen;
  const auto text = top_json(kitchen_picture(seen));
  CHECK(lines_of(text) == 1);
  const auto x = nlohmann::json::parse(text);
  CHECK(x.at("peers")[0].at("links").is_null());
  CHECK(x.at("peers")[0].at("metric") == 2);
  CHECK(x.at("gateways")[0].at("motes") == nlohmann::json({2, 7, 9}));
  CHECK(x.at("proxies")[0].at("values").at("temperature") == "22.3 C");
  CHECK(x.at("changes_per_s") == 2.5);
}

TEST_CASE("hostile names and values do nothing to a picture", "[cli][SVC-07]") {
  const std::string evil = "x\033[2J\n\xff\xe2\x80\xae";
  top_observer seen;
  auto x = seen.look({{peer_id{7}, {evil, 1, 1}}},
                     {tuple_of(7, "devices", evil), tuple_of(7, evil + ".status", evil),
                      tuple_of(7, evil + ".class", evil), tuple_of(7, evil + ".id", evil),
                      tuple_of(7, evil + ".value", std::string(20'000, 'y') + evil)},
                     1s);
  x.network = x.via = x.time = evil;
  const auto text = top_text(x, 10'000, std::nullopt, false);
  CHECK(text.find('\033') == std::string::npos);
  CHECK(text.find('\xff') == std::string::npos);
  CHECK(text.size() < 4000);
  CHECK(x.proxies.size() == 1);
  CHECK(nlohmann::json::parse(top_json(x)).at("proxies").size() == 1);
}
