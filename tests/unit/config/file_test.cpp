#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <unistd.h>

#include "config/load.hpp"
#include "config/run/summary.hpp"
#include "config/toml/document.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using rubicon::test::problem_in;

namespace {

/// A file that is gone after the test.
class scratch_file {
public:
  scratch_file(const std::string& name, const std::string& content)
      : path_(std::filesystem::temp_directory_path() /
              ("rubicon-config-test-" + std::to_string(::getpid()) + '-' + name)) {
    std::ofstream(path_, std::ios::binary) << content;
  }
  scratch_file(const scratch_file&) = delete;
  scratch_file& operator=(const scratch_file&) = delete;
  ~scratch_file() { std::filesystem::remove(path_); }

  [[nodiscard]] std::string path() const { return path_.string(); }

private:
  std::filesystem::path path_;
};

std::string only_problem_of_file(const std::string& path) {
  const auto x = load_file(path);
  CHECK_FALSE(x.ecology);
  REQUIRE(x.problems.size() == 1);
  return to_string(x.problems.front());
}

} // namespace

TEST_CASE("a text without quotes is called that", "[config][GEN-06]") {
  struct row {
    const char* line;
    unsigned column;
    const char* message;
  };
  const auto [line, column, message] = GENERATE(
      row{"name = kitchen", 8, "a text needs quotes: \"kitchen\""},
      row{"duration =  5min # long", 13, "a text needs quotes: \"5min\""},
      row{"name = living room ", 8, "a text needs quotes: \"living room\""},
      row{"seed = 99999999999999999999 # many", 8,
          "a whole number has 64 bits and no zeros in front: \"99999999999999999999\""},
      row{"seed = -9_999_999_999_999_999_999", 8,
          "a whole number has 64 bits and no zeros in front: \"-9_999_999_999_999_999_999\""},
      row{"seed = 007", 8, "a whole number has 64 bits and no zeros in front: \"007\""},
      row{"name = \u2764", 8, "a text needs quotes: \"\u2764\""},
      row{"name = caf\u00e9", 8, "a text needs quotes: \"caf\u00e9\""});
  const auto found = load_text("[ecology]\n" + std::string(line) + "\n", "a.toml").problems;
  REQUIRE(found.size() == 1);
  CHECK(found[0] == problem{"a.toml", 2, column, message});
  // Other mistakes of the syntax are told as such.
  const auto twice = load_text("[ecology]\nseed = 1\nseed = 2\n", "a.toml").problems;
  REQUIRE(twice.size() == 1);
  CHECK(twice[0].message.find("quotes") == std::string::npos);
}

TEST_CASE("a file that cannot be an ecology costs one clear line", "[config][GEN-06]") {
  CHECK(only_problem_of_file("/nowhere/x.toml") ==
        "/nowhere/x.toml: cannot be opened: No such file or directory");
  CHECK(only_problem_of_file(".") == ".: is a directory, not a file");
  const scratch_file empty("empty.toml", "");
  CHECK(only_problem_of_file(empty.path()) ==
        empty.path() + ": is empty; an ecology needs [ecology] and an [[island]] or [[peer]]");
  const scratch_file binary("binary.toml", std::string("\x7f"
                                                       "ELF\0\1",
                                                       6));
  CHECK(only_problem_of_file(binary.path()) ==
        binary.path() + ": is a binary file, not TOML: octet 4 is NUL");
}

TEST_CASE("a good file yields its description, under whatever name", "[config][GEN-04]") {
  const scratch_file file("good.toml", std::string(test::head));
  const auto x = load_file(file.path());
  CHECK(x.problems.empty());
  REQUIRE(x.ecology);
  CHECK(x.ecology->name == "t");
}

TEST_CASE("a file of comments alone lacks everything", "[config][GEN-06]") {
  rubicon::test::check_mistakes("", R"(
# nothing
#< the file has neither an [[island]] nor a [[peer]]
#< the file lacks the table [ecology]
)");
}

TEST_CASE("a syntax error is told with its place", "[config][GEN-06]") {
  struct row {
    const char* toml;
    const char* place;
  };
  const auto x = GENERATE(values<row>({{"a = 1\nb = \n", "2:5: "},
                                       {"a = 1\na = 2\n", "2:5: "},
                                       {"[ecology\n", "1:9: "},
                                       {"[ecology]\nname = \"t\n", "2:10: "},
                                       {"[ecology]\nname = \"\xff\"\n", "2:8: "},
                                       {"[x]\n[x]\n", "2:1: "},
                                       {"[,]\n", "1:2: "},
                                       {"[ #]\n", "1:3: "},
                                       {"\xff\xfe", "1:1: "},
                                       {"a = [[[[[[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]]]]]]", "1:"}}));
  CAPTURE(x.toml);
  const auto found = test::problems_in(x.toml);
  REQUIRE(found.size() == 1);
  CAPTURE(found.front());
  CHECK(found.front().starts_with(x.place));
}

TEST_CASE("limits keep a hostile file from exhausting the parser", "[config]") {
  const auto key_with_dots = [](std::size_t dots) {
    std::string key = "a";
    for (std::size_t i = 0; i < dots; ++i)
      key += i % 2 == 0 ? ".a" : ".\"=,\"";
    return key;
  };
  CHECK(problem_in("\n[" + key_with_dots(200'000) + "]\n")
            .ends_with(": a key has more than 64 dots"));
  CHECK(problem_in("[a]\n" + key_with_dots(65) + " = 1\n").starts_with("2:"));
  CHECK(test::problem_after(test::head, key_with_dots(64) + " = 1\n").find("unknown key `a`") !=
        std::string::npos);
  std::string numbers = "a = [";
  for (int i = 0; i < 2000; ++i)
    numbers += "0.5, ";
  CHECK(test::problem_after(test::head, numbers + "]\n").find("unknown key `a`") !=
        std::string::npos);
  CHECK(problem_in(std::string(file_octets_max + 1, '#')) == " is larger than 16777216 octets");
}

TEST_CASE("characters beyond ASCII stand in strings and comments", "[config][GEN-06]") {
  struct row {
    const char* toml;
    const char* place; ///< of the stray character; nullptr if there is none
  };
  const auto x = GENERATE(values<row>({{"k\u00fcche = 1\n", "6:2: "},
                                       {"[\ufef7]\n", "6:2: "},
                                       {"[\u00e9]\n", "6:2: "},
                                       {"x = 1979-05-\"=\u00e9\n", "6:"},
                                       {"x = \"\u00fc\" \u00fc\n", "6:9: "},
                                       {"x = \"\u00fc\" # \u00fc\n", nullptr},
                                       {"\"\u00fc\" = 1 # \u00fc\n# \u00fc\n", nullptr}}));
  CAPTURE(x.toml);
  const auto found = test::problem_after(test::head, x.toml);
  CAPTURE(found);
  if (x.place == nullptr)
    CHECK(found.starts_with("6:1: unknown key"));
  else
    CHECK((found.starts_with(x.place) && found.find("Error while parsing") != std::string::npos));
}

TEST_CASE("dots in strings, comments and numbers are not dots of a key", "[config]") {
  const std::string dots(100, '.');
  const std::vector<std::string> harmless{"x = \"" + dots + "\"\n",
                                          "x = '" + dots + "\\' # " + dots + "\n",
                                          "x = \"\\\"" + dots + "\\\\\" # " + dots + "\n",
                                          "x = \"\"\"\n" + dots + "\"\"" + dots +
                                              "\\\"\"\"\"\"\" # " + dots + "\n",
                                          "x = '''\n" + dots + "\n''''' # " + dots + "\n",
                                          "x = \"\" # \"\"\" " + dots + "\n# \"" + dots + "\n",
                                          "\"" + dots + "\" = 1.5\n"};
  for (const auto& toml : harmless) {
    CAPTURE(toml);
    CHECK(test::problem_after(test::head, toml).starts_with("6:1: unknown key"));
  }
}

TEST_CASE("a byte order mark is no part of the text", "[config]") {
  CHECK(problem_in("\xef\xbb\xbf" + std::string(test::head)) == "none");
}

TEST_CASE("text that a terminal would act on is made harmless", "[config]") {
  const auto found = test::problem_after(test::head, "\"a\\u001b[2J\" = 1\n");
  CHECK(found.find("unknown key `a\\x1b[2J` in [[peer]]") != std::string::npos);
}

TEST_CASE("a run may end at the first flat battery, if a battery can be flat here",
          "[config][NRG-05]") {
  const auto until = [](const std::string& what, const std::string& rest) {
    return "[ecology]\nname = \"t\"\nuntil = \"" + what + "\"\n" + rest;
  };
  const std::string peer = "[[peer]]\nname = \"pc\"\nid = 300\n";
  const std::string island = "[[island]]\nname = \"k\"\nid = 1\n";
  const std::string mote = "[[island.mote]]\nid = 2\ntype = 7\nposition_m = [1, 2]\n";
  CHECK(test::good(until("duration", peer)).until == run_end::duration);
  const auto x = test::good(until("first_flat_battery", island + mote));
  CHECK(x.until == run_end::first_flat_battery);
  CHECK(summary(x).starts_with("t: until the first flat battery, at most 10 min of virtual time"));
  CHECK(problem_in(until("flat", peer)) ==
        "3:9: `until` must be \"duration\" or \"first_flat_battery\", not \"flat\"");
  const auto no_mote = "3:9: `until = \"first_flat_battery\"` means nothing without a simulated "
                       "mote: no other battery ends";
  CHECK(problem_in(until("first_flat_battery", peer)) == no_mote);
  CHECK(problem_in(until("first_flat_battery", island)) == no_mote);
  CHECK(problem_in(until("first_flat_battery", "mode = \"wall\"\n" + island +
                                                   "serial = { device = \"/dev/ttyUSB0\" }\n")) ==
        no_mote);
  CHECK(problem_in(until("first_flat_battery", island + mote +
                                                   "[[host]]\nname = \"h\"\naddress = "
                                                   "\"127.0.0.1\"\n")) ==
        "3:9: `until = \"first_flat_battery\"` is for a run in one process: the hosts of a file "
        "with [[host]] do not tell each other of batteries");
}
