// [[change]]: what may be another way while an ecology runs, and what may not.
#include <string>
#include <string_view>

#include "config/plan/debug_selection.hpp"
#include "config/run/change_text.hpp"
#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// A mote `k/two` with a sampler and a messenger, and one `k/three` with a sampler; a class of
/// proxies of motes, and one of tagged objects.
const std::string change_head = R"([ecology]
name = "t"
duration = "1h"
[[peer]]
name = "pc"
id = 300
apps = [{ app = "proxy_manager", objects = true }]
[mote_type.c]
type = 7
transducers.temperature = { model = "constant", value = 20 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "10s", every_min = "2s", jitter = "3s" }]
[[island]]
name = "k"
id = 1
mote = [
  { id = 2, name = "two", type = "c", position_m = [1, 2], apps = [
    { app = "sampler", transducers = ["temperature"], channel = 4 },
    { app = "messenger", to = "k/three", text = "hi" }] },
  { id = 3, name = "three", type = "c", position_m = [1, 2] }]
[[island]]
name = "far"
id = 2
[[proxy]]
name = "warm"
types = [7]
field = [{ name = "temperature", channel = 1, unit = "C" }]
[[proxy]]
name = "thing"
ids = ["rfid/"]
)";

template <class Change>
Change only_change(std::string_view keys) {
  const auto all = good(change_head + "[[change]]\nat = \"1s\"\n" + std::string(keys)).faults;
  REQUIRE(all.size() == 1);
  CHECK(all[0].at == 1s);
  return std::get<Change>(std::get<change>(all[0].what));
}

} // namespace

TEST_CASE("changes arrive with their keys", "[config][ACT-10]") {
  using texts = std::vector<std::string>;
  CHECK(only_change<debug_change>("kind = \"debug\"\nof = [\"mote/k\", \"gateway\"]\n").of ==
        texts{"mote/k", "gateway"});
  CHECK(only_change<debug_change>("kind = \"debug\"\nof = \"mote/k/two, sink\"\n").of ==
        texts{"mote/k/two", "sink"});
  CHECK(only_change<debug_change>("kind = \"debug\"\nof = \"\"\n").of.empty());

  const auto only =
      only_change<program_change>("kind = \"rate\"\nmote = \"k/three\"\nperiod = \"5s\"\n");
  CHECK(only.mote == mote_address{island_id{1}, mote_id{3}});
  CHECK(only.sampler == 1);
  CHECK_FALSE(only.messenger);
  CHECK(only.settings == keys::key_changes{{"every", duration(5s)}});
  const auto one = only_change<program_change>(
      "kind = \"rate\"\nmote = \"k/two\"\nmessenger = 10\nperiod = \"1min\"\n");
  CHECK(one.messenger == 10);
  CHECK_FALSE(one.sampler);

  const auto program = only_change<program_change>(
      "kind = \"program\"\nmote = \"k/two\"\nmessenger = 10\ntext = \"ho\"\nreliable = false\n");
  CHECK(program.messenger == 10);
  CHECK(program.settings == keys::key_changes{{"text", "ho"}, {"reliable", false}});

  const auto link = only_change<link_change>(
      "kind = \"link\"\nfrom = \"k/two\"\nto = \"k/sink\"\nloss = \"30%\"\n");
  CHECK(link.from.mote == mote_id{2});
  CHECK(link.to.mote == mote_id{1});
  CHECK(link.loss == 0.3);
  CHECK_FALSE(link.gain_db);

  const auto settings = only_change<proxy::class_change>(
      "kind = \"proxy_class\"\nclass = \"warm\"\nperiod = \"3s\"\nfield = \"temperature\"\n"
      "unit = \"K\"\nadd = 273.15\n");
  CHECK(settings.class_name == "warm");
  CHECK(settings.settings == keys::key_changes{{"period", duration(3s)}});
  CHECK(settings.field == "temperature");
  CHECK(settings.field_settings == keys::key_changes{{"add", 273.15}, {"unit", "K"}});
  CHECK(proxy::to_text(settings) == "period 3 s, add of temperature 273.15, unit of temperature K");
}

TEST_CASE("network keys may change, of motes that have some", "[config][ACT-10][SMP-02]") {
  const std::string head = R"([ecology]
name = "t"
[[island]]
name = "k"
id = 1
mote = [
  { id = 2, name = "two", type = 7, position_m = [1, 2], apps = [{ app = "member", group = "care", creates = true }] },
  { id = 3, name = "three", type = 7, position_m = [1, 2] }]
[[smepp.group]]
name = "care"
[[change]]
at = "1s"
kind = "network_keys"
)";
  const std::string key = "network_key = \"000102030405060708090a0b0c0d0e0f\"\n";
  const auto planned = good(head + key + "motes = [\"k/two\"]\n").faults;
  REQUIRE(planned.size() == 1);
  const auto& x = std::get<network_keys_change>(std::get<change>(planned[0].what));
  CHECK(x.network_key == *smepp::key::from_hex("000102030405060708090a0b0c0d0e0f"));
  CHECK_FALSE(x.network_mac);
  CHECK(x.motes == std::vector{mote_address{island_id{1}, mote_id{2}}});
  CHECK(summary(good(head + key)).find("0001020304") == std::string::npos);
  check_mistakes(head, R"(network_key = "00"
#             ^ `network_key` must be a key of 32 hexadecimal digits
)");
  check_mistakes(head + key, R"(motes = ["k/three"]
#       ^ `three` has no program `member`, and therefore no such keys
)");
  check_mistakes(change_head, R"(
[[change]]
#@ 30:1: no mote has the program `member`: there are no network keys
at = "1s"
kind = "network_keys"
network_key = "000102030405060708090a0b0c0d0e0f"
)");
}

TEST_CASE("changes are planned behind the faults, which keep their numbers", "[config][ACT-10]") {
  const auto all = good(change_head + R"(
[[change]]
at = "9s"
kind = "debug"
of = []
[[change]]
at = "1s"
kind = "debug"
of = ["mote"]
[[fault]]
at = "5s"
kind = "kill"
peer = "pc"
)")
                       .faults;
  REQUIRE(all.size() == 3);
  CHECK_FALSE(is_change(all[0]));
  CHECK(all[1].at == 1s);
  CHECK(all[2].at == 9s);
}

TEST_CASE("a summary tells changes", "[config][ACT-10]") {
  const auto text = summary(good(change_head + R"(
[[change]]
at = "1min"
kind = "rate"
mote = "k/three"
period = "5s"
[[change]]
at = "2min"
kind = "link"
from = "k/two"
to = "k/sink"
gain = "-80dB"
[[change]]
at = "3min"
kind = "proxy_class"
class = "warm"
stale_after = "7s"
[[change]]
at = "4min"
kind = "debug"
of = ["mote/k"]
)"));
  for (const auto* line : {"k/three sampler 1 every 5 s", "k/two to k/sink, gain -80 dB",
                           "warm: stale_after 7 s", "of mote/k"})
    CHECK(text.find(line) != std::string::npos);
}

TEST_CASE("changes that cannot be are refused, with the reason", "[config][GEN-06][ACT-10]") {
  check_mistakes(change_head, R"(
[[change]]
at = "1s"
kind = "seed"
#      ^ `seed` cannot change while an ecology runs: it determines all random numbers from the
#        start; run again with `--seed`
value = 7

[[change]]
at = "1s"
kind = "mode"
#      ^ `mode` cannot change while an ecology runs: it is fixed for the whole run; run again with
#        `--mode`

[[change]]
at = "1s"
kind = "lnik"
#      ^ `kind` must be "debug", "rate", "program", "link", "proxy_class" or "network_keys", not
#        "lnik"; did you mean "link"?

[[change]]
kind = "debug"
#@ 30:1: `at` is missing in [[change]]
of = []

[[change]]
at = "2h"
#    ^ `at` is after the end of the run, which is at 1 h
kind = "debug"
of = []

[[change]]
at = "1s"
kind = "debug"
of = ["motes"]
#    ^ there is no module `motes`: did you mean `mote`?

[[change]]
at = "1s"
kind = "debug"
of = "mote/k/tow"
#    ^ no actor is named `mote/k/tow`: did you mean `mote/k/two`?

[[change]]
at = "1s"
kind = "debug"
of = 7
#    ^ `of` must be an array of patterns, or a text with some, not 7

[[change]]
at = "1s"
kind = "rate"
mote = "k/two"
#      ^ that mote has several samplers and messengers: choose one with `sampler` or `messenger`
period = "5s"

[[change]]
at = "1s"
kind = "rate"
mote = "k/two"
sampler = 9
#         ^ that mote has no sampler 9
period = "5s"

[[change]]
at = "1s"
kind = "rate"
mote = "k/two"
sampler = 4
messenger = 10
#           ^ `messenger` has no effect with `sampler`
period = "5s"

[[change]]
at = "1s"
kind = "rate"
mote = "k/three"
period = "1s"
#        ^ `period` must not be shorter than the sampler's `jitter`, which is 3 s

[[change]]
at = "1s"
kind = "program"
mote = "k/three"
every = "1s"
#       ^ `every` must not be shorter than the sampler's `jitter`, which is 3 s

[[change]]
at = "1s"
kind = "program"
mote = "k/three"
text = "ho"
#@ 30:1: no change of the program is given
#@ 34:1: unknown key `text` in [[change]] kind = "program": there is at, kind, mote, sampler, messenger, every,
#          reliable, only_subscribed

[[change]]
at = "1s"
kind = "link"
from = "k/two"
to = "far/sink"
#    ^ the two use different radio media, which are isolated from each other
loss = 0.5

[[change]]
at = "1s"
kind = "link"
from = "k/two"
to = "k/two"
#    ^ a link leads from one mote to another
loss = 0.5

[[change]]
#@ 30:1: a link needs `loss`, `gain` or both
at = "1s"
kind = "link"
from = "k/two"
to = "k/three"

[[change]]
at = "1s"
kind = "proxy_class"
class = "worm"
#       ^ no proxy class is named `worm`: did you mean `warm`?
period = "5s"

[[change]]
at = "1s"
kind = "proxy_class"
class = "thing"
#       ^ that class is for tagged objects; only classes for motes may change
retire_after = "5s"

[[change]]
at = "1s"
kind = "proxy_class"
class = "warm"
unit = "K"
#      ^ `unit` needs `field`

[[change]]
at = "1s"
kind = "proxy_class"
class = "warm"
field = "temprature"
#       ^ the class has no field `temprature`: did you mean `temperature`?
unit = "K"

[[change]]
#@ 30:1: no change of the class is given
at = "1s"
kind = "proxy_class"
class = "warm"

[[change]]
at = "1s"
kind = "proxy_class"
class = "warm"
types = [9]
#@ 30:1: no change of the class is given
#@ 34:1: unknown key `types` in [[change]] kind = "proxy_class": it is a key of [[proxy]]; see
#          rubicon check --explain types
)");
}

TEST_CASE("a debug log is of modules, of paths and of all below one", "[config][NFR-02]") {
  const debug_selection all;
  CHECK(all.has("mote/k/two"));
  CHECK(all.text() == "all actors");
  const debug_selection nobody{std::vector<std::string>{}};
  CHECK_FALSE(nobody.has("mote/k/two"));
  CHECK(nobody.text() == "no actors");
  const debug_selection some({"gateway", "mote/k/two", "sink/k"});
  CHECK(some.has("gateway/k"));
  CHECK(some.has("mote/k/two"));
  CHECK_FALSE(some.has("mote/k/two-more"));
  CHECK_FALSE(some.has("mote/k"));
  CHECK_FALSE(some.has("gateways"));
  CHECK(some.has("sink/k"));
  CHECK(some.text() == "gateway, mote/k/two, sink/k");
  CHECK(debug_patterns(" mote/k,\tsink  ,, air ") ==
        std::vector<std::string>{"mote/k", "sink", "air"});
  CHECK(debug_patterns(" , ").empty());
}

TEST_CASE("patterns that mean nobody are known before the run", "[config][NFR-02]") {
  const debug_names names(good(change_head));
  for (const auto* good_one : {"*", "mote", "mote/k", "mote/k/two", "mote_app/k/two/sampler-4",
                               "sink/k", "peis_peer/k-gateway", "peis_peer/pc", "peis_lan",
                               "proxy/k.two", "ecology/t", "air/k", "serial_line/far"}) {
    INFO(good_one);
    CHECK(names.problem(good_one).empty());
  }
  for (const auto* bad : {"", "mot", "mote/", "mote//two", "mote/x", "mote/k/four", "mote/k/two/x",
                          "sink/pc", "peis_peer/k", "/mote", "proxy/"}) {
    INFO(bad);
    CHECK_FALSE(names.problem(bad).empty());
  }
  CHECK(names.problem("mote/k/" + std::string(200, 'x')) == "a pattern has at most 200 characters");
  CHECK(names.problem(std::vector<std::string>(65, "mote")) == "there are more than 64 patterns");
}
