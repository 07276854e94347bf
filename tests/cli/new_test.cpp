// A file to begin with, the help for keys, and what packages install, as a user meets them.
#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/shell.hpp"

using rubicon::test::outcome;
using rubicon::test::scratch_folder;
using rubicon::test::shell;

namespace {

outcome rubicon_in(const scratch_folder& folder, const std::string& arguments) {
  return shell("cd '" + folder.path.string() + "' && '" RUBICON_BINARY "' " + arguments + " 2>&1");
}

std::string content(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

constexpr std::array templates{"home", "office", "grid", "sensors", "robots"};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("each template passes the check and runs", "[cli]") {
  const scratch_folder folder;
  for (const std::string name : templates) {
    CAPTURE(name);
    const auto made = rubicon_in(folder, "new " + name);
    CHECK(made.status == 0);
    CHECK(made.out == "wrote " + name + ".toml\nNext: rubicon run " + name + ".toml\n");
    CHECK(rubicon_in(folder, "check --strict " + name + ".toml").status == 0);
    CHECK(rubicon_in(folder, "run --strict " + name + ".toml").status == 0);
  }
}

TEST_CASE("each line of a template is explained, and the first one is listed", "[cli]") {
  const scratch_folder folder;
  for (const std::string name : templates) {
    CAPTURE(name);
    std::istringstream lines(rubicon_in(folder, "new " + name + " -").out);
    std::string line;
    REQUIRE(std::getline(lines, line));
    REQUIRE(line.starts_with("# " + name + ": "));
    CHECK(contains(rubicon_in(folder, "new").out, "  " + line.substr(name.size() + 4) + '\n'));
    for (int number = 2; std::getline(lines, line); ++number) {
      CAPTURE(number, line);
      CHECK((line.empty() || line.starts_with(']') || contains(line, "#")));
    }
  }
}

TEST_CASE("a file is overwritten only if that was asked for", "[cli]") {
  const scratch_folder folder;
  std::ofstream(folder.file("mine.toml")) << "mine";
  const auto refused = rubicon_in(folder, "new home mine.toml");
  CHECK(refused.status == 2);
  CHECK(refused.out == "rubicon: mine.toml exists already; --force overwrites it\n");
  CHECK(content(folder.file("mine.toml")) == "mine");
  CHECK(rubicon_in(folder, "new home mine.toml --force").status == 0);
  CHECK(content(folder.file("mine.toml")).starts_with("# home: "));
  CHECK(contains(rubicon_in(folder, "new home 'my home.toml'").out, "rubicon run 'my home.toml'"));
  CHECK(rubicon_in(folder, "new home -").out == content(folder.file("mine.toml")));
  CHECK(rubicon_in(folder, "new home no/such/folder.toml").status == 2);
}

TEST_CASE("templates are listed, and the nearest one is suggested", "[cli]") {
  const scratch_folder folder;
  const auto all = rubicon_in(folder, "new");
  CHECK(all.status == 0);
  CHECK(contains(all.out, "\n  grid     24 motes"));
  const auto unknown = rubicon_in(folder, "new hom");
  CHECK(unknown.status == 2);
  CHECK(contains(unknown.out, "there is no template `hom`: did you mean `home`?"));
  CHECK(contains(all.out, "\n  --lua DIR       a mote"));
  const auto program = rubicon_in(folder, "new firmware");
  CHECK(program.status == 2);
  CHECK(contains(program.out, "rubicon new --firmware DIR"));
  CHECK(std::filesystem::is_empty(folder.path));
}

TEST_CASE("check explains a key without a file", "[cli][ACT-13]") {
  const scratch_folder folder;
  const auto x = rubicon_in(folder, "check --explain duty_cycle.period");
  CHECK(x.status == 0);
  CHECK(contains(x.out, "period = \"4s\""));
  const auto unknown = rubicon_in(folder, "check --explain duty_cicle");
  CHECK(unknown.status == 2);
  CHECK(contains(unknown.out, "did you mean `duty_cycle`?"));
  CHECK(rubicon_in(folder, "check").status == 2);
  CHECK(rubicon_in(folder, "check a.toml --explain seed").status == 2);
}

TEST_CASE("the binary writes its pages and completions", "[cli]") {
  const scratch_folder folder;
  CHECK(rubicon_in(folder, "help --pages . --date 2026-11-28").status == 0);
  CHECK(contains(content(folder.file("rubicon-run.1")), ".TH \"RUBICON\\-RUN\" 1 "));
  CHECK(contains(content(folder.file("rubicon.toml.5")), "2026"));
  CHECK(rubicon_in(folder, "help --pages no/folder").status == 2);
  CHECK(contains(rubicon_in(folder, "completion bash").out, "complete -o filenames -F _rubicon"));
  CHECK(rubicon_in(folder, "completion csh").status == 2);
  CHECK(rubicon_in(folder, "completion").status == 2);
}

TEST_CASE("what a run does with another file is shown beforehand", "[cli][ACT-10]") {
  const scratch_folder folder;
  REQUIRE(rubicon_in(folder, "new home old.toml").status == 0);
  auto text = content((folder.path / "old.toml").string());
  std::ofstream(folder.path / "new.toml")
      << text << "[[change]]\nat = \"1min\"\nkind = \"debug\"\nof = []\n";
  const auto same = rubicon_in(folder, "check old.toml --changes-from old.toml");
  CHECK(same.status == 0);
  CHECK(same.out == "nothing changes\n");
  const auto planned = rubicon_in(folder, "check new.toml --changes-from old.toml");
  CHECK(planned.status == 0);
  CHECK(contains(planned.out, "1 min  debug of no actors\n"));
  const auto refused = rubicon_in(folder, "check old.toml --changes-from new.toml");
  CHECK(refused.status == 2);
  CHECK(contains(refused.out, "was removed from the file"));
  for (const auto* words : {"check new.toml --changes-from - < old.toml",
                            "check - --changes-from old.toml < new.toml"}) {
    const auto read = rubicon_in(folder, words);
    CHECK(read.status == 0);
    CHECK(read.out == planned.out);
  }
  const auto lost = rubicon_in(folder, "check - --changes-from new.toml < old.toml");
  CHECK(contains(lost.out, "<stdin>:"));
}

TEST_CASE("firmware to begin with is built by make and floods over five hops", "[cli]") {
  const scratch_folder folder;
  const auto made = rubicon_in(folder, "new --firmware \"my motes\"");
  CHECK(made.status == 0);
  CHECK(made.out == "wrote flood.c, Makefile, flood.toml and rubicon_mote.h in my motes\n"
                    "Next: make -C 'my motes' && rubicon run 'my motes/flood.toml'\n");
  CHECK(contains(rubicon_in(folder, "check 'my motes/flood.toml'").out, "flood.so"));
  REQUIRE(shell("make -s -C '" + folder.path.string() + "/my motes' 2>&1").status == 0);
  CHECK(rubicon_in(folder, "run --strict 'my motes/flood.toml'").status == 0);
  CHECK(rubicon_in(folder, "new --firmware 'my motes'").status != 0); // the files exist
  CHECK(rubicon_in(folder, "new --force --firmware 'my motes'").status == 0);
}

TEST_CASE("a program in Lua to begin with runs, and its script is judged with the file", "[cli]") {
  const scratch_folder folder;
  const auto made = rubicon_in(folder, "new --lua \"my fan\"");
  CHECK(made.status == 0);
  CHECK(made.out == "wrote fan.lua and fan.toml in my fan\n"
                    "Next: rubicon run 'my fan/fan.toml'\n");
  CHECK(rubicon_in(folder, "check --strict 'my fan/fan.toml'").status == 0);
  CHECK(rubicon_in(folder, "run --strict 'my fan/fan.toml'").status == 0); // it expects the fan on
  CHECK(rubicon_in(folder, "new --lua 'my fan'").status != 0);             // the files exist
  CHECK(rubicon_in(folder, "new --lua a --firmware b").status != 0);
  std::ofstream(folder.file("my fan/fan.lua")) << "local is_on = false\nif is_on\n";
  const auto wrong = rubicon_in(folder, "check 'my fan/fan.toml'");
  CHECK(wrong.status == 2);
  CHECK(contains(wrong.out, "fan.lua:"));
}

TEST_CASE("a study in Python to begin with finds a window", "[cli]") {
  const scratch_folder folder;
  const auto made = rubicon_in(folder, "new --python 'my study'");
  CHECK(made.status == 0);
  const std::string before =
      "wrote window.py, distance.py, environment.py, test_room.py and room.toml "
      "in my study\nNext: ";
  REQUIRE(made.out.starts_with(before));
  CHECK(made.out.ends_with(" python3 'my study/window.py'\n"));
  CHECK(rubicon_in(folder, "check --strict 'my study/room.toml'").status == 0);
  CHECK(rubicon_in(folder, "new --python a --lua b").status != 0);
  auto next = made.out.substr(before.size()); // as printed: it finds the package and the binary
  next.pop_back();
  const auto found = shell("cd '" + folder.path.string() + "' && " + next + " 2 2>&1");
  CHECK(found.status == 0);
  CHECK(contains(found.out, "the shortest window with 99%: "));
  CHECK(!contains(found.out, "none of these"));
}
