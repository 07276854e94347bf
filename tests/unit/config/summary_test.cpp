#include <algorithm>
#include <string>

#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using rubicon::test::good;

namespace {

std::string lines(std::string_view start, int count, const char* format) {
  std::string out(start);
  for (int i = 1; i <= count; ++i) {
    auto text = std::string(format);
    for (auto at = text.find('#'); at != std::string::npos; at = text.find('#'))
      text.replace(at, 1, std::to_string(i));
    out += text;
  }
  return out;
}

} // namespace

TEST_CASE("a summary shows everything in columns", "[config]") {
  const auto x =
      good("[ecology]\nname = \"t\"\nduration = \"1h\"\nseed = 4\n[radio]\nloss = \"7%\"\n"
           "[[host]]\nname = \"h\"\naddress = \"10.0.0.1\"\n"
           "[mote_type.c]\ntype = 7\n"
           "[[island]]\nname = \"kitchen\"\nid = 1\n"
           "mote = [{ id = 2, type = \"c\", position_m = [0, 0] },\n"
           "{ id = 3, type = 9, position_m = [0, 0] },\n"
           "{ id = 4, type = \"c\", position_m = [0, 0] }]\n"
           "gateway.links = [\"inproc://pc\"]\n"
           "[[island]]\nname = \"b\"\nid = 20\nsink.platform = \"telosb\"\n"
           "[[air]]\nname = \"flat\"\nislands = [\"kitchen\", \"b\"]\n"
           "[[peer]]\nname = \"pc\"\nid = 300\nhost = \"h\"\n"
           "apps = [{ app = \"proxy_manager\", islands = [\"b\"] },\n"
           "{ app = \"collector\", keys = [\"*.t\"] },\n"
           "{ app = \"rules\", rules = [{ when = \"a\", above = 1, write = \"b\","
           " then = \"x\" }] }]\n"
           "[[proxy]]\nname = \"p\"\ntypes = [7, \"9..10\"]\n"
           "field = [{ name = \"t\", channel = 1 }]\n"
           "input = [{ name = \"s\", channel = 2, words = { on = \"01\" } }]\n"
           "[[fault]]\nat = \"2s\"\nkind = \"unplug\"\nisland = \"b\"\n"
           "[[fault]]\nat = \"1s\"\nkind = \"crash\"\nmote = \"kitchen/c-2\"\n");
  CHECK(summary(x) == R"(t: 1 h of virtual time, seed 4, network rubicon
2 islands, 3 motes, 1 peer
radio: unit disk of 30 m; no noise; collisions strict; loss 7 %
mac: micaz standard, telosb standard; senses energy or carrier; queue of 8

islands
  1   kitchen  3 motes: 2 c, 1 type 9  sink 1, micaz, 57600 baud
  20  b        0 motes                 sink 1, telosb, 115200 baud

shared airs
  flat  kitchen, b

peers and gateways
  1    kitchen-gateway  -> pc        gateway of kitchen
  20   b-gateway                     gateway of b
  300  pc                      on h  proxy manager (b), collector (*.t), 1 rule

hosts
  h  10.0.0.1  PEIS port 4243

proxies
  p  types 7, 9..10  {island}.{name}  t, s (input)

faults
  1 s  crash   kitchen/c-2
  2 s  unplug  b for 30 s
)");
}

TEST_CASE("a summary stays on a screen", "[config]") {
  const auto count = [](const ecology_description& x) {
    const auto text = summary(x);
    return std::count(text.begin(), text.end(), '\n');
  };
  const auto motes = lines("[ecology]\nname = \"t\"\n[[island]]\nname = \"k\"\nid = 1\n", 54,
                           "[[island.mote]]\nid = 1#\ntype = 1\nposition_m = [0, 0]\n");
  CHECK(count(good(motes)) == 10);
  const auto peers = lines("[ecology]\nname = \"t\"\n", 21, "[[peer]]\nname = \"p#\"\nid = #\n");
  CHECK(count(good(peers)) == 2 + 2 + 20 + 1);
  CHECK(summary(good(peers)).ends_with("  ... and 1 more\n"));
}

TEST_CASE("a summary tells how the medium is modelled and what is measured", "[config]") {
  const auto x = good("[ecology]\nname = \"t\"\n"
                      "[radio]\nretries = 1\nsensitivity = \"-94.5dBm\"\ncapture = true\n"
                      "cca_threshold = \"-80dBm\"\nsensing = \"energy\"\ncurve = \"tossim\"\n"
                      "sensing_window = \"end\"\n"
                      "[radio.propagation]\nmodel = \"log_distance\"\nexponent = 2.7\n"
                      "shadowing = \"4dB\"\nasymmetry = \"1dB\"\n"
                      "[radio.mac]\ntelosb = \"cc2420\"\niris = \"rf230\"\n"
                      "[[radio.link]]\nfrom = \"k/sink\"\nto = \"k/node-2\"\nloss = 1\n"
                      "[[island]]\nname = \"k\"\nid = 1\nstack = \"mac\"\n"
                      "sink.apps = [{ app = \"receiver\" }]\nsink.platform = \"telosb\"\n"
                      "[[island.group]]\ncount = 3\nprefix = \"node\"\nlayout = \"line\"\n"
                      "spacing = \"5m\"\napps = [{ app = \"sender\", to = \"sink\" },\n"
                      "{ app = \"sender\", to = \"*\", pattern = \"saturated\" }]\n");
  CHECK(summary(x) == R"(t: 10 min of virtual time, seed 1, network rubicon
1 island, 3 motes, 0 peers
radio: log distance, exponent 2.7, 40 dB at 1 m, shadowing 4 dB, asymmetry 1 dB; noise of -98 dBm; collisions by SINR, capture, TOSSIM's curve, sensitivity -94.5 dBm; loss 0 %; 1 link as listed
mac: micaz standard, telosb cc2420; senses energy at the end, threshold -80 dBm; 1 retry; queue of 8
flows: 6 senders (3 periodic, 3 saturated), 0 relays, 1 receiver

islands
  1  k  3 motes: 3 untyped  sink 1, telosb, mac only
)");
}
