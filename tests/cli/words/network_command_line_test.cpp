#include <vector>

#include "cli/options/parse_command_line.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::cli;

namespace {

command parse(std::vector<const char*> words) {
  words.insert(words.begin(), "rubicon");
  return parse_command_line(words);
}

network_command parsed(std::vector<const char*> words) {
  const auto x = parse(std::move(words));
  REQUIRE(std::holds_alternative<network_command>(x));
  return std::get<network_command>(x);
}

} // namespace

TEST_CASE("how to get into a network is told alike for every command", "[cli][SVC-08]") {
  for (const auto& words :
       std::vector<std::vector<const char*>>{{"hosts"},
                                             {"route", "7"},
                                             {"ping", "7"},
                                             {"tuples", "ls"},
                                             {"tuples", "get", "a"},
                                             {"tuples", "watch", "a"},
                                             {"tuples", "set", "a", "b", "--owner", "7"}}) {
    auto line = words;
    line.insert(line.end(), {"--connect", "here:9000", "--network", "lab", "--id", "60000",
                             "--timeout", "2s", "--json"});
    CAPTURE(line);
    const auto x = parsed(line).with;
    CHECK(x.peer == "tcp://here:9000");
    CHECK(x.network == "lab");
    CHECK(x.id == peer_id{60000});
    CHECK(x.timeout == 2s);
    CHECK(x.json);
  }
  const auto x = parsed({"hosts", "--connect", "here"}).with;
  CHECK(x.peer == "tcp://here:8000");
  CHECK(x.network == config::ecology_description{}.network);
  CHECK(!x.id);
  CHECK(!x.json);
}

TEST_CASE("each network command keeps its words", "[cli][SVC-08]") {
  const auto set = std::get<write_tuple>(
      parsed({"tuples", "set", "--connect", "x", "--owner", "3", "lamp.state", "on"}).what);
  CHECK(set.owner.id == peer_id{3});
  CHECK(set.key == "lamp.state");
  CHECK(set.value == "on");
  CHECK(!set.append);
  const auto append = std::get<write_tuple>(
      parsed({"tuples", "append", "--connect", "x", "--owner", "3", "log", "-1"}).what);
  CHECK(append.append);
  CHECK(append.value == "-1");
  const auto get =
      std::get<get_tuple>(parsed({"tuples", "get", "--connect", "x", "a.b", "--owner", "3"}).what);
  CHECK(get.key == "a.b");
  CHECK(get.owner.id == peer_id{3});
  const auto watch = std::get<watch_tuples>(
      parsed({"tuples", "watch", "--connect", "x", "a.*", "b", "--for", "3s", "--count", "2"})
          .what);
  CHECK(watch.patterns == std::vector<std::string>{"a.*", "b"});
  CHECK(watch.length == 3s);
  CHECK(watch.count == 2U);
  CHECK(std::get<list_tuples>(parsed({"tuples", "ls", "--connect", "x", "--all"}).what).all);
  CHECK(std::get<trace_route>(parsed({"route", "--connect", "x", "9"}).what).host.id == peer_id{9});
  const auto ping =
      std::get<ping_host>(parsed({"ping", "--connect", "x", "9", "--count", "1"}).what);
  CHECK(ping.host.id == peer_id{9});
  CHECK(ping.count == 1);
}

TEST_CASE("a network command that makes no sense is refused with its reason", "[cli]") {
  const auto line =
      GENERATE(std::vector<const char*>{"hosts", "--lan", "--connect", "x"},
               std::vector<const char*>{"tuples", "--connect", "x"},
               std::vector<const char*>{"hosts", "--connect", "x:99999"},
               std::vector<const char*>{"hosts", "--connect", "bt://AA:BB:CC:DD:EE:FF"},
               std::vector<const char*>{"hosts", "--connect", "x", "--id", "0"},
               std::vector<const char*>{"hosts", "--connect", "x", "--id", "65536"},
               std::vector<const char*>{"hosts", "--connect", "x", "--timeout", "0s"},
               std::vector<const char*>{"hosts", "--connect", "x", "7"},
               std::vector<const char*>{"route", "--connect", "x"},
               std::vector<const char*>{"route", "--connect", "x", ""},
               std::vector<const char*>{"route", "--connect", "x", "65536"},
               std::vector<const char*>{"ping", "--connect", "x", "7", "--count", "0"},
               std::vector<const char*>{"tuples", "get", "--connect", "x", "a.*"},
               std::vector<const char*>{"tuples", "get", "--connect", "x", ""},
               std::vector<const char*>{"tuples", "set", "a", "b", "--owner", ""},
               std::vector<const char*>{"tuples", "graph", "--dot", "--json"},
               std::vector<const char*>{"top", "--every", "0s"},
               std::vector<const char*>{"tuples", "set", "--connect", "x", "a", "--owner", "3"},
               std::vector<const char*>{"tuples", "watch", "--connect", "x"},
               std::vector<const char*>{"tuples", "watch", "--connect", "x", "a.b*"},
               std::vector<const char*>{"tuples", "ls", "--connect", "x", "a.b.c.d.e.f.g.h"});
  const auto x = parse(line);
  CAPTURE(line);
  REQUIRE(std::holds_alternative<refused_command>(x));
  CHECK(std::get<refused_command>(x).text.starts_with("rubicon: "));
}

TEST_CASE("neither the network's place nor a tuple's owner needs to be said", "[cli][SVC-08]") {
  const auto plain = parsed({"hosts"}).with;
  CHECK(plain.peer.empty());
  CHECK(!plain.network_given);
  CHECK(!plain.lan);
  CHECK(parsed({"hosts", "--lan"}).with.lan);
  CHECK(parsed({"hosts", "--network", "rubicon"}).with.network_given);
  const auto set = std::get<write_tuple>(parsed({"tuples", "set", "a", "b"}).what);
  CHECK(set.owner.is_any());
  const auto named =
      std::get<write_tuple>(parsed({"tuples", "set", "a", "b", "--owner", "care-pc"}).what);
  CHECK(named.owner.name == "care-pc");
  CHECK(!named.owner.id);
  CHECK(std::get<trace_route>(parsed({"route", "home"}).what).host.name == "home");
}

TEST_CASE("pictures of a network are asked for", "[cli][SVC-07]") {
  const auto top = std::get<show_top>(
      parsed({"top", "--connect", "x", "--once", "--every", "2s", "--count", "3"}).what);
  CHECK(top.once);
  CHECK(top.every == 2s);
  CHECK(top.count == 3U);
  CHECK(!std::get<show_top>(parsed({"top"}).what).once);
  const auto graph = std::get<show_graph>(parsed({"tuples", "graph", "--dot", "--all"}).what);
  CHECK(graph.dot);
  CHECK(graph.all);
}
