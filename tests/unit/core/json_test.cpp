#include "core/text/json.hpp"

#include <nlohmann/json.hpp>

#include "support/catch.hpp"

using namespace rubicon;
using nlohmann::json;
using nlohmann::ordered_json;

TEST_CASE("text that is no JSON is refused where it was to be trusted, and is no value where not",
          "[core]") {
  CHECK(parse_json(R"({"b":1,"a":[2.5,null]})") == json{{"a", {2.5, nullptr}}, {"b", 1}});
  CHECK(parse_ordered_json(R"("x")") == "x");
  CHECK_THROWS_AS(parse_json("{"), json::parse_error);
  CHECK_THROWS_AS(parse_ordered_json(""), json::parse_error);
  CHECK_THROWS_AS(parse_json("1e999"), json::out_of_range);

  CHECK(try_parse_json(" [] ") == json::array());
  CHECK(try_parse_ordered_json("[1]") == ordered_json{1});
  for (const auto* text : {"", "{", "[1,]", "1 2", "nul", "\"\xff\"", "1e999"}) {
    CHECK(try_parse_json(text).is_discarded());
    CHECK(try_parse_ordered_json(text).is_discarded());
  }
}

TEST_CASE("members are written in their order where it is kept, and sorted where not", "[core]") {
  const auto* const text = R"({"b":1,"a":{"c":[]}})";
  CHECK(json_line(parse_ordered_json(text)) == text);
  CHECK(json_line(parse_json(text)) == R"({"a":{"c":[]},"b":1})");
  CHECK(json_lines(parse_ordered_json(R"({"b":[1],"a":2})")) ==
        "{\n  \"b\": [\n    1\n  ],\n  \"a\": 2\n}");
  CHECK(json_lines(parse_json(R"({"b":1,"a":2})")) == "{\n  \"a\": 2,\n  \"b\": 1\n}");
}

TEST_CASE("octets that are not UTF-8 are written as JSON too", "[core]") {
  CHECK(json_line(json("a\xff")) == "\"a\xef\xbf\xbd\"");
  CHECK(json_line(ordered_json("\xc3")) == "\"\xef\xbf\xbd\"");
  CHECK(json_lines(json("\xff")) == "\"\xef\xbf\xbd\"");
  CHECK(json_lines(ordered_json("\xff")) == "\"\xef\xbf\xbd\"");
  CHECK(ascii_json_line(ordered_json("22 °C\xff")) == R"("22 \u00b0C\ufffd")");
}
