#include <string>
#include <vector>

#include "core/text/spelling.hpp"
#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("the distance of two words counts the slips between them", "[core]") {
  struct row {
    const char* a;
    const char* b;
    std::size_t distance;
  };
  const auto x = GENERATE(values<row>({{"", "", 0},
                                       {"", "abc", 3},
                                       {"abc", "", 3},
                                       {"range", "range", 0},
                                       {"range", "Range", 0},
                                       {"range", "rnage", 1}, // swapped
                                       {"range", "rang", 1},
                                       {"range", "ranges", 1},
                                       {"range", "rance", 1},
                                       {"loss", "queue", 5},
                                       {"kitten", "sitting", 3}}));
  CAPTURE(x.a, x.b);
  CHECK(edit_distance(x.a, x.b) == x.distance);
  CHECK(edit_distance(x.b, x.a) == x.distance);
}

TEST_CASE("a suggestion is near, or lists what there is", "[core]") {
  const std::vector<std::string> known{"range", "loss", "queue"};
  CHECK(suggestion("rnage", known) == ": did you mean `range`?");
  CHECK(suggestion("LOSS", known) == ": did you mean `loss`?");
  CHECK(suggestion("colour", known) == ": there is range, loss, queue");
  CHECK(suggestion("ab", known) == ": there is range, loss, queue");
  CHECK(suggestion("x", {}) == ": there is none");
  const std::vector<std::string> many(11, "abcdefgh");
  CHECK(suggestion("x", many).ends_with("abcdefgh, ..."));
  CHECK(nearest("abcdefgi", std::vector<std::string>(2000, "abcdefgh")) == "abcdefgh");
  CHECK(nearest("abcdefgi", std::vector<std::string>(2001, "abcdefgh")).empty());
}

TEST_CASE("of equally near names the first is suggested", "[core]") {
  CHECK(nearest("mote-1", {"mote-2", "mote-3"}) == "mote-2");
  CHECK(nearest(std::string(65, 'a'), {std::string(65, 'a')}).empty()); // not worth the time
}
