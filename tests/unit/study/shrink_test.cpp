#include <string>
#include <vector>

#include "core/numbers/random.hpp"
#include "study/outline.hpp"
#include "study/shrink.hpp"
#include "support/catch.hpp"
#include "support/text.hpp"

using namespace rubicon;
using namespace rubicon::study;
using rubicon::test::contains;

namespace {

constexpr const char* small = R"([ecology] # a house
name = "house"
duration = "10min"

# the kitchen
[[island]]
id = 1
[[island.mote]]
name = "a # no comment"
apps = [{ app = "sampler", every = "17s" }, # of heat
        { app = "listener" }]
text = """
[no table]
"""
[[island.mote]]
name = "b"
[island.mote.transducers]
light = [1, [2, 3]]
[[fault]]
at = "5min"
)";

std::string list_of(const std::vector<piece>& all, piece_kind what) {
  std::string out;
  for (const auto& each : all)
    if (each.what == what)
      out += (out.empty() ? "" : " ") + each.path;
  return out;
}

/// What happens if all of these lines are in a file, and a run of it is long enough.
struct planted {
  std::vector<std::string> lines;
  std::uint64_t length_s = 0;

  [[nodiscard]] bool happens(const std::string& text) const {
    for (const auto& each : lines)
      if (!contains(text, each + '\n'))
        return false;
    const auto at = text.find("duration = \"");
    return at != std::string::npos && std::stoull(text.substr(at + 12)) >= length_s;
  }
};

std::string large_file() {
  std::string text = "[ecology]\nname = \"house\"\nduration = \"3600s\"\n[[island]]\nid = 1\n";
  for (int i = 0; i < 40; ++i) {
    const auto n = std::to_string(i);
    text += "[[island.mote]]\nname = \"mote-" + n + "\"\nposition_m = [" + n + ", 0]\n";
  }
  for (int i = 0; i < 6; ++i)
    text += "[[peer]]\nname = \"peer-" + std::to_string(i) + "\"\n";
  for (int i = 0; i < 25; ++i) {
    const auto n = std::to_string(i);
    text += "[[fault]]\nkind = \"kill\"\nmote = \"mote-" + n + "\"\nafter = \"f" + n + "\"\n";
  }
  return text;
}

planted plant(random_stream& random) {
  planted out;
  for (std::uint64_t i = 0; i <= random.below(3); ++i) {
    const auto n = std::to_string(random.below(25));
    out.lines.push_back("after = \"f" + n + '"');
    out.lines.push_back("name = \"mote-" + n + '"'); // which the fault names
  }
  out.lines.push_back("name = \"mote-" + std::to_string(random.below(40)) + '"');
  if (random.chance(0.5))
    out.lines.push_back("name = \"peer-" + std::to_string(random.below(6)) + '"');
  out.length_s = 1 + random.below(3600);
  return out;
}

} // namespace

TEST_CASE("a file consists of tables, entries and elements", "[study]") {
  const auto all = outline_of(small);
  CHECK(list_of(all, piece_kind::table) ==
        "ecology island island.mote island.mote island.mote.transducers fault");
  CHECK(list_of(all, piece_kind::element) ==
        "island.mote.apps island.mote.apps island.mote.transducers.light "
        "island.mote.transducers.light");
  CHECK(
      list_of(all, piece_kind::entry) ==
      "ecology.name ecology.duration island.id island.mote.name island.mote.apps island.mote.text "
      "island.mote.name island.mote.transducers.light fault.at");
  CHECK(shrinker(small).smallest().size() < std::string(small).size()); // without its comments
  for (const auto& each : all)
    CHECK(each.begin < each.end);
}

TEST_CASE("any octets have an outline within them", "[study]") {
  random_stream random(1);
  const std::string letters = "[]{}\"'=#\n., ab1\\";
  for (int i = 0; i < 2000; ++i) {
    std::string text;
    for (std::uint64_t n = random.below(40); n > 0; --n)
      text += letters[random.below(letters.size())];
    CAPTURE(text);
    for (const auto& each : outline_of(text)) {
      CHECK(each.begin < each.end);
      CHECK(each.end <= text.size());
      CHECK((each.parent == piece::npos || each.parent < outline_of(text).size()));
    }
    shrinker x(text);
    while (x.next())
      x.take(true);
    CHECK(x.smallest().size() <= text.size() + 16);
  }
}

TEST_CASE("what is not needed is left out", "[study]") {
  shrinker x(small, 600, 301);
  const planted needed{{"name = \"b\"", "at = \"5min\""}, 200};
  while (const auto text = x.next())
    x.take(needed.happens(*text));
  const auto text = x.smallest();
  CAPTURE(text);
  CHECK(text.starts_with("[ecology] # a house\nduration = \"2"));
  CHECK(
      text.ends_with("s\"\n[[island]]\n[[island.mote]]\nname = \"b\"\n[[fault]]\nat = \"5min\"\n"));
  CHECK(x.motes().left == 1);
  CHECK(x.motes().of == 3); // with a table of one
}

TEST_CASE("numbers get fewer digits", "[study]") {
  shrinker x("[a]\nfirst = 123.45\nsecond = \"-37s\"\nthird = 10\nname = \"x12\"\n");
  while (const auto text = x.next())
    x.take(contains(*text, "second = \"-37s\"") && contains(*text, "first = ") &&
           contains(*text, "name = "));
  CHECK(x.smallest() == "[a]\nfirst = 100.00\nsecond = \"-37s\"\nname = \"x12\"\n");
}

TEST_CASE("of 40 planted failures what makes them is left", "[study]") {
  random_stream random(2);
  for (int i = 0; i < 40; ++i) {
    const auto needed = plant(random);
    shrinker x(large_file(), 3600, needed.length_s + random.below(60));
    while (const auto text = x.next())
      x.take(needed.happens(*text));
    CAPTURE(i, x.smallest());
    CHECK(needed.happens(x.smallest()));
    CHECK(x.faults().left <= 3);
    CHECK(x.motes().left <= 4);
    CHECK(x.peers().left <= 1);
    CHECK(x.tries() < 400);
  }
}
