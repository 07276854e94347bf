#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/network/graph_text.hpp"
#include "report/print/text_layout.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::cli;

namespace {

peis::tuple_pointer tuple_of(int owner, const std::string& key, const std::string& value,
                             std::string_view mimetype = peis::text_mimetype) {
  auto x = std::make_shared<peis::tuple>();
  x->owner = x->creator = peer_id{owner};
  x->name = *peis::key::from_wire(key);
  x->value = payload(peis::text_content(value).value);
  x->mimetype = mimetype;
  return x;
}

peis::tuple_pointer meta_of(int owner, const std::string& key, const std::string& value) {
  return tuple_of(owner, key, value, peis::meta_mimetype);
}

/// Two rooms and a robot, looked at by 60001.
ecology_graph small_graph(bool all = false) {
  return graph_of({{peer_id{7}, "lamp@hall!3"}, {peer_id{9}, "robot@r2!4"}, {peer_id{60001}, "us"}},
                  {tuple_of(7, "room.temp", "21.5"), tuple_of(7, "room.light", "on"),
                   tuple_of(7, "kernel.subscribers",
                            "(\n  ( 9 -1.room.* )\n  ( 9 7.room.temp )\n  ( 60001 -1. )\n"
                            "  ( 9 7.kernel.name )\n)\n"),
                   tuple_of(7, "kernel.name", "lamp"),
                   tuple_of(9, "kernel.subscribers", "(\n  ( 9 -1.room.* )\n  ( 60001 -1. )\n)\n"),
                   meta_of(9, "mi-light", "(META 7 room.light)"),
                   meta_of(9, "mi-fan", "(META 7 room.fan)"),
                   meta_of(9, "mi-door", "(META -1 NULL)"), tuple_of(60001, "own", "x")},
                  peer_id{60001}, all);
}

} // namespace

TEST_CASE("what a peer says of its subscribers is read, and nothing else", "[cli][SVC-07]") {
  const auto all = read_subscribers("(\n  ( 30 -1.*.*.temp )\n  ( 5 7. )\n  ( 8 7.a b )\n"
                                    "  ...\n  ( x 7.a )\n  ( 3 7.a\n  ( -2 7.a )\n( 4 9.c )\n)\n");
  REQUIRE(all.size() == 4);
  CHECK(all[0].host == peer_id{30});
  CHECK(all[0].owner == any_peer);
  CHECK(all[0].wanted.text() == "*.*.temp");
  CHECK(all[1].wanted.any());
  CHECK(all[2].wanted.text() == "a b");
  CHECK(all[3].host == peer_id{4});
  CHECK(read_subscribers("").empty());
  CHECK(read_subscribers("(  )").empty());
  CHECK(read_subscribers("( 99999999999 7.a )").empty());
}

TEST_CASE("a graph says who has what and who subscribes to it", "[cli][SVC-07]") {
  const auto x = small_graph();
  REQUIRE(x.tuples.size() == 5); // neither kernel.* nor ours
  CHECK(x.tuples[0].content->name.text() == "room.light");
  CHECK(x.tuples[0].subscribers == std::set{peer_id{9}});
  REQUIRE(x.subscriptions.size() == 2); // one is told by two peers
  CHECK(x.subscriptions[0].owner == any_peer);
  CHECK(x.subscriptions[0].tuples == 2);
  CHECK(x.subscriptions[1].owner == peer_id{7});
  CHECK(x.subscriptions[1].tuples == 1);
  CHECK(small_graph(true).subscriptions.size() == 3);
  CHECK(small_graph(true).tuples.size() == 8);
}

TEST_CASE("a graph as text shows peers, subscriptions, meta tuples and tuples", "[cli][SVC-07]") {
  const auto text = graph_text(small_graph(), 100, false);
  CAPTURE(text);
  CHECK(text.find("9 robot") != std::string::npos);
  CHECK(text.find("mi-fan      7 lamp     room.fan    no such tuple") != std::string::npos);
  CHECK(text.find("mi-light    7 lamp     room.light\n") != std::string::npos);
  CHECK(text.find("mi-door     nowhere") != std::string::npos);
  CHECK(text.find("room.temp   21.5") != std::string::npos);
  for (std::size_t width = 20; width < 120; ++width) {
    const auto narrow = graph_text(small_graph(), width, false);
    for (std::size_t from = 0; from < narrow.size();) {
      const auto end = narrow.find('\n', from);
      CHECK(report::display_width(narrow.substr(from, end - from)) <= width);
      from = end + 1;
    }
  }
}

TEST_CASE("a graph as JSON can be read back", "[cli][SVC-07]") {
  const auto x = nlohmann::json::parse(to_json(small_graph()));
  CHECK(x.at("peers").size() == 2);
  CHECK(x.at("subscriptions")[0].at("owner").is_null());
  CHECK(x.at("subscriptions")[1].at("owner") == 7);
  CHECK(x.at("tuples")[0].at("subscribers") == nlohmann::json({9}));
  CHECK(x.at("tuples")[2].at("key") == "mi-door");
  CHECK(x.at("tuples")[2].at("points_at").is_null());
  CHECK(x.at("tuples")[3].at("points_at").at("key") == "room.fan");
  CHECK(!x.at("tuples")[0].contains("points_at"));
}

TEST_CASE("a graph for Graphviz draws what arrows end at", "[cli][SVC-07]") {
  const auto dot = to_dot(small_graph());
  CAPTURE(dot);
  CHECK(dot.starts_with("digraph ecology {\n"));
  CHECK(dot.find(R"("7 room.temp" -> "peer 9";)") != std::string::npos);
  CHECK(dot.find(R"("9 mi-light" -> "7 room.light" [style=dashed];)") != std::string::npos);
  CHECK(dot.find(R"(label="7 lamp";)") != std::string::npos);
  CHECK(dot.find("60001") == std::string::npos);
}

TEST_CASE("hostile names break neither text nor quotes of a graph", "[cli][SVC-07]") {
  const std::string evil = "a\"]; x\\\"\033[2J\n( 7 9.b )";
  const auto x =
      graph_of({{peer_id{7}, evil}},
               {tuple_of(7, evil, evil), tuple_of(7, "kernel.subscribers", "( 9 -1. )\n")},
               peer_id{60001}, false);
  const auto dot = to_dot(x);
  CHECK(dot.find('\033') == std::string::npos);
  CHECK(dot.find(R"(a\"]; x\\\"\\x1b[2J\\n)") != std::string::npos);
  CHECK(graph_text(x, 200, false).find('\033') == std::string::npos);
  CHECK(nlohmann::json::parse(to_json(x)).at("tuples")[0].at("subscribers") == nlohmann::json({9}));
}
