#include <string>

#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// An island `k` with a sink that receives and three motes `n-2`, `n-3`, `n-4`, of which 3 relays
/// to the sink; from line 13 follow the apps of mote 2.
const std::string flow_head =
    "[ecology]\nname = \"t\"\n[[island]]\nname = \"k\"\nid = 1\nstack = \"mac\"\n"
    "sink.apps = [{ app = \"receiver\" }]\n"
    "mote = [{ id = 3, name = \"n-3\", position_m = [0, 0], apps = [{ app = \"relay\", next = "
    "\"k/sink\" }] },\n"
    "        { id = 4, name = \"n-4\", position_m = [0, 0] },\n"
    "        { id = 2, name = \"n-2\", position_m = [0, 0], apps = [\n\n\n";
const std::string flow_tail = "\n] }]\n[[island]]\nname = \"b\"\nid = 2\nstack = \"mac\"\n"
                              "mote = [{ id = 2, name = \"n-2\", position_m = [0, 0] }]\n";

std::string problem_with_app(const std::string& app) {
  return problem_in(flow_head + app + flow_tail);
}

mote_app app_with(const std::string& app) {
  return good(flow_head + app + flow_tail).islands.at(0).motes.at(0).apps.at(0);
}

} // namespace

TEST_CASE("a sender arrives with its keys", "[config][traffic]") {
  const auto x = std::get<traffic::sender_config>(
      app_with("{ app = \"sender\", to = \"k/sink\", via = \"k/n-3\", payload = 116, pattern = "
               "\"periodic\", every = \"20ms\", jitter = \"5ms\", start = \"1s\", stop = \"9s\", "
               "count = 100, ack = false }"));
  CHECK(x.to == mote_id{1});
  CHECK(x.via == mote_id{3});
  CHECK(x.payload == 116);
  CHECK(x.pattern == traffic::arrivals::periodic);
  CHECK(x.every == 20ms);
  CHECK(x.jitter == 5ms);
  CHECK(x.start == 1s);
  CHECK(x.stop == 9s);
  CHECK(x.count == 100U);
  CHECK_FALSE(x.ack);
  const auto y = std::get<traffic::sender_config>(app_with("{ app = \"sender\", to = \"sink\" }"));
  CHECK(y.to == mote_id{1});
  CHECK_FALSE(y.via);
  CHECK(y.payload == 20);
  CHECK(y.every == 1s);
  CHECK_FALSE(y.start);
  CHECK_FALSE(y.stop);
  CHECK_FALSE(y.count);
  CHECK(y.ack);
  const auto z = std::get<traffic::sender_config>(
      app_with("{ app = \"sender\", to = \"*\", pattern = \"saturated\" }"));
  CHECK(z.to == broadcast_mote);
  CHECK(z.pattern == traffic::arrivals::saturated);
  CHECK_FALSE(z.ack);
}

TEST_CASE("relays and receivers arrive, on motes and sinks of both stacks", "[config][traffic]") {
  const auto x = good(flow_head + "{ app = \"relay\", next = \"k/n-3\", ack = false }" + flow_tail);
  const auto& relay = std::get<traffic::relay_config>(x.islands[0].motes.at(0).apps.at(0));
  CHECK(relay.next == mote_id{3});
  CHECK_FALSE(relay.ack);
  const auto full = good(mote_head + "apps = [{ app = \"sender\", to = \"sink\" },\n"
                                     "{ app = \"listener\" }]\n"
                                     "[island.sink]\napps = [{ app = \"receiver\" }]\n");
  CHECK(std::get<traffic::sender_config>(full.islands[0].motes.at(0).apps.at(0)).to == mote_id{1});
  CHECK(full.islands[0].sink.apps.size() == 1);
}

TEST_CASE("a type's sender goes to the sink of each mote's island", "[config][traffic][NET-13]") {
  const auto x = good("[ecology]\nname = \"t\"\n"
                      "[mote_type.s]\ntype = 1\napps = [{ app = \"sender\", to = \"sink\" },\n"
                      "{ app = \"receiver\" }]\n"
                      "[[island]]\nname = \"a\"\nid = 1\nstack = \"mac\"\n"
                      "sink = { id = 9, apps = [{ app = \"receiver\" }] }\n"
                      "mote = [{ id = 2, type = \"s\", position_m = [0, 0], "
                      "apps = [{ app = \"receiver\" }] }]\n"
                      "[[island]]\nname = \"b\"\nid = 2\nstack = \"mac\"\n"
                      "sink = { id = 8, apps = [{ app = \"receiver\" }] }\n"
                      "mote = [{ id = 2, type = \"s\", position_m = [0, 0] }]\n");
  CHECK(std::get<traffic::sender_config>(x.islands[0].motes[0].apps[0]).to == mote_id{9});
  CHECK(x.islands[0].motes[0].apps.size() == 2); // the receiver took the type's place
  CHECK(std::get<traffic::sender_config>(x.islands[1].motes[0].apps[0]).to == mote_id{8});
}

TEST_CASE("the keys of a sender make sense together", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"{ app = \"sender\" }", "13:1: `to` is missing in app = \"sender\""},
      {"{ app = \"sender\", to = \"k/n-2\" }", "13:24: a mote cannot send to itself"},
      {"{ app = \"sender\", to = \"sink\", via = \"k/n-2\" }",
       "13:38: a mote cannot send to itself"},
      {"{ app = \"sender\", to = \"b/n-2\" }",
       "13:24: packets of measuring apps do not leave their island"},
      {"{ app = \"sender\", to = \"k/n-9\" }",
       "13:24: no mote of island `k` is named `n-9`: did you mean `n-2`?"},
      {"{ app = \"sender\", to = \"n-3\" }",
       "13:24: `to` must be the island and the name of a mote, as in \"lab/node-7\", or \"sink\" "
       "or \"*\", not \"n-3\""},
      {"{ app = \"sender\", to = \"sink\", via = \"*\" }",
       "13:38: `via` must be the island and the name of a mote, as in \"lab/node-7\", or "
       "\"sink\", not \"*\""},
      {"{ app = \"sender\", to = \"*\", via = \"k/n-3\" }",
       "13:35: a broadcast goes to all radios in range, not `via` a relay"},
      {"{ app = \"sender\", to = \"*\", ack = true }", "13:35: a broadcast is never acknowledged"},
      {"{ app = \"sender\", to = \"*\", ack = false }", "none"},
      {"{ app = \"sender\", to = \"sink\", payload = 19 }",
       "13:42: `payload` must be a whole number from 20 to 116, not 19"},
      {"{ app = \"sender\", to = \"sink\", payload = 117 }",
       "13:42: `payload` must be a whole number from 20 to 116, not 117"},
      {"{ app = \"sender\", to = \"sink\", jitter = \"2s\" }",
       "13:41: `jitter` must not be longer than `every`, which is 1 s"},
      {"{ app = \"sender\", to = \"sink\", pattern = \"saturated\", every = \"2s\" }",
       "13:63: `every` has no effect with pattern = \"saturated\""},
      {"{ app = \"sender\", to = \"sink\", pattern = \"poisson\", jitter = \"2ms\" }",
       "13:62: `jitter` has no effect with pattern = \"poisson\""},
      {"{ app = \"sender\", to = \"sink\", start = \"2s\", stop = \"2s\" }",
       "13:53: `stop` must be later than `start`, which is 2 s"},
      {"{ app = \"sender\", to = \"sink\", count = 0 }",
       "13:40: `count` must be a whole number from 1 to 9223372036854775807, not 0"},
      {"{ app = \"sender\", to = \"k/n-4\" }", "13:24: mote `n-4` has no app = \"receiver\""},
      {"{ app = \"sender\", to = \"sink\", via = \"k/n-4\" }",
       "13:38: mote `n-4` on the route to `sink` has no app = \"relay\""},
      {"{ app = \"sender\", to = \"sink\", via = \"k/n-3\" }", "none"},
      {"{ app = \"relay\", next = \"k/n-2\" }", "13:25: a mote cannot send to itself"},
      {"{ app = \"relay\", next = \"*\" }",
       "13:25: `next` must be the island and the name of a mote, as in \"lab/node-7\", or "
       "\"sink\", not \"*\""},
      {"{ app = \"relay\", next = \"sink\" }, { app = \"relay\", next = \"k/n-3\" }",
       "13:43: the relay of the mote is already taken (line 13, column 9)"},
      {"{ app = \"receiver\" }, { app = \"receiver\" }",
       "13:31: the receiver of the mote is already taken (line 13, column 9)"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_with_app(x.toml) == x.problem);
}

TEST_CASE("relays that go in circles are told", "[config][GEN-06]") {
  check_mistakes("", R"(
[ecology]
name = "t"
[[island]]
name = "k"
id = 1
stack = "mac"
sink.apps = [{ app = "receiver" }]
mote = [
{ id = 2, position_m = [0, 0], apps = [{ app = "relay", next = "k/mote-3" }] },
{ id = 3, position_m = [0, 0], apps = [{ app = "relay", next = "k/mote-2" }] },
{ id = 4, position_m = [0, 0], apps = [{ app = "sender", to = "sink", via = "k/mote-2" }] }]
#                                                                           ^ through `mote-2`
#   packets do not reach `sink` within 1024 hops
)");
}

TEST_CASE("channel 240 is that of the measuring apps", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"apps = [{ app = \"listener\", am_type = 240 }]\n",
       "19:39: channel 240 is that of the apps sender, relay and receiver"},
      {"apps = [{ app = \"messenger\", to = \"k/c-2\", text = \"x\", am_type = 240 }]\n",
       "19:66: channel 240 is that of the apps sender, relay and receiver"},
      {"apps = [{ app = \"actuator\", actuator = \"fan\", channel = 240 }]\n",
       "19:57: channel 240 is that of the apps sender, relay and receiver"},
      {"apps = [{ app = \"sampler\", transducers = [\"temperature\"], channel = 240 }]\n",
       "19:69: channel 240 is that of the apps sender, relay and receiver"},
      {"apps = [{ app = \"listener\", am_type = 241 }]\n", "none"},
      {"[island.sink]\napps = [{ app = \"listener\" }]\n",
       "20:9: a sink has no other apps than sender, relay and receiver"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(mote_head, x.toml) == x.problem);
}
