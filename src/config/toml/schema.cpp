#include "config/toml/schema.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <sstream>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"

namespace rubicon::config {

namespace {

using json = nlohmann::ordered_json;

/// `sampler` of `app = "sampler"`.
std::string word_of(const std::string& title) {
  const auto begin = title.find('"') + 1;
  return title.substr(begin, title.rfind('"') - begin);
}

/// Collects tables that stand in several places under their titles.
class schema_writer {
public:
  json object_of(const table_description& x) {
    if (x.choice.empty())
      return plain(x.keys);
    json out{{"type", "object"}, {"required", json::array({x.choice})}};
    if (x.find(x.choice) != nullptr && !x.find(x.choice)->is_required)
      out.erase("required");
    for (const auto& variant : x.variants) {
      auto keys = x.keys;
      keys.insert(keys.end(), variant.keys.begin(), variant.keys.end());
      auto each = plain(keys);
      each["properties"][x.choice] = {{"const", word_of(variant.title)}};
      out["oneOf"].push_back(std::move(each));
    }
    if (!out.contains("required")) // then there may be none of the choices
      out["oneOf"].push_back(plain(x.keys, x.choice));
    return out;
  }

  json take_definitions() { return std::move(definitions_); }

private:
  json plain(const std::vector<key_description>& keys, const std::string& but = {}) {
    json out{{"type", "object"}, {"properties", json::object()}, {"additionalProperties", false}};
    for (const auto& key : keys) {
      if (key.name == but)
        continue;
      if (key.part == part::other_tables) {
        out["additionalProperties"] = value_of(key);
        continue;
      }
      out["properties"][key.name] = value_of(key);
      if (key.is_required)
        out["required"].push_back(key.name);
    }
    return out;
  }

  json value_of(const key_description& x) {
    json out = x.part == part::value ? parse_ordered_json(x.schema) : part_of(x);
    auto meaning = x.meaning;
    if (!x.unset.empty())
      meaning += (meaning.empty() ? "default: " : "; default: ") + x.unset;
    if (!meaning.empty())
      out["description"] = std::move(meaning);
    if (!x.standard.empty() && x.unset.empty())
      out["default"] = parse_ordered_json(x.standard);
    return out;
  }

  json part_of(const key_description& x) {
    const json one{{"$ref", "#/definitions/" + define(*x.table)}};
    if (x.part == part::tables) {
      json out{{"type", "array"}, {"items", one}};
      if (x.is_required)
        out["minItems"] = 1;
      return out;
    }
    if (x.part == part::named_tables)
      return {{"type", "object"}, {"additionalProperties", one}};
    // Beside a reference nothing else counts.
    if (!x.schema.empty())
      return {{"anyOf", json::array({parse_ordered_json(x.schema), one})}};
    return {{"allOf", json::array({one})}};
  }

  std::string define(const table_description& x) {
    std::string name;
    for (const char c : x.title)
      if (c == '.' || c == '_' || c == ' ' || std::isalnum(static_cast<unsigned char>(c)) != 0)
        name += c == ' ' ? '_' : c;
    if (!definitions_.contains(name)) {
      definitions_[name] = nullptr; // keeps its place before those that it refers to
      definitions_[name] = object_of(x);
    }
    return name;
  }

  json definitions_ = json::object();
};

void each_table(const table_description& x,
                const std::function<void(const table_description&)>& use) {
  use(x);
  for (const auto& key : x.keys)
    if (key.table)
      each_table(*key.table, use);
  for (const auto& variant : x.variants)
    each_table(variant, use);
}

std::vector<std::string> titles_if(const table_description& file,
                                   const std::function<bool(const table_description&)>& fits) {
  std::vector<std::string> out;
  each_table(file, [&](const table_description& x) {
    if (fits(x) && std::ranges::find(out, x.title) == out.end())
      out.push_back(x.title);
  });
  return out;
}

/// The place of a heading on its page, as Markdown makes it.
std::string anchor_of(const std::string& title) {
  std::string out;
  for (const char c : title) {
    if (c == ' ' || c == '-')
      out += '-';
    else if (c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return out;
}

std::string link_to(const std::string& text, const table_description& x) {
  return '[' + text + "](#" + anchor_of(x.title) + ')';
}

/// A value as a file has it.
std::string toml_of(const json& x) {
  if (!x.is_array())
    return json_line(x);
  std::string out;
  for (const auto& each : x)
    out += (out.empty() ? "" : ", ") + toml_of(each);
  return '[' + out + ']';
}

std::string default_of(const key_description& x) {
  if (!x.unset.empty() || x.standard.empty())
    return x.unset;
  return '`' + toml_of(parse_ordered_json(x.standard)) + '`';
}

/// Tables have a column of their own if one of their keys may change.
std::string change_cell(const key_description& x) {
  if (x.is_changeable)
    return change_of(x);
  return x.table == nullptr ? "no" : "see there";
}

} // namespace

const key_description* table_description::find(std::string_view key) const {
  const auto found = std::ranges::find(keys, key, &key_description::name);
  return found == keys.end() ? nullptr : &*found;
}

const table_description* table_description::variant(std::string_view word) const {
  const auto found = std::ranges::find_if(
      variants, [word](const table_description& x) { return word_of(x.title) == word; });
  return found == variants.end() ? nullptr : &*found;
}

std::string change_of(const key_description& x) {
  if (!x.is_changeable)
    return {};
  return x.effect.empty() ? "yes" : "yes: " + x.effect;
}

std::string wanted_of(const key_description& x) {
  if (!x.wanted.empty() || x.table == nullptr)
    return x.wanted;
  const auto& title = x.table->title;
  if (x.part == part::table || x.part == part::other_tables)
    return title.front() == '[' ? "table " + link_to('`' + title + '`', *x.table)
                                : link_to("table", *x.table);
  return (title.front() == '[' ? "tables " + link_to('`' + title + '`', *x.table)
                               : link_to("array of tables", *x.table)) +
         (x.is_required ? ", at least 1" : "");
}

std::string json_schema(const table_description& file) {
  schema_writer writer;
  json out{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Rubicon ecology"}};
  out.update(writer.object_of(file));
  out["definitions"] = writer.take_definitions();
  return json_lines(out) + '\n';
}

std::vector<std::string> titles_of(const table_description& file) {
  return titles_if(file, [](const table_description& x) { return !x.keys.empty(); });
}

std::vector<std::string> titles_with(const table_description& file, std::string_view key) {
  return titles_if(file, [key](const table_description& x) { return x.find(key) != nullptr; });
}

std::vector<const key_description*> keys_of(const table_description& file, std::string_view title) {
  std::vector<const key_description*> keys;
  each_table(file, [&](const table_description& x) {
    if (x.title != title)
      return;
    for (const auto& key : x.keys)
      if (key.name != x.choice &&
          std::ranges::find(keys, key.name, &key_description::name) == keys.end())
        keys.push_back(&key);
  });
  return keys;
}

std::string markdown_of(const table_description& file, std::string_view title) {
  const auto keys = keys_of(file, title);
  const bool some_change = std::ranges::any_of(keys, &key_description::is_changeable);
  std::string out;
  for (const auto* key : keys)
    out += "| `" + key->name + "` | " + wanted_of(*key) + " | " + default_of(*key) + " | " +
           (some_change ? change_cell(*key) + " | " : "") + key->meaning + " |\n";
  if (out.empty())
    return out;
  return (some_change ? "| Key | Value | Default | May change | Meaning |\n|---|---|---|---|---|\n"
                      : "| Key | Value | Default | Meaning |\n|---|---|---|---|\n") +
         out;
}

std::string with_tables(const table_description& file, const std::string& text) {
  const std::string begin = "<!-- keys of ";
  const std::string end = "<!-- end of keys -->";
  std::string out;
  bool in_table = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    in_table = in_table && line != end;
    if (!in_table)
      out += line + '\n';
    if (!line.starts_with(begin))
      continue;
    const auto title = line.substr(begin.size(), line.rfind(" -->") - begin.size());
    out += markdown_of(file, title);
    in_table = true;
  }
  return out;
}

} // namespace rubicon::config
