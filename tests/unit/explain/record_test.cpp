#include "explain/record.hpp"

#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::explain;

namespace {

header sample_header() {
  header x;
  x.ecology = "home";
  x.seed = 18446744073709551615U;
  x.file = "config/home.toml";
  x.digest = "0123";
  x.options = {"--set", "radio.loss=0.2"};
  x.length = 90s;
  x.wall = true;
  x.islands = {{1,
                "kitchen",
                1,
                "kitchen-gateway",
                {{7, "climate-7"}, {65532, "far"}},
                {"attic"},
                {{"far-double", 65532}}}};
  x.peers = {{1, "kitchen-gateway"}, {40, "care-pc"}};
  return x;
}

record full_record() {
  record x;
  x.number = 12;
  x.time = instant(1500ms);
  x.from = "mote/kitchen/climate-7";
  x.to = "air/kitchen";
  x.what = kind::radio_send;
  x.cause = 11;
  x.id = 1ULL << 63U;
  x.mote = {island_id{1}, mote_id{7}};
  x.peer = -1;
  x.channel = 256;
  x.text = "a \"word\" of\nsome";
  x.octets = {0, 0xff};
  x.count = 3;
  x.yes = true;
  x.unheard = true;
  return x;
}

std::string sample_text() {
  return encode(sample_header()) + encode(full_record()) + encode(record{});
}

/// What is wrong with a record whose second line is this.
bad_line problem_of(const std::string& line) {
  const auto x = read(encode(sample_header()) + line + '\n');
  return x.problem.value_or(bad_line{});
}

} // namespace

TEST_CASE("a record is read as it was written", "[explain][codec]") {
  const auto x = read(sample_text());
  REQUIRE(!x.problem);
  CHECK(x.content.about == sample_header());
  REQUIRE(x.content.records.size() == 2);
  CHECK(x.content.records[0] == full_record());
  CHECK(x.content.records[1] == record{});
  CHECK(!x.content.cut_off);
}

TEST_CASE("every kind of record has a word of its own", "[explain][codec]") {
  for (int i = 0; i <= static_cast<int>(kind::message_ended); ++i)
    CHECK(parse_kind(to_string(static_cast<kind>(i))) == static_cast<kind>(i));
  CHECK(!parse_kind("nothing"));
}

TEST_CASE("half a last line is left out, because the run may have been killed", "[explain]") {
  auto text = sample_text();
  text.resize(text.size() - 5);
  const auto x = read(text);
  REQUIRE(!x.problem);
  CHECK(x.content.cut_off);
  CHECK(x.content.records.size() == 1);
}

TEST_CASE("a last line without its newline is a line", "[explain]") {
  auto text = sample_text();
  text.pop_back();
  const auto x = read(text);
  REQUIRE(!x.problem);
  CHECK(!x.content.cut_off);
  CHECK(x.content.records.size() == 2);
}

TEST_CASE("what is no record is refused at its first line", "[explain]") {
  const auto text = GENERATE(as<std::string>{}, "", "\n", "not json\n", "[1]\n", "{}\n",
                             "{\"rubicon_record\":5}\n", "{\"rubicon_record\":\"3\"}\n", "half");
  CAPTURE(text);
  const auto x = read(text);
  REQUIRE(x.problem);
  CHECK(x.problem->line == 1);
}

TEST_CASE("a record of the version before is refused by its number", "[explain]") {
  const auto x = read("{\"rubicon_record\":1}\n");
  REQUIRE(x.problem);
  CHECK(x.problem->message == "a record of version 1, this program reads version " +
                                  std::to_string(record_version) + ": record the run again");
}

TEST_CASE("fields that are as usual are left out", "[explain][codec]") {
  CHECK(encode(record{}) == "{\"what\":\"event\"}\n");
  record x;
  x.what = kind::radio_done;
  x.cause = 7;
  CHECK(encode(x) == "{\"what\":\"radio_done\",\"cause\":7}\n");
}

TEST_CASE("a bad line is refused with its number and what is wrong with it", "[explain]") {
  CHECK(problem_of("nonsense") == bad_line{2, "this is not a JSON object"});
  CHECK(problem_of("{\"what\":\"flies\"}").message.find("\"flies\"") != std::string::npos);
  CHECK(problem_of("{\"number\":3}") == bad_line{2, "`what` is missing"});
  CHECK(problem_of("{\"what\":\"event\",\"from\":3}").message == "`from` is no text");
  CHECK(problem_of("{\"what\":\"event\",\"octets\":\"0\"}").message ==
        "`octets` is not hexadecimal");
  CHECK(problem_of("{\"what\":\"event\",\"mote\":[1,65536]}").message ==
        "`mote` is not a number in range");
  CHECK(problem_of("{\"what\":\"event\",\"number\":-1}").message ==
        "`number` is not a number in range");
  CHECK(problem_of("{\"what\":\"event\",\"number\":1.5}").message ==
        "`number` is not a number in range");
  CHECK(problem_of("{\"what\":\"event\",\"text\":7}").message == "`text` is no text");
  CHECK(problem_of("{\"what\":\"event\",\"yes\":1}").line == 2);
  CHECK(problem_of("{\"what\":\"event\",\"mote\":7}").message == "`mote` is no pair");
}
