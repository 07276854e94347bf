#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "radio/medium/tossim_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

gain_table table(std::string_view text) {
  auto x = read_topology(text);
  if (const auto* problem = std::get_if<file_problem>(&x))
    FAIL(problem->line << ": " << problem->message);
  return std::get<gain_table>(x);
}

/// `LINE: MESSAGE`.
template <class Result>
std::string problem(const Result& x) {
  const auto* found = std::get_if<file_problem>(&x);
  return found == nullptr ? "none" : std::to_string(found->line) + ": " + found->message;
}

std::string topology_problem(std::string_view text) {
  return problem(read_topology(text));
}

std::string repeated(std::string_view line, int times) {
  std::string text;
  for (int i = 0; i < times; ++i)
    text += line;
  return text;
}

} // namespace

TEST_CASE("a topology of TOSSIM is read", "[radio][tossim]") {
  const auto x = table("gain\t1\t0\t-95.95\n"
                       "gain 0  1\t -90.80 \n"
                       "# a remark\n"
                       "\n"
                       "  // another\r\n"
                       "noise 1 -107.5 4.0\r\n"
                       "gain 0 65534 +3e1\n"
                       "noise\t0\t-105\t0");
  using gain = gain_table::gain;
  using floor = gain_table::floor;
  CHECK(x.gains == std::vector<gain>{{0, 1, -90.80F}, {0, 65534, 30}, {1, 0, -95.95F}});
  CHECK(x.floors == std::vector<floor>{{0, -105}, {1, -107.5F}});
}

TEST_CASE("a gain needs no noise, and its ends are allowed", "[radio][tossim]") {
  CHECK(table("gain 0 1 -250\ngain 1 0 50").gains.size() == 2);
  CHECK(table("gain 0 1 -250").floors.empty());
}

TEST_CASE("a topology is read as others write theirs", "[radio][tossim]") {
  const auto same = table("gain 0 1 -60\ngain 1 0 -60.5\n");
  for (const auto* text : {
           "0 1 -60\n1 0 -60.5\n",
           "0\t1\t-60\r\n  1  0  -60.5  \r\n",
           "\xef\xbb\xbfgain 0 1 -60\ngain 1 0 -60.5",
           "\xef\xbb\xbf# links\n0 1 -60\n1 0 -60.5",
           "% links of the lab\ngain 0 1 -60\n%\ngain 1 0 -60.5\n",
           "// links\ngain 0 1 -60 // to the window\ngain 1 0 -60.5//back\n",
           "gain 0 1 -60 # to the window\ngain 1 0 -60.5% back\n",
           "0,1,-60\n1, 0, -60.5\n",
           "0;1;-60\n1;0;-60.5;\n",
           "GAIN 0 1 -60\nGain 1 0 -60.5\n",
       }) {
    CAPTURE(text);
    CHECK(table(text) == same);
  }
  CHECK(table("0 1 -60\nNoise 0 -105 4\n").floors == std::vector<gain_table::floor>{{0, -105}});
  const auto trace = read_noise_trace("\xef\xbb\xbf-39 % loud\n" + repeated("-98 # quiet\n", 99));
  CHECK(problem(trace) == "none");
}

TEST_CASE("mistakes in a topology are reported with their line", "[radio][tossim]") {
  using row = std::pair<std::string, std::string>;
  for (const auto& [text, expected] : {
           row{"", "0: there is no gain in it"},
           row{"# gain 0 1 -5\n", "0: there is no gain in it"},
           row{"noise 0 -98 1\n", "0: there is no gain in it"},
           row{"\n\ngian 0 1 -5",
               R"(3: a line begins with gain, noise or, as in 0 1 -60.0, a node, not "gian")"},
           row{"from,to,gain", // as heads of tables are
               R"(1: a line begins with gain, noise or, as in 0 1 -60.0, a node, not "from")"},
           row{"0 1", R"(1: gain needs two nodes and a number of dB, not "0 1")"},
           row{"0 1 -5 6", R"(1: gain needs two nodes and a number of dB, not "0 1 -5 6")"},
           row{"0 1 -5 6 7", R"(1: gain needs two nodes and a number of dB, not "0 1 -5 6 7")"},
           row{"0 x -5", R"(1: gain needs nodes of 0 to 65534, not "x")"},
           row{"-1 0 -5", R"(1: gain needs nodes of 0 to 65534, not "-1")"},
           row{"gain 0 1", R"(1: gain needs two nodes and a number of dB, not "0 1")"},
           row{"gain", R"(1: gain needs two nodes and a number of dB, not "")"},
           row{"gain 0 1 -5 6", R"(1: gain needs two nodes and a number of dB, not "0 1 -5 6")"},
           row{"gain 0 1 -5 6 7 8",
               R"(1: gain needs two nodes and a number of dB, not "0 1 -5 6 7 8")"},
           row{"gain 65535 1 -5", R"(1: gain needs nodes of 0 to 65534, not "65535")"},
           row{"gain 0 99999 -5", R"(1: gain needs nodes of 0 to 65534, not "99999")"},
           row{"gain 0 -1 -5", R"(1: gain needs nodes of 0 to 65534, not "-1")"},
           row{"gain 0 1.0 -5", R"(1: gain needs nodes of 0 to 65534, not "1.0")"},
           row{"gain 0 1 x", R"(1: gain needs -250 to 50 dB, not "x")"},
           row{"gain 0 1 -5dB", R"(1: gain needs -250 to 50 dB, not "-5dB")"},
           row{"gain 0 1 nan", R"(1: gain needs -250 to 50 dB, not "nan")"},
           row{"gain 0 1 -inf", R"(1: gain needs -250 to 50 dB, not "-inf")"},
           row{"gain 0 1 1e999", R"(1: gain needs -250 to 50 dB, not "1e999")"},
           row{"gain 0 1 +-5", R"(1: gain needs -250 to 50 dB, not "+-5")"},
           row{"gain 0 1 +", R"(1: gain needs -250 to 50 dB, not "+")"},
           row{"gain 0 1 0x1", R"(1: gain needs -250 to 50 dB, not "0x1")"},
           row{"gain 0 1 -250.1", R"(1: gain needs -250 to 50 dB, not "-250.1")"},
           row{"gain 0 1 50.1", R"(1: gain needs -250 to 50 dB, not "50.1")"},
           row{"gain 7 7 -5", "1: gain needs two nodes, not 7 twice"},
           row{"noise 0 -98", R"(1: noise needs a node, a floor and a deviation, not "0 -98")"},
           row{"noise x -98 1", R"(1: noise needs a node of 0 to 65534, not "x")"},
           row{"noise 0 -251 1", R"(1: noise needs a floor of -250 to 50 dBm, not "-251")"},
           row{"noise 0 -98 y", R"(1: noise needs a deviation in dB, not "y")"},
           row{"noise 0 -98 inf", R"(1: noise needs a deviation in dB, not "inf")"},
       })
    CHECK(topology_problem(text) == expected);
}

TEST_CASE("what is given twice is reported where it is given again", "[radio][tossim]") {
  CHECK(topology_problem("gain 0 1 -5\ngain 1 0 -5\n\ngain 0 1 -6\ngain 1 0 -5\n") ==
        "4: the gain from 0 to 1 is given in line 1 already");
  CHECK(topology_problem("gain 0 1 -5\nnoise 3 -98 1\nnoise 3 -98 1\n") ==
        "3: the noise of 3 is given in line 2 already");
  CHECK(topology_problem("gain 9 8 -5\ngain 9 8 -5\ngain 9 8 -5\n") ==
        "2: the gain from 9 to 8 is given in line 1 already");
}

TEST_CASE("the first mistake of a topology is reported, of whichever kind", "[radio][tossim]") {
  CHECK(topology_problem("gain 0 1 -5\ngain 0 1 -5\nrubbish\n").substr(0, 2) == "2:");
  CHECK(topology_problem("gain 0 1 -5\nrubbish\ngain 0 1 -5\n").substr(0, 2) == "2:");
  CHECK(topology_problem("noise 0 1 1\nnoise 0 1 1\ngain 0 1 -5\ngain 0 1 -5\n").substr(0, 2) ==
        "2:");
  CHECK(topology_problem("gain 0 1 -5\ngain 0 1 -5\nnoise 0 1 1\nnoise 0 1 1\n").substr(0, 2) ==
        "2:");
}

TEST_CASE("a quoted text is short and plain", "[radio][tossim]") {
  CHECK(topology_problem("a\x01\x7f\xc3\xa4\"z") ==
        "1: a line begins with gain, noise or, as in 0 1 -60.0, a node, not \"a????\"z\"");
  CHECK(topology_problem(std::string(1000, 'q')) ==
        "1: a line begins with gain, noise or, as in 0 1 -60.0, a node, not \"" +
            std::string(40, 'q') + '"');
  CHECK(topology_problem(std::string("gain 0 1 \0", 10)) ==
        "1: gain needs -250 to 50 dB, not \"?\"");
}

TEST_CASE("a noise trace of TOSSIM is read", "[radio][tossim]") {
  const auto x =
      read_noise_trace("# a remark\n -39\n-98.2\r\n\n+3\n-128\n127.9\n" + repeated("-98\n", 95));
  REQUIRE(problem(x) == "none");
  const auto& readings = std::get<std::shared_ptr<const noise_trace>>(x)->readings();
  REQUIRE(readings.size() == 100);
  CHECK(std::vector<int>(readings.begin(), readings.begin() + 6) ==
        std::vector<int>{-39, -99, 3, -128, 127, -98});
}

TEST_CASE("mistakes in a noise trace are reported with their line", "[radio][tossim]") {
  const auto problem_of = [](std::string_view text) { return problem(read_noise_trace(text)); };
  CHECK(problem_of("") == "0: it has 0 readings, at least 100 are needed");
  CHECK(problem_of(repeated("-98\n", 99)) == "0: it has 99 readings, at least 100 are needed");
  CHECK(problem_of(repeated("-98\n", 100)) == "none");
  CHECK(problem_of("-98\n\n-98 -97\n") ==
        R"(3: a line is one reading of -128 to 127 dBm, not "-98 -97")");
  CHECK(problem_of("-128.5") == R"(1: a line is one reading of -128 to 127 dBm, not "-128.5")");
  CHECK(problem_of("128") == R"(1: a line is one reading of -128 to 127 dBm, not "128")");
  CHECK(problem_of("nan") == R"(1: a line is one reading of -128 to 127 dBm, not "nan")");
  CHECK(problem_of("-98,") == R"(1: a line is one reading of -128 to 127 dBm, not "-98,")");
}

TEST_CASE("files beyond the limits are refused", "[radio][tossim]") {
  const auto count = static_cast<int>(noise_trace::readings_max);
  CHECK(problem(read_noise_trace(repeated("1\n", count + 1))) ==
        "4194305: more than 4194304 readings");
  const std::string big(tossim_file_octets_max + 1, '\n');
  CHECK(topology_problem(big) == "0: it has 268435457 octets, more than 268435456");
  CHECK(problem(read_noise_trace(big)) == "0: it has 268435457 octets, more than 268435456");
}
