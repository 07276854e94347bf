// What `rubicon compare` says of two sets of runs, and of two records.
#include <sstream>
#include <string>
#include <vector>

#include "cli/study/compare_records.hpp"
#include "cli/study/compare_text.hpp"
#include "cli/study/result_runs.hpp"
#include "cli/study/shrink_command.hpp"
#include "explain/record.hpp"
#include "support/catch.hpp"
#include "support/text.hpp"

using namespace rubicon;
using namespace rubicon::cli;
using rubicon::test::contains;

namespace {

shown_comparison two_figures() {
  const std::vector<double> a(10, 100);
  std::vector<double> lower(10, 80);
  lower[3] = 79;
  auto unsure = a;
  unsure[0] = 101;
  return {
      "a.toml", "b.toml", 10, 1,
      study::compare({{"", "delivery", a, lower}, {"", "events", a, unsure}, {"", "same", a, a}})};
}

std::string record_of(std::uint64_t seed, const std::vector<explain::record>& all) {
  explain::header about;
  about.ecology = "room";
  about.seed = seed;
  auto text = encode(about);
  for (const auto& each : all)
    text += encode(each);
  return text;
}

explain::record frame(std::uint64_t number, std::uint32_t count) {
  explain::record x;
  x.number = number;
  x.time = instant(number * 1s);
  x.what = explain::kind::radio_done;
  x.from = "air/room";
  x.to = "mote/room/meter";
  x.count = count;
  return x;
}

record_difference compared(const std::string& a, const std::string& b) {
  std::istringstream in_a(a);
  std::istringstream in_b(b);
  return compare_records(in_a, "a.rec", in_b, "b.rec");
}

} // namespace

TEST_CASE("a comparison says what differs, and how sure that is", "[cli]") {
  const auto text = comparison_text(two_figures(), false, 200, false);
  CAPTURE(text);
  CHECK(
      text.starts_with("A: a.toml\nB: b.toml\n10 pairs of runs (1 run of only one side left out), "
                       "3 numbers compared: 2 numbers not equal in all pairs, of which 1 differ"));
  CHECK(contains(text, "corrected (Holm) for 2 comparisons"));
  CHECK(text.find("delivery") < text.find("events"));
  CHECK(contains(text, "-20.1 %"));
  CHECK(!contains(text, "same"));
}

TEST_CASE("a comparison as CSV has a line for each number that differs", "[cli]") {
  const auto text = comparison_csv(two_figures().found);
  CAPTURE(text);
  CHECK(text.starts_with(
      "scalar,variant,runs,a,b,difference,low,high,relative,p,sure\ndelivery,,10,100,79."));
  CHECK(contains(text, ",1\nevents,,10,100,100.1"));
  CHECK(text.ends_with(",0\n"));
}

TEST_CASE("runs that are equal in all pairs have no table", "[cli]") {
  auto x = two_figures();
  x.found = study::compare({{"", "same", {1, 2}, {1, 2}}});
  x.single = 0;
  CHECK(comparison_text(x, true, 100, false) == "A: a.toml\nB: b.toml\n10 pairs of runs, 1 number "
                                                "compared: all are equal in all pairs\n");
}

TEST_CASE("two records part at the first record that differs", "[cli][explain]") {
  const auto a = record_of(1, {frame(1, 1), frame(2, 1), frame(3, 1)});
  const auto same = compared(a, a);
  CHECK(!same.differs);
  CHECK(same.equal == 3);
  CHECK(contains(same.text, "All 3 records are equal."));
  const auto x = compared(a, record_of(1, {frame(1, 1), frame(2, 4), frame(3, 1)}));
  CAPTURE(x.text);
  CHECK(x.differs);
  CHECK(x.equal == 1);
  CHECK(contains(x.text, "They part after 1 equal record:\n"));
  CHECK(contains(x.text, "radio_done air/room -> mote/room/meter (2)\n"));
  CHECK(contains(x.text, "  count: 1 / 4\n"));
  CHECK(!contains(x.text, "different seeds"));
}

TEST_CASE("where only numbers differ what follows is searched", "[cli][explain]") {
  const auto a = record_of(1, {frame(1, 1), frame(2, 1), frame(3, 1), frame(4, 1)});
  auto second = frame(2, 1);
  second.number = 7;
  const auto x = compared(a, record_of(1, {frame(1, 1), second, frame(3, 1), frame(4, 9)}));
  CAPTURE(x.text);
  CHECK(contains(x.text, "They part after 1 equal record:\n"));
  CHECK(contains(x.text, "  number: 2 / 7\nOnly numbers differ in 2 records"));
  CHECK(x.text.ends_with("  count: 1 / 9\n"));
  const auto y = compared(a, record_of(1, {frame(1, 1), second, frame(3, 1), frame(4, 1)}));
  CHECK(y.text.ends_with("Up to the end only numbers differ.\n"));
}

TEST_CASE("one record may end before the other", "[cli][explain]") {
  const auto x = compared(record_of(1, {frame(1, 1), frame(2, 1)}), record_of(2, {frame(1, 1)}));
  CAPTURE(x.text);
  CHECK(x.differs);
  CHECK(contains(x.text, "They are of different seeds."));
  CHECK(contains(x.text, "\nB: ends\n"));
}

TEST_CASE("what is no record is refused with its line", "[cli][explain]") {
  const auto good = record_of(1, {frame(1, 1)});
  CHECK(contains(compared("", good).problem, "a.rec:"));
  CHECK(contains(compared(good, "{}\n").problem, "b.rec:1: "));
  CHECK(contains(compared(good, good + "nonsense\n").problem, "b.rec:3: "));
}

TEST_CASE("progress of a study has a speed once a run has ended", "[cli]") {
  CHECK(study_progress(0, 8, 1s, 80) == "0 of 8 runs");
  CHECK(study_progress(2, 8, 4s, 80) == "2 of 8 runs  25%  0.5 runs/s  12 s left");
  CHECK(study_progress(2, 8, 4s, 10).size() <= 12);
}

TEST_CASE("a violation is about whom its detail begins with", "[cli]") {
  CHECK(subject_of_violation("every mote is joined", "yard/well: left: silence") == "yard/well");
  CHECK(subject_of_violation("the device list is true", "island 3: not listed: 4") == "island 3");
  CHECK(subject_of_violation("no mote is silent", "yard/well was silent for 3 min: none") ==
        "yard/well");
  CHECK(subject_of_violation("expected: delivery >= 95%", "50% of 60; rubicon run a.toml").empty());
  CHECK(subject_of_violation("rule", "").empty());
}
