// What the kinds of values take, for documents and for editors.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "config/values.hpp"

namespace rubicon::config {

namespace {

/// JSON Schema of a text that a regular expression holds for.
json pattern(const std::string& x) {
  return {{"type", "string"}, {"pattern", '^' + x + '$'}};
}

/// A number and one of some units; the units are a part of a regular expression.
json quantity(const std::string& units, bool is_signed = false) {
  return pattern(std::string(is_signed ? "-?" : "") + R"([0-9]+(\.[0-9]+)? *()" + units + ')');
}

json either(const json& a, const json& b) {
  return {{"anyOf", json::array({a, b})}};
}

json integer(std::int64_t min, std::optional<std::int64_t> max = std::nullopt) {
  json out{{"type", "integer"}, {"minimum", min}};
  if (max)
    out["maximum"] = *max;
  return out;
}

/// Whole numbers without a point.
json number(double x) {
  constexpr double exact_max = 1e15;
  if (std::abs(x) < exact_max && x == std::floor(x))
    return static_cast<std::int64_t>(x);
  return x;
}

const std::string times = R"(([0-9]+(\.[0-9]+)? *(ns|us|ms|s|min|h|d) *)+)";
const std::string key_part = "[A-Za-z0-9_-]+";

json array_schema(const json& of, std::size_t min, std::size_t max) {
  json out{{"type", "array"}, {"items", of}};
  if (min > 0)
    out["minItems"] = min;
  if (max < std::numeric_limits<std::size_t>::max())
    out["maxItems"] = max;
  return out;
}

json points_schema(const json& value) {
  const json pair{{"type", "array"},
                  {"minItems", 2},
                  {"maxItems", 2},
                  {"items", json::array({pattern(times), value})}};
  return {{"type", "array"}, {"minItems", 1}, {"items", pair}};
}

json place_schema() {
  return {{"type", "array"}, {"minItems", 2}, {"maxItems", 3}, {"items", {{"type", "number"}}}};
}

/// `10s`: the largest unit of which it is a whole number.
std::string duration_text(duration x) {
  constexpr std::array<std::pair<duration, const char*>, 6> units{
      {{24h, "d"}, {1h, "h"}, {1min, "min"}, {1s, "s"}, {1ms, "ms"}, {1us, "us"}}};
  for (const auto& [length, name] : units)
    if (x != 0s && x % length == 0s)
      return std::to_string(x / length) + name;
  return x == 0s ? "0s" : std::to_string(x.count()) + "ns";
}

std::string length_text(double x) {
  if (x >= 1000)
    return shown(x / 1000) + " km";
  return x > 0 && x < 1 ? shown(x * 100) + " cm" : shown(x) + " m";
}

bool is_open(double x) {
  return std::abs(x) >= std::numeric_limits<double>::max();
}

} // namespace

form whole_form(std::int64_t min, std::optional<std::int64_t> max) {
  return {max ? std::to_string(min) + " to " + std::to_string(*max)
              : "number from " + std::to_string(min),
          integer(min, max)};
}

form word_form(const std::vector<std::string>& words) {
  form out{{}, {{"enum", words}}};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto join = i + 1 == words.size() ? " or " : ", ";
    out.wanted += (i == 0 ? "" : join) + ("`\"" + words[i] + "\"`");
  }
  return out;
}

form list_form(const form& of, std::size_t min, std::size_t max) {
  form out{"array", array_schema(of.schema, min, max)};
  if (max < std::numeric_limits<std::size_t>::max())
    out.wanted +=
        (min == 0 ? " of up to " : " of " + std::to_string(min) + " to ") + std::to_string(max);
  else if (min > 0)
    out.wanted += " of at least " + std::to_string(min);
  out.wanted += ", each a " + of.wanted;
  return out;
}

form pairs_form(const form& of) {
  return {"table, each value a " + of.wanted,
          {{"type", "object"}, {"additionalProperties", of.schema}}};
}

form form_of(const real& kind) {
  form out{"number", {{"type", "number"}}};
  if (!is_open(kind.min)) {
    out.schema["minimum"] = number(kind.min);
    out.wanted += " from " + shown(kind.min);
  }
  if (!is_open(kind.max)) {
    out.schema["maximum"] = number(kind.max);
    out.wanted += " to " + shown(kind.max);
  }
  return out;
}

form form_of(const flag& /*kind*/) {
  return {"true or false", {{"type", "boolean"}}};
}

form form_of(const text& kind) {
  return {"text of 1 to " + std::to_string(kind.octets_max) + " octets",
          {{"type", "string"}, {"minLength", 1}, {"maxLength", kind.octets_max}}};
}

form form_of(const name_text& /*kind*/) {
  return {"name", pattern("[A-Za-z0-9_-]{1,32}")};
}

form form_of(const tuple_key& kind) {
  const auto part = kind.wildcards ? "(\\*|" + key_part + ')' : key_part;
  return {kind.wildcards ? "tuple key, in which a part may be `*`" : "tuple key",
          pattern(part + "(\\." + part + "){0,6}")};
}

form form_of(const time_span& kind) {
  std::string wanted = "time";
  if (kind.min > 0s)
    wanted += " from " + to_text(kind.min);
  if (kind.max < time_span{}.max)
    wanted += (kind.min > 0s ? " to " : " up to ") + to_text(kind.max);
  return {wanted, pattern(times)};
}

form form_of(const time_step& /*kind*/) {
  return {"time, `\"5s\"` or `\"-5s\"`", pattern("-?" + times)};
}

form form_of(const ratio& /*kind*/) {
  return {"ratio", either(json{{"type", "number"}, {"minimum", 0}, {"maximum", 1}}, quantity("%"))};
}

form form_of(const metres& kind) {
  return {(kind.min > 0 ? "length from " + length_text(kind.min) + " to " : "length up to ") +
              length_text(kind.max),
          quantity("cm|m|km")};
}

form form_of(const charge& /*kind*/) {
  return {"charge", quantity("mAh|Ah")};
}

form form_of(const power_level& kind) {
  return {"power from " + shown(kind.min_dbm) + " to " + shown(kind.max_dbm) + " dBm",
          quantity("dBm", true)};
}

form form_of(const decibels& kind) {
  return {"decibels from " + shown(kind.min) + " to " + shown(kind.max), quantity("dB", true)};
}

form form_of(const frequency& /*kind*/) {
  return {"frequency", quantity("MHz|GHz")};
}

form form_of(const baud& /*kind*/) {
  return {"baud", either(integer(300, 4'000'000), pattern("[0-9]+ *baud|[a-z][A-Za-z0-9]+"))};
}

form form_of(const bit_rate& /*kind*/) {
  return {"rate", either(integer(0), quantity("[kMG]?bit/s"))};
}

form form_of(const place& /*kind*/) {
  return {"position", place_schema()};
}

form form_of(const time_points& /*kind*/) {
  return {"`[[\"0s\", 21.0], [\"5min\", 27.5]]`, at least 1", points_schema({{"type", "number"}})};
}

form form_of(const hex_octets& /*kind*/) {
  return {"1 to 100 octets in hexadecimal", pattern("([0-9A-Fa-f]{2}){1,100}")};
}

form time_of_day::takes() {
  return {"time of day, `\"07:30\"` or `\"07:30:15\"`",
          pattern("([01][0-9]|2[0-3]):[0-5][0-9](:[0-5][0-9])?")};
}

form way::takes() {
  return {"`[[\"0s\", [0, 2]], [\"1min\", [30, 2]]]`, at least 1", points_schema(place_schema())};
}

form tcp_url::takes() {
  return {"URL", pattern("tcp://.+")};
}

form interface_address::takes() {
  return {"IPv4 address", pattern(R"(([0-9]{1,3}\.){3}[0-9]{1,3})")};
}

form network_text::takes() {
  return {"network, as in `\"192.168.1.0/24\"`",
          pattern(R"(([0-9]{1,3}\.){3}[0-9]{1,3}(/[0-9]{1,2})?)")};
}

form type_span::takes() {
  return {
      "number, range `\"110..119\"` or mask `\"0x0100/0xff00\"`, 1 to 4294967295",
      either(integer(1, 4294967295), pattern(R"([0-9]+\.\.[0-9]+|[0-9a-fA-Fx]+/[0-9a-fA-Fx]+)"))};
}

json written(const real& /*kind*/, double x) {
  return is_open(x) ? json() : number(x);
}

json written(const flag& /*kind*/, bool x) {
  return x;
}

json written(const text& /*kind*/, const std::string& x) {
  return x.empty() ? json() : json(x);
}

json written(const time_span& /*kind*/, duration x) {
  return duration_text(x);
}

json written(const ratio& /*kind*/, double x) {
  return number(x);
}

json written(const metres& /*kind*/, double x) {
  return shown(x) + 'm';
}

json written(const power_level& /*kind*/, double x) {
  return shown(x) + "dBm";
}

json written(const decibels& /*kind*/, double x) {
  return shown(x) + "dB";
}

json written(const frequency& /*kind*/, double x) {
  return shown(x) + "MHz";
}

json written(const baud& /*kind*/, std::uint32_t x) {
  return x;
}

json written(const bit_rate& /*kind*/, std::uint64_t x) {
  constexpr std::uint64_t thousand = 1000;
  return x == 0 || x % thousand != 0 ? json(x) : json(std::to_string(x / thousand) + "kbit/s");
}

json written(const place& /*kind*/, const position& x) {
  auto out = json::array({number(x.x_m), number(x.y_m)});
  if (x.z_m != 0)
    out.push_back(number(x.z_m));
  return out;
}

} // namespace rubicon::config
