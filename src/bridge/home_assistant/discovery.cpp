#include "bridge/home_assistant/discovery.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/decimal.hpp"
#include "core/text/json.hpp"

namespace rubicon::bridge {

namespace {

using json = nlohmann::ordered_json;

constexpr std::array<std::pair<platform, std::string_view>, 9> platform_names{{
    {platform::sensor, "sensor"},
    {platform::binary_sensor, "binary_sensor"},
    {platform::switch_, "switch"},
    {platform::light, "light"},
    {platform::cover, "cover"},
    {platform::fan, "fan"},
    {platform::number, "number"},
    {platform::select, "select"},
    {platform::button, "button"},
}};

struct quantity {
  std::string_view unit;         ///< of the field
  std::string_view name;         ///< part of the field's name; empty: any
  std::string_view device_class; ///< of Home Assistant; empty: none
  std::string_view shown;        ///< unit in Home Assistant
};

/// The first row that fits counts.
constexpr std::array<quantity, 17> quantities{{
    {"C", "", "temperature", "\u00b0C"},
    {"\u00b0C", "", "temperature", "\u00b0C"},
    {"K", "", "temperature", "K"},
    {"%", "humid", "humidity", "%"},
    {"%", "batter", "battery", "%"},
    {"%", "moist", "moisture", "%"},
    {"lx", "", "illuminance", "lx"},
    {"ppm", "co2", "carbon_dioxide", "ppm"},
    {"dBm", "", "signal_strength", "dBm"},
    {"V", "", "voltage", "V"},
    {"A", "", "current", "A"},
    {"W", "", "power", "W"},
    {"hPa", "", "atmospheric_pressure", "hPa"},
    {"Pa", "", "pressure", "Pa"},
    {"m", "", "distance", "m"},
    {"ms", "", "duration", "ms"},
    {"s", "", "duration", "s"},
}};

constexpr quantity quantity_of(const field_model& x, std::string_view name) {
  for (const auto& each : quantities)
    if (each.unit == x.unit && name.find(each.name) != std::string_view::npos)
      return each;
  return {x.unit, {}, {}, x.unit};
}

/// Words of a field of two states, and the class that its entity has.
struct pair_of_words {
  std::string_view on;
  std::string_view off;
  std::string_view device_class;
};
constexpr std::array<pair_of_words, 8> pairs{{{"on", "off", ""},
                                              {"open", "closed", "opening"},
                                              {"true", "false", ""},
                                              {"yes", "no", ""},
                                              {"occupied", "empty", "occupancy"},
                                              {"occupied", "free", "occupancy"},
                                              {"motion", "still", "motion"},
                                              {"wet", "dry", "moisture"}}};

bool has(const std::vector<std::string>& words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

const pair_of_words* pair_in(const std::vector<std::string>& words) {
  if (words.size() != 2)
    return nullptr;
  const auto found = std::ranges::find_if(
      pairs, [&words](const auto& each) { return has(words, each.on) && has(words, each.off); });
  return found == pairs.end() ? nullptr : found;
}

bool mentions(const class_model& of, std::string_view name, std::string_view what) {
  return folded(of.name).find(what) != std::string::npos ||
         folded(name).find(what) != std::string::npos;
}

std::optional<platform> given_for(const class_model& of, const std::string& name,
                                  const platform_table& given) {
  const auto found = given.find(of.name + '.' + name);
  return found == given.end() ? std::nullopt : std::optional(found->second);
}

/// `light_level` as `Light level`.
std::string shown_name(std::string_view x) {
  std::string out(x);
  for (auto& c : out)
    c = c == '_' || c == '-' ? ' ' : c;
  if (!out.empty() && out[0] >= 'a' && out[0] <= 'z')
    out[0] = static_cast<char>(out[0] - 'a' + 'A');
  return out;
}

/// What an entity's own id may hold: lower case, digits and `_`.
std::string slug(std::string_view x) {
  auto out = folded(x);
  for (auto& c : out)
    c = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ? c : '_';
  return out;
}

std::string value_template(const std::string& name) {
  return "{{ value_json['" + name + "'] }}";
}

json entity(const discovery_names& names, const object& x, const std::string& name, platform as) {
  const auto kind = std::string(to_string(as));
  return {{"p", kind},
          {"name", shown_name(name)},
          {"unique_id", device_id(names, x.name) + '_' + name},
          {"default_entity_id", kind + '.' + slug(names.base + '_' + x.name + '_' + name)}};
}

json entity_of(const discovery_names& names, const class_model& of, const object& x,
               const field_model& field, platform as) {
  auto out = entity(names, x, field.name, as);
  out["val_tpl"] = value_template(field.name);
  if (as == platform::binary_sensor) {
    const auto* words = pair_in(field.words);
    out["pl_on"] = words == nullptr ? field.words.back() : words->on;
    out["pl_off"] = words == nullptr ? field.words.front() : words->off;
    if (words != nullptr && !words->device_class.empty())
      out["dev_cla"] = words->device_class;
    return out;
  }
  if (!field.words.empty()) {
    out["dev_cla"] = "enum";
    out["ops"] = field.words;
    return out;
  }
  const auto what = quantity_of(field, folded(field.name + ' ' + of.name));
  if (!what.device_class.empty())
    out["dev_cla"] = what.device_class;
  if (!what.shown.empty())
    out["unit_of_meas"] = what.shown;
  out["stat_cla"] = "measurement";
  out["sug_dsp_prc"] = field.decimals;
  return out;
}

void add_two_states(json& out, const std::string& name, bool with_state_words) {
  out["pl_on"] = "on";
  out["pl_off"] = "off";
  if (with_state_words) {
    out["stat_on"] = "on";
    out["stat_off"] = "off";
    out["val_tpl"] = value_template(name);
  } else
    out["stat_val_tpl"] = value_template(name);
}

json entity_of(const discovery_names& names, const object& x, const input_model& input,
               platform as) {
  auto out = entity(names, x, input.name, as);
  out["cmd_t"] = names.base + '/' + x.name + "/set/" + input.name;
  switch (as) {
  case platform::switch_:
    add_two_states(out, input.name, true);
    break;
  case platform::light:
  case platform::fan:
    add_two_states(out, input.name, false);
    break;
  case platform::cover:
    out["pl_open"] = "open";
    out["pl_cls"] = "close";
    out["pl_stop"] = has(input.words, "stop") ? json("stop") : json(nullptr);
    out["stat_open"] = "open";
    out["stat_clsd"] = "close";
    out["val_tpl"] = value_template(input.name);
    break;
  case platform::number:
    out["min"] = input.numbers->min;
    out["max"] = input.numbers->max;
    out["step"] = std::max(input.numbers->step, 0.001);
    if (!input.unit.empty())
      out["unit_of_meas"] = input.unit == "C" ? "\u00b0C" : input.unit;
    out["val_tpl"] = value_template(input.name);
    break;
  case platform::select:
    out["ops"] = input.words;
    out["val_tpl"] = value_template(input.name);
    break;
  case platform::button:
    out["pl_prs"] = input.words.front();
    break;
  case platform::sensor:
  case platform::binary_sensor:
    break; // fits() excludes them
  }
  return out;
}

json availability(const discovery_names& names, const std::string& topic) {
  return {{"t", names.base + '/' + topic}, {"val_tpl", "{{ value_json.state }}"}};
}

/// A number if it is one.
json value_of(const std::string& text) {
  if (const auto number = number_in(text))
    return *number;
  return text;
}

} // namespace

std::string_view to_string(platform x) {
  return platform_names[static_cast<std::size_t>(x)].second;
}

std::optional<platform> platform_named(std::string_view name) {
  for (const auto& [what, called] : platform_names)
    if (called == name)
      return what;
  return std::nullopt;
}

bool fits(const field_model& x, platform as) {
  return as == platform::sensor || (as == platform::binary_sensor && x.words.size() == 2);
}

bool fits(const input_model& x, platform as) {
  switch (as) {
  case platform::switch_:
  case platform::light:
  case platform::fan:
    return has(x.words, "on") && has(x.words, "off");
  case platform::cover:
    return has(x.words, "open") && has(x.words, "close");
  case platform::number:
    return x.numbers.has_value();
  case platform::select:
    return !x.words.empty();
  case platform::button:
    return x.words.size() == 1;
  case platform::sensor:
  case platform::binary_sensor:
    return false;
  }
  return false;
}

platform platform_of(const class_model& of, const field_model& x, const platform_table& given) {
  if (const auto as = given_for(of, x.name, given); as && fits(x, *as))
    return *as;
  return pair_in(x.words) == nullptr ? platform::sensor : platform::binary_sensor;
}

platform platform_of(const class_model& of, const input_model& x, const platform_table& given) {
  if (const auto as = given_for(of, x.name, given); as && fits(x, *as))
    return *as;
  if (x.numbers)
    return platform::number;
  if (x.words.size() == 1)
    return platform::button;
  if (fits(x, platform::cover) && x.words.size() <= 3)
    return platform::cover;
  if (!fits(x, platform::switch_) || x.words.size() > 2)
    return platform::select;
  if (mentions(of, x.name, "fan"))
    return platform::fan;
  return mentions(of, x.name, "light") || mentions(of, x.name, "lamp") ? platform::light
                                                                       : platform::switch_;
}

std::string device_id(const discovery_names& names, std::string_view object) {
  std::string out;
  for (const char c : names.base + '/' + folded(object))
    out += c == '.'   ? std::string("_")
           : c == '_' ? std::string("-u")
           : c == '-' ? "--"
           : c == '/' ? "-s"
                      : std::string(1, c);
  return out;
}

std::string discovery_topic(const discovery_names& names, std::string_view object) {
  return names.discovery + "/device/" + device_id(names, object) + "/config";
}

std::string discovery_document(const discovery_names& names, const class_model& of, const object& x,
                               const platform_table& given, std::string_view called) {
  json components = json::object();
  for (const auto& each : of.fields)
    components[each.name] = entity_of(names, of, x, each, platform_of(of, each, given));
  for (const auto& each : of.inputs) {
    auto name = each.name;
    if (components.contains(name)) // a field may have the name of an input
      name += "-set";
    components[name] = entity_of(names, x, each, platform_of(of, each, given));
    if (name != each.name)
      components[name]["unique_id"] = device_id(names, x.name) + '_' + name;
  }
  const json out = {
      {"dev",
       {{"ids", device_id(names, x.name)}, {"name", called}, {"mdl", of.name}, {"mf", "Rubicon"}}},
      {"o", {{"name", "rubicon"}}},
      {"cmps", std::move(components)},
      {"stat_t", names.base + '/' + x.name},
      {"avty",
       {availability(names, "bridge/state"), availability(names, x.name + "/availability")}},
      {"avty_mode", "all"}};
  return json_line(out);
}

std::string state_document(const class_model& of, const object& x) {
  auto out = json::object();
  for (const auto& each : of.fields) {
    const auto found = x.values.find(each.name);
    out[each.name] = found == x.values.end() ? json(nullptr) : value_of(found->second);
  }
  for (const auto& each : of.inputs) {
    const auto found = x.inputs.find(each.name);
    if (found != x.inputs.end() || !out.contains(each.name))
      out[each.name] = found == x.inputs.end() ? json(nullptr) : value_of(found->second);
    if (const auto ended = x.outcomes.find(each.name); ended != x.outcomes.end())
      out[each.name + "_outcome"] = ended->second;
  }
  return json_line(out);
}

} // namespace rubicon::bridge
