#include "deploy/bundle.hpp"

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

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

const std::string house = R"([ecology]
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
  const auto path = in.with("house.toml", house);
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
  const bundle one{"a.toml", "x", {{"f", "1"}}, {}, {}, 1, 1s};
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

TEST_CASE("a file that is not there is a problem", "[deploy]") {
  const auto packed = pack("/nowhere/house.toml", {}, std::nullopt, {});
  REQUIRE(packed.loaded.problems.size() == 1);
  CHECK_FALSE(packed.loaded.ecology);
}

TEST_CASE("all hosts on one computer have ports of their own", "[deploy][GEN-05]") {
  const folder in;
  const auto path = in.with("house.toml", house);
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
