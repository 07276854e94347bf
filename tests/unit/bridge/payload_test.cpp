#include <string>

#include <nlohmann/json.hpp>

#include "bridge/table/payload.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::bridge;

TEST_CASE("JSON is read up to a depth", "[bridge]") {
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  CHECK(bounded_json(nested(json_depth_max)).is_array());
  CHECK(bounded_json(nested(json_depth_max + 1)).is_discarded());
  CHECK(bounded_json(std::string(100'000, '[')).is_discarded());
  CHECK(bounded_json('"' + std::string(100, '[') + "\\\"\"").is_string());
  CHECK(bounded_json("{").is_discarded());
}

TEST_CASE("payloads are texts of their type, or none", "[bridge]") {
  CHECK(text_of(payload_type::number, "2.50") == "2.5");
  CHECK(!text_of(payload_type::number, "2,5"));
  CHECK(text_of(payload_type::flag, "TRUE") == "on");
  CHECK(text_of(payload_type::flag, "0") == "off");
  CHECK(!text_of(payload_type::flag, "2"));
  CHECK(text_of(payload_type::text, std::string(payload_text_max, 'x')));
  CHECK(!text_of(payload_type::text, std::string(payload_text_max + 1, 'x')));
  CHECK(word_in(nlohmann::json(-3)) == "-3");
  CHECK(word_in(nlohmann::json(2.5)) == "2.5");
  CHECK(word_in(nlohmann::json(true)) == "on");
  CHECK(!word_in(nlohmann::json::array()));
}
