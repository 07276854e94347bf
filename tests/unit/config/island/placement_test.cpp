#include "config/plan/placement.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "config/load.hpp"
#include "core/numbers/random.hpp"
#include "device/transducer.hpp"
#include "device/walk.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::config;

namespace {

const std::string hosts = R"(
[[host]]
name = "attic"
address = "127.0.0.1"
control_port = 4250
[[host]]
name = "cellar"
address = "10.0.0.2"
networks = ["10.0.0.0/24"]
[[host]]
name = "spare"
address = "10.0.0.3"
)";

const std::string house = R"(
[ecology]
name = "house"
duration = "10min"
start = "23:55"
[[island]]
name = "up"
id = 1
[[island.mote]]
id = 2
name = "fan"
type = 7
position_m = [3, 0]
[[island]]
name = "down"
id = 2
host = "cellar"
gateway = { links = ["inproc://robot", "inproc://pc"] }
[[island.mote]]
id = 2
type = 7
position_m = [3, 0]
[[peer]]
name = "pc"
id = 300
host = "cellar"
[[peer]]
name = "robot"
id = 65535
)" + hosts;

ecology_description loaded_from(const std::string& toml) {
  auto found = load_text(toml, "t.toml");
  for (const auto& each : found.problems)
    UNSCOPED_INFO(to_string(each));
  REQUIRE(found.ecology);
  return *std::move(found.ecology);
}

std::string fault_table(const std::string& keys) {
  return "\n[[fault]]\n" + keys + '\n';
}

template <class T>
std::vector<std::string> names_of(const std::vector<T>& all) {
  std::vector<std::string> names;
  for (const auto& x : all)
    names.push_back(x.name);
  return names;
}

using strings = std::vector<std::string>;

std::string only_problem(const std::string& toml) {
  const auto found = placement_problems(loaded_from(toml));
  REQUIRE(found.size() == 1);
  return found.front();
}

} // namespace

TEST_CASE("hosts say where they listen", "[config][GEN-05]") {
  const auto x = loaded_from(house).hosts;
  CHECK(x[0].listen == "127.0.0.1");
  CHECK(x[0].control_port == 4250);
  CHECK(x[0].peis_port == 4251);
  CHECK(x[1].peis_port == 4243);
  REQUIRE(x[1].networks.size() == 1);
  CHECK(to_string(x[1].networks[0]) == "10.0.0.0/24");
}

TEST_CASE("what names no host is on the first one", "[config][GEN-05]") {
  const auto x = loaded_from(house);
  CHECK(host_of(x, x.islands[0]) == "attic");
  CHECK(host_of(x, x.islands[1]) == "cellar");
  CHECK(names_of(used_hosts(x)) == strings{"attic", "cellar"}); // nothing is on the spare one
  CHECK(placement_problems(x).empty());
}

TEST_CASE("a part has what is on its host, and a peer for links to others", "[config][LEA-02]") {
  const auto all = loaded_from(house);
  const auto attic = part_of(all, "attic");
  CHECK(attic.mode == run_mode::wall);
  CHECK(names_of(attic.islands) == strings{"up"});
  CHECK(names_of(attic.airs) == strings{"up"});
  CHECK(names_of(attic.peers) == strings{"attic", "robot"});
  REQUIRE(attic.part);
  CHECK(names_of(attic.part->others) == strings{"down"});
  CHECK(attic.part->others[0].motes.size() == 1);
  const auto* up = host_peer(attic);
  REQUIRE(up != nullptr);
  CHECK(up->id == peer_id(65534)); // the highest that nobody has
  CHECK(up->tcp->port == 4251);
  CHECK(up->tcp->address == "127.0.0.1");
  CHECK(up->connect.empty());

  const auto cellar = part_of(all, "cellar");
  const auto* down = host_peer(cellar);
  REQUIRE(down != nullptr);
  CHECK(down->id == peer_id(65533));
  CHECK(down->tcp->networks.size() == 1);
  CHECK(down->connect == strings{"tcp://127.0.0.1:4251"}); // of two one asks
  CHECK(cellar.islands[0].gateway_links == strings{"cellar", "pc"});
}

TEST_CASE("all on one host is a part without a peer more", "[config]") {
  const auto all = loaded_from("[ecology]\nname = \"t\"\n[[peer]]\nname = \"pc\"\nid = 300\n"
                               "[[host]]\nname = \"a\"\naddress = \"some.where\"\n");
  CHECK(placement_problems(all).empty());
  const auto part = part_of(all, "a");
  CHECK(names_of(part.peers) == strings{"pc"});
  CHECK_FALSE(part.part);
  CHECK(host_peer(part) == nullptr);
}

TEST_CASE("the peer of a host has a name of its own", "[config]") {
  auto text = house;
  for (std::size_t at = 0; (at = text.find("robot", at)) != std::string::npos;)
    text.replace(at, 5, "attic"); // also in links
  CHECK(host_peer(part_of(loaded_from(text), "attic"))->name == "host-attic");
}

TEST_CASE("what is of one place is on one host", "[config]") {
  CHECK(only_problem(house + fault_table("at = \"1s\"\nkind = \"partition\"\n"
                                         "groups = [[\"pc\"], [\"robot\"]]")) ==
        "the fault at 1 s affects several hosts, `attic`, `cellar`: a fault can affect only one");
  auto text = house;
  text.replace(text.find("10.0.0.2"), 8, "some.where");
  CHECK(only_problem(text).find("set `listen` to the IPv4 address") != std::string::npos);
  text = house;
  text.replace(text.find("4250"), 4, "4242");
  text.replace(text.find("10.0.0.2"), 8, "127.0.0.1");
  CHECK(placement_problems(loaded_from(text)).size() == 2); // both ports
}

TEST_CASE("faults are for the hosts of what they are about", "[config]") {
  const auto all =
      loaded_from(house + fault_table("at = \"1s\"\nkind = \"kill\"\npeer = \"robot\"") +
                  fault_table("at = \"2s\"\nkind = \"crash\"\nmote = \"down/mote-2\"") +
                  fault_table("every = \"1min\"\nkind = \"crash\"\nmote = \"*\"") +
                  fault_table("at = \"3s\"\nkind = \"link_loss\"\nloss = 0.1"));
  const auto count = [&all](const std::string& host) { return part_of(all, host).faults.size(); };
  CHECK(count("attic") == 3);
  CHECK(count("cellar") == 3);
  for (const auto& each : all.faults)
    CHECK(hosts_of(all, each.what).size() == (each.repeated || each.at == 3s ? 2 : 1));
}

TEST_CASE("a part judges what it alone can see", "[config]") {
  const auto all = loaded_from(house + R"(
[[expect]]
kind = "joined"
of = "down"
within = "1min"
[[expect]]
kind = "delivery"
of = "down"
at_least = 0.9
)");
  REQUIRE(all.expectations.size() == 2);
  CHECK(part_of(all, "attic").expectations.empty());
  CHECK(part_of(all, "cellar").expectations.size() == 1);
}

TEST_CASE("a part that begins late ends with the others", "[config]") {
  auto x =
      part_of(loaded_from(house + fault_table("at = \"1min\"\nkind = \"kill\"\npeer = \"robot\"") +
                          fault_table("at = \"9min\"\nkind = \"kill\"\npeer = \"robot\"") +
                          fault_table("every = \"4min\"\nkind = \"kill\"\npeer = \"robot\"") +
                          fault_table("every = \"1min\"\nuntil = \"5min\"\nkind = \"kill\"\n"
                                      "peer = \"robot\"")),
              "attic");
  begin_later(x, 6min);
  CHECK(x.length == 4min);
  CHECK(x.day_begins == 1min);
  REQUIRE(x.faults.size() == 2);
  CHECK(x.faults[0].at == 2min); // at 8 min, and each 4 min
  CHECK(x.faults[1].at == 3min);
}

TEST_CASE("rules of a part that begins late keep their times of day", "[config][rules]") {
  auto x = loaded_from(house);
  proxy::rules_config rules;
  rules.rules.resize(2);
  rules.rules[0].daily = 7h;
  rules.rules[1].daily = 5min;
  rules.clock_changes = {{instant(20h), 1h}};
  REQUIRE_FALSE(x.peers.empty());
  x.peers.front().apps = {rules};
  begin_later(x, 6min);
  const auto& later = std::get<proxy::rules_config>(x.peers.front().apps.front());
  CHECK(later.rules[0].daily == 7h - 6min);
  CHECK(later.rules[1].daily == 24h - 1min);
  CHECK(later.clock_changes == std::vector<proxy::clock_change>{{instant(20h - 6min), 1h}});
}

TEST_CASE("readings and places of a part that begins anew are those of the whole",
          "[config][NFR-08]") {
  auto x = part_of(loaded_from(house + R"(
[[tag]]
id = "e004010012345678"
path = [["0s", [0, 0]], ["10min", [10, 0]]]
)"),
                   "attic");
  device::transducer_config rising;
  rising.model = device::points_model{{{0s, 0.0}, {10min, 100.0}}};
  x.islands.at(0).motes.at(0).transducers = {rising};
  x.islands[0].motes[0].path = {{0s, {0, 0, 0}}, {2min, {2, 0, 0}}};
  begin_later(x, 6min);
  const auto& mote = x.islands[0].motes[0];
  random_stream rng(1, "noise");
  CHECK(device::value_of(mote.transducers[0], instant(1min), rng) == 70.0);
  CHECK(mote.place.x_m == 2);
  REQUIRE(x.tags.size() == 1);
  CHECK(x.tags[0].place.x_m == Approx(6));
  CHECK(device::walk(x.tags[0].path, 1s).at(instant(1min)).x_m == Approx(7));
}
