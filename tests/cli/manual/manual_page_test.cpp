#include <fstream>
#include <string>

#include "cli/manual/manual_page.hpp"
#include "cli/manual/roff.hpp"
#include "cli/options/parse_command_line.hpp"
#include "config/load.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "support/shell.hpp"

using namespace rubicon;
using namespace rubicon::cli;
using rubicon::test::scratch_folder;
using rubicon::test::shell;

namespace {

std::vector<manual_page> pages() {
  return manual_pages(describe_commands(), config::describe_file(), {"2026-11-28", "0.1.0"});
}

std::string page(const std::string& file) {
  for (auto& each : pages())
    if (each.file == file)
      return each.text;
  return {};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

bool is_installed(const std::string& program) {
  return shell("command -v " + program + " >/dev/null").status == 0;
}

} // namespace

TEST_CASE("each command has a page, and the file one", "[cli][docs]") {
  CHECK(contains(page("rubicon.1"), ".BR rubicon\\-tuples (1)\n"));
  CHECK(contains(page("rubicon-run.1"),
                 ".TP\n\\fB\\-\\-seed\\fR \\fIN\\fR\nSeed of all random numbers\n"));
  CHECK(contains(page("rubicon-run.1"), "(needs \\-\\-csv)"));
  CHECK_FALSE(contains(page("rubicon-run.1"), "part\\-report")); // not for users
  CHECK(contains(page("rubicon-tuples.1"), ".SS \"rubicon tuples set\"\n"));
  CHECK(contains(page("rubicon.toml.5"), ".SS \"[island.duty_cycle]\"\n.TP\n\\fBperiod\\fR\n"));
  for (const auto& command : describe_commands().commands)
    CHECK_FALSE(page("rubicon-" + command.name('-') + ".1").empty());
}

TEST_CASE("texts are no requests, and their characters stay", "[cli]") {
  CHECK(roff::filled(".TH is a request") == "\\&.TH is a request\n");
  CHECK(roff::filled("'it' a\\b -c") == "\\(aqit\\(aq a\\eb \\-c\n");
  CHECK(roff::literal("  a\n.b") == ".nf\n  a\n\\&.b\n.fi\n");
  CHECK(roff::filled("").empty());
  CHECK(roff::quoted("a \"b\"") == "\"a \\(dqb\\(dq\"");
  const auto lines = roff::filled(std::string(60, 'a') + ' ' + std::string(30, 'b'));
  CHECK(lines == std::string(60, 'a') + '\n' + std::string(30, 'b') + '\n');
}

TEST_CASE("mandoc and groff have no warnings of any page", "[cli][docs]") {
  const scratch_folder folder;
  for (const auto& each : pages())
    std::ofstream(folder.file(each.file)) << each.text;
  if (is_installed("mandoc")) {
    const auto x =
        shell("cd '" + folder.path.string() + "' && mandoc -Tlint -Wwarning *.1 *.5 2>&1");
    CHECK(x.out.empty());
    CHECK(x.status == 0);
  }
  if (is_installed("groff")) {
    const auto x = shell("cd '" + folder.path.string() +
                         "' && for x in *.1 *.5; do groff -man -ww -z -Tutf8 $x 2>&1; done");
    CHECK(x.out.empty());
  }
}
