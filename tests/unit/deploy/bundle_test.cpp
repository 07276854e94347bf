#include "deploy/bundle.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "config/plan/placement.hpp"
#include "config/toml/schema.hpp"
#include "deploy/fault_sentence.hpp"

#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace rubicon;
using namespace rubicon::deploy;

namespace {

namespace fs = std::filesystem;

struct folder : test::scratch_folder {
  [[nodiscard]] std::string with(const std::string& name, const std::string& content) const {
    std::ofstream(path / name) << content;
    return file(name);
  }
};

const std::string house_toml = R"([ecology]
name = "house"
seed = 5
duration = "2min"
[[host]]
name = "attic"
address = "10.0.0.1"
control_port = 4000
[[host]]
name = "cellar"
address = "10.0.0.2"
control_port = 4000
networks = ["10.0.0.0/24"]
[[island]]
id = 1
name = "kitchen"
host = "attic"
[[island.mote]]
id = 3
name = "stove"
type = 7
position_m = [1, 1]
transducers.temperature = { model = "trace", file = "stove.csv", column = "t" }
[[peer]]
id = 40
name = "robot"
host = "cellar"
)";

config::overrides wall() {
  config::overrides instead;
  instead.mode = config::run_mode::wall;
  return instead;
}

} // namespace

TEST_CASE("a bundle is the same ecology where its files are not", "[deploy][GEN-05]") {
  const folder in;
  const auto path = in.with("house.toml", house_toml);
  static_cast<void>(in.with("stove.csv", "time,t\n0,20\n10,25\n"));
  const auto packed = pack(path, wall(), 30s, {});
  REQUIRE(packed.loaded.problems.empty());
  CHECK(packed.what.files.size() == 1);
  CHECK(packed.what.seed == 5);
  CHECK(packed.what.length == 30s);
  fs::remove(in.path / "stove.csv");
  fs::remove(in.path / "house.toml");

  const auto loaded = load(packed.what, wall(), {});
  REQUIRE(loaded.ecology);
  CHECK(loaded.ecology->length == 30s);
  CHECK(loaded.ecology->seed == 5);
  auto other_seed = wall();
  other_seed.seed = 9;
  CHECK(load(packed.what, other_seed, {}).ecology->seed == 9);

  auto without = packed.what;
  without.files.clear();
  const auto lacking = load(without, wall(), {});
  REQUIRE(lacking.problems.size() == 1);
  CHECK(lacking.problems[0].message.find("not among the files that were sent") !=
        std::string::npos);
}

TEST_CASE("a bundle's hash is that of its files", "[deploy]") {
  const bundle one{"a.toml", "x", {{"f", "1"}}, {}, {}, {}, 1, 1s};
  auto two = one;
  two.seed = 2;
  two.length = 9s;
  CHECK(hash_of(one) == hash_of(two));
  two.files["f"] = "2";
  CHECK(hash_of(one) != hash_of(two));
  two = one;
  two.toml = "y";
  CHECK(hash_of(one) != hash_of(two));
}

namespace {

/// Groups of two hosts, and one of nobody; each key is as often a digit as it is called.
std::string with_groups(const std::string& smepp) {
  return R"([ecology] # a secret remark
name = "groups"
duration = "2min"
[[host]]
name = "attic"
address = "10.0.0.1"
[[host]]
name = "cellar"
address = "10.0.0.2"
[[host]]
name = "shed"
address = "10.0.0.3"
[mote_type.guard]
type = 7
apps = [{ app = "member", group = "alarm" }]
[[island]]
id = 1
name = "up"
host = "attic"
mote = [{ id = 3, name = "watch", type = 7, position_m = [1, 1], apps = [{ app = "member", group = "care" }] }]
[[island]]
id = 2
name = "down"
host = "cellar"
mote = [{ id = 3, name = "watch", type = 7, position_m = [1, 1], apps = [{ app = "member", group = "alarm" }] },
  { id = 4, name = "lamp", type = 7, position_m = [2, 1] }]
[[peer]]
id = 40
name = "robot"
host = "shed"
[smepp]
)" + smepp;
}

const std::string all_keys = R"(authenticate = "sender"
network_key = "11111111111111111111111111111111"
network_mac = '22222222222222222222222222222222' # was 99999999999999999999999999999999
pairwise_key = """33333333333333333333333333333333"""
[[smepp.group]]
name = "care"
closed = true
master_key = "aaaaAAAAaaaaaaaaaaaaaaaaaaaaaaaa"
[[smepp.group]]
  "name" = "alarm"
  "closed" = true
  "master_key" = "bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb\u0062"
[[smepp.group]]
name = "# \"nobody"
private = true
master_key = "cccccccccccccccccccccccccccccccc"
[[change]]
at = "1s"
kind = "network_keys"
network_key = "11111111111111111111111111111111"
network_mac = "22222222222222222222222222222222"
)";

std::string secrets_in(const std::string& toml) {
  std::string found;
  for (const std::string each : {"1111", "2222", "3333", "aaaa", "bbbb", "cccc", "9999", "remark"})
    if (toml.find(each) != std::string::npos)
      found += each.front();
  return found;
}

packed packed_groups(const folder& in, const std::string& smepp) {
  auto x = pack(in.with("groups.toml", with_groups(smepp)), wall(), std::nullopt, {});
  for (const auto& each : x.loaded.problems)
    FAIL(each.message);
  return x;
}

} // namespace

TEST_CASE("a host is sent the keys that its motes use, and no others", "[deploy][SMP-29]") {
  const folder in;
  const auto all = packed_groups(in, all_keys);
  REQUIRE(secrets_in(all.what.toml) == "123abc9r");
  const auto attic = part_of(all, "attic");
  CHECK(secrets_in(attic.toml) == "123a");
  CHECK(secrets_in(part_of(all, "cellar").toml) == "123b");
  CHECK(secrets_in(part_of(all, "shed").toml).empty());
  CHECK(attic.withheld == std::vector<std::string>{"smepp.group.# \"nobody.master_key",
                                                   "smepp.group.alarm.master_key"});
  const auto lines = [](const std::string& x) { return std::ranges::count(x, '\n'); };
  CHECK(lines(attic.toml) == lines(all.what.toml));

  const auto read = load(attic, wall(), {});
  REQUIRE(read.ecology);
  CHECK(config::part_of(*read.ecology, "attic").islands.size() == 1);
  CHECK(read.ecology->smepp.groups[0].master == all.loaded.ecology->smepp.groups[0].master);
  CHECK_FALSE(read.ecology->smepp.groups[1].master == all.loaded.ecology->smepp.groups[1].master);
  CHECK(read.ecology->smepp.network_key == all.loaded.ecology->smepp.network_key);
  CHECK(read.ecology->smepp.pairwise_root == all.loaded.ecology->smepp.pairwise_root);
}

TEST_CASE("who proves senders for nobody is not sent what proves them", "[deploy][SMP-29]") {
  const folder in;
  const auto all = packed_groups(in, all_keys.substr(all_keys.find('\n') + 1));
  CHECK(secrets_in(part_of(all, "attic").toml) == "12a");
}

TEST_CASE("a fault that makes a mote a member brings the key, planned or not at all",
          "[deploy][SMP-29]") {
  const folder in;
  const std::string becomes =
      "[[fault]]\nat = \"10s\"\nkind = \"crash\"\nmote = \"up/watch\"\ntype = \"guard\"\n";
  const auto planned = packed_groups(in, all_keys + becomes);
  CHECK(secrets_in(part_of(planned, "attic").toml) == "123ab");

  const auto all = packed_groups(in, all_keys);
  const auto why = [&](const std::string& host, const std::string& sentence) {
    const auto part = part_of(all, host);
    const auto fault = fault_of(part, sentence, {});
    REQUIRE(std::holds_alternative<config::fault>(fault));
    return lacks(part, *all.loaded.ecology, std::get<config::fault>(fault));
  };
  CHECK(why("attic", "crash mote up/watch type guard")
            .starts_with("it needs `smepp.group.alarm.master_key`, which was not sent"));
  CHECK(why("attic", "crash mote up/watch for 3s").empty());
  CHECK(why("cellar", "crash mote down/lamp type guard").empty());
}

namespace {

using visitor = std::function<void(const std::string& path, const config::key_description& key)>;

void walk(const config::table_description& x, const std::string& path, std::size_t depth,
          const visitor& visit) {
  for (const auto& key : x.keys) {
    visit(path + key.name, key);
    if (key.table && depth > 0)
      walk(*key.table, path + key.name + '.', depth - 1, visit);
  }
  for (const auto& each : x.variants)
    walk(each, path, depth, visit);
}

} // namespace

TEST_CASE("no secret of the schema is sent without need", "[deploy][SMP-29]") {
  constexpr std::size_t depth_max = 8;
  std::set<std::string> secret;
  std::set<std::string> doubtful;
  walk(config::describe_file(), "", depth_max, [&](const auto& path, const auto& key) {
    const bool is_secret = key.schema.find("\"writeOnly\"") != std::string::npos;
    if (is_secret)
      secret.insert(path);
    for (const std::string word :
         {"secret", "password", "token", "credential", "passphrase", "pin", "_key", "_mac"})
      if (!is_secret && key.name.find(word) != std::string::npos)
        doubtful.insert(path);
  });
  INFO("a new one: tell config::secrets_of() which hosts need it, and put it into all_keys");
  CHECK(secret == std::set<std::string>{"smepp.network_key", "smepp.network_mac",
                                        "smepp.pairwise_key", "smepp.group.master_key",
                                        "change.network_key", "change.network_mac"});
  CHECK(doubtful == std::set<std::string>{"mqtt.password_file"}); // which its host reads
  const folder in;
  const auto all = packed_groups(in, all_keys);
  CHECK(all.loaded.seen.secrets.size() == secret.size() + 2); // three groups have a key
}

TEST_CASE("a file that is not there is a problem", "[deploy]") {
  const auto packed = pack("/nowhere/house.toml", {}, std::nullopt, {});
  REQUIRE(packed.loaded.problems.size() == 1);
  CHECK_FALSE(packed.loaded.ecology);
}

TEST_CASE("all hosts on one computer have ports of their own", "[deploy][GEN-05]") {
  const folder in;
  const auto path = in.with("house.toml", house_toml);
  static_cast<void>(in.with("stove.csv", "time,t\n0,20\n"));
  auto packed = pack(path, wall(), std::nullopt, {});
  REQUIRE(packed.loaded.ecology);
  packed.what.places = places_on_one_computer(*packed.loaded.ecology,
                                              [](std::uint16_t port) { return port != 4001; });
  std::set<std::uint16_t> ports;
  for (const auto& place : packed.what.places) {
    CHECK(place.address == "127.0.0.1");
    ports.insert(place.control_port);
    ports.insert(place.peis_port);
  }
  CHECK(ports.size() == 4);
  CHECK_FALSE(ports.contains(4001));
  const auto loaded = load(packed.what, wall(), {});
  REQUIRE(loaded.ecology);
  CHECK(loaded.ecology->hosts[1].listen == "127.0.0.1");
  CHECK(loaded.ecology->hosts[1].networks.empty());
}

TEST_CASE("a bundle holds the file with its settings in place", "[deploy][NFR-07]") {
  const folder files;
  static_cast<void>(files.with("stove.csv", "time,t\n0,20\n"));
  const auto path = files.with("house.toml", house_toml);
  config::overrides instead;
  instead.settings = {"ecology.seed=9", "island.kitchen.mote.stove.type=8"};
  const auto packed = pack(path, instead, std::nullopt, {});
  REQUIRE(packed.loaded.problems.empty());
  CHECK(packed.what.seed == 9);
  const auto loaded = load(packed.what, {}, {});
  REQUIRE(loaded.problems.empty());
  CHECK(loaded.ecology->islands.front().motes.back().type == 8);
  CHECK(hash_of(packed.what) != hash_of(pack(path, {}, std::nullopt, {}).what));
}
