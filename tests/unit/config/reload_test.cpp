// A file that is read again: what follows from it, and what cannot.
#include <string>
#include <string_view>

#include "config/run/reload.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

constexpr std::string_view home = R"([ecology]
name = "t"
seed = 3
duration = "1h"
[radio]
range = "20m"
[[radio.link]]
from = "k/two"
to = "k/sink"
loss = "10%"
[mote_type.c]
type = 7
transducers.temperature = { model = "constant", value = 20 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "10s" }]
[[island]]
name = "k"
id = 1
mote = [
  { id = 2, name = "two", type = "c", position_m = [1, 2] },
  { id = 3, name = "three", type = "c", position_m = [1, 2], apps = [
    { app = "messenger", to = "k/two", text = "hi" }] }]
[[peer]]
name = "pc"
id = 300
[[proxy]]
name = "warm"
types = [7]
qos = { period = "5s" }
field = [{ name = "temperature", channel = 1, unit = "C" }]
[[fault]]
at = "10min"
kind = "kill"
peer = "pc"
)";

followed_file follow() {
  return {home, "home.toml", {}, {}};
}

/// The file with another text in the place of one.
std::string home_but(std::string_view old, std::string_view now) {
  std::string text(home);
  const auto at = text.find(old);
  REQUIRE(at != std::string::npos);
  return text.replace(at, old.size(), now);
}

std::vector<std::string> refused(const reloaded& x) {
  std::vector<std::string> all;
  for (const auto& each : x.refused)
    all.push_back(to_string(each));
  return all;
}

/// The only change that follows.
template <class Change>
Change only(const reloaded& x) {
  CHECK(refused(x).empty());
  CHECK(x.plan.empty());
  REQUIRE(x.changes.size() == 1);
  return std::get<Change>(x.changes[0]);
}

} // namespace

TEST_CASE("a file that says the same changes nothing", "[config][ACT-10]") {
  auto file = follow();
  const auto x = file.read("# only words\n" + std::string(home) + "\n", 1min);
  CHECK(x.changes.empty());
  CHECK(x.plan.empty());
  CHECK(refused(x).empty());
}

TEST_CASE("another period of a program follows, of each mote that has it", "[config][ACT-10]") {
  auto file = follow();
  const auto x = file.read(home_but("every = \"10s\"", "every = \"2s\""), 1min);
  CHECK(refused(x).empty());
  REQUIRE(x.changes.size() == 2);
  CHECK(std::get<program_change>(x.changes[1]).mote.mote == mote_id{3});
  const auto& rate = std::get<program_change>(x.changes[0]);
  CHECK(rate.mote.mote == mote_id{2});
  CHECK(rate.sampler == 1);
  CHECK(rate.settings == keys::key_changes{{"every", duration(2s)}});
  // Compared is what was read last.
  CHECK(file.read(home_but("every = \"10s\"", "every = \"2s\""), 1min).changes.empty());
  CHECK(file.read(home, 1min).changes.size() == 2);
  const auto messenger = only<program_change>(
      file.read(home_but("text = \"hi\"", "text = \"hi\", every = \"7s\""), 1min));
  CHECK(messenger.messenger == 10);
  CHECK(messenger.settings == keys::key_changes{{"every", duration(7s)}});
}

TEST_CASE("all keys of programs that may change follow, and no others", "[config][ACT-10]") {
  auto file = follow();
  const auto change = only<program_change>(
      file.read(home_but("text = \"hi\"", "text = \"ho\", reliable = false"), 1min));
  CHECK(change.messenger == 10);
  CHECK(change.settings == keys::key_changes{{"text", "ho"}, {"reliable", false}});
  const auto more = file.read(home_but("text = \"hi\"", "text = \"hi\", count = 3"), 1min);
  CHECK(refused(more) ==
        std::vector<std::string>{
            "home.toml:21:61: `island.mote.apps.count` is new, and cannot change while an ecology "
            "runs: it is fixed when the run begins"});
}

TEST_CASE("other network keys follow", "[config][ACT-10][SMP-02]") {
  const auto keys = [](const std::string& more) {
    return std::string(home) + "\n[smepp]\nnetwork_key = \"" + more + "\"\n";
  };
  const std::string first = "000102030405060708090a0b0c0d0e0f";
  const std::string second = "f0e1d2c3b4a5968778695a4b3c2d1e0f";
  followed_file file(keys(first), "home.toml", {}, {});
  CHECK(file.read(keys(first), 1min).changes.empty());
  const auto change = only<network_keys_change>(file.read(keys(second), 1min));
  CHECK(change.network_key == *smepp::key::from_hex(second));
  CHECK(change.network_mac); // as before
  CHECK(change.motes.empty());
  CHECK(file.read(keys(second), 2min).changes.empty());
}

TEST_CASE("another link follows, and one that is new", "[config][ACT-10]") {
  auto file = follow();
  const auto link =
      only<link_change>(file.read(home_but("loss = \"10%\"", "loss = \"60%\""), 1min));
  CHECK(link.from.mote == mote_id{2});
  CHECK(link.loss == 0.6);
  const auto more =
      file.read(home_but("[mote_type.c]",
                         "[[radio.link]]\nfrom = \"k/two\"\nto = \"k/three\"\ngain = \"-70dB\"\n"
                         "[mote_type.c]"),
                1min);
  CHECK(refused(more).empty());
  CHECK(more.changes.size() == 2); // the first has its loss of before again
  const auto gone = refused(file.read(
      home_but("[[radio.link]]\nfrom = \"k/two\"\nto = \"k/sink\"\nloss = \"10%\"\n", ""), 1min));
  REQUIRE(gone.size() == 1);
  CHECK(gone[0].starts_with("home.toml:5:1: `radio.link` lacks a link"));
}

TEST_CASE("another class of proxies follows", "[config][ACT-10]") {
  auto file = follow();
  const auto unit =
      only<proxy::class_change>(file.read(home_but("unit = \"C\"", "unit = \"K\""), 1min));
  CHECK(unit.class_name == "warm");
  CHECK(unit.field == "temperature");
  CHECK(unit.settings.empty());
  CHECK(unit.field_settings == keys::key_changes{{"unit", "K"}});
  const auto both =
      file.read(home_but("period = \"5s\"", "period = \"3s\", stale_after = \"9s\""), 1min);
  CHECK(refused(both).empty());
  REQUIRE(both.changes.size() == 2);
  CHECK(proxy::to_text(std::get<proxy::class_change>(both.changes[0])) ==
        "period 3 s, stale_after 9 s");
  CHECK(proxy::to_text(std::get<proxy::class_change>(both.changes[1])) == "unit of temperature C");
  const auto first = home_but("[[proxy]]", "[[proxy]]\nname = \"other\"\ntypes = [8]\n[[proxy]]");
  followed_file another(first, "home.toml", {}, {});
  const auto told =
      another.read(std::string(first).insert(first.find("types = [8]"), "qos.retry_for = \"7s\"\n"),
                   1min); // a table that was not there
  CHECK(proxy::to_text(only<proxy::class_change>(told)) == "retry_for 7 s");
}

TEST_CASE("faults and changes to come join the plan", "[config][ACT-10]") {
  auto file = follow();
  const auto more = std::string(home) + R"([[fault]]
at = "5min"
kind = "pause"
peer = "pc"
[[change]]
at = "20min"
kind = "debug"
of = "mote"
[[fault]]
every = "7min"
kind = "pause"
peer = "pc"
)";
  const auto x = file.read(more, 1min);
  CHECK(refused(x).empty());
  CHECK(x.changes.empty());
  REQUIRE(x.plan.size() == 3);
  CHECK(x.plan[0].repeated);
  CHECK(x.plan[1].at == 5min);
  CHECK(x.plan[2].at == 20min);
  CHECK(is_change(x.plan[2]));
  CHECK(file.read(more, 2min).plan.empty());

  const auto late = refused(file.read(more + "[[fault]]\nat = \"2min\"\nkind = \"kill\"\n"
                                             "peer = \"pc\"\n",
                                      3min));
  CHECK(late == std::vector<std::string>{
                    "home.toml:46:1: that [[fault]] is too late: it is 3 min already"});
  const auto gone = refused(file.read(home, 3min));
  REQUIRE(gone.size() == 2);
  CHECK(gone[1].find(
            "a [[fault]] at 5 min was removed from the file: planned actions remain planned") !=
        std::string::npos);
}

TEST_CASE("what cannot follow is refused with its place and the reason", "[config][ACT-10]") {
  auto file = follow();
  using texts = std::vector<std::string>;
  const auto says = [&file](std::string_view old, std::string_view now) {
    const auto x = file.read(home_but(old, now), 1min);
    CHECK(x.changes.empty());
    return refused(x);
  };
  CHECK(says("seed = 3", "seed = 4") ==
        texts{"home.toml:3:8: `ecology.seed` differs, and cannot change while an ecology runs: it "
              "determines all random numbers from the start; run again with `--seed`"});
  CHECK(says("range = \"20m\"", "range = \"30m\"").size() == 1);
  CHECK(says("value = 20", "value = 21") ==
        texts{"home.toml:13:57: `mote_type.c.transducers.temperature.value` differs, and cannot "
              "change while an ecology runs: it is fixed when the run begins"});
  CHECK(says("position_m = [1, 2] },", "position_m = [1, 3] },").size() == 1);
  CHECK(says("[[peer]]\nname = \"pc\"\nid = 300\n",
             "[[peer]]\nname = \"pc\"\nid = 300\n[[peer]]\nname = \"tv\"\nid = 301\n") ==
        texts{"home.toml:25:1: `peer` has more, and cannot change while an ecology runs: it exists "
              "from the start; a fault of kind = \"kill\" ends it"});
  CHECK(
      says("qos = { period = \"5s\" }\n", "") ==
      texts{"home.toml:25:1: `proxy.qos.period` is gone, and cannot change while an ecology runs"});
  CHECK(refused(file.read(home, 1min)).empty());
}

TEST_CASE("a file that is wrong changes nothing", "[config][ACT-10][GEN-06]") {
  auto file = follow();
  const auto broken = file.read(home_but("every = \"10s\"", "every = \"2 apples\""), 1min);
  CHECK(broken.changes.empty());
  REQUIRE_FALSE(broken.refused.empty());
  CHECK(broken.refused[0].line == 14);
  CHECK_FALSE(file.read("[ecology", 1min).refused.empty());
  CHECK(file.read(home_but("every = \"10s\"", "every = \"2s\""), 1min).changes.size() == 2);
}
