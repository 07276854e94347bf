#include <algorithm>

#include <nlohmann/json.hpp>

#include "support/catch.hpp"
#include "view/conversation.hpp"
#include "view/ecology_json.hpp"
#include "view/page_files.hpp"

using namespace rubicon;
using nlohmann::json;

namespace {

constexpr const char* hostile = "<img src=x onerror=alert(1)>\xff\"\\";

config::ecology_description ecology_of_two() {
  config::ecology_description x;
  x.name = hostile;
  x.length = 1h;
  config::island_description island;
  island.id = island_id(1);
  island.name = "kitchen";
  island.gateway_name = "kitchen-gateway";
  for (const std::uint16_t id : {std::uint16_t{5}, std::uint16_t{6}}) {
    config::mote_description mote;
    mote.id = mote_id(id);
    mote.name = id == 5 ? "stove" : hostile;
    mote.type_name = "climate";
    mote.place = {1.0 * id, 2, 0};
    island.motes.push_back(mote);
  }
  island.motes[1].path = {{0s, {6, 2, 0}}, {10s, {7, 3, 0}}};
  x.islands.push_back(island);
  x.airs.push_back({"kitchen", {island_id(1)}});
  x.plan = config::floor_plan{"plan.png", {-1, -2, 0}, 12};
  return x;
}

report::run_sample climate_sample_at(duration at) {
  report::run_sample x{instant(at), {{island_id(1), {{"radio", {{"collision", 7}}}}}}, {}};
  report::mote_sample mote;
  mote.address = {island_id(1), mote_id(5)};
  mote.alive = mote.joined = mote.radio_on = true;
  mote.parent = mote_id(1);
  mote.hops = 1;
  mote.used_mah = 1;
  mote.battery_mah = 25;
  mote.etx = 1.25;
  mote.neighbours = {{mote_id(1), 1.25}, {mote_id(6), std::nullopt}};
  x.motes.push_back(mote);
  return x;
}

std::shared_ptr<const view::introduction> about(std::string facts) {
  return std::make_shared<const view::introduction>(view::introduction_of(std::move(facts)));
}

struct page {
  std::shared_ptr<view::timeline> all = std::make_shared<view::timeline>();
  view::conversation with{
      all,
      about(view::with_facts(view::ecology_json(ecology_of_two()), {.file = "home.toml"}, "wall")),
      nullptr};

  json ask(const json& question) { return json::parse(with.on_text(question.dump())); }
  json news() {
    const auto text = with.news();
    return text ? json::parse(*text) : json();
  }
};

} // namespace

TEST_CASE("a page is told the ecology first, then how far the run is", "[view][ACT-09]") {
  page x;
  const auto ecology = x.news();
  CHECK(ecology["kind"] == "ecology");
  CHECK(ecology["mode"] == "wall");
  CHECK(ecology["control"] == false);
  CHECK(ecology["plan"]["width_m"] == 12.0);
  CHECK(ecology["islands"][0]["motes"][0] == json::parse(R"([5,"stove",5.0,2.0,"climate"])"));
  CHECK(ecology["paths"]["1"].size() == 2);
  CHECK(ecology["peers"][0]["name"] == "kitchen-gateway");
  x.all->add(view::listed_event{instant(1s), "stove", "joined"});
  x.all->set({instant(2s), instant(1h), true, 100, 1});
  const auto state = x.news();
  CHECK(state["kind"] == "state");
  CHECK(state["now_s"] == 2.0);
  CHECK(state["new_events"][0] == json::parse(R"([1.0,"stove","joined","event"])"));
  CHECK(x.news().is_null());
  x.all->set({instant(3s), instant(1h), true, 200, 1});
  CHECK(x.news()["new_events"].empty());
}

TEST_CASE("what is planned to go wrong is told, and is in a record", "[view]") {
  auto ecology = ecology_of_two();
  ecology.faults.push_back({20s, config::unplug_fault{island_id(1)}});
  ecology.faults.push_back({10s, config::unplug_fault{island_id(1)}});
  std::ranges::sort(ecology.faults, {}, &config::fault_description::at);
  const auto planned = view::planned_faults(ecology);
  REQUIRE(planned.size() == 2);
  CHECK(planned[0].at == instant(10s));
  CHECK(planned[0].kind == "fault");
  CHECK_FALSE(planned[0].what.empty());
  const auto again = view::planned_faults(view::ecology_json(ecology));
  REQUIRE(again.size() == 2);
  CHECK(again[1].at == instant(20s));
  CHECK(again[1].what == planned[1].what);
  for (const auto* text : {"", "[]", "{}", R"({"faults":[1,[2],["x","y"],[1,"z",3]]})"})
    CHECK(view::planned_faults(std::string(text)).empty());
}

TEST_CASE("a record names the picture of its floor plan, and the time of day of its start",
          "[view]") {
  auto ecology = ecology_of_two();
  CHECK(json::parse(view::ecology_json(ecology)).contains("start_s") == false);
  ecology.day_begins = 7h + 30min;
  const auto text = view::ecology_json(ecology);
  CHECK(json::parse(text)["start_s"] == 27000.0);
  CHECK(view::plan_picture(text) == "plan.png");
  ecology.plan.reset();
  CHECK(view::plan_picture(view::ecology_json(ecology)).empty());
  for (const auto* other : {"", "[]", "{}", R"({"plan":7})", R"({"plan":{"picture":7}})"})
    CHECK(view::plan_picture(other).empty());
}

TEST_CASE("who follows is told the newest moment, and states in turns with it", "[view]") {
  page x;
  x.news();
  x.news();
  std::size_t moments = 0;
  for (int i = 1; i <= 20; ++i) {
    x.all->add(climate_sample_at(i * 1s));
    x.all->set({instant(i * 1s), instant(1h), true, 1, 1});
    moments += x.news()["kind"] == "moment" ? 1 : 0;
  }
  CHECK(moments == 10);
  CHECK(x.ask({{"ask", "follow"}, {"on", false}})["ok"] == true);
  x.news();
  x.all->add(climate_sample_at(30s));
  CHECK(x.news().is_null());
}

TEST_CASE("a moment tells of each mote in the order of the ecology", "[view][ACT-09]") {
  page x;
  x.all->add(climate_sample_at(3600s));
  const auto y = x.ask({{"ask", "moment"}, {"at_s", 4000}, {"id", 7}});
  CHECK(y["id"] == 7);
  CHECK(y["sample_s"] == 3600.0);
  CHECK(y["motes"]["state"] == json::parse("[1,0]"));
  CHECK(y["motes"]["parent"] == json::parse("[1,0]"));
  CHECK(y["motes"]["etx"] == json::parse("[1.25,null]"));
  CHECK(y["motes"]["hours"] == json::parse("[24.0,null]"));
  CHECK(y["lost"]["radio/collision"] == 7);
  const auto before = x.ask({{"ask", "moment"}, {"at_s", 1}});
  CHECK(before["sample_s"].is_null());
  CHECK(before["motes"]["state"] == json::parse("[0,0]"));
}

TEST_CASE("states of motes are told apart", "[view]") {
  page x;
  const auto state_of = [&x](auto change) {
    auto sample = climate_sample_at(10s);
    change(sample.motes[0]);
    x.all->add(std::move(sample));
    return x.ask({{"ask", "moment"}, {"at_s", 10}})["motes"]["state"][0].get<int>();
  };
  CHECK(state_of([](auto&) {}) == 1);
  CHECK(state_of([](auto& mote) { mote.radio_on = false; }) == 2);
  CHECK(state_of([](auto& mote) { mote.parent = {}; }) == 3);
  CHECK(state_of([](auto& mote) { mote.joined = false; }) == 3);
  CHECK(state_of([](auto& mote) { mote.alive = false; }) == 4);
  CHECK(state_of([](auto& mote) {
          mote.alive = false;
          mote.flat = true;
        }) == 5);
}

TEST_CASE("a mote, tuples and curves are asked for", "[view][ACT-09][SVC-07]") {
  page x;
  x.all->add(climate_sample_at(10s));
  x.all->add(climate_sample_at(20s));
  const auto mote = x.ask({{"ask", "mote"}, {"address", "1/5"}, {"at_s", 20}});
  CHECK(mote["name"] == "kitchen/stove");
  CHECK(mote["neighbours"][0][0] == "sink");
  CHECK(mote["used"].size() == 2);
  CHECK(x.ask({{"ask", "mote"}, {"address", "1/6"}, {"at_s", 20}})["kind"] == "mote");
  x.all->add(report::tuple_write{instant(5s), "pc", "pc", hostile, "21.5 C", false});
  x.all->add(report::tuple_write{instant(6s), "pc", "pc", hostile, "22.5 C", false});
  const auto tuples = x.ask({{"ask", "tuples"}, {"at_s", 5.5}});
  REQUIRE(tuples["tuples"].size() == 1);
  CHECK(tuples["tuples"][0][2] == "21.5 C");
  CHECK(tuples["tuples"][0][3] == 5.0);
  x.all->add(report::tuple_write{instant(7s), "pc", "pc", "t", "1", false});
  x.all->add(report::tuple_write{instant(8s), "pc", "pc", "t", "2", false});
  CHECK(x.ask({{"ask", "curve"}, {"owner", "pc"}, {"key", "t"}})["points"] ==
        json::parse("[[7.0,1.0],[8.0,2.0]]"));
  const auto series = x.ask({{"ask", "series"}});
  CHECK(series["times"] == json::parse("[10.0,20.0]"));
  CHECK(series["lost"]["radio/collision"] == json::parse("[7,7]"));
}

TEST_CASE("without a record messages are not ready, and the page is told why", "[view]") {
  page x;
  x.all->set_why_no_messages("add --record");
  const auto y = x.ask({{"ask", "messages"}, {"lost", true}});
  CHECK(y["ready"] == false);
  CHECK(y["why"] == "add --record");
  CHECK(x.ask({{"ask", "explain"}, {"message", "a#1"}})["kind"] == "refused");
  CHECK(x.ask({{"ask", "frames"}, {"from_s", 0}, {"to_s", 1}})["kind"] == "refused");
}

TEST_CASE("messages of a run that goes on are told, as of when they are", "[view]") {
  page x;
  explain::header about;
  about.islands = {{1, "kitchen", 1, "kitchen-gateway", {{5, "stove"}}, {}, {}}};
  about.peers = {{1, "kitchen-gateway"}};
  explain::following all(about);
  const auto sends = [&all](std::uint64_t number, const std::string& who, mote_address to) {
    explain::record r;
    r.number = number;
    r.time = instant(std::chrono::seconds(number));
    r.what = explain::kind::send_message;
    r.from = "mote_app/kitchen/stove/messenger-1";
    r.to = who;
    r.id = number;
    r.mote = to;
    all.take(r);
  };
  const auto show = [&](bool is_whole) {
    x.all->set(std::make_shared<const view::message_list>(
        std::make_shared<const explain::traces>(all.so_far()), is_whole));
  };
  int asked = 0;
  x.all->set_on_messages([&asked] { ++asked; });
  CHECK(x.ask({{"ask", "messages"}})["ready"] == false);
  CHECK(asked == 1); // so that somebody reads them
  sends(1, "mote/kitchen/stove", {own_island, no_mote});
  sends(3, "gateway/kitchen", {island_id(1), mote_id(5)});
  sends(4, "gateway/kitchen", {island_id(1), mote_id(6)});
  show(false);
  x.all->set_why_no_messages("later ones are not kept");
  const auto some = x.ask({{"ask", "messages"}});
  CHECK(some["ready"] == true);
  CHECK(some["as_of_s"] == 4.0);
  CHECK(some["total"] == 3);
  CHECK(some["why"] == "later ones are not kept");
  CHECK(x.ask({{"ask", "explain"}, {"message", "kitchen/stove#1"}})["as_of_s"] == 4.0);
  CHECK(x.ask({{"ask", "frames"}, {"from_s", 0}, {"to_s", 9}})["as_of_s"] == 4.0);
  CHECK(asked == 4);
  const auto of = [&x](const std::string& who) {
    return x.ask({{"ask", "messages"}, {"of", who}})["total"].get<int>();
  };
  CHECK(of("1/5") == 2); // from it, and to it
  CHECK(of("1/6") == 1);
  CHECK(of("kitchen-gateway") == 3);
  CHECK(x.ask({{"ask", "messages"}, {"of", "nobody"}})["kind"] == "refused");
  explain::record much_later;
  much_later.time = instant(90s);
  much_later.what = explain::kind::sample;
  all.take(much_later);
  sends(91, "mote/kitchen/stove", {own_island, no_mote});
  show(true);
  const auto whole = x.ask({{"ask", "messages"}, {"limit", 2}});
  CHECK(whole["as_of_s"].is_null());
  CHECK(whole["total"] == 4);
  REQUIRE(whole["messages"].size() == 2); // lost ones first, the newest of them before the others
  CHECK(whole["messages"][0]["class"] == "lost");
  CHECK(whole["messages"][0]["sent_s"] == 4.0);
  CHECK(whole["messages"][1]["sent_s"] == 3.0);
}

TEST_CASE("a peer tells its links, queues and newest tuples", "[view]") {
  page x;
  auto sample = climate_sample_at(10s);
  sample.peers = {{"kitchen-gateway", true, {{peer_id(1), 2}, {peer_id(77), 3}}, 4}};
  x.all->add(sample);
  for (int i = 0; i < 10; ++i)
    x.all->add(report::tuple_write{instant(std::chrono::seconds(i)), "kitchen-gateway",
                                   "kitchen-gateway", "k" + std::to_string(i), "v", false});
  x.all->add(report::tuple_write{instant(9s), "pc", "pc", "other", "v", false});
  const auto y = x.ask({{"ask", "peer"}, {"name", "kitchen-gateway"}, {"at_s", 10}});
  CHECK(y["facts"] == json::parse(R"([["state","runs"],["packages waiting","5"],)"
                                  R"(["packets waiting for the cable","4"]])"));
  CHECK(y["links"] == json::parse(R"([["kitchen-gateway",2],["77",3]])"));
  CHECK(y["tuples"] == 10);
  REQUIRE(y["newest"].size() == 8);
  CHECK(y["newest"][0][0] == "k9");
  const auto nobody = x.ask({{"ask", "peer"}, {"name", "x"}, {"at_s", 10}});
  CHECK(nobody["facts"].empty());
  CHECK(nobody["tuples"] == 0);
}

TEST_CASE("what is no question is refused", "[view]") {
  page x;
  const auto refused = [&x](const std::string& text) {
    return json::parse(x.with.on_text(text))["kind"] == "refused";
  };
  CHECK(refused(""));
  CHECK(refused("[]"));
  CHECK(refused("{}"));
  CHECK(refused(R"({"ask":7})"));
  CHECK(refused(R"({"ask":"secrets"})"));
  CHECK(refused(R"({"ask":"moment"})"));
  CHECK(refused(R"({"ask":"moment","at_s":"now"})"));
  CHECK(refused(R"({"ask":"mote","address":"1","at_s":1})"));
  CHECK(refused(R"({"ask":"mote","address":"1/5x","at_s":1})"));
  CHECK(refused(R"({"ask":"mote","address":"9/9","at_s":1})"));
  CHECK(refused(R"({"ask":"follow","on":"yes"})"));
  CHECK(refused(R"({"ask":"fault","sentence":"crash mote kitchen/stove"})"));
  const std::string deep(30'000, '[');
  const auto answer =
      x.with.on_text(R"({"ask":"series","id":)" + deep + std::string(deep.size(), ']') + '}');
  CHECK(answer.find("\"id\"") == std::string::npos);
  CHECK_FALSE(refused(R"({"ask":"moment","at_s":-1e300})"));
  CHECK_FALSE(refused(R"({"ask":"moment","at_s":1e300})"));
  CHECK_FALSE(refused(R"({"ask":"messages","limit":1e300})"));
}

TEST_CASE("with controls faults and tuples are passed on", "[view][ACT-10][SVC-07]") {
  page x;
  std::string seen;
  const auto controls = std::make_shared<view::controls>();
  controls->fault = [&](const std::string& sentence) {
    seen = sentence;
    return view::controls::outcome{sentence == "crash", "done"};
  };
  controls->set_tuple = [&](const std::string& owner, const std::string& key,
                            const std::string& value) {
    seen = owner + '|' + key + '|' + value;
    return view::controls::outcome{true, ""};
  };
  view::conversation with(x.all, about("{}"), controls);
  const auto ask = [&with](const json& question) {
    return json::parse(with.on_text(question.dump()));
  };
  CHECK(ask({{"ask", "fault"}, {"sentence", "crash"}})["ok"] == true);
  CHECK(ask({{"ask", "fault"}, {"sentence", "bash"}})["ok"] == false);
  CHECK(ask({{"ask", "set"}, {"owner", "pc"}, {"key", "k"}, {"value", "v"}})["ok"] == true);
  CHECK(seen == "pc|k|v");
  CHECK(ask({{"ask", "set"}, {"owner", "pc"}, {"key", "k"}})["kind"] == "refused");
}

TEST_CASE("the page is small, whole, and asks nobody else", "[view][ACT-09]") {
  const auto html = view::page_html();
  const auto all = std::string(html) + std::string(view::page_css()) + std::string(view::page_js());
  CHECK(all.size() <= 150'000);
  CHECK(html.find("page.js") != std::string_view::npos);
  CHECK(html.find("page.css") != std::string_view::npos);
  CHECK(all.find("innerHTML") == std::string::npos);
  CHECK(all.find("eval(") == std::string::npos);
  // Names of namespaces are no addresses.
  for (auto at = all.find("http"); at != std::string::npos; at = all.find("http", at + 1)) {
    const auto rest = std::string_view(all).substr(at);
    CHECK((!rest.starts_with("http://") || rest.starts_with("http://www.w3.org/")));
    CHECK_FALSE(rest.starts_with("https://"));
  }
}
