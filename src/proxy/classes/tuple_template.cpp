#include "proxy/classes/tuple_template.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/text/decimal.hpp"
#include "core/text/json.hpp"
#include "proxy/classes/tuple_key.hpp"

namespace rubicon::proxy {

namespace {

constexpr std::string_view unit_suffix = ".unit";

const std::string* value_in(const name_values& all, std::string_view name) {
  const auto found = std::ranges::find(all, name, &name_values::value_type::first);
  return found == all.end() ? nullptr : &found->second;
}

const reading* reading_of(const std::vector<reading>& all, std::string_view name) {
  const auto found = std::ranges::find(all, name, &reading::name);
  return found == all.end() ? nullptr : &*found;
}

std::string filled_key(std::string_view key, const name_values& names) {
  std::vector<std::string> braced;
  for (const auto& [name, value] : names)
    braced.push_back('{' + name + '}');
  std::vector<std::pair<std::string_view, std::string>> pairs;
  for (std::size_t i = 0; i < names.size(); ++i)
    pairs.emplace_back(braced[i], key_part(names[i].second));
  return fill_prefix(key, pairs);
}

/// Text of which the prior names are filled in once and for all.
std::vector<template_part> prefilled(std::string_view text, const name_values& names) {
  auto parts = template_parts(text);
  if (!parts)
    return {{std::string(text), false}}; // the reader of files refuses such a one
  for (auto& x : *parts)
    if (const auto* value = x.is_name ? value_in(names, x.text) : nullptr)
      x = {*value, false};
  return *std::move(parts);
}

std::string text_of(const std::vector<template_part>& parts, const std::vector<reading>& all) {
  std::string text;
  for (const auto& part : parts) {
    if (!part.is_name) {
      text += part.text;
      continue;
    }
    if (const auto* x = reading_of(all, part.text))
      text += x->text;
    else if (part.text.ends_with(unit_suffix))
      if (const auto* of = reading_of(
              all, std::string_view(part.text).substr(0, part.text.size() - unit_suffix.size())))
        text += of->unit;
  }
  return text;
}

std::string json_of(const std::vector<std::string>& names, const std::vector<reading>& all,
                    const std::vector<std::string>& words, instant now) {
  nlohmann::ordered_json out;
  out["time"] = number_in(to_text(now)).value_or(0);
  for (const auto& name : names) {
    const auto* x = reading_of(all, name);
    if (x == nullptr)
      continue;
    auto& value = out[name];
    const auto number = std::ranges::count(words, name) == 0 ? number_in(x->text) : std::nullopt;
    if (number)
      value["value"] = *number;
    else
      value["value"] = x->text;
    if (!x->unit.empty())
      value["unit"] = x->unit;
  }
  // Units and words come from the file, which may have octets that are no UTF-8.
  return json_line(out);
}

} // namespace

result<std::vector<template_part>> template_parts(std::string_view text) {
  std::vector<template_part> parts;
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c != '{' && c != '}') {
      plain += c;
    } else if (i + 1 < text.size() && text[i + 1] == c) {
      plain += c;
      ++i;
    } else {
      const auto end = text.find_first_of("{}", i + 1);
      if (c == '}' || end == std::string_view::npos || text[end] != '}' || end == i + 1)
        return errc::bad_value;
      if (!plain.empty())
        parts.push_back({std::move(plain), false});
      plain.clear();
      parts.push_back({std::string(text.substr(i + 1, end - i - 1)), true});
      i = end;
    }
  }
  if (!plain.empty())
    parts.push_back({std::move(plain), false});
  return parts;
}

const std::vector<std::string>& mote_template_names() {
  static const std::vector<std::string> names{"island", "id", "name", "class", "room"};
  return names;
}

const std::vector<std::string>& object_template_names() {
  static const std::vector<std::string> names{"channel", "id", "name", "class"};
  return names;
}

const field* field_named(const proxy_class& what, std::string_view name) {
  if (name.ends_with(unit_suffix))
    name.remove_suffix(unit_suffix.size());
  const auto found = std::ranges::find(what.fields, name, &field::name);
  return found == what.fields.end() ? nullptr : &*found;
}

std::optional<reading_source> source_of(const proxy_class& what, const tuple_template& x) {
  for (const auto& name : x.json)
    if (const auto* of = field_named(what, name))
      return of->source();
  const auto parts = template_parts(x.text);
  if (!parts)
    return std::nullopt;
  for (const auto& part : *parts)
    if (const auto* of = part.is_name ? field_named(what, part.text) : nullptr)
      return of->source();
  return std::nullopt;
}

tuple_templates::tuple_templates(const proxy_class& what, name_values names) {
  names.emplace_back("class", what.name);
  const auto* const island = value_in(names, "island");
  if (island != nullptr && value_in(names, "room") == nullptr)
    names.emplace_back("room", std::string(*island));
  for (const auto& x : what.tuples)
    all_.push_back({filled_key(x.key, names),
                    x.json.empty() ? prefilled(x.text, names) : std::vector<template_part>{},
                    x.json, source_of(what, x)});
  for (const auto& x : what.fields)
    if (!x.words.empty())
      words_.push_back(x.name);
}

std::vector<tuple_templates::tuple> tuple_templates::at_start() const {
  std::vector<tuple> out;
  for (const auto& x : all_)
    if (!x.source)
      out.push_back({x.key, text_of(x.parts, {})});
  return out;
}

std::vector<tuple_templates::tuple> tuple_templates::on_readings(reading_source from,
                                                                 const std::vector<reading>& all,
                                                                 instant now) const {
  std::vector<tuple> out;
  for (const auto& x : all_)
    if (x.source == from)
      out.push_back(
          {x.key, x.json.empty() ? text_of(x.parts, all) : json_of(x.json, all, words_, now)});
  return out;
}

} // namespace rubicon::proxy
