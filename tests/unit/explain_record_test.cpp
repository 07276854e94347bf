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
  x.islands = {{1, "kitchen", 1, "kitchen-gateway", {{7, "climate-7"}, {65532, "far"}}, {"attic"}}};
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
  encoder out;
  return encoder::encode(sample_header()) + out.encode(full_record()) + out.encode(record{});
}

/// What is wrong with a record whose second line is this.
bad_line problem_of(const std::string& line) {
  const auto x = read(encoder::encode(sample_header()) + line + '\n');
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
  for (int i = 0; i <= static_cast<int>(kind::story); ++i)
    CHECK(parse_kind(to_string(static_cast<kind>(i))) == static_cast<kind>(i));
  CHECK(!parse_kind("nothing"));
}

TEST_CASE("an actor is named once", "[explain][codec]") {
  encoder out;
  const auto first = out.encode(full_record());
  const auto second = out.encode(full_record());
  CHECK(first.find("climate-7") != std::string::npos);
  CHECK(second.find("climate-7") == std::string::npos);
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
                             "{\"rubicon_record\":2}\n", "{\"rubicon_record\":\"1\"}\n", "half");
  CAPTURE(text);
  const auto x = read(text);
  REQUIRE(x.problem);
  CHECK(x.problem->line == 1);
}

TEST_CASE("a bad line is refused with its number and what is wrong with it", "[explain]") {
  CHECK(problem_of("nonsense") == bad_line{2, "this is no JSON object"});
  CHECK(problem_of("{\"what\":\"flies\"}").message.find("\"flies\"") != std::string::npos);
  CHECK(problem_of("{\"what\":\"story\",\"from\":3}").message.find("actor 3") != std::string::npos);
  CHECK(problem_of("{\"what\":\"story\",\"octets\":\"0\"}").message ==
        "`octets` is not hexadecimal");
  CHECK(problem_of("{\"what\":\"story\",\"mote\":65536}").message ==
        "`mote` is no number that fits");
  CHECK(problem_of("{\"what\":\"story\",\"n\":-1}").message == "`n` is no number that fits");
  CHECK(problem_of("{\"what\":\"story\",\"n\":1.5}").message == "`n` is no number that fits");
  CHECK(problem_of("{\"what\":\"story\",\"text\":7}").message == "`text` is no text");
  CHECK(problem_of("{\"what\":\"story\",\"yes\":1}").line == 2);
}
