// Described values as octets and back: one form for each, and nothing else is read.
#include "core/describe/field_codec.hpp"

#include <array>
#include <deque>
#include <set>

#include "core/numbers/delay_histogram.hpp"
#include "core/numbers/random.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

enum class colour : std::uint8_t { red, green, violet = 7 };

struct leaf {
  std::string name;
  std::optional<int> height;
};
RUBICON_FIELDS(leaf, name, height);

struct tree {
  bool evergreen = false;
  colour of_leaves = colour::green;
  std::uint16_t rings = 0;
  std::int64_t worth = 0;
  double girth_m = 0;
  float lean = 0;
  bytes bark;
  payload sap;
  std::vector<leaf> leaves;
  std::deque<std::uint8_t> twigs;
  std::map<std::string, std::vector<std::uint32_t>> nests;
  std::set<std::string> birds;
  std::array<std::uint8_t, 3> shade{};
  std::tuple<std::string, std::uint32_t, bool> tag;
  std::pair<mote_address, std::string> mote;
  std::variant<std::monostate, leaf, std::uint32_t> top;
  duration age{};
  std::optional<instant> felled;
  island_id island;
  largest<std::uint64_t> tallest;
  delay_histogram drips;
};
RUBICON_FIELDS(tree, evergreen, of_leaves, rings, worth, girth_m, lean, bark, sap, leaves, twigs,
               nests, birds, shade, tag, mote, top, age, felled, island, tallest, drips);

tree some_tree() {
  tree x;
  x.evergreen = true;
  x.of_leaves = colour::violet;
  x.rings = 0x1234;
  x.worth = -5;
  x.girth_m = 1.5;
  x.lean = -0.25F;
  x.bark = {1, 2, 3};
  x.sap = payload(bytes{4, 5});
  x.leaves = {{"a", 3}, {"b", std::nullopt}};
  x.twigs = {9, 8};
  x.nests = {{"high", {1, 2}}, {"low", {}}};
  x.birds = {"owl", "tit"};
  x.shade = {1, 2, 3};
  x.tag = {"oak", 7, true};
  x.mote = {{island_id(3), mote_id(4)}, "bird box"};
  x.top = leaf{"crown", 20};
  x.age = 40h;
  x.felled = instant(3s);
  x.island = island_id(9);
  x.tallest = std::uint64_t{30};
  x.drips.add(5ms);
  x.drips.add(7s);
  return x;
}

} // namespace

TEST_CASE("what is encoded by its fields is decoded to the same", "[core][codec]") {
  const auto before = some_tree();
  const auto octets = encode_value(before);
  const auto after = decode_value<tree>(octets);
  REQUIRE(after);
  CHECK(encode_value(*after) == octets);
  CHECK(after->leaves.at(0).height == 3);
  CHECK_FALSE(after->leaves.at(1).height);
  CHECK(after->nests.at("high") == std::vector<std::uint32_t>{1, 2});
  CHECK(after->birds.contains("tit"));
  CHECK(std::get<leaf>(after->top).name == "crown");
  CHECK(after->mote.first == before.mote.first);
  CHECK(after->felled == before.felled);
  CHECK(after->drips == before.drips);
  CHECK(after->tallest == before.tallest);
  CHECK(after->sap == before.sap);
}

TEST_CASE("numbers are in network byte order, sizes before what they count", "[core][codec]") {
  CHECK(encode_value(std::uint32_t{0x01020304}) == bytes{1, 2, 3, 4});
  CHECK(encode_value(std::string("ab")) == bytes{0, 0, 0, 2, 'a', 'b'});
  CHECK(encode_value(std::optional<bool>()) == bytes{0});
  CHECK(encode_value(std::optional(true)) == bytes{1, 1});
  CHECK(encode_value(std::variant<bool, std::uint16_t>(std::uint16_t{5})) == bytes{1, 0, 5});
  CHECK(encode_value(-1.0) == bytes{0xbf, 0xf0, 0, 0, 0, 0, 0, 0});
  CHECK(encode_value(std::pair(colour::violet, 1s)) == bytes{7, 0, 0, 0, 0, 0, 0, 0, 1});
}

TEST_CASE("what is cut off, or goes on, is no value", "[core][codec]") {
  auto octets = encode_value(some_tree());
  for (std::size_t size = 0; size < octets.size(); ++size)
    CHECK_FALSE(decode_value<tree>(byte_view(octets).first(size)));
  octets.push_back(0);
  CHECK_FALSE(decode_value<tree>(octets));
}

TEST_CASE("a value has one form", "[core][codec]") {
  CHECK_FALSE(decode_value<bool>(bytes{2}));
  CHECK_FALSE(decode_value<std::optional<std::uint8_t>>(bytes{2, 1}));
  CHECK_FALSE(decode_value<colour>(bytes{2})); // between two that there are
  CHECK_FALSE(decode_value<colour>(bytes{200}));
  CHECK(decode_value<colour>(bytes{7}));
  CHECK_FALSE(decode_value<std::variant<bool, std::uint8_t>>(bytes{2, 1}));
  using sizes = std::map<std::uint8_t, std::uint8_t>;
  CHECK(decode_value<sizes>(bytes{0, 0, 0, 2, 1, 0, 2, 0}));
  CHECK_FALSE(decode_value<sizes>(bytes{0, 0, 0, 2, 2, 0, 1, 0}));
  CHECK_FALSE(decode_value<sizes>(bytes{0, 0, 0, 2, 1, 0, 1, 0}));
  CHECK_FALSE(decode_value<std::set<std::uint8_t>>(bytes{0, 0, 0, 2, 1, 1}));
}

TEST_CASE("a count that cannot be is refused before room is made for it", "[core][codec]") {
  for (const bytes& all : {bytes{0xff, 0xff, 0xff, 0xff}, bytes{0x7f, 0xff, 0xff, 0xff, 1, 2, 3},
                           bytes{0, 0, 0, 2, 0, 0, 0, 1, 'x'}}) {
    CHECK_FALSE(decode_value<std::string>(all));
    CHECK_FALSE(decode_value<bytes>(all));
    CHECK_FALSE(decode_value<payload>(all));
    CHECK_FALSE(decode_value<std::vector<std::string>>(all));
    CHECK_FALSE(decode_value<std::vector<tree>>(all));
    CHECK_FALSE((decode_value<std::map<std::string, leaf>>(all)));
  }
}

TEST_CASE("what would take more memory than it may is refused", "[core][codec]") {
  const std::vector<std::string> many(1000);
  const auto octets = encode_value(many);
  CHECK(decode_value<std::vector<std::string>>(octets, 1000 * sizeof(std::string)));
  CHECK_FALSE(decode_value<std::vector<std::string>>(octets, 1000 * sizeof(std::string) - 1));
  CHECK(decode_value<std::string>(encode_value(std::string(100, 'x')), 100));
  CHECK_FALSE(decode_value<std::string>(encode_value(std::string(101, 'x')), 100));
}

TEST_CASE("octets that are changed anywhere are another value or none", "[core][codec]") {
  const auto octets = encode_value(some_tree());
  random_stream rng(3);
  for (std::size_t i = 0; i < 20 * octets.size(); ++i) {
    auto changed = octets;
    changed[i % changed.size()] ^= static_cast<std::uint8_t>(1 + rng.below(255));
    if (const auto found = decode_value<tree>(changed))
      CHECK(encode_value(*found) == changed);
  }
}

TEST_CASE("an enumeration knows the numbers that have names", "[core]") {
  CHECK(is_enumerator(colour::red));
  CHECK(is_enumerator(colour::violet));
  CHECK_FALSE(is_enumerator(static_cast<colour>(3)));
  CHECK_FALSE(is_enumerator(static_cast<colour>(255)));
}
