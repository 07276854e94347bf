#include <string>

#include "config_sample.hpp"
#include "support/catch.hpp"

using namespace rubicon::test;

TEST_CASE("an ecology needs its table and somebody in it", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[ecology]\nname = \"t\"\n", "1:1: the file has neither an [[island]] nor a [[peer]]"},
      {"[[peer]]\nname = \"pc\"\nid = 300\n", "1:1: the file lacks the table [ecology]"},
      {"ecology = 1\n[[peer]]\nname = \"pc\"\nid = 300\n",
       "1:11: `ecology` must be a table, not 1"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after("", x.toml) == x.problem);
}

TEST_CASE("an unknown, missing or misplaced key is told with its place", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[radio]\nrnage = \"25m\"\n", "7:1: unknown key `rnage` in [radio]: did you mean `range`?"},
      {"[radio]\ncolour = \"blue\"\n",
       "7:1: unknown key `colour` in [radio]: there is loss, queue, retries, receive_slots, "
       "service_time, propagation, range, noise, sensitivity, cca_threshold, ..."},
      {"[radios]\n", "6:2: unknown key `radios` in the file: did you mean `radio`?"},
      {"[colour]\n", "6:2: unknown key `colour` in the file: there is ecology, radio, host, "
                     "mote_type, island, air, peis, peer, proxy, tag, ..."},
      {"nick = \"x\"\n",
       "6:1: unknown key `nick` in [[peer]]: there is id, name, count, host, links, connect, tcp, "
       "lan, leaf, manager, ..."},
      {"[island]\nid = 1\n", "6:1: `island` must be tables under headers [[island]], not a table"},
      {"[[radio]]\nloss = 0\n", "6:1: `radio` must be a table, not an array of 1"},
      {"[[peer]]\nname = \"pc2\"\n", "6:1: `id` is missing in [[peer]]"},
      {"[[peer]]\nid = 301\n", "6:1: `name` is missing in [[peer]]"},
      {"[peer.apps]\napp = \"collector\"\n",
       "6:1: `apps` must be an array of tables, as in [{ ... }], not a table"},
      {"apps = [1]\n", "6:9: `apps` must be an array of tables, as in [{ ... }], not 1"},
      {"apps = [{ keys = [\"a\"] }]\n", "6:9: `app` is missing in apps of a peer"},
      {"apps = [{ app = \"colector\", keys = [\"a\"] }]\n",
       "6:17: `app` must be \"proxy_manager\", \"rules\", \"collector\", \"translate\", "
       "\"rfid_reader\", "
       "\"goal\", \"init\", "
       "\"stream_reader\", "
       "\"reservoir\", \"readout\", \"average\", \"stream_switch\" or \"recorder\", not "
       "\"colector\"; did you mean \"collector\"?"},
      {"apps = [{ app = \"collector\", keys = [\"a\"], rate = \"1s\" }]\n",
       "6:44: unknown key `rate` in app = \"collector\": there is app, keys, every"},
      {"apps = [{ app = \"collector\", keys = [\"devices.*.output.*\"], every = \"1s\" }]\n",
       "6:69: `every` needs a key that names an output channel of motes, such as "
       "`devices.*.output.1`"},
      {"apps = [{ app = \"collector\" }]\n", "6:9: `keys` is missing in app = \"collector\""},
      {"apps = [{ app = \"rules\" }]\n", "6:9: `rules` is missing in app = \"rules\""},
      {"[mote_type]\nc = 1\n", "7:5: `c` must be tables under headers [mote_type.NAME], not 1"},
      {"[mote_type.\"a b\"]\ntype = 1\n",
       "6:12: mote type \"a b\" must have a name of 1 to 32 letters, digits, - and _"},
      {"[mote_type.c]\n", "6:1: `type` is missing in [mote_type.NAME]"},
      {"[mote_type.c]\ntype = 0\n",
       "7:8: `type` must be a whole number from 1 to 4294967295, not 0"},
      {"[[mote_type]]\ntype = 1\n",
       "6:1: `mote_type` must be tables under headers [mote_type.NAME], not an array of 1"},
      {"[[island]]\n", "6:1: `id` is missing in [[island]]\n6:1: `name` is missing in [[island]]"},
      {"[[air]]\n", "6:1: `islands` is missing in [[air]]\n6:1: `name` is missing in [[air]]"},
      {"[[proxy]]\n", "6:1: `name` is missing in [[proxy]]\n6:1: a proxy needs either `types`, of "
                      "motes, or `ids`, of tagged objects"},
      {"[[fault]]\n", "6:1: `at` is missing in [[fault]]\n6:1: `kind` is missing in [[fault]]"},
      {"[[fault]]\nat = \"1s\"\nkind = \"crash\"\n", "6:1: `mote` is missing in kind = \"crash\""},
      {"[[fault]]\nat = \"1s\"\nkind = \"unplug\"\n",
       "6:1: `island` is missing in kind = \"unplug\""},
      {"[[fault]]\nat = \"1s\"\nkind = \"unplugged\"\n",
       "8:8: `kind` must be \"battery_end\", \"crash\", \"unplug\", \"kill\", \"power_off\", "
       "\"pause\", \"partition\", \"link_loss\", \"duplicate_id\", \"clock_step\", \"move\", "
       "\"noise\" or \"radio_loss\", not \"unplugged\"; did you mean \"unplug\"?"},
      {"[[host]]\n", "6:1: `address` is missing in [[host]]\n6:1: `name` is missing in [[host]]"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(head, x.toml) == x.problem);
}

TEST_CASE("fields and inputs need their keys", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[[proxy.field]]\n",
       "9:1: `channel` is missing in [[proxy.field]]\n9:1: `name` is missing in [[proxy.field]]"},
      {"[[proxy.input]]\n", "9:1: `channel` is missing in [[proxy.input]]\n9:1: `name` is missing "
                            "in [[proxy.input]]\n9:1: `words` is missing in [[proxy.input]]"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(proxy_head, x.toml) == x.problem);
}

TEST_CASE("an island's tables have keys of their own", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[[island.mote]]\n",
       "15:1: `id` is missing in [[island.mote]]\n15:1: `position_m` is missing in "
       "[[island.mote]]\n15:1: `type` is missing in [[island.mote]]"},
      {"mote = [{ id = 2, type = \"c\", position_m = [1, 2], positoin = 1 }, 3]\n",
       "15:52: unknown key `positoin` in [[island.mote]]: there is id, type, platform, battery, "
       "power, transducers, actuators, apps, name, position_m, ...\n15:68: `mote` must be tables "
       "under "
       "headers [[island.mote]], not 3"},
      {"[island.sink]\nbaud = 1\n",
       "16:1: unknown key `baud` in [island.sink]: there is id, platform, position_m, power, "
       "promiscuous, apps"},
      {"[island.gateway]\nlink = []\n",
       "16:1: unknown key `link` in [island.gateway]: did you mean `links`?"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}

TEST_CASE("a mote's transducers and actuators have keys of their own", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"transducers.temprature = { model = \"constant\", value = 1 }\n",
       "19:13: unknown key `temprature` in transducers: did you mean `temperature`?"},
      {"transducers = 1\n", "19:15: `transducers` must be a table, not 1"},
      {"transducers.light = 1\n", "19:21: `light` must be a table, not 1"},
      {"transducers.light = { value = 1 }\n", "19:21: `model` is missing in transducers.QUANTITY"},
      {"transducers.light = { model = \"constant\" }\n",
       "19:21: `value` is missing in model = \"constant\""},
      {"transducers.light = { model = \"sine\", valeu = 1 }\n",
       "19:21: `amplitude` is missing in model = \"sine\"\n19:21: `mean` is missing in model = "
       "\"sine\"\n19:39: unknown key `valeu` in model = \"sine\": there is noise, resolution, "
       "model, mean, amplitude, period, phase_turns"},
      {"transducers.light = { model = \"constant\", value = 1, noize = 1 }\n",
       "19:54: unknown key `noize` in model = \"constant\": did you mean `noise`?"},
      {"actuators = [{ kind = \"relay\" }]\n", "19:14: `name` is missing in actuators"},
      {"actuators = { name = \"x\", kind = \"relay\" }\n",
       "19:13: `actuators` must be an array of tables, as in [{ ... }], not a table"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(mote_head, x.toml) == x.problem);
}

TEST_CASE("every mistake of a file is told in one go, in order of place", "[config][GEN-06]") {
  CHECK(problem_in("[ecology]\n"
                   "name = \"t\"\n"
                   "sede = 3\n" // unknown key
                   "[[peer]]\n"
                   "name = \"pc\"\n"
                   "id = \"12\"\n"                 // wrong type
                   "links = [\"inproc://robt\"]\n" // dangling reference
                   "[[peer]]\n"
                   "name = \"robot\"\n"
                   "id = 12\n") ==
        "3:1: unknown key `sede` in [ecology]: did you mean `seed`?\n"
        "6:6: `id` must be a whole number from 1 to 65535, not \"12\"\n"
        "7:10: no peer or gateway is called `robt`: did you mean `robot`?");
}

TEST_CASE("a mistake is not told again by what depends on it", "[config][GEN-06]") {
  const std::string far = "[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [99, 0]\n";
  CHECK(problem_after(island_head, far).starts_with("18:14: mote `c-2` is out of reach"));
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
  CHECK(problem_after(head, "[[air]]\n") ==
        "6:1: `islands` is missing in [[air]]\n6:1: `name` is missing in [[air]]");
}

TEST_CASE("problems show as compilers show them", "[config][GEN-06]") {
  using rubicon::config::problem;
  CHECK(to_string(problem{"home.toml", 3, 7, "oh"}) == "home.toml:3:7: oh");
  CHECK(to_string(problem{"home.toml", 0, 0, "oh"}) == "home.toml: oh");
}
