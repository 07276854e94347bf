#include <string>

#include "config_sample.hpp"
#include "support/catch.hpp"

using namespace rubicon::test;

TEST_CASE("a value of the wrong kind or range says what would be right", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[radio]\nqueue = \"8\"\n", "7:9: `queue` must be a whole number from 1 to 1024, not \"8\""},
      {"[radio]\nqueue = 8.5\n", "7:9: `queue` must be a whole number from 1 to 1024, not 8.5"},
      {"[radio]\nqueue = true\n", "7:9: `queue` must be a whole number from 1 to 1024, not true"},
      {"[radio]\nqueue = []\n",
       "7:9: `queue` must be a whole number from 1 to 1024, not an empty array"},
      {"[radio]\nqueue = {}\n", "7:9: `queue` must be a whole number from 1 to 1024, not a table"},
      {"[radio]\nqueue = 2026-01-01\n",
       "7:9: `queue` must be a whole number from 1 to 1024, not a date or time"},
      {"[radio]\nqueue = 0\n", "7:9: `queue` must be a whole number from 1 to 1024, not 0"},
      {"[radio]\nqueue = 1024\n", "none"},
      {"[radio]\nqueue = 1025\n", "7:9: `queue` must be a whole number from 1 to 1024, not 1025"},
      {"[radio]\nretries = -1\n", "7:11: `retries` must be a whole number from 0 to 7, not -1"},
      {"[radio]\nretries = 8\n", "7:11: `retries` must be a whole number from 0 to 7, not 8"},
      {"[radio]\nrange = 25\n", "7:9: `range` must be a length from 0.1 m to 100000 m with its "
                                "unit (cm, m or km), as in \"25m\", not 25"},
      {"[radio]\nrange = \"25\"\n", "7:9: `range` must be a length from 0.1 m to 100000 m with its "
                                    "unit (cm, m or km), as in \"25m\", not \"25\""},
      {"[radio]\nrange = \"25 feet\"\n",
       "7:9: `range` must be a length from 0.1 m to 100000 m with its unit (cm, m or km), as in "
       "\"25m\", not \"25 feet\""},
      {"[radio]\nrange = \"0m\"\n", "7:9: `range` must be a length from 0.1 m to 100000 m with its "
                                    "unit (cm, m or km), as in \"25m\", not \"0m\""},
      {"[radio]\nloss = 2\n",
       "7:8: `loss` must be a ratio from 0 to 1, or from \"0%\" to \"100%\", not 2"},
      {"[radio]\nloss = \"101%\"\n",
       "7:8: `loss` must be a ratio from 0 to 1, or from \"0%\" to \"100%\", not \"101%\""},
      {"[radio]\nloss = \"2\"\n",
       "7:8: `loss` must be a ratio from 0 to 1, or from \"0%\" to \"100%\", not \"2\""},
      {"[radio]\nloss = nan\n",
       "7:8: `loss` must be a ratio from 0 to 1, or from \"0%\" to \"100%\", not nan"},
      {"[radio]\nloss = 1\n", "none"},
      {"[[proxy]]\nname = \"p\"\ntypes = []\n",
       "8:9: `types` must be an array of at least 1, not an empty array"},
      {"[[proxy]]\nname = \"p\"\ntypes = 7\n", "8:9: `types` must be an array in [ ], not 7"},
      {"[[proxy]]\nname = \"p\"\ntypes = [\"9..8\"]\n",
       "8:10: `types` must be types from 1 to 4294967295, as in 101, \"100..119\" or "
       "\"0x0100/0xff00\" (a value and the mask under which types have it), not \"9..8\""},
      {"[[proxy]]\nname = \"p\"\ntypes = [\"a..b\"]\n",
       "8:10: `types` must be types from 1 to 4294967295, as in 101, \"100..119\" or "
       "\"0x0100/0xff00\" (a value and the mask under which types have it), not \"a..b\""},
      {"[[proxy]]\nname = \"p\"\ntypes = [0]\n",
       "8:10: `types` must be types from 1 to 4294967295, as in 101, \"100..119\" or "
       "\"0x0100/0xff00\" (a value and the mask under which types have it), not 0"},
      {"[[proxy]]\nname = \"p\"\ntypes = [\"5\"]\n",
       "8:10: `types` must be types from 1 to 4294967295, as in 101, \"100..119\" or "
       "\"0x0100/0xff00\" (a value and the mask under which types have it), not \"5\""},
      {"[[proxy]]\nname = \"p\"\ntypes = [\"1..4294967296\"]\n",
       "8:10: `types` must be types from 1 to 4294967295, as in 101, \"100..119\" or "
       "\"0x0100/0xff00\" (a value and the mask under which types have it), not "
       "\"1..4294967296\""},
      {"apps = [{ app = \"collector\", keys = [\"a b\"] }]\n",
       "6:38: `keys` must be a tuple key of 1 to 7 parts between dots, each of letters, digits, - "
       "and _ or a single *, not \"a b\""},
      {"apps = [{ app = \"collector\", keys = [\"a.*.b\", \"a.b*\"] }]\n",
       "6:47: `keys` must be a tuple key of 1 to 7 parts between dots, each of letters, digits, - "
       "and _ or a single *, not \"a.b*\""},
      {"apps = [{ app = \"collector\", keys = [\"a.b.c.d.e.f.g\"] }]\n", "none"},
      {"apps = [{ app = \"collector\", keys = [\"a.b.c.d.e.f.g.h\"] }]\n",
       "6:38: `keys` must be a tuple key of 1 to 7 parts between dots, each of letters, digits, - "
       "and _ or a single *, not \"a.b.c.d.e.f.g.h\""},
      {"apps = [{ app = \"rules\", rules = [] }]\n",
       "6:34: `rules` must be an array of at least 1, not an empty array"},
      {"[[peer.apps]]\napp = \"rules\"\n[[peer.apps.rules]]\nwhen = \"*.t\"\nabove = 1\nwrite = "
       "\"f\"\nthen = \"on\"\n",
       "9:8: `when` must be a tuple key of 1 to 7 parts between dots, each of letters, digits, - "
       "and _, not \"*.t\""},
      {"[[peer.apps]]\napp = \"rules\"\n[[peer.apps.rules]]\nwhen = \"t\"\nwrite = \"f\"\nthen = "
       "\"on\"\n",
       "8:1: a rule needs either `above`, `below` or both, or `equals`"},
      {"[[peer.apps]]\napp = \"rules\"\n[[peer.apps.rules]]\nwhen = \"t\"\nabove = 1\nwrite = "
       "\"f\"\n",
       "8:1: a rule needs `then`, `otherwise` or both"},
      {"[[peer.apps]]\napp = \"rules\"\n[[peer.apps.rules]]\nwhen = \"t\"\nabove = 1\nbelow = "
       "2\nwrite = \"f\"\nthen = \"on\"\n",
       "11:9: `below` must not be more than `above`, which is 1"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(head, x.toml) == x.problem);
}

TEST_CASE("a value of [ecology] that no run can have is refused", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[ecology]\nname = \"t\"\nseed = -1\nmode = \"fast\"\nduration = \"0s\"\n[[peer]]\nname = "
       "\"pc\"\nid = 300\n",
       "3:8: `seed` must be a whole number from 0 to 9223372036854775807, not -1\n4:8: `mode` must "
       "be \"virtual\" or \"wall\", not \"fast\"\n5:12: `duration` must be a time from 1 ms to "
       "3650 d, not \"0s\""},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after("", x.toml) == x.problem);
}

TEST_CASE("quantities of an island need their units and ranges", "[config][GEN-06][ADR-09]") {
  const auto x = GENERATE(values<row>({
      {"keep_alive = 10\n", "15:14: `keep_alive` must be a time with its unit (ns, us, ms, s, min, "
                            "h or d), as in \"31s\" or \"1min30s\", not 10"},
      {"keep_alive = \"10\"\n", "15:14: `keep_alive` must be a time with its unit (ns, us, ms, s, "
                                "min, h or d), as in \"31s\" or \"1min30s\", not \"10\""},
      {"keep_alive = \"10 sec\"\n",
       "15:14: `keep_alive` must be a time with its unit (ns, us, ms, s, min, h or d), as in "
       "\"31s\" or \"1min30s\", not \"10 sec\""},
      {"keep_alive = \"10ms\"\n",
       "15:14: `keep_alive` must be a time from 1 s to 1 d, not \"10ms\""},
      {"keep_alive = \"2d\"\n", "15:14: `keep_alive` must be a time from 1 s to 1 d, not \"2d\""},
      {"serial.baud = 9\n", "15:15: `baud` must be a rate from 300 to 4000000 baud, as in 57600 or "
                            "\"57600baud\", not 9"},
      {"serial.baud = \"fast\"\n", "15:15: `baud` must be a rate from 300 to 4000000 baud, as in "
                                   "57600 or \"57600baud\", not \"fast\""},
      {"serial.buffer = 63\n",
       "15:17: `buffer` must be a whole number from 64 to 16777216, not 63"},
      {"serial.octet_error = -0.1\n",
       "15:22: `octet_error` must be a ratio from 0 to 1, or from \"0%\" to \"100%\", not -0.1"},
      {"serial.latency = \"11s\"\n",
       "15:18: `latency` must be a time from 0 ns to 10 s, not \"11s\""},
      {"sink.platform = \"mica\"\n", "15:17: `platform` must be \"micaz\", \"iris\" or \"telosb\", "
                                     "not \"mica\"; did you mean \"micaz\"?"},
      {"sink.platform = \"zebra\"\n",
       "15:17: `platform` must be \"micaz\", \"iris\" or \"telosb\", not \"zebra\""},
      {"sink.platform = 1\n", "15:17: `platform` must be \"micaz\", \"iris\" or \"telosb\", not 1"},
      {"sink.position_m = [1]\n", "15:19: `position_m` must be [x, y] or [x, y, z] in metres, each "
                                  "at most 1000000, not an array of 1"},
      {"sink.position_m = [1, \"2m\"]\n", "15:23: `position_m` must be [x, y] or [x, y, z] in "
                                          "metres, each at most 1000000, not \"2m\""},
      {"sink.position_m = [1, inf]\n",
       "15:23: `position_m` must be [x, y] or [x, y, z] in metres, each at most 1000000, not inf"},
      {"sink.position_m = [1, 2, 3, 4]\n", "15:19: `position_m` must be [x, y] or [x, y, z] in "
                                           "metres, each at most 1000000, not an array of 4"},
      {"sink.id = 65533\n", "15:11: `id` must be a whole number from 1 to 65532, not 65533"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}

TEST_CASE("what is said about a mote has to be possible", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"battery = 2000\n", "19:11: `battery` must be a charge from 0.001 mAh to 1000 Ah with its "
                           "unit (mAh or Ah), as in \"2000mAh\", not 2000"},
      {"battery = \"2V\"\n", "19:11: `battery` must be a charge from 0.001 mAh to 1000 Ah with its "
                             "unit (mAh or Ah), as in \"2000mAh\", not \"2V\""},
      {"name = \"a b\"\n",
       "19:8: `name` must be a name of 1 to 32 letters, digits, - and _, not \"a b\""},
      {"name = \"\"\n",
       "19:8: `name` must be a name of 1 to 32 letters, digits, - and _, not \"\""},
      {"name = \"a.b\"\n",
       "19:8: `name` must be a name of 1 to 32 letters, digits, - and _, not \"a.b\""},
      {"actuators = [{ name = \"x\", kind = \"relay\", initial = 1 }]\n",
       "19:54: `initial` must be \"off\" or \"on\", not 1"},
      {"actuators = [{ name = \"x\", kind = \"dimmer\", initial = 256 }]\n",
       "19:55: `initial` must be a whole number from 0 to 255, not 256"},
      {"actuators = [{ name = \"x\", kind = \"dimmer\", initial = 255 }]\n", "none"},
      {"apps = [{ app = \"messenger\", to = \"k/c-2\", text = \"\" }]\n",
       "19:51: `text` must be a text of 1 to 100 octets without control characters, not \"\""},
      {"apps = [{ app = \"messenger\", to = \"k/c-2\", text = \"a\\nb\" }]\n",
       "19:51: `text` must be a text of 1 to 100 octets without control characters, not \"a\\nb\""},
      {"apps = [{ app = \"messenger\", to = \"k/c-2\", text = \"x\", reliable = 1 }]\n",
       "19:67: `reliable` must be true or false, not 1"},
      {"apps = [{ app = \"sampler\", transducers = [] }]\n",
       "19:42: `transducers` must be an array of at least 1, not an empty array"},
      {"apps = [{ app = \"sampler\", transducers = \"temperature\" }]\n",
       "19:42: `transducers` must be an array in [ ], not \"temperature\""},
      {"apps = [{ app = \"sampler\", transducers = [\"temprature\"] }]\n",
       "19:43: `transducers` must be \"temperature\", \"humidity\", \"light\", \"voltage\", "
       "\"presence\", \"acceleration\", \"magnetism\", \"sound\" or \"signal\", not "
       "\"temprature\"; "
       "did you mean \"temperature\"?"},
      {"apps = [{ app = \"sampler\", transducers = [\"temperature\"], channel = 256 }]\n",
       "19:69: `channel` must be a whole number from 0 to 255, not 256"},
      {"apps = [{ app = \"sampler\", transducers = [\"temperature\"], every = \"1ms\" }]\n",
       "19:67: `every` must be a time from 10 ms to 10 d, not \"1ms\""},
      {"apps = [{ app = \"sampler\", transducers = [\"temperature\"], every = \"1s\", jitter = "
       "\"2s\" }]\n",
       "19:82: `jitter` must not be longer than `every`, which is 1 s"},
      {"transducers.light = { model = \"points\", points = [] }\n",
       "19:50: `points` must be points of a time and a number, as in [[\"0s\", 21.0], [\"5min\", "
       "27]], not an empty array"},
      {"transducers.light = { model = \"points\", points = [[\"0s\", 1], [\"0s\", 2]] }\n",
       "19:63: the times of `points` must increase from one to the next"},
      {"transducers.light = { model = \"points\", points = [[\"0s\"]] }\n",
       "19:51: `points` must be points of a time and a number, as in [[\"0s\", 21.0], [\"5min\", "
       "27]], not an array of 1"},
      {"transducers.light = { model = \"points\", points = [[0, 1]] }\n",
       "19:52: `points` must be a time with its unit (ns, us, ms, s, min, h or d), as in \"31s\" "
       "or \"1min30s\", not 0"},
      {"transducers.light = { model = \"points\", points = [[\"0s\", \"1\"]] }\n",
       "19:58: `points` must be a number, not \"1\""},
      {"transducers.light = { model = \"constant\", value = inf }\n",
       "19:51: `value` must be a number, not inf"},
      {"transducers.light = { model = \"constant\", value = 1, noise = -1 }\n",
       "19:62: `noise` must be a number from 0, not -1"},
      {"transducers.light = { model = \"constant\", value = 1, resolution = 0 }\n",
       "19:67: `resolution` must be a number from 1e-09 to 1000000000, not 0"},
      {"transducers.light = { model = \"constant\", value = 60000 }\n",
       "19:21: a value of 60000 is more than 32767 counts of `resolution` 0.1, which a message "
       "cannot carry: use a coarser one"},
      {"transducers.light = { model = \"sine\", mean = -40000, amplitude = -1, resolution = 1 }\n",
       "19:83: a value of 40001 is more than 32767 counts of `resolution` 1, which a message "
       "cannot carry: use a coarser one"},
      {"transducers.light = { model = \"points\", points = [[\"0s\", 1], [\"1s\", 32768]], "
       "resolution = 1 }\n",
       "19:91: a value of 32768 is more than 32767 counts of `resolution` 1, which a message "
       "cannot carry: use a coarser one"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(mote_head, x.toml) == x.problem);
}

TEST_CASE("types, prefix and properties of a proxy have to be possible",
          "[config][GEN-06][PXY-11][PXY-13]") {
  const auto x = GENERATE(values<row>({
      {"prefix = \"{room}.x\"\n",
       "9:10: `prefix` must be 1 to 5 parts between dots, at most 48 characters, each of letters, "
       "digits, -, _, {island}, {channel}, {id} and {name}, not \"{room}.x\""},
      {"prefix = \"a..b\"\n",
       "9:10: `prefix` must be 1 to 5 parts between dots, at most 48 characters, each of letters, "
       "digits, -, _, {island}, {channel}, {id} and {name}, not \"a..b\""},
      {"prefix = \"\"\n",
       "9:10: `prefix` must be 1 to 5 parts between dots, at most 48 characters, each of letters, "
       "digits, -, _, {island}, {channel}, {id} and {name}, not \"\""},
      {"prefix = \"a.b.c.d.e.f\"\n",
       "9:10: `prefix` must be 1 to 5 parts between dots, at most 48 characters, each of letters, "
       "digits, -, _, {island}, {channel}, {id} and {name}, not \"a.b.c.d.e.f\""},
      {"prefix = \"a.b.c.d.{id}\"\n", "none"},
      {"properties = \"x\"\n",
       "9:14: `properties` must be a table, as in { key = \"value\" }, not \"x\""},
      {"properties = { x = 1 }\n",
       "9:20: `x` must be a text of 1 to 200 octets without control characters, not 1"},
      {"properties = { \"x y\" = \"1\" }\n",
       "9:16: a property's name must have 1 to 32 letters, digits, - and _, unlike \"x y\""},
      {"properties = { status = \"1\" }\n",
       "9:16: `status` is a tuple that proxies set by themselves"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(proxy_head, x.toml) == x.problem);
}

TEST_CASE("a field fits the message it is read from", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"encoding = \"i24\"\n", "12:12: `encoding` must be \"u8\", \"i8\", \"u16\", \"i16\", "
                               "\"u32\" or \"i32\", not \"i24\""},
      {"decimals = 7\n", "12:12: `decimals` must be a whole number from 0 to 6, not 7"},
      {"offset = 99\n", "12:10: the field ends beyond the 100 octets that a message can carry"},
      {"offset = 98\n", "none"},
      {"scale = \"0.1\"\n", "12:9: `scale` must be a number, not \"0.1\""},
      {"words = { a = \"x\" }\n",
       "12:11: a count of `words` must be a whole number from -32768 to 32767, not \"a\""},
      {"words = { 32768 = \"x\" }\n",
       "12:11: a count of `words` must be a whole number from -32768 to 32767, not \"32768\""},
      {"words = { -32768 = \"x\" }\n", "none"},
      {"words = { 01 = \"x\" }\n",
       "12:11: a count of `words` must be a whole number from -32768 to 32767, not \"01\""},
      {"encoding = \"u8\"\nwords = { -1 = \"x\" }\n",
       "13:11: a count of `words` must be a whole number from 0 to 255, not \"-1\""},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(field_head, x.toml) == x.problem);
}

TEST_CASE("the words of an input become octets", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"words = {}\n", "12:9: `words` must have at least one word"},
      {"words = { on = \"0\" }\n",
       "12:16: `on` must be 1 to 100 octets in hexadecimal, as in \"01\" or \"00ff\", not \"0\""},
      {"words = { on = \"\" }\n",
       "12:16: `on` must be 1 to 100 octets in hexadecimal, as in \"01\" or \"00ff\", not \"\""},
      {"words = { \"o n\" = \"01\" }\n",
       "12:11: a word must have 1 to 32 letters, digits, - and _, unlike \"o n\""},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(input_head, x.toml) == x.problem);
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
