// The components of an init, in the file and in files of a folder.
#include <map>
#include <string>

#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

const std::string others = "[[peer]]\nname = \"rules\"\nid = 301\n";

/// A peer, called pc, whose init has the keys in line 6, and a peer called rules.
std::string with_init(const std::string& keys) {
  return std::string(head) + "apps = [{ app = \"init\", " + keys + " }]\n" + others;
}

std::string component(const std::string& keys) {
  return with_init("components = [{ " + keys + " }]");
}

std::string in_wall_time(const std::string& toml) {
  return "[ecology]\nname = \"t\"\nmode = \"wall\"\n" + toml.substr(toml.find("[[peer]]"));
}

const init_app& init_of(const ecology_description& x) {
  return std::get<init_app>(x.peers.at(0).apps.at(0));
}

/// A file, and those in its folder `parts`.
loaded load_with(const std::string& toml, const std::map<std::string, std::string>& parts) {
  return load_text(
      toml, "host/t.toml", {},
      [&](const std::string& path, std::size_t) -> file_text {
        const auto found = parts.find(path);
        return found == parts.end() ? file_text{std::nullopt, "is not there"}
                                    : file_text{found->second, {}};
      },
      [&](const std::string& path) -> folder_names {
        folder_names all{std::vector<std::string>{}, {}};
        for (const auto& [name, text] : parts) {
          if (name.starts_with(path + '/'))
            all.names->push_back(name.substr(path.size() + 1));
        }
        return path == "host/parts" ? all : folder_names{std::nullopt, "is not there"};
      });
}

} // namespace

TEST_CASE("a component is a peer of the file", "[config][SVC-02]") {
  const auto x = good(component("name = \"care\", peer = \"rules\", state = \"off\", "
                                "delay = \"5s\", semantics = \"s\", proxy = \"p\""));
  REQUIRE(init_of(x).components.size() == 1);
  const auto& care = init_of(x).components[0];
  CHECK(care.name == "care");
  CHECK(care.peer == "rules");
  CHECK(care.command.empty());
  CHECK(care.id == peer_id{301});
  CHECK_FALSE(care.on);
  CHECK(care.delay == 5s);
  CHECK(care.semantics == "s");
  CHECK(care.proxy == "p");
  CHECK(x.peers.at(1).init == peer_id{300});
  CHECK_FALSE(x.peers.at(0).init);
  CHECK(summary(x).find("init (care)") != std::string::npos);

  const auto like = good(component("name = \"care\", peer = \"rules\""));
  CHECK(init_of(like).components[0].on);
  CHECK(init_of(like).components[0].delay == 3s);
}

TEST_CASE("a component is a command with a PEIS id", "[config][SVC-02]") {
  const auto command = [](const std::string& keys) {
    return init_of(good(in_wall_time(
                       component("name = \"cam\", command = \"cam $PEISINIT\", " + keys))))
        .components.at(0);
  };
  CHECK(command("id = 7").id == peer_id{7});
  CHECK(command("id = 7").command == "cam $PEISINIT");
  CHECK(command("id = \"+5\"").id == peer_id{305});
  CHECK(command("id = 7, arguments = \"--fps 5\"").arguments == "--fps 5");
}

TEST_CASE("what is wrong with components is told", "[config][SVC-02][SVC-06]") {
  const std::string need_wall =
      "`command` needs mode = \"wall\": in virtual time no process can be "
      "started";
  const std::string a_or_b = "a component is either a `peer` or a `command`";
  CHECK(problem_in(with_init("lock = \"l\"")).find("an init needs `components`, a `folder`") !=
        std::string::npos);
  CHECK(problem_in(component("name = \"a\", command = \"x\", id = 7")).find(need_wall) !=
        std::string::npos);
  CHECK(problem_in(component("name = \"a\"")).find(a_or_b) != std::string::npos);
  CHECK(problem_in(component("name = \"a\", peer = \"rules\", command = \"x\"")).find(a_or_b) !=
        std::string::npos);
  const auto wall = [](const std::string& keys) {
    return problem_in(in_wall_time(component(keys)));
  };
  CHECK(wall("name = \"a\", command = \"x\"").find("`id` is missing") != std::string::npos);
  CHECK(wall("name = \"a\", command = \"x\", id = 301").find("PEIS id 301 is already taken") !=
        std::string::npos);
  CHECK(wall("name = \"a\", command = \"x\", id = \"-1\"").find("as in \"+1\"") !=
        std::string::npos);
  CHECK(wall("name = \"a\", command = \"x\", id = \"+65535\"").find("as in \"+1\"") !=
        std::string::npos);
  CHECK(wall("name = \"a\", peer = \"rules\", id = 7").find("has its `id` already") !=
        std::string::npos);
  CHECK(
      wall("name = \"a\", peer = \"rules\", arguments = \"x\"").find("have no effect on a peer") !=
      std::string::npos);
  CHECK(wall("name = \"a\", peer = \"rule\"").find("did you mean `rules`?") != std::string::npos);
  CHECK(wall("name = \"a\", peer = \"pc\"").find("peer `pc` has an init") != std::string::npos);
  CHECK(wall("name = \"a\", peer = \"rules\" }, { name = \"A\", command = \"x\", id = 9")
            .find("component `A` is already there") != std::string::npos);
  CHECK(wall("name = \"a\", peer = \"rules\" }, { name = \"b\", peer = \"rules\"")
            .find("peer `rules` is already a component") != std::string::npos);
}

TEST_CASE("a host has one init", "[config][SVC-06]") {
  const std::string empty = "apps = [{ app = \"init\", components = [] }]\n";
  const std::string hosts = "[[host]]\nname = \"a\"\naddress = \"x\"\n";
  const auto two = [&](const std::string& keys) {
    return std::string(head) + keys + empty + "[[peer]]\nname = \"b\"\nid = 301\n" + keys + empty +
           hosts;
  };
  CHECK(problems_in(two("")).empty()); // each has a computer of its own
  CHECK(problem_in(two("host = \"a\"\n")) ==
        "12:17: host `a` already has an init (line 7, column 17)");
  CHECK(problem_in(in_wall_time(two("tcp = true\n"))).find("this computer already has an init") !=
        std::string::npos);
  CHECK(problem_in(std::string(head) + "count = 2\n" + empty).find("a host has one init, not 2") !=
        std::string::npos);
  CHECK(problem_in(std::string(head) + "apps = [{ app = \"init\", components = [] }, "
                                       "{ app = \"init\", components = [] }]\n")
            .find("already has an init") != std::string::npos);
}

TEST_CASE("components are on the host of their init", "[config][SVC-01]") {
  const std::string hosts =
      "[[host]]\nname = \"a\"\naddress = \"x\"\n[[host]]\nname = \"b\"\naddress = \"y\"\n";
  const auto text = [&](const std::string& own, const std::string& of_component) {
    return std::string(head) + own +
           "apps = [{ app = \"init\", components = [{ name = \"c\", peer = \"rules\" }] }]\n" +
           others + of_component + hosts;
  };
  CHECK(good(text("host = \"a\"\n", "")).peers.at(1).host == "a");
  CHECK(good(text("host = \"a\"\n", "host = \"a\"\n")).peers.at(1).host == "a");
  CHECK(problem_in(text("host = \"a\"\n", "host = \"b\"\n"))
            .find("peer `rules` is on host `b`, and its init is not") != std::string::npos);
  CHECK(problem_in(text("", "host = \"b\"\n")).find("is on host `b`") != std::string::npos);
}

TEST_CASE("each good file of a folder is a component, and the others are left out and told",
          "[config][SVC-02]") {
  const auto x = load_with(
      in_wall_time(with_init("folder = \"parts\", lock = \"l\"")),
      {{"host/parts/arm.toml", "name = \"arm\"\ncommand = \"arm\"\nid = \"+9\"\n"},
       {"host/parts/bad.toml", "name = \"bad\"\ncommand = \"bad\"\nid = 70000\nfast = true\n"},
       {"host/parts/broken.toml", "name = \"broken"},
       {"host/parts/double.toml", "name = \"ARM\"\ncommand = \"arm\"\nid = 8\n"},
       {"host/parts/readme.txt", "not for us"},
       {"host/parts/rules.toml", "name = \"rules\"\npeer = \"rules\"\nstate = \"off\"\n"}});
  REQUIRE(x.ecology);
  const auto& app = init_of(*x.ecology);
  CHECK(app.lock == "host/l");
  REQUIRE(app.components.size() == 2);
  CHECK(app.components[0].name == "arm");
  CHECK(app.components[0].id == peer_id{309});
  CHECK(app.components[1].name == "rules");
  std::vector<std::string> told;
  for (const auto& each : x.skipped)
    told.push_back(to_string(each));
  REQUIRE(told.size() == 4);
  CHECK(told[0].starts_with("host/parts/bad.toml:3:6: `id` must be a PEIS id"));
  CHECK(told[1].starts_with("host/parts/bad.toml:4:1: unknown key `fast`"));
  CHECK(told[2].starts_with("host/parts/broken.toml:1:"));
  CHECK(told[3] == "host/parts/double.toml:1:1: component `ARM` is already there");
}

TEST_CASE("in virtual time files with commands are left out", "[config][SVC-02]") {
  const auto x = load_with(with_init("folder = \"parts\""),
                           {{"host/parts/arm.toml", "name = \"arm\"\ncommand = \"a\"\nid = 9\n"}});
  REQUIRE(x.ecology);
  CHECK(init_of(*x.ecology).components.empty());
  REQUIRE(x.skipped.size() == 1);
  CHECK(x.skipped[0].message.find("needs mode = \"wall\"") != std::string::npos);
}

TEST_CASE("a folder that is not there is a mistake", "[config][SVC-02]") {
  const auto x = load_with(with_init("folder = \"nowhere\""), {});
  REQUIRE(x.problems.size() == 1);
  CHECK(to_string(x.problems[0]) == "host/t.toml:6:34: \"host/nowhere\" is not there");
}
