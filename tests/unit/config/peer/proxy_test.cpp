#include <string>
#include <variant>

#include "proxy/classes/program.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// A class of fields `t` and `h` on channel 1 and `d` on channel 2; what follows stands from
/// line 24.
const std::string class_head = proxy_head + R"(properties = { room = "larder" }
[[proxy.field]]
name = "t"
channel = 1
unit = "C"
[[proxy.field]]
name = "h"
channel = 1
offset = 2
[[proxy.field]]
name = "d"
channel = 2
words = { 0 = "closed" }


)";

} // namespace

TEST_CASE("templates, qualities and masks of a class arrive", "[config][PXY-04][PXY-11][PXY-12]") {
  const auto all = good(class_head + R"(
[[proxy.tuple]]
key = "{room}.{name}.text"
value = "{t} {t.unit} {{{island}}}"
[[proxy.tuple]]
key = "climate"
json = ["h", "t"]
[proxy.qos]
period = "2s"
retry_for = "1min"
answer_timeout = "5s"
stale_after = "10s"
inactive_after = "20s"
retire_after = "1h"
[[proxy]]
name = "masked"
types = ["0x0100/0xff00", "512/65280"]
indirect = true
)");
  const auto& x = all.proxies.at(0);
  REQUIRE(x.tuples.size() == 2);
  CHECK(x.tuples[0].key == "{room}.{name}.text");
  CHECK(x.tuples[0].text == "{t} {t.unit} {{{island}}}");
  CHECK(x.tuples[1].json == std::vector<std::string>{"h", "t"});
  CHECK(x.settings.period == 2s);
  CHECK(x.settings.retry_for == 1min);
  CHECK(x.settings.answer_timeout == 5s);
  CHECK(x.settings.stale_after == 10s);
  CHECK(x.settings.inactive_after == duration(20s));
  CHECK(x.settings.retire_after == duration(1h));
  CHECK(!x.indirect);
  const auto& masked = all.proxies.at(1);
  CHECK(masked.indirect);
  CHECK(masked.types.at(0).first == 0x100);
  CHECK(masked.types.at(0).mask == 0xff00);
  CHECK(masked.types.at(1).first == 512);
  CHECK(masked.types.at(1).mask == 65280);
}

TEST_CASE("a template has names that its class has", "[config][GEN-06][PXY-04]") {
  const auto x = GENERATE(values<row>({
      {"[[proxy.tuple]]\nkey = \"a\"\n",
       "24:1: a tuple needs either `value`, a text, or `json`, names of fields"},
      {"[[proxy.tuple]]\nkey = \"a\"\nvalue = \"x\"\njson = [\"t\"]\n",
       "24:1: a tuple needs either `value`, a text, or `json`, names of fields"},
      {"[[proxy.tuple]]\nkey = \"{rom}.a\"\nvalue = \"x\"\n",
       "25:7: a key has no {rom}: did you mean `room`?"},
      {"[[proxy.tuple]]\nkey = \"{t}.a\"\nvalue = \"x\"\n",
       "25:7: a key has no {t}: there is island, id, name, class, room"},
      {"[[proxy.tuple]]\nkey = \"a..b\"\nvalue = \"x\"\n",
       "25:7: `key` must be 1 to 7 parts between dots, at most 100 characters, each of letters, "
       "digits, -, _ and names in braces, as in \"{room}.climate\", not \"a..b\""},
      {"[[proxy.tuple]]\nkey = \"a.*\"\nvalue = \"x\"\n",
       "25:7: `key` must be 1 to 7 parts between dots, at most 100 characters, each of letters, "
       "digits, -, _ and names in braces, as in \"{room}.climate\", not \"a.*\""},
      {"[[proxy.tuple]]\nkey = \"a\"\nvalue = \"{t\"\n",
       "26:9: `value` must be text in which { and } enclose a name, as in \"{temperature} C\"; {{ "
       "and }} are braces, not \"{t\""},
      {"[[proxy.tuple]]\nkey = \"a\"\nvalue = \"{hh}\"\n",
       "26:9: the proxy has no field `hh`: did you mean `h`?"},
      {"[[proxy.tuple]]\nkey = \"a\"\nvalue = \"{t} {d}\"\n",
       "26:9: `d` is of channel 2, not of channel 1: the fields of a tuple come in one message"},
      {"[[proxy.tuple]]\nkey = \"a\"\njson = [\"zz\"]\n",
       "26:8: the proxy has no field `zz`: there is t, h, d"},
      {"[[proxy.tuple]]\nkey = \"a\"\njson = [\"t\"]\n[[proxy.tuple]]\nkey = \"A\"\nvalue = "
       "\"x\"\n",
       "28:7: the key `A` is already taken (line 25, column 7)"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(class_head, x.toml) == x.problem);
}

TEST_CASE("masks of types have to be possible, and to leave no doubt", "[config][PXY-11]") {
  CHECK(problem_after(head, "[[proxy]]\nname = \"p\"\ntypes = [\"0x0101/0xff00\"]\n")
            .starts_with("8:10: `types` must be types from 1"));
  CHECK(problem_after(head, "[[proxy]]\nname = \"p\"\ntypes = [\"0x0100/0xff00\"]\n[[proxy]]\nname "
                            "= \"q\"\ntypes = [\"0x0010/0x00ff\", \"0x0100/0xf0\"]\n")
            .starts_with("11:"));
  check_mistakes(head, R"(
[[proxy]]
name = "p"
types = ["0x0100/0xff00"]
[[proxy]]
name = "q"
types = ["0x0010/0x00ff"]
#        ^ proxies `p` and `q` both claim type 272, with equally wide ranges (line 8, column 10)
)");
}

TEST_CASE("a program is one that is known, with settings that it takes",
          "[config][GEN-06][PXY-04]") {
  const auto x = GENERATE(values<row>({
      {"program = \"occupancy\"\nsettings = { t = 1 }\n", "none"},
      {"program = \"ocupancy\"\n",
       "9:11: no program is named `ocupancy`: did you mean `occupancy`?"},
      {"program = \"comfort\"\n", "9:11: no program is named `comfort`: there is occupancy"},
      {"program = \"occupancy\"\n", "9:11: `occupancy` needs a setting with the name of a field"},
      {"program = \"occupancy\"\nsettings = { t = 1, hold_s = -1 }\n",
       "10:21: `hold_s` must be more than 0 and at most 86400"},
      {"program = \"occupancy\"\nsettings = { u = 1 }\n",
       "10:14: `u` is neither \"hold_s\" nor a field of the proxy"},
      {"settings = { t = 1 }\n", "9:12: `settings` are those of a `program`"},
      {"program = \"occupancy\"\nsettings = { t = 1 }\nproperties = { occupied = \"x\" }\n",
       "11:16: name `occupied` is already taken (line 9, column 11)"},
  }));
  CAPTURE(x.toml);
  const auto found =
      problem_in(proxy_head + x.toml + "[[proxy.field]]\nname = \"t\"\nchannel = 1\n");
  if (std::string(x.toml).find("properties") == std::string::npos)
    CHECK(found == x.problem);
  else
    CHECK(found.find("`occupied` is already taken") != std::string::npos);
}

TEST_CASE("what only motes have is refused with ids", "[config][GEN-06]") {
  const auto head_of_ids = std::string(head) +
                           "apps = [{ app = \"proxy_manager\", islands = [], objects = true }]\n"
                           "[[proxy]]\nname = \"p\"\nids = [\"rfid/\"]\n";
  for (const auto* key :
       {"indirect = true\n", "program = \"occupancy\"\nsettings = {}\n", "qos = {}\n"}) {
    CAPTURE(key);
    CHECK(problem_after(head_of_ids, key)
              .find("only for motes, and the proxy has `ids` of tagged objects") !=
          std::string::npos);
  }
}

TEST_CASE("a mean is computed where the file says", "[config][PXY-17]") {
  const auto text = [](const std::string& field) {
    return mote_head + R"(apps = [{ app = "sampler", transducers = ["temperature", "signal"] }]
[[proxy]]
name = "p"
types = [7]
[[proxy.field]]
name = "f"
channel = 1
)" + field;
  };
  const auto means = [&](const std::string& field) {
    const auto all = good(text(field));
    return std::get<sampler_app>(all.islands.at(0).motes.at(0).apps.at(0)).mean_of;
  };
  CHECK(means("mean_of = 4\n").empty());
  CHECK(means("mean_of = 4\ncomputed_by = \"proxy\"\n").empty());
  CHECK(means("mean_of = 4\ncomputed_by = \"mote\"\n") == std::vector<std::size_t>{4, 1});
  CHECK(means("offset = 2\nmean_of = 16\ncomputed_by = \"mote\"\n") ==
        std::vector<std::size_t>{1, 16});

  const auto x = GENERATE(values<row>({
      {"mean_of = 17\n", "26:11: `mean_of` must be a whole number from 1 to 16, not 17"},
      {"computed_by = \"mote\"\n", "26:15: `computed_by` needs `mean_of`: what is computed"},
      {"computed_by = \"moat\"\nmean_of = 2\n",
       "26:15: `computed_by` must be \"proxy\" or \"mote\", not \"moat\""},
      {"mean_of = 2\nwords = { 0 = \"a\" }\n", "26:11: words have no mean"},
      {"mean_of = 2\ncomputed_by = \"mote\"\noffset = 1\n",
       "27:15: mote `k/c-2` has no sampler that sends a count there that it could average"},
      {"mean_of = 2\ncomputed_by = \"mote\"\noffset = 4\n",
       "27:15: mote `k/c-2` has no sampler that sends a count there that it could average"},
      {"mean_of = 2\ncomputed_by = \"mote\"\nencoding = \"u8\"\n",
       "27:15: mote `k/c-2` has no sampler that sends a count there that it could average"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_in(text(x.toml)) == x.problem);
}

TEST_CASE("a field takes offset, scale and unit from its transducer", "[config][PXY-05]") {
  const auto motes = std::string(island_head) + R"([mote_type.b]
type = 8
transducers.temperature = { model = "constant", value = 20, resolution = 0.5 }
transducers.light = { model = "constant", value = 20, resolution = 2 }
apps = [{ app = "sampler", transducers = ["light", "temperature", "signal"] }]
[[island.mote]]
id = 2
type = "b"
position_m = [1, 2]
[[island.mote]]
id = 3
type = "b"
position_m = [2, 2]
[[proxy]]
name = "p"
types = [8]
[[proxy.field]]
name = "t"
channel = 1
)";
  const auto field = [&motes](const std::string& keys) {
    return good(motes + keys).proxies.at(0).fields.at(0);
  };
  const auto all = field("transducer = \"temperature\"\n");
  CHECK(all.offset == 2);
  CHECK(all.scale == 0.5);
  CHECK(all.unit == "C");
  const auto signal = field("transducer = \"signal\"\n");
  CHECK(signal.offset == 4);
  CHECK(signal.scale == 1);
  CHECK(signal.unit == "dBm");
  const auto own = field("transducer = \"light\"\nscale = 3\nunit = \"klx\"\noffset = 4\n");
  CHECK(own.offset == 4);
  CHECK(own.scale == 3);
  CHECK(own.unit == "klx");
  check_mistakes(motes, R"(
transducer = "sound"
#            ^ mote `k/b-2` has no sampler that sends `sound` on channel 1

transducer = "temprature"
#            ^ `transducer` must be "temperature", "humidity", "light", "voltage", "presence",
#   "acceleration", "magnetism", "sound" or "signal", not "temprature"; did you mean "temperature"?

transducer = "light"
encoding = "u8"
#          ^ `encoding` has no effect with `transducer`

transducer = "light"
#            ^ motes `k/b-2` and `k/warm` send `light` with different units or scales: make one
#   class for each, or set `offset` and `scale`
[[island.mote]]
id = 4
name = "warm"
type = "b"
position_m = [2, 2]
transducers.light = { model = "constant", value = 20, resolution = 1 }
)");
  check_mistakes(proxy_head, R"(
[[proxy.field]]
name = "t"
channel = 1
transducer = "light"
#            ^ the file has no mote of this class whose `light` it could be
)");
}

TEST_CASE("a proxy reads a stream that can end at it", "[config][PXY-18]") {
  const auto motes = std::string(island_head) + R"([[island.mote]]
id = 2
name = "a"
type = 8
position_m = [1, 2]
[[island.mote]]
id = 3
name = "b"
type = 9
position_m = [2, 2]
[[proxy]]
name = "p"
types = [8]
)";
  const auto field = good(motes + R"([[proxy.field]]
name = "t"
stream = 7
every = "3s"
)")
                         .proxies.at(0)
                         .fields.at(0);
  REQUIRE(field.stream);
  CHECK(field.stream->number == 7);
  CHECK(field.stream->every == 3s);
  check_mistakes(motes, R"(
[[proxy.field]]
name = "t"
every = "3s"
#       ^ `every` needs a `stream`
channel = 1

[[proxy.field]]
name = "t"
stream = 7
channel = 1
#         ^ `channel` has no effect with `stream`: it applies to messages

[[proxy.field]]
name = "t"
stream = 7
[[proxy.field]]
name = "u"
stream = 7
#        ^ the fields of a stream need the same `every`
every = "2s"

[[proxy.field]]
name = "t"
stream = 7
[[proxy]]
name = "q"
types = [9]
[[proxy.field]]
name = "t"
stream = 7
#        ^ stream 7 is read by proxies of `p`

[[proxy.field]]
name = "t"
stream = 7
[[proxy]]
name = "q"
types = [10, 9]
[[island.mote]]
id = 4
name = "c"
type = 9
position_m = [2, 2]
[[proxy.field]]
name = "t"
stream = 8
#        ^ 2 motes are of this class, but stream 8 can be read by the proxy of one: a class of its own

[[proxy.field]]
name = "t"
stream = 7
#        ^ stream 7 is read by a program of `house`, where the proxies are
[[peer]]
id = 31
name = "house"
apps = [{ app = "proxy_manager" }, { app = "stream_reader", stream = 7 }]
)");
}

TEST_CASE("what is known of single motes arrives", "[config][PXY-05][PXY-06]") {
  const auto of_motes = mote_head + "[[proxy]]\nname = \"p\"\ntypes = [7]\n";
  const auto all = good(of_motes + R"([[proxy.object]]
mote = "k/c-2"
position_m = [1, 2.5]
properties = { shelf = "upper" }
)");
  const auto& known = all.proxies.at(0).objects.at(0);
  CHECK(known.id == "1/2");
  REQUIRE(known.place);
  CHECK(known.place->y_m == 2.5);
  CHECK(known.properties.at(0).first == "shelf");

  const auto x = GENERATE(values<row>({
      {"[[proxy.object]]\n", "22:1: `mote` is missing in [[proxy.object]]"},
      {"[[proxy.object]]\nmote = \"k/c-3\"\n", "23:8: no mote"},
      {"[[proxy.object]]\nmote = \"k/c-2\"\n[[proxy.object]]\nmote = \"k/c-2\"\n",
       "25:8: mote `1/2` is already taken (line 23, column 8)"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_in(of_motes + x.toml).starts_with(x.problem));
  // A text may name what not all have; a key may not.
  const std::string about =
      "[[proxy.object]]\nmote = \"k/c-2\"\nproperties = { shelf = \"upper\" }\n"
      "[[proxy.tuple]]\n";
  CHECK(problem_in(of_motes + about + "key = \"a\"\nvalue = \"{shelf}\"\n") == "none");
  CHECK(problem_in(of_motes + about + "key = \"{shelf}\"\nvalue = \"a\"\n")
            .starts_with("26:7: a key has no {shelf}"));
}

TEST_CASE("an input takes words, numbers or both", "[config][PXY-12]") {
  const auto all =
      good(input_head + "encoding = \"i16\"\nscale = 0.1\nadd = 5\nmax = 30\nunit = \"C\"\n"
                        "words = { off = \"00\" }\n");
  const auto& x = all.proxies.at(0).inputs.at(0);
  REQUIRE(x.numbers);
  CHECK(x.numbers->min == Approx(-3276.8 + 5));
  CHECK(x.numbers->max == 30);
  CHECK(x.unit == "C");
  CHECK(x.words.size() == 1);
  const auto r = GENERATE(values<row>({
      {"encoding = \"u8\"\n", "none"},
      {"encoding = \"u8\"\nmax = 256\n", "13:7: `max` must be a number from 0 to 255, not 256"},
      {"encoding = \"u8\"\nmin = 7\nmax = 6\n",
       "14:7: `max` must be a number from 7 to 255, not 6"},
      {"encoding = \"u8\"\nscale = 0\n", "13:9: `scale` must not be 0"},
      {"words = { a = \"01\" }\nscale = 2\n",
       "13:9: `scale` applies to numbers, which the input accepts with `encoding` only"},
      {"encoding = \"u9\"\n", "12:12: `encoding` must be \"u8\", \"i8\", \"u16\", \"i16\", \"u32\" "
                              "or \"i32\", not \"u9\"; did "
                              "you mean \"u8\"?"},
  }));
  CAPTURE(r.toml);
  CHECK(problem_after(input_head, r.toml) == r.problem);
}

TEST_CASE("translations arrive", "[config][SVC-09]") {
  const auto all = good(std::string(head) + R"(apps = [{ app = "translate", rules = [
  { from = "*.ad0", to = "{1}.light", value = "x / 2", decimals = 1, unit = "lx", history = 5 },
  { from = "door" , history = 100 } ] }]
)");
  const auto& rules = std::get<translate_app>(all.peers.at(0).apps.at(0)).rules;
  REQUIRE(rules.size() == 2);
  CHECK(rules[0].from == "*.ad0");
  CHECK(rules[0].to == "{1}.light");
  REQUIRE(rules[0].value);
  CHECK((*rules[0].value)(3) == 1.5);
  CHECK(rules[0].decimals == 1);
  CHECK(rules[0].unit == "lx");
  CHECK(rules[0].history == 5);
  CHECK(rules[1].to.empty());
  CHECK(!rules[1].value);
}

TEST_CASE("a translation has to be possible", "[config][GEN-06][SVC-09]") {
  const auto x = GENERATE(values<row>({
      {"to = \"b\"", "6:39: `from` is missing in rules of a translation"},
      {"from = \"a\"", "6:39: a translation needs `to`, `history` or both"},
      {"from = \"a\", to = \"{1}\"",
       "6:58: `to` must be 1 to 7 parts between dots, at most 127 characters, each of letters, "
       "digits, - and _, not \"{1}\""},
      {"from = \"*.*\", to = \"{3}\"",
       "6:60: `to` must be 1 to 7 parts between dots, at most 127 characters, each of letters, "
       "digits, - and _, and {1} to {2}, which the `*` of `from` stand for, not \"{3}\""},
      {"from = \"a\", to = \"b\", value = \"x + y\"",
       "6:71: `value`, at character 5 of \"x + y\": `y` is neither `x` nor a function: there are "
       "abs, floor, ceil, round, sqrt, min and max"},
      {"from = \"a\", to = \"b\", value = 3",
       "6:71: `value` must be an expression in text, as in \"(x - 400) * 0.5\", not 3"},
      {"from = \"a\", to = \"b\", decimals = 2", "6:74: `decimals` need a `value`"},
      {"from = \"a\", history = 3, unit = \"C\"", "6:73: `unit` needs `to`"},
      {"from = \"a\", history = 101",
       "6:63: `history` must be a whole number from 1 to 100, not 101"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(head, "apps = [{ app = \"translate\", rules = [{ " + std::string(x.toml) +
                                " }] }]\n") == x.problem);
}
