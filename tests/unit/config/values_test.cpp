#include <string>

#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon::test;

TEST_CASE("a value of the wrong kind or range says what would be right", "[config][GEN-06]") {
  check_mistakes(head, R"(
[radio]
queue = "8"
#       ^ `queue` must be a whole number from 1 to 1024, not "8"

[radio]
queue = 8.5
#       ^ `queue` must be a whole number from 1 to 1024, not 8.5

[radio]
queue = true
#       ^ `queue` must be a whole number from 1 to 1024, not true

[radio]
queue = []
#       ^ `queue` must be a whole number from 1 to 1024, not an empty array

[radio]
queue = {}
#       ^ `queue` must be a whole number from 1 to 1024, not a table

[radio]
queue = 2026-01-01
#       ^ `queue` must be a whole number from 1 to 1024, not a date or time

[radio]
queue = 0
#       ^ `queue` must be a whole number from 1 to 1024, not 0

[radio]
queue = 1024

[radio]
queue = 1025
#       ^ `queue` must be a whole number from 1 to 1024, not 1025

[radio]
retries = -1
#         ^ `retries` must be a whole number from 0 to 7, not -1

[radio]
retries = 8
#         ^ `retries` must be a whole number from 0 to 7, not 8

[radio]
range = 25
#       ^ `range` must be a length from 0.1 m to 100000 m with its unit (cm, m or km), as in "25m",
#   not 25

[radio]
range = "25"
#       ^ `range` must be a length from 0.1 m to 100000 m with its unit (cm, m or km), as in "25m",
#   not "25"

[radio]
range = "25 feet"
#       ^ `range` must be a length from 0.1 m to 100000 m with its unit (cm, m or km), as in "25m",
#   not "25 feet"

[radio]
range = "0m"
#       ^ `range` must be a length from 0.1 m to 100000 m with its unit (cm, m or km), as in "25m",
#   not "0m"

[radio]
loss = 2
#      ^ `loss` must be a ratio from 0 to 1, or from "0%" to "100%", not 2

[radio]
loss = "101%"
#      ^ `loss` must be a ratio from 0 to 1, or from "0%" to "100%", not "101%"

[radio]
loss = "2"
#      ^ `loss` must be a ratio from 0 to 1, or from "0%" to "100%", not "2"

[radio]
loss = nan
#      ^ `loss` must be a ratio from 0 to 1, or from "0%" to "100%", not nan

[radio]
loss = 1

[[proxy]]
name = "p"
types = []
#       ^ `types` must be an array of at least 1, not an empty array

[[proxy]]
name = "p"
types = 7
#       ^ `types` must be an array in [ ], not 7

[[proxy]]
name = "p"
types = ["9..8"]
#        ^ `types` must be types from 1 to 4294967295, as in 101, "100..119" or "0x0100/0xff00" (a
#   value and the mask under which types have it), not "9..8"

[[proxy]]
name = "p"
types = ["a..b"]
#        ^ `types` must be types from 1 to 4294967295, as in 101, "100..119" or "0x0100/0xff00" (a
#   value and the mask under which types have it), not "a..b"

[[proxy]]
name = "p"
types = [0]
#        ^ `types` must be types from 1 to 4294967295, as in 101, "100..119" or "0x0100/0xff00" (a
#   value and the mask under which types have it), not 0

[[proxy]]
name = "p"
types = ["5"]
#        ^ `types` must be types from 1 to 4294967295, as in 101, "100..119" or "0x0100/0xff00" (a
#   value and the mask under which types have it), not "5"

[[proxy]]
name = "p"
types = ["1..4294967296"]
#        ^ `types` must be types from 1 to 4294967295, as in 101, "100..119" or "0x0100/0xff00" (a
#   value and the mask under which types have it), not "1..4294967296"

apps = [{ app = "collector", keys = ["a b"] }]
#                                    ^ `keys` must be a tuple key of 1 to 7 parts between dots, each
#   of letters, digits, - and _ or a single *, not "a b"

apps = [{ app = "collector", keys = ["a.*.b", "a.b*"] }]
#                                             ^ `keys` must be a tuple key of 1 to 7 parts between
#   dots, each of letters, digits, - and _ or a single *, not "a.b*"

apps = [{ app = "collector", keys = ["a.b.c.d.e.f.g"] }]

apps = [{ app = "collector", keys = ["a.b.c.d.e.f.g.h"] }]
#                                    ^ `keys` must be a tuple key of 1 to 7 parts between dots, each
#   of letters, digits, - and _ or a single *, not "a.b.c.d.e.f.g.h"

apps = [{ app = "rules", rules = [] }]
#                                ^ `rules` must be an array of at least 1, not an empty array

[[peer.apps]]
app = "rules"
[[peer.apps.rules]]
when = "*.t"
#      ^ `when` must be a tuple key of 1 to 7 parts between dots, each of letters, digits, - and _,
#   not "*.t"
above = 1
write = "f"
then = "on"

[[peer.apps]]
app = "rules"
[[peer.apps.rules]]
#< a rule needs either `above`, `below` or both, or `equals`
when = "t"
write = "f"
then = "on"

[[peer.apps]]
app = "rules"
[[peer.apps.rules]]
#< a rule needs `then`, `otherwise` or both
when = "t"
above = 1
write = "f"

[[peer.apps]]
app = "rules"
[[peer.apps.rules]]
when = "t"
above = 1
below = 2
#       ^ `below` must not be more than `above`, which is 1
write = "f"
then = "on"
)");
}

TEST_CASE("a value of [ecology] that no run can have is refused", "[config][GEN-06]") {
  check_mistakes("", R"(
[ecology]
name = "t"
seed = -1
#      ^ `seed` must be a whole number from 0 to 9223372036854775807, not -1
mode = "fast"
#      ^ `mode` must be "virtual" or "wall", not "fast"
duration = "0s"
#          ^ `duration` must be a time from 1 ms to 3650 d, not "0s"
[[peer]]
name = "pc"
id = 300
)");
}

TEST_CASE("quantities of an island need their units and ranges", "[config][GEN-06][ADR-09]") {
  check_mistakes(island_head, R"(
keep_alive = 10
#            ^ `keep_alive` must be a time with its unit (ns, us, ms, s, min, h or d), as in "31s"
#   or "1min30s", not 10

keep_alive = "10"
#            ^ `keep_alive` must be a time with its unit (ns, us, ms, s, min, h or d), as in "31s"
#   or "1min30s", not "10"

keep_alive = "10 sec"
#            ^ `keep_alive` must be a time with its unit (ns, us, ms, s, min, h or d), as in "31s"
#   or "1min30s", not "10 sec"

keep_alive = "10ms"
#            ^ `keep_alive` must be a time from 1 s to 1 d, not "10ms"

keep_alive = "2d"
#            ^ `keep_alive` must be a time from 1 s to 1 d, not "2d"

serial.baud = 9
#             ^ `baud` must be a rate from 300 to 4000000 baud, as in 57600 or "57600baud",
#   or the name of a platform that has it, as "telosb", not 9

serial.baud = "fast"
#             ^ `baud` must be a rate from 300 to 4000000 baud, as in 57600 or "57600baud",
#   or the name of a platform that has it, as "telosb", not "fast"

serial.buffer = 63
#               ^ `buffer` must be a whole number from 64 to 16777216, not 63

serial.octet_error = -0.1
#                    ^ `octet_error` must be a ratio from 0 to 1, or from "0%" to "100%", not -0.1

serial.latency = "11s"
#                ^ `latency` must be a time from 0 ns to 10 s, not "11s"

sink.platform = "mica"
#               ^ `platform` must be "micaz", "iris" or "telosb", not "mica"; did you mean "micaz"?

sink.platform = "zebra"
#               ^ `platform` must be "micaz", "iris" or "telosb", not "zebra"

sink.platform = 1
#               ^ `platform` must be "micaz", "iris" or "telosb", not 1

sink.position_m = [1]
#                 ^ `position_m` must be [x, y] or [x, y, z] in metres, each at most 1000000, not an
#   array of 1

sink.position_m = [1, "2m"]
#                     ^ `position_m` must be [x, y] or [x, y, z] in metres, each at most 1000000,
#   not "2m"

sink.position_m = [1, inf]
#                     ^ `position_m` must be [x, y] or [x, y, z] in metres, each at most 1000000,
#   not inf

sink.position_m = [1, 2, 3, 4]
#                 ^ `position_m` must be [x, y] or [x, y, z] in metres, each at most 1000000, not an
#   array of 4

sink.id = 65533
#         ^ `id` must be a whole number from 1 to 65532, not 65533
)");
}

TEST_CASE("what is said about a mote has to be possible", "[config][GEN-06]") {
  check_mistakes(mote_head, R"(
battery = 2000
#         ^ `battery` must be a charge from 0.001 mAh to 1000 Ah with its unit (mAh or Ah), or its
#   energy at 3 V (J or kJ), as in "2000mAh" or "21.6kJ", not 2000

battery = "2V"
#         ^ `battery` must be a charge from 0.001 mAh to 1000 Ah with its unit (mAh or Ah), or its
#   energy at 3 V (J or kJ), as in "2000mAh" or "21.6kJ", not "2V"

name = "a b"
#      ^ `name` must be a name of 1 to 32 letters, digits, - and _, not "a b": give `name = "a-b"`
#   and `label = "a b"`

name = "Küche"
#      ^ `name` must be a name of 1 to 32 letters, digits, - and _, not "Küche": `label` takes any
#   text

name = ""
#      ^ `name` must be a name of 1 to 32 letters, digits, - and _, not ""

name = "a.b"
#      ^ `name` must be a name of 1 to 32 letters, digits, - and _, not "a.b"

actuators = [{ name = "x", kind = "relay", initial = 1 }]
#                                                    ^ `initial` must be "off" or "on", not 1

actuators = [{ name = "x", kind = "dimmer", initial = 256 }]
#                                                     ^ `initial` must be a whole number from 0 to
#   255, not 256

actuators = [{ name = "x", kind = "dimmer", initial = 255 }]

apps = [{ app = "messenger", to = "k/c-2", text = "" }]
#                                                 ^ `text` must be a text of 1 to 100 octets without
#   control characters, not ""

apps = [{ app = "messenger", to = "k/c-2", text = "a\nb" }]
#                                                 ^ `text` must be a text of 1 to 100 octets without
#   control characters, not "a\nb"

apps = [{ app = "messenger", to = "k/c-2", text = "x", reliable = 1 }]
#                                                                 ^ `reliable` must be true or
#   false, not 1

apps = [{ app = "sampler", transducers = [] }]
#                                        ^ `transducers` must be an array of at least 1, not an
#   empty array

apps = [{ app = "sampler", transducers = "temperature" }]
#                                        ^ `transducers` must be an array in [ ], not "temperature"

apps = [{ app = "sampler", transducers = ["temprature"] }]
#                                         ^ `transducers` must be "temperature", "humidity",
#   "light", "voltage", "presence", "acceleration", "magnetism", "sound" or "signal", not
#   "temprature"; did you mean "temperature"?

apps = [{ app = "sampler", transducers = ["temperature"], channel = 256 }]
#                                                                   ^ `channel` must be a whole
#   number from 0 to 255, not 256

apps = [{ app = "sampler", transducers = ["temperature"], every = "1ms" }]
#                                                                 ^ `every` must be a time from 10
#   ms to 10 d, not "1ms"

apps = [{ app = "sampler", transducers = ["temperature"], every = "1s", jitter = "2s" }]
#                                                                                ^ `jitter` must not
#   be longer than `every`, which is 1 s

transducers.light = { model = "points", points = [] }
#                                                ^ `points` must be points of a time and a number,
#   as in [["0s", 21.0], ["5min", 27]], not an empty array

transducers.light = { model = "points", points = [["0s", 1], ["0s", 2]] }
#                                                             ^ the times of `points` must increase
#   from one to the next

transducers.light = { model = "points", points = [["0s"]] }
#                                                 ^ `points` must be points of a time and a number,
#   as in [["0s", 21.0], ["5min", 27]], not an array of 1

transducers.light = { model = "points", points = [[0, 1]] }
#                                                  ^ `points` must be a time with its unit (ns, us,
#   ms, s, min, h or d), as in "31s" or "1min30s", not 0

transducers.light = { model = "points", points = [["0s", "1"]] }
#                                                        ^ `points` must be a number, not "1"

transducers.light = { model = "constant", value = inf }
#                                                 ^ `value` must be a number, not inf

transducers.light = { model = "constant", value = 1, noise = -1 }
#                                                            ^ `noise` must be a number from 0, not
#   -1

transducers.light = { model = "constant", value = 1, resolution = 0 }
#                                                                 ^ `resolution` must be a number
#   from 1e-09 to 1000000000, not 0

transducers.light = { model = "constant", value = 60000 }
#                   ^ a value of 60000 is more than 32767 counts of `resolution` 0.1, which a
#   message cannot carry: use a coarser one

transducers.light = { model = "sine", mean = -40000, amplitude = -1, resolution = 1 }
#                                                                                 ^ a value of 40001
#   is more than 32767 counts of `resolution` 1, which a message cannot carry: use a coarser one

transducers.light = { model = "points", points = [["0s", 1], ["1s", 32768]], resolution = 1 }
#                                                                                         ^ a value
#   of 32768 is more than 32767 counts of `resolution` 1, which a message cannot carry: use a
#   coarser one
)");
}

TEST_CASE("types, prefix and properties of a proxy have to be possible",
          "[config][GEN-06][PXY-11][PXY-13]") {
  check_mistakes(proxy_head, R"(
prefix = "{room}.x"
#        ^ `prefix` must be 1 to 5 parts between dots, at most 48 characters, each of letters,
#   digits, -, _, {island}, {channel}, {id} and {name}, not "{room}.x"

prefix = "a..b"
#        ^ `prefix` must be 1 to 5 parts between dots, at most 48 characters, each of letters,
#   digits, -, _, {island}, {channel}, {id} and {name}, not "a..b"

prefix = ""
#        ^ `prefix` must be 1 to 5 parts between dots, at most 48 characters, each of letters,
#   digits, -, _, {island}, {channel}, {id} and {name}, not ""

prefix = "a.b.c.d.e.f"
#        ^ `prefix` must be 1 to 5 parts between dots, at most 48 characters, each of letters,
#   digits, -, _, {island}, {channel}, {id} and {name}, not "a.b.c.d.e.f"

prefix = "a.b.c.d.{id}"

properties = "x"
#            ^ `properties` must be a table, as in { key = "x" }, not "x"

properties = { x = 1 }
#                  ^ `x` must be a text of 1 to 200 octets without control characters, not 1

properties = { "x y" = "1" }
#              ^ a property's name must have 1 to 32 letters, digits, - and _, unlike "x y"

properties = { status = "1" }
#              ^ `status` is a tuple that proxies set by themselves
)");
}

TEST_CASE("a field fits the message it is read from", "[config][GEN-06]") {
  check_mistakes(field_head, R"(
encoding = "i24"
#          ^ `encoding` must be "u8", "i8", "u16", "i16", "u32", "i32" or "stamp", not "i24"

decimals = 7
#          ^ `decimals` must be a whole number from 0 to 6, not 7

offset = 99
#        ^ the field ends beyond the 100 octets that a message can carry

offset = 98

scale = "0.1"
#       ^ `scale` must be a number, not "0.1"

words = { a = "x" }
#         ^ a count of `words` must be a whole number from -32768 to 32767, not "a"

words = { 32768 = "x" }
#         ^ a count of `words` must be a whole number from -32768 to 32767, not "32768"

words = { -32768 = "x" }

words = { 01 = "x" }
#         ^ a count of `words` must be a whole number from -32768 to 32767, not "01"

encoding = "u8"
words = { -1 = "x" }
#         ^ a count of `words` must be a whole number from 0 to 255, not "-1"
)");
}

TEST_CASE("the words of an input become octets", "[config][GEN-06]") {
  check_mistakes(input_head, R"(
words = {}
#       ^ `words` must have at least one word

words = { on = "0" }
#              ^ `on` must be 1 to 100 octets in hexadecimal, as in "01" or "00ff", not "0"

words = { on = "" }
#              ^ `on` must be 1 to 100 octets in hexadecimal, as in "01" or "00ff", not ""

words = { "o n" = "01" }
#         ^ a word must have 1 to 32 letters, digits, - and _, unlike "o n"
)");
}

TEST_CASE("text is taken up to its limit and quoted in part", "[config][GEN-06]") {
  const auto name_of = [](std::size_t length) {
    return "name = \"" + std::string(length, 'n') + "\"\n";
  };
  CHECK(problem_after(mote_head, name_of(32)) == "none");
  CHECK(problem_after(mote_head, name_of(33)) ==
        "19:8: `name` must be a name of 1 to 32 letters, digits, - and _, not \"" +
            std::string(33, 'n') + "\"");
  const auto text_of = [](const std::string& text) {
    return "apps = [{ app = \"messenger\", to = \"k/c-2\", text = \"" + text + "\" }]\n";
  };
  CHECK(problem_after(mote_head, text_of(std::string(100, 't'))) == "none");
  CHECK(problem_after(mote_head, text_of(std::string(101, 't'))) ==
        "19:51: `text` must be a text of 1 to 100 octets without control characters, not \"" +
            std::string(60, 't') + "...\"");
  std::string umlauts = "x";
  for (int i = 0; i < 50; ++i)
    umlauts += "\u00fc"; // two octets each: no cut inside of one
  const auto shown = problem_after(mote_head, text_of(umlauts));
  CHECK(shown.substr(shown.find(", not ")) == ", not \"" + umlauts.substr(0, 59) + "...\"");
  const auto network_of = [](std::size_t length) {
    return "[ecology]\nname = \"t\"\nnetwork = \"" + std::string(length, 'n') +
           "\"\n[[peer]]\nname = \"pc\"\nid = 300\n";
  };
  CHECK(problem_in(network_of(62)) == "none");
  CHECK(problem_in(network_of(63)).starts_with("3:11: `network` must be a text of 1 to 62 octets"));
}
