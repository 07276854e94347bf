#include <string>

#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon::test;

TEST_CASE("islands and peers share ids and names", "[config][GEN-06][ADR-02][ADR-03]") {
  check_mistakes(island_head, R"(
[[island]]
name = "b"
id = 1
#    ^ PEIS id 1 is already taken (line 13, column 6)

[[island]]
name = "K"
#      ^ island name `K` is already taken (line 12, column 8)
id = 2

[[island]]
name = "b"
id = 300
#    ^ `id` must be a whole number from 1 to 254, not 300

[[island]]
name = "b"
id = 254

[[island]]
name = "b"
id = 255
#    ^ `id` must be a whole number from 1 to 254, not 255

[[island]]
name = "b"
id = 0
#    ^ `id` must be a whole number from 1 to 65534, not 0

[[peer]]
name = "pc2"
id = 1
#    ^ PEIS id 1 is already taken (line 13, column 6)

[[peer]]
name = "PC"
#      ^ peer or gateway name `PC` is already taken (line 5, column 8)
id = 301

[[peer]]
name = "k-gateway"
#      ^ peer or gateway name `k-gateway` is already taken (line 12, column 8)
id = 301

gateway.name = "pc"
#              ^ peer or gateway name `pc` is already taken (line 5, column 8)

[[peer]]
name = "p2"
id = 65536
#    ^ `id` must be a whole number from 1 to 65535, not 65536

[[peer]]
name = "p2"
id = 65535
)");
}

TEST_CASE("mote ids and names are unique in their island, the sink included",
          "[config][GEN-06][ADR-04][ADR-07][ADR-09]") {
  check_mistakes(island_head, R"(
[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
[[island.mote]]
id = 2
#    ^ mote id 2 is already taken (line 16, column 6)
type = "c"
position_m = [1, 2]

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
name = "x"
[[island.mote]]
id = 3
type = "c"
position_m = [1, 2]
name = "X"
#      ^ mote name `X` is already taken (line 19, column 8)

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
[[island.mote]]
id = 3
type = "c"
position_m = [1, 2]
name = "c-2"
#      ^ mote name `c-2` is already taken (line 15, column 1)

[[island.mote]]
id = 1
#    ^ mote id 1 is the sink's
type = "c"
position_m = [1, 2]

sink.id = 2
[[island.mote]]
id = 2
#    ^ mote id 2 is the sink's
type = "c"
position_m = [1, 2]

[[island.mote]]
id = 65533
#    ^ `id` must be a whole number from 1 to 65532, not 65533
type = "c"
position_m = [1, 2]

[[island.mote]]
id = 65532
type = "c"
position_m = [1, 2]

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
[[island]]
name = "b"
id = 2
[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
)");
}

TEST_CASE("a mote has the type of a table or a number", "[config][GEN-06][PXY-13]") {
  check_mistakes(island_head, R"(
[[island.mote]]
id = 2
type = "d"
#      ^ no mote type is named `d`: did you mean `c`?
position_m = [1, 2]

[[island.mote]]
id = 2
type = "lamp"
#      ^ no mote type is named `lamp`: there is c
position_m = [1, 2]

[[island.mote]]
id = 2
type = 8
position_m = [1, 2]

[[island.mote]]
id = 2
type = 0
#      ^ `type` must be a whole number from 1 to 4294967295, not 0
position_m = [1, 2]

[[island.mote]]
id = 2
type = 1.5
#      ^ `type` must be a whole number from 1 to 4294967295, not 1.5
position_m = [1, 2]
)");
}

TEST_CASE("a mote to which no chain of motes leads from its sink is told", "[config][GEN-06]") {
  check_mistakes(island_head, R"(
[[island.mote]]
id = 2
type = "c"
position_m = [30, 1]
#            ^ mote `c-2` is unreachable: no chain of motes at most 30 m apart leads to its sink;
#   place it nearer, add motes between, or raise `range` in [radio]

[[island.mote]]
id = 2
type = "c"
position_m = [30, 0]

[[island.mote]]
id = 2
type = "c"
position_m = [0, 30, 5]
#            ^ mote `c-2` is unreachable: no chain of motes at most 30 m apart leads to its sink;
#   place it nearer, add motes between, or raise `range` in [radio]

[[island.mote]]
id = 2
type = "c"
position_m = [55, 0]
[[island.mote]]
id = 3
type = "c"
position_m = [28, 0]

[[island.mote]]
id = 2
type = "c"
position_m = [59, 0]
#            ^ mote `c-2` is unreachable: no chain of motes at most 30 m apart leads to its sink;
#   place it nearer, add motes between, or raise `range` in [radio]
[[island.mote]]
id = 3
type = "c"
position_m = [28, 0]
)");
}

TEST_CASE("apps need what they name, and a channel of their own", "[config][GEN-06]") {
  check_mistakes(island_head, R"(
[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
apps = [{ app = "sampler", transducers = ["temperature", "light"] }]
#                                                        ^ the mote has no transducer `light`; it
#   has: temperature

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
apps = [{ app = "sampler", transducers = ["temperature", "temperature"] }]
#                                                        ^ transducer `temperature` is already
#   listed (line 19, column 43)

[[island.mote]]
id = 2
type = 8
position_m = [1, 2]
apps = [{ app = "sampler", transducers = ["light"] }]
#                                         ^ the mote has no transducer `light`; it has: none

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
apps = [{ app = "actuator", actuator = "lamp" }]
#                                      ^ the mote has no actuator `lamp`; it has: fan

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
apps = [{ app = "actuator", actuator = "fan" }, { app = "listener", am_type = 2 }]
#                                                                             ^ input channel 2 of
#   the mote is already taken (line 19, column 9)

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
apps = [{ app = "actuator", actuator = "fan", channel = 1 }, { app = "sampler", transducers = ["temperature"] }]
#                                                            ^ output channel 1 of the mote is
#   already taken (line 19, column 57)

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
apps = [{ app = "listener" }, { app = "listener" }]
#                             ^ input channel 10 of the mote is already taken (line 19, column 9)

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
actuators = [{ name = "x", kind = "relay" }, { name = "x", kind = "dimmer" }]
#                                                     ^ actuator `x` is already taken (line 19,
#   column 23)

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
apps = [{ app = "messenger", text = "x", to = "c-2" }]
#                                             ^ `to` must be the island and the name of a mote, as
#   in "kitchen/climate-7", not "c-2"

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
apps = [{ app = "messenger", text = "x", to = "kk/c-2" }]
#                                             ^ no island is named `kk`: did you mean `k`?

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
apps = [{ app = "messenger", text = "x", to = "k/c-3" }]
#                                             ^ no mote of island `k` is named `c-3`: did you mean
#   `c-2`?

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
apps = [{ app = "messenger", text = "x", to = 2 }]
#                                             ^ `to` must be the island and the name of a mote, as
#   in "kitchen/climate-7", not 2

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
apps = [{ app = "messenger", text = "x", to = "k/c-2" }]
)");
}

TEST_CASE("a mistake in a mote type is told once", "[config][GEN-06]") {
  constexpr const char* start = R"([ecology]
name = "t"
duration = "1h"
[[peer]]
name = "pc"
id = 300
[mote_type.c]
type = 7
transducers.temperature = { model = "constant", value = 20 }
)";
  check_mistakes(start, R"(
apps = [{ app = "sampler", transducers = ["light"] }]
#                                         ^ the mote has no transducer `light`; it has: temperature
actuators = [{ name = "fan", kind = "relay" }]
[[island]]
name = "k"
id = 1

apps = [{ app = "sampler", transducers = ["light"] }]
#                                         ^ the mote has no transducer `light`; it has: temperature
actuators = [{ name = "fan", kind = "relay" }]
[[island]]
name = "k"
id = 1
[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
[[island.mote]]
id = 3
type = "c"
position_m = [1, 2]

apps = [{ app = "sampler", transducers = ["light"] }]
actuators = [{ name = "fan", kind = "relay" }]
[[island]]
name = "k"
id = 1
[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
transducers.light = { model = "constant", value = 1 }
)");
}

TEST_CASE("hosts are known by name", "[config][GEN-06]") {
  check_mistakes(island_head, R"(
host = "h1"
#      ^ no host is named `h1`: there is none; describe it under [[host]]

host = "h2"
#      ^ no host is named `h2`: did you mean `h1`?
[[host]]
name = "h1"
address = "10.0.0.1"

host = "h1"
[[host]]
name = "h1"
address = "10.0.0.1"

host = 3
#      ^ `host` must be the name of a host, not 3
[[host]]
name = "h1"
address = "10.0.0.1"

[[host]]
name = "h1"
address = "10.0.0.1"
[[host]]
name = "h1"
#      ^ host name `h1` is already taken (line 16, column 8)
address = "10.0.0.1"
)");
}

TEST_CASE("links lead to other peers or gateways", "[config][GEN-06]") {
  check_mistakes(island_head, R"(
gateway.links = ["inproc://pcc"]
#                ^ no peer or gateway is named `pcc`: did you mean `pc`?

gateway.links = ["pc"]
#                ^ `links` must be a link to a peer or gateway, as in "inproc://kitchen-gateway",
#   not "pc"

gateway.links = ["tcp://pc:8000"]
#                ^ `links` must be a link to a peer or gateway, as in "inproc://kitchen-gateway",
#   not "tcp://pc:8000"

gateway.links = ["inproc://k-gateway"]
#                ^ `k-gateway` cannot have a link to itself

gateway.links = ["inproc://pc", "inproc://pc"]
#                               ^ the link to `pc` is already listed (line 15, column 18)

gateway.links = "inproc://pc"
#               ^ `links` must be an array in [ ], not "inproc://pc"

gateway.links = ["inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc", "inproc://pc"]
#               ^ `links` must be an array of at most 16, not an array of 17

[[peer]]
name = "p2"
id = 301
links = ["inproc://p3"]
[[peer]]
name = "p3"
id = 302
links = ["inproc://p2"]

[[peer]]
name = "p2"
id = 301
links = ["inproc://p2"]
#        ^ `p2` cannot have a link to itself
)");
}

TEST_CASE("an island is in one air", "[config][GEN-06]") {
  check_mistakes(island_head, R"(
[[island]]
name = "b"
id = 2
[[air]]
name = "a"
islands = ["k", "b"]
[[air]]
name = "a2"
islands = ["k"]
#          ^ island `k` already belongs to a radio medium (line 20, column 12)

[[island]]
name = "b"
id = 2
[[air]]
name = "a"
islands = ["k", "k"]
#               ^ island `k` already belongs to a radio medium (line 20, column 12)

[[air]]
name = "a"
islands = ["q"]
#          ^ no island is named `q`: did you mean `k`?

[[air]]
name = "a"
islands = []
#         ^ `islands` must be an array of at least 1, not an empty array

[[island]]
name = "b"
id = 2
[[air]]
name = "b"
#      ^ air `b` has the name of an island that is not in it
islands = ["k"]

[[island]]
name = "b"
id = 2
[[air]]
name = "b"
islands = ["k", "b"]

[[island]]
name = "b"
id = 2
host = "h1"
[[air]]
name = "a"
islands = ["k", "b"]
#               ^ islands `k` and `b` share a radio medium, so they must be on one host
[[host]]
name = "h1"
address = "10.0.0.1"

[[island]]
name = "b"
id = 2
[[air]]
name = "a"
islands = ["k"]
[[air]]
name = "A"
#      ^ air name `A` is already taken (line 19, column 8)
islands = ["b"]
)");
}

TEST_CASE("a proxy manager serves islands that exist", "[config][GEN-06]") {
  check_mistakes(head, R"(
apps = [{ app = "proxy_manager", islands = ["k"] }]
#                                           ^ no island is named `k`: there is none
)");
}

TEST_CASE("an island has at most one proxy manager", "[config][GEN-06]") {
  check_mistakes(island_head, R"(
[[peer]]
name = "p2"
id = 301
apps = [{ app = "proxy_manager" }]
[[peer]]
name = "p3"
id = 302
apps = [{ app = "proxy_manager", islands = ["k"] }]
#                                           ^ island `k` already has a proxy manager (line 18,
#   column 9)
)");
}

TEST_CASE("proxies differ in name, types and tuples", "[config][GEN-06][PXY-11]") {
  check_mistakes(head, R"(
[[proxy]]
name = "p"
types = [7]
[[proxy]]
name = "q"
types = ["7..7"]
#        ^ proxies `p` and `q` both claim type 7, with equally wide ranges (line 8, column 10)

[[proxy]]
name = "p"
types = ["1..10"]
[[proxy]]
name = "q"
types = [99, "8..17"]
#            ^ proxies `p` and `q` both claim type 8, with equally wide ranges (line 8, column 10)

[[proxy]]
name = "p"
types = ["1..10"]
[[proxy]]
name = "q"
types = ["8..18", 5]

[[proxy]]
name = "p"
types = [7]
[[proxy]]
name = "p"
#      ^ proxy name `p` is already taken (line 7, column 8)
types = [8]

[[proxy]]
name = "p"
types = [7]
[[proxy.field]]
name = "f"
channel = 1
[[proxy.field]]
name = "f"
#      ^ name `f` is already taken (line 10, column 8)
channel = 1

[[proxy]]
name = "p"
types = [7]
[[proxy.field]]
name = "f"
channel = 1
[[proxy.input]]
name = "f"
#      ^ name `f` is already taken (line 10, column 8)
channel = 2
words = { on = "01" }

[[proxy]]
name = "p"
types = [7]
properties = { f = "x" }
[[proxy.field]]
name = "f"
#      ^ name `f` is already taken (line 9, column 16)
channel = 1

[[proxy]]
name = "p"
types = [7]
[[proxy.field]]
name = "class"
#      ^ `class` is a tuple that proxies set by themselves
channel = 1
)");
}

TEST_CASE("a fault hits somebody before the end", "[config][GEN-06]") {
  check_mistakes(island_head, R"(
[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
[[fault]]
at = "1h1s"
#    ^ `at` is after the end of the run, which is at 1 h
kind = "crash"
mote = "k/c-2"

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
[[fault]]
at = "1h"
kind = "crash"
mote = "k/c-2"

[[island.mote]]
id = 2
type = "c"
position_m = [1, 2]
[[fault]]
at = "1s"
kind = "crash"
mote = "k/c-9"
#      ^ no mote of island `k` is named `c-9`: did you mean `c-2`?

[[fault]]
at = "1s"
kind = "unplug"
island = "kitchen"
#        ^ no island is named `kitchen`: there is k

[[fault]]
at = "1s"
kind = "unplug"
island = "k"
for = "0s"
#     ^ `for` must be a time from 1 ms to 3650 d, not "0s"
)");
}

TEST_CASE("an island of radios alone may have any PAN id, one with a gateway none above 254",
          "[config][ADR-03][NFR-06]") {
  const auto island = [](const char* id, const char* rest) {
    return std::string("[ecology]\nname = \"t\"\n[[island]]\nname = \"k\"\nid = ") + id + '\n' +
           rest + "[[island.mote]]\nid = 2\ntype = 1\nposition_m = [1, 2]\n";
  };
  for (const auto* id : {"255", "300", "65534"}) {
    CAPTURE(id);
    CHECK(problem_in(island(id, "stack = \"mac\"\n")) == "none");
    CHECK(problem_in(island(id, "")) ==
          std::string("5:6: `id` must be a whole number from 1 to 254, not ") + id);
  }
  CHECK(problem_in(island("65535", "stack = \"mac\"\n")) ==
        "5:6: `id` must be a whole number from 1 to 65534, not 65535");
}
