#include <fstream>
#include <string>

#include "cli/manual/completion.hpp"
#include "cli/options/parse_command_line.hpp"
#include "core/text/shell_word.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/shell.hpp"

using namespace rubicon;
using namespace rubicon::cli;
using rubicon::test::scratch_folder;
using rubicon::test::shell;

namespace {

/// What bash completes a line with, sorted, one a line; each word is one of bash.
std::string completed(const scratch_folder& folder, const std::string& words) {
  std::ofstream(folder.file("rubicon.bash")) << completion_script(describe_commands(), "bash");
  std::ofstream(folder.file("question"))
      << "source ./rubicon.bash\n"
         "COMP_WORDS=(rubicon " +
             words +
             ")\n"
             "COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n"
             "_rubicon\n"
             "printf '%s\\n' \"${COMPREPLY[@]}\" | LC_ALL=C sort\n";
  const auto x =
      shell("cd " + shell_word(folder.path.string()) + " && bash --norc --noprofile question 2>&1");
  CHECK(x.status == 0);
  return x.out;
}

bool has_line(const std::string& text, const std::string& line) {
  return ('\n' + text).find('\n' + line + '\n') != std::string::npos;
}

} // namespace

TEST_CASE("bash completes commands, and those below them", "[cli]") {
  const scratch_folder folder;
  CHECK(completed(folder, "ch") == "check\n");
  CHECK(has_line(completed(folder, "''"), "run"));
  CHECK(completed(folder, "tuples wa") == "wait\nwatch\n");
  CHECK(has_line(completed(folder, "tuples ''"), "set"));
}

TEST_CASE("bash completes options of the command that was given", "[cli]") {
  const scratch_folder folder;
  CHECK(completed(folder, "run --check-d") == "--check-determinism\n");
  CHECK(completed(folder, "run --part-r") == "\n"); // not for users
  CHECK(completed(folder, "check --check-d") == "\n");
  CHECK(has_line(completed(folder, "tuples set --"), "--wait"));
  CHECK_FALSE(has_line(completed(folder, "tuples get --"), "--wait"));
}

TEST_CASE("bash completes words of options, also after =", "[cli]") {
  const scratch_folder folder;
  CHECK(completed(folder, "run x.toml --mode ''") == "virtual\nwall\n");
  CHECK(completed(folder, "run --mode = w") == "wall\n"); // bash divides words at =
  CHECK(completed(folder, "run --mode =") == "virtual\nwall\n");
  CHECK(completed(folder, "run --for ''") == "\n");
  CHECK(completed(folder, "run --control = k") == "kernel\n");
  CHECK(completed(folder, "run --control k") == "\n"); // another argument
  CHECK(completed(folder, "completion z") == "zsh\n");
}

TEST_CASE("bash completes files, and folders where only these fit", "[cli]") {
  const scratch_folder folder;
  std::ofstream(folder.file("a home.toml")) << "";
  std::ofstream(folder.file("home.toml")) << "";
  CHECK(shell("mkdir " + shell_word(folder.file("house"))).status == 0);
  CHECK(completed(folder, "run ho") == "home.toml\nhouse\n");
  CHECK(completed(folder, "run home.toml --csv ho") == "house\n");
  CHECK(completed(folder, "run home.toml --report ho") == "home.toml\nhouse\n");
  CHECK(completed(folder, "run a") == "a home.toml\n");
}

TEST_CASE("zsh and fish have a script with the same commands and options", "[cli]") {
  const auto all = describe_commands();
  const auto zsh = completion_script(all, "zsh");
  const auto fish = completion_script(all, "fish");
  CHECK(zsh.starts_with("#compdef rubicon\n"));
  for (const auto& command : all.commands) {
    CAPTURE(command.name());
    CHECK(zsh.find("_rubicon_" + command.name('_') + "() {") != std::string::npos);
    CHECK(fish.find(" -a " + command.name() + " -d ") != std::string::npos);
    for (const auto& option : command.options) {
      CHECK(zsh.find(option.names.front() + (option.value.empty() ? "[" : "=")) !=
            std::string::npos);
      CHECK(fish.find(" -l " + option.names.front().substr(2) + ' ') != std::string::npos);
    }
  }
  CHECK(completion_script(all, "csh").empty());
  const scratch_folder folder;
  std::ofstream(folder.file("_rubicon")) << zsh;
  std::ofstream(folder.file("rubicon.fish")) << fish;
  for (const auto& command :
       {"command -v zsh >/dev/null && ! zsh -n " + folder.file("_rubicon"),
        "command -v fish >/dev/null && ! fish -n " + folder.file("rubicon.fish")})
    CHECK(shell(command).status != 0); // the shell is not installed, or has nothing to say
}

TEST_CASE("descriptions have what the help has", "[cli]") {
  const auto all = describe_commands();
  const auto& run = all.commands.front();
  REQUIRE(run.name() == "run");
  REQUIRE(run.arguments.size() == 1);
  CHECK(run.arguments.front().names.front() == "FILE");
  CHECK(run.arguments.front().is_required);
  CHECK(run.arguments.front().with == completes::files);
  const auto find = [&run](const std::string& name) {
    for (const auto& each : run.options)
      if (each.names.front() == name)
        return each;
    return option_description{};
  };
  CHECK(find("--mode").value == "MODE");
  CHECK(find("--mode").words == std::vector<std::string>{"virtual", "wall"});
  CHECK(find("--threads").range == "1 to 256");
  CHECK(find("--json").value.empty());
  CHECK(find("--json").excludes == std::vector<std::string>{"--brief", "--full"});
  CHECK(find("--csv-every").needs == std::vector<std::string>{"--csv"});
  CHECK(find("--view").has_optional_value);
  CHECK(find("--control").words == std::vector<std::string>{"kernel"});
  CHECK(find("--bundled").names.empty()); // not for users
}
