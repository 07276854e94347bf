// What the kinds of values take, for documents and for editors.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "config/toml/values.hpp"

namespace rubicon::config {

namespace {

/// A number and one of some units; the units are a part of a regular expression.
json_text quantity(const std::string& units, bool is_signed = false) {
  return pattern_schema(std::string(is_signed ? "-?" : "") + R"([0-9]+(\.[0-9]+)? *()" + units +
                        ')');
}

const std::string times = R"(([0-9]+(\.[0-9]+)? *(ns|us|ms|s|min|h|d) *)+)";
const std::string key_part = "[A-Za-z0-9_-]+";

json_text points_schema(const json_text& value) {
  const auto pair = json_object({{"type", json_string("array")},
                                 {"minItems", "2"},
                                 {"maxItems", "2"},
                                 {"items", json_array({pattern_schema(times), value})}});
  return json_object({{"type", json_string("array")}, {"minItems", "1"}, {"items", pair}});
}

json_text place_schema() {
  return json_object({{"type", json_string("array")},
                      {"minItems", "2"},
                      {"maxItems", "3"},
                      {"items", type_schema("number")}});
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

form form_of(const real& kind) {
  form out{"number", type_schema("number")};
  if (!is_open(kind.min)) {
    out.schema = with_member(std::move(out.schema), "minimum", json_number(kind.min));
    out.wanted += " from " + shown(kind.min);
  }
  if (!is_open(kind.max)) {
    out.schema = with_member(std::move(out.schema), "maximum", json_number(kind.max));
    out.wanted += " to " + shown(kind.max);
  }
  return out;
}

form form_of(const flag& /*kind*/) {
  return {"true or false", type_schema("boolean")};
}

form form_of(const text& kind) {
  return {"text of 1 to " + std::to_string(kind.octets_max) + " octets",
          json_object({{"type", json_string("string")},
                       {"minLength", "1"},
                       {"maxLength", std::to_string(kind.octets_max)}})};
}

form form_of(const name_text& /*kind*/) {
  return {"name", pattern_schema("[A-Za-z0-9_-]{1,32}")};
}

form form_of(const tuple_key& kind) {
  const auto part = kind.wildcards ? "(\\*|" + key_part + ')' : key_part;
  return {kind.wildcards ? "tuple key, in which a part may be `*`" : "tuple key",
          pattern_schema(part + "(\\." + part + "){0,6}")};
}

form form_of(const time_span& kind) {
  std::string wanted = "time";
  if (kind.min > 0s)
    wanted += " from " + to_text(kind.min);
  if (kind.max < time_span{}.max)
    wanted += (kind.min > 0s ? " to " : " up to ") + to_text(kind.max);
  return {wanted, pattern_schema(times)};
}

form form_of(const time_step& /*kind*/) {
  return {"time, `\"5s\"` or `\"-5s\"`", pattern_schema("-?" + times)};
}

form form_of(const ratio& /*kind*/) {
  return {"ratio", either_schema(form_of(real{0, 1}).schema, quantity("%"))};
}

form form_of(const metres& kind) {
  return {(kind.min > 0 ? "length from " + length_text(kind.min) + " to " : "length up to ") +
              length_text(kind.max),
          quantity("cm|m|km")};
}

form form_of(const charge& /*kind*/) {
  return {"charge, or energy at 3 V", quantity("mAh|Ah|kJ|J")};
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
  return {"baud", either_schema(integer_schema(300, 4'000'000),
                                pattern_schema("[0-9]+ *baud|[a-z][A-Za-z0-9]+"))};
}

form form_of(const bit_rate& /*kind*/) {
  return {"rate", either_schema(integer_schema(0), quantity("[kMG]?bit/s"))};
}

form form_of(const place& /*kind*/) {
  return {"position", place_schema()};
}

form form_of(const time_points& /*kind*/) {
  return {"`[[\"0s\", 21.0], [\"5min\", 27.5]]`, at least 1", points_schema(type_schema("number"))};
}

form form_of(const hex_octets& /*kind*/) {
  return {"1 to 100 octets in hexadecimal", pattern_schema("([0-9A-Fa-f]{2}){1,100}")};
}

form calendar_day::takes() {
  return {"date, as in `\"2026-11-05\"`", pattern_schema("[0-9]{4}-[0-9]{2}-[0-9]{2}")};
}

form time_of_day::takes() {
  return {"time of day, `\"07:30\"` or `\"07:30:15\"`",
          pattern_schema("([01][0-9]|2[0-3]):[0-5][0-9](:[0-5][0-9])?")};
}

form way::takes() {
  return {"`[[\"0s\", [0, 2]], [\"1min\", [30, 2]]]`, at least 1", points_schema(place_schema())};
}

form peer_url::takes() {
  return {"URL", pattern_schema("(tcp|udp|bt)://.+")};
}

form interface_address::takes() {
  return {"IPv4 address", pattern_schema(R"(([0-9]{1,3}\.){3}[0-9]{1,3})")};
}

form network_text::takes() {
  return {"network, as in `\"192.168.1.0/24\"`",
          pattern_schema(R"(([0-9]{1,3}\.){3}[0-9]{1,3}(/[0-9]{1,2})?)")};
}

form type_span::takes() {
  return {"number, range `\"110..119\"` or mask `\"0x0100/0xff00\"`, 1 to 4294967295",
          either_schema(integer_schema(1, 4294967295),
                        pattern_schema(R"([0-9]+\.\.[0-9]+|[0-9a-fA-Fx]+/[0-9a-fA-Fx]+)"))};
}

json_text written(const real& /*kind*/, double x) {
  return is_open(x) ? json_text() : json_number(x);
}

json_text written(const flag& /*kind*/, bool x) {
  return x ? "true" : "false";
}

json_text written(const text& /*kind*/, const std::string& x) {
  return x.empty() ? json_text() : json_string(x);
}

json_text written(const time_span& /*kind*/, duration x) {
  return json_string(duration_text(x));
}

json_text written(const ratio& /*kind*/, double x) {
  return json_number(x);
}

json_text written(const metres& /*kind*/, double x) {
  return json_string(shown(x) + 'm');
}

json_text written(const power_level& /*kind*/, double x) {
  return json_string(shown(x) + "dBm");
}

json_text written(const decibels& /*kind*/, double x) {
  return json_string(shown(x) + "dB");
}

json_text written(const frequency& /*kind*/, double x) {
  return json_string(shown(x) + "MHz");
}

json_text written(const baud& /*kind*/, std::uint32_t x) {
  return std::to_string(x);
}

json_text written(const bit_rate& /*kind*/, std::uint64_t x) {
  constexpr std::uint64_t thousand = 1000;
  return x == 0 || x % thousand != 0 ? std::to_string(x)
                                     : json_string(std::to_string(x / thousand) + "kbit/s");
}

json_text written(const place& /*kind*/, const position& x) {
  std::vector<json_text> out{json_number(x.x_m), json_number(x.y_m)};
  if (x.z_m != 0)
    out.push_back(json_number(x.z_m));
  return json_array(out);
}

} // namespace rubicon::config
