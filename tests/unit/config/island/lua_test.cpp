// Programs in Lua, in files.
#include <map>
#include <string>

#include "apps/application.hpp"
#include "apps/tables.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

const std::map<std::string, std::string> lua_scripts{
    {"lab/fan.lua", "function joined() end\n"},
    {"lab/broken.lua", "local x = 1\n\nif x then\n"},
};

file_text read_lua_script(const std::string& path, std::size_t /*octets_max*/) {
  return text_in(lua_scripts, path);
}

loaded load_scripted(const std::string& apps) {
  return load_text(mote_head + "apps = [" + apps + "]\n", "lab/x.toml", {}, read_lua_script);
}

std::string problem_of_script(const std::string& keys) {
  return problems_of(load_scripted("{ app = \"lua\", " + keys + " }"));
}

} // namespace

TEST_CASE("a program in Lua has its script from a file beside the TOML file", "[config][PAR-05]") {
  const auto x = load_scripted("{ app = \"lua\", script = \"fan.lua\", streams = 9, memory = 5000, "
                               "instructions = 2000, settings = { on_at = 25.5 } }");
  CAPTURE(problems_of(x));
  REQUIRE(x.ecology);
  const auto& app = std::get<apps::app_config>(x.ecology->islands.at(0).motes.at(0).apps.at(0));
  CHECK(kind_of(app) == "lua");
  CHECK(apps::ends_max(4, {app}) == 9);
  CHECK(apps::make_application(app, random_stream(1)) != nullptr);
  const auto beside = load_scripted("{ app = \"lua\", script = \"fan.lua\", place = \"actor\" }");
  REQUIRE(beside.ecology);
  CHECK(std::holds_alternative<separate_app>(beside.ecology->islands.at(0).motes.at(0).apps.at(0)));
}

TEST_CASE("gateways and peers have programs in Lua too", "[config][PAR-05]") {
  const auto x = load_text(std::string(island_head) +
                               "gateway.apps = [{ app = \"lua\", script = \"fan.lua\" }]\n",
                           "lab/x.toml", {}, read_lua_script);
  CAPTURE(problems_of(x));
  REQUIRE(x.ecology);
  CHECK(x.ecology->islands.at(0).gateway_apps.size() == 1);
}

TEST_CASE("what is wrong with a script has its place in the script, once", "[config][ACT-13]") {
  CHECK(problem_of_script("script = \"broken.lua\"") ==
        "lab/broken.lua:4: 'end' expected (to close 'if' at line 3) near <eof>");
  const auto twice = load_scripted("{ app = \"lua\", script = \"broken.lua\" }, "
                                   "{ app = \"lua\", script = \"broken.lua\" }");
  CHECK(twice.problems.size() == 1);
  CHECK(problem_of_script("script = \"none.lua\"").find("lab/x.toml:19:") == 0);
  CHECK(problem_of_script("memory = 5000").find("`script`") != std::string::npos);
  CHECK(problem_of_script("script = \"fan.lua\", memory = 100").find("`memory`") !=
        std::string::npos);
  CHECK(problem_of_script("script = \"fan.lua\", settings = { a = \"b\" }").find("`a`") !=
        std::string::npos);
}
