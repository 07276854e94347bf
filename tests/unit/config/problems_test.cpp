#include <string>

#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon::test;

TEST_CASE("an ecology needs its table and somebody in it", "[config][GEN-06]") {
  check_mistakes("", R"(
[ecology]
#< the file has neither an [[island]] nor a [[peer]]
name = "t"

[[peer]]
#< the file lacks the table [ecology]
name = "pc"
id = 300

ecology = 1
#         ^ `ecology` must be a table, not 1
[[peer]]
name = "pc"
id = 300
)");
}

TEST_CASE("an unknown, missing or misplaced key is told with its place", "[config][GEN-06]") {
  check_mistakes(head, R"(
[radio]
rnage = "25m"
#< unknown key `rnage` in [radio]: did you mean `range`?

[radio]
colour = "blue"
#< unknown key `colour` in [radio]: there is loss, queue, retries, receive_slots, service_time,
#   propagation, range, noise, sensitivity, cca_threshold, ...

[radios]
#^ unknown key `radios` in the file: did you mean `radio`?

[colour]
#^ unknown key `colour` in the file: there is ecology, plan, radio, host, quantity, smepp,
#   mote_type, island, air, peis, ...

[plan]
#< `width` is missing in [plan]
picture = "flat.png"

[plan]
picture = "flat.png"
width = "0m"
#       ^ `width` must be a length from 0.1 m to 100000 m with its unit (cm, m or km), as in
#   "25m", not "0m"

nick = "x"
#< unknown key `nick` in [[peer]]: there is id, name, count, label, host, links, connect, tcp, lan,
#   udp, ...

[island]
#< `island` must be tables under headers [[island]], not a table
id = 1

[[radio]]
#< `radio` must be a table, not an array of 1; its header is [radio]
loss = 0

[[peer]]
#< `id` is missing in [[peer]]
name = "pc2"

[[peer]]
#< `name` is missing in [[peer]]
id = 301

[peer.apps]
#< `apps` must be an array of tables, as in [{ ... }], not a table
app = "collector"

apps = [1]
#       ^ `apps` must be an array of tables, as in [{ ... }], not 1

apps = [{ keys = ["a"] }]
#       ^ `app` is missing in apps of a peer

apps = [{ app = "colector", keys = ["a"] }]
#               ^ `app` must be "proxy_manager", "rules", "collector", "translate", "rfid_reader",
#   "goal", "init", "stream_reader", "reservoir", "readout", "average", "stream_switch",
#   "recorder" or "lua", not "colector"; did you mean "collector"?

apps = [{ app = "collector", keys = ["a"], rate = "1s" }]
#                                          ^ unknown key `rate` in app = "collector": it is a
#   key of subscriptions of a member, [peis.bluetooth], [mqtt]; see rubicon check --explain rate

apps = [{ app = "collector", keys = ["devices.*.output.*"], every = "1s" }]
#                                                                   ^ `every` needs a key that names
#   an output channel of motes, such as `devices.*.output.1`

apps = [{ app = "collector" }]
#       ^ `keys` is missing in app = "collector"

apps = [{ app = "rules" }]
#       ^ `rules` is missing in app = "rules"

[mote_type]
c = 1
#   ^ `c` must be tables under headers [mote_type.NAME], not 1

[mote_type."a b"]
#          ^ mote type "a b" must have a name of 1 to 32 letters, digits, - and _
type = 1

[mote_type.c]
#< `type` is missing in [mote_type.NAME]

[mote_type.c]
type = 0
#      ^ `type` must be a whole number from 1 to 4294967295, not 0

[[mote_type]]
#< `mote_type` must be tables under headers [mote_type.NAME], not an array of 1
type = 1

[[island]]
#< `id` is missing in [[island]]
#< `name` is missing in [[island]]

[[air]]
#< `islands` is missing in [[air]]
#< `name` is missing in [[air]]

[[proxy]]
#< `name` is missing in [[proxy]]
#< a proxy needs either `types`, of motes, or `ids`, of tagged objects

[[fault]]
#< `at` is missing in [[fault]]
#< `kind` is missing in [[fault]]

[[fault]]
#< `mote` is missing in kind = "crash"
at = "1s"
kind = "crash"

[[fault]]
#< `island` is missing in kind = "unplug"
at = "1s"
kind = "unplug"

[[fault]]
at = "1s"
kind = "unplugged"
#      ^ `kind` must be "battery_end", "crash", "unplug", "kill", "power_off", "pause", "partition",
#   "link_loss", "duplicate_id", "clock_step", "move", "noise" or "radio_loss", not "unplugged"; did
#   you mean "unplug"?

[[host]]
#< `address` is missing in [[host]]
#< `name` is missing in [[host]]
)");
}

TEST_CASE("fields and inputs need their keys", "[config][GEN-06]") {
  check_mistakes(proxy_head, R"(
[[proxy.field]]
#< `channel` is missing in [[proxy.field]]
#< `name` is missing in [[proxy.field]]

[[proxy.input]]
#< `channel` is missing in [[proxy.input]]
#< `name` is missing in [[proxy.input]]
#< `words` is missing in [[proxy.input]]
)");
}

TEST_CASE("an island's tables have keys of their own", "[config][GEN-06]") {
  check_mistakes(island_head, R"(
[[island.mote]]
#< `id` is missing in [[island.mote]]
#< `position_m` is missing in [[island.mote]]
#< `type` is missing in [[island.mote]]

mote = [{ id = 2, type = "c", position_m = [1, 2], positoin = 1 }, 3]
#                                                  ^ unknown key `positoin` in [[island.mote]]:
#   there is id, type, platform, battery, power, channel, csma, transducers, actuators, apps, ...
#                                                                  ^ `mote` must be tables under
#   headers [[island.mote]], not 3

[island.sink]
baud = 1
#< unknown key `baud` in [island.sink]: it is a key of [island.serial], [island.real],
#   [island.alias.serial], ...; see rubicon check --explain baud

[island.gateway]
link = []
#< unknown key `link` in [island.gateway]: did you mean `links`?
)");
}

TEST_CASE("a mote's transducers and actuators have keys of their own", "[config][GEN-06]") {
  check_mistakes(mote_head, R"(
transducers.temprature = { model = "constant", value = 1 }
#           ^ unknown key `temprature` in transducers: did you mean `temperature`?

transducers = 1
#             ^ `transducers` must be a table, not 1

transducers.light = 1
#                   ^ `light` must be a table, not 1

transducers.light = { value = 1 }
#                   ^ `model` is missing in transducers.QUANTITY

transducers.light = { model = "constant" }
#                   ^ `value` is missing in model = "constant"

transducers.light = { model = "sine", valeu = 1 }
#                   ^ `amplitude` is missing in model = "sine"
#                   ^ `mean` is missing in model = "sine"
#                                     ^ unknown key `valeu` in model = "sine": there is noise,
#   resolution, model, mean, amplitude, period, phase_turns

transducers.light = { model = "constant", value = 1, noize = 1 }
#                                                    ^ unknown key `noize` in model = "constant":
#   did you mean `noise`?

actuators = [{ kind = "relay" }]
#            ^ `name` is missing in actuators

actuators = { name = "x", kind = "relay" }
#           ^ `actuators` must be an array of tables, as in [{ ... }], not a table
)");
}

TEST_CASE("every mistake of a file is told in one go, in order of place", "[config][GEN-06]") {
  check_mistakes("", R"(
[ecology]
name = "t"
sede = 3
#< unknown key `sede` in [ecology]: did you mean `seed`?
[[peer]]
name = "pc"
id = "12"
#    ^ `id` must be a whole number from 1 to 65535, not "12"
links = ["inproc://robt"]
#        ^ no peer or gateway is named `robt`: did you mean `robot`?
[[peer]]
name = "robot"
id = 12
)");
}

TEST_CASE("a mistake is not told again by what depends on it", "[config][GEN-06]") {
  const std::string far = "[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [99, 0]\n";
  CHECK(problem_after(island_head, far).starts_with("18:14: mote `c-2` is unreachable"));
  const auto bad_range = problem_after(island_head, far + "[radio]\nrange = 200\n");
  CHECK(bad_range.starts_with("20:9: `range` must be a length"));
  const auto bad_key = problem_after(island_head, far + "[radio]\nrnage = \"200m\"\n");
  CHECK(bad_key == "20:1: unknown key `rnage` in [radio]: did you mean `range`?");
  const auto bad_sink = problem_after(island_head, "sink.position_m = 5\n" + far);
  CHECK(bad_sink.starts_with("15:19: `position_m` must be"));
  CHECK(bad_sink.find('\n') == std::string::npos);
  const auto bad_end = problem_in("[ecology]\nname = \"t\"\nduration = 20\n"
                                  "[[island]]\nname = \"k\"\nid = 1\n"
                                  "[[fault]]\nat = \"15min\"\nkind = \"unplug\"\nisland = \"k\"\n");
  CHECK(bad_end.starts_with("3:12: `duration` must be a time"));
  CHECK(bad_end.find('\n') == std::string::npos);
  CHECK(problem_after(field_head, "encoding = \"u3\"\nwords = { 99999 = \"x\" }\n").find('\n') ==
        std::string::npos);
  CHECK(problem_after(mote_head, "transducers.light = { model = \"constant\", value = 5000, "
                                 "resolution = \"1\" }\n")
            .find('\n') == std::string::npos);
  CHECK(problem_after(mote_head, "apps = [{ app = \"sampler\", transducers = [\"temperature\"], "
                                 "every = 60, jitter = \"45s\" }]\n")
            .find('\n') == std::string::npos);
  check_mistakes(head, R"(
[[air]]
#< `islands` is missing in [[air]]
#< `name` is missing in [[air]]
)");
}

TEST_CASE("problems show as compilers show them", "[config][GEN-06]") {
  using rubicon::config::problem;
  CHECK(to_string(problem{"home.toml", 3, 7, "oh"}) == "home.toml:3:7: oh");
  CHECK(to_string(problem{"home.toml", 0, 0, "oh"}) == "home.toml: oh");
}
