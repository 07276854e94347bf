#include "cli/manual/value_kind.hpp"

#include <algorithm>
#include <cctype>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"

namespace rubicon::cli {

namespace {

using json = nlohmann::ordered_json;

std::string toml_of(const json& x) {
  if (!x.is_array())
    return json_line(x);
  std::string out;
  for (const auto& each : x)
    out += (out.empty() ? "" : ", ") + toml_of(each);
  return '[' + out + ']';
}

/// `"1s"` of `time from 1 s to 1 d`; empty: there is no least value.
std::string least_of(std::string_view wanted) {
  constexpr std::string_view word = " from ";
  const auto at = wanted.find(word);
  const auto rest = at == std::string_view::npos ? "" : wanted.substr(at + word.size());
  const auto number = rest.substr(0, rest.find(' '));
  const auto behind = number.size() < rest.size() ? rest.substr(number.size() + 1) : "";
  const auto unit = behind.substr(0, behind.find_first_of(" ,"));
  if (number.empty() || unit.empty() || unit == "to")
    return {};
  return '"' + std::string(number) + std::string(unit) + '"';
}

/// What stands between the first pair of code marks, if it is a value.
std::string quoted_of(std::string_view wanted) {
  const auto begin = wanted.find('`');
  const auto end = begin == std::string_view::npos ? begin : wanted.find('`', begin + 1);
  if (end == std::string_view::npos)
    return {};
  const auto code = std::string(wanted.substr(begin + 1, end - begin - 1));
  return !code.empty() && std::string_view("\"[{").find(code.front()) != std::string_view::npos
             ? code
             : std::string();
}

std::string sample_of_schema(const json& x);

std::string sample_array(const json& x) {
  const auto least = x.value("minItems", 1);
  std::string out;
  for (int i = 0; i < least && x.contains("items"); ++i)
    out += (out.empty() ? "" : ", ") +
           sample_of_schema(x["items"].is_array() ? x["items"].at(static_cast<std::size_t>(i))
                                                  : x["items"]);
  return '[' + out + ']';
}

std::string sample_of_schema(const json& x) {
  for (const auto* const choices : {"anyOf", "oneOf"})
    if (x.contains(choices))
      return sample_of_schema(x[choices].front());
  if (x.contains("const"))
    return toml_of(x["const"]);
  if (x.contains("enum"))
    return toml_of(x["enum"].front());
  if (!x.contains("type"))
    return "\"...\"";
  const auto type = x["type"].is_array() ? x["type"].front() : x["type"];
  if (type == "integer" || type == "number")
    return x.contains("minimum") ? json_line(x["minimum"]) : "1";
  if (type == "boolean")
    return "true";
  if (type == "array")
    return sample_array(x);
  return type == "object" ? "{}" : "\"...\"";
}

} // namespace

std::span<const value_kind> kinds_with_units() {
  static constexpr value_kind all[] = {
      {"time", "\"10s\"", "ns, us, ms, s, min, h, d"},
      {"ratio", "0.02", "none, or %"},
      {"length", "\"25m\"", "cm, m, km"},
      {"power", "\"-10dBm\"", "dBm"},
      {"decibels", "\"46.68dB\"", "dB"},
      {"frequency", "\"2480MHz\"", "MHz, GHz"},
      {"charge", "\"2000mAh\"", "mAh, Ah, J, kJ"},
      {"rate", "\"10Mbit/s\"", "bit/s, kbit/s, Mbit/s, Gbit/s"},
      {"position", "[1, 2]", "metres"},
      {"name", "\"climate-7\"", ""},
      {"mote", "\"kitchen/climate-7\"", ""},
      {"tuple key", "\"kitchen.fan.switch\"", ""},
      {"URL", "\"tcp://192.168.1.7:8000\"", ""},
      {"baud", "57600", "baud"},
  };
  return all;
}

const value_kind* kind_of(const config::key_description& x) {
  const auto fits = [&x](const value_kind& kind) {
    const auto behind = x.wanted.substr(std::min(kind.name.size(), x.wanted.size()));
    return x.wanted.starts_with(kind.name) &&
           (behind.empty() || behind.front() == ',' ||
            (behind.front() == ' ' && !behind.starts_with(" of ")));
  };
  const auto all = kinds_with_units();
  const auto found = std::ranges::find_if(all, fits);
  return found == all.end() ? nullptr : &*found;
}

std::string sample_of(const config::key_description& x) {
  if (!x.standard.empty())
    return toml_of(parse_ordered_json(x.standard));
  if (const auto* const kind = kind_of(x)) {
    const bool has_units = kind->sample.starts_with('"') && !kind->units.empty();
    const auto least = has_units ? least_of(x.wanted) : std::string();
    return least.empty() ? std::string(kind->sample) : least;
  }
  if (auto code = quoted_of(x.wanted); !code.empty())
    return code;
  return sample_of_schema(parse_ordered_json(x.schema));
}

std::string plain_text(std::string_view markdown) {
  std::string out;
  for (std::size_t i = 0; i < markdown.size(); ++i) {
    const char c = markdown[i];
    const auto close = c == '[' ? markdown.find("](", i) : std::string_view::npos;
    const auto end = close == std::string_view::npos ? close : markdown.find(')', close);
    const auto inner = markdown.find('[', i + 1);
    if (end != std::string_view::npos &&
        (inner > close || markdown[i + 1] == '`')) { // a link, not an array
      out += plain_text(markdown.substr(i + 1, close - i - 1));
      i = end;
    } else if (c != '`' && (c != '\\' || i + 1 == markdown.size())) {
      out += c;
    }
  }
  return out;
}

std::string range_text(const config::key_description& x) {
  return plain_text(config::wanted_of(x));
}

std::string default_text(const config::key_description& x) {
  if (x.is_required)
    return "required";
  if (!x.unset.empty())
    return "default: " + plain_text(x.unset);
  return x.standard.empty() ? std::string() : "default: " + toml_of(parse_ordered_json(x.standard));
}

} // namespace rubicon::cli
