#include "config/toml/document.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "config/toml/text_check.hpp"
#include "config/toml/toml_library.hpp"

namespace rubicon::config {

namespace {

mark to_mark(const toml::source_region& x) {
  return {static_cast<unsigned>(x.begin.line), static_cast<unsigned>(x.begin.column)};
}

node to_node(const toml::node& x);

node_table to_table(const toml::table& x) {
  node_table members;
  members.reserve(x.size());
  for (auto&& [key, value] : x)
    members.push_back({std::string(key.str()), to_mark(key.source()), to_node(value)});
  std::stable_sort(members.begin(), members.end(),
                   [](const member& a, const member& b) { return a.at < b.at; });
  return members;
}

node_array to_array(const toml::array& x) {
  node_array elements;
  elements.reserve(x.size());
  for (auto&& element : x)
    elements.push_back(to_node(element));
  return elements;
}

node to_node(const toml::node& x) {
  node out{to_mark(x.source()), date_or_time{}};
  if (const auto* table = x.as_table())
    out.content = to_table(*table);
  else if (const auto* array = x.as_array())
    out.content = to_array(*array);
  else if (const auto* text = x.as_string())
    out.content = text->get();
  else if (const auto* whole = x.as_integer())
    out.content = whole->get();
  else if (const auto* real = x.as_floating_point())
    out.content = real->get();
  else if (const auto* flag = x.as_boolean())
    out.content = flag->get();
  return out;
}

std::optional<problem> unfit(std::string_view text, const std::string& file) {
  if (text.empty())
    return problem{file, 0, 0,
                   "is empty; an ecology needs [ecology] and an [[island]] or [[peer]]"};
  if (text.size() > file_octets_max)
    return problem{file, 0, 0, "is larger than " + std::to_string(file_octets_max) + " octets"};
  if (const auto at = text.find('\0'); at != std::string_view::npos)
    return problem{file, 0, 0,
                   "is a binary file, not TOML: octet " + std::to_string(at) + " is NUL"};
  if (const auto at = overlong_key(text))
    return problem{file, at->line, at->column,
                   "a key has more than " + std::to_string(key_dots_max) + " dots"};
  return std::nullopt;
}

/// Where the value on that line begins, and it, if it is a text without quotes.
std::optional<std::pair<mark, std::string_view>> bare_text(std::string_view text,
                                                           unsigned at_line) {
  for (unsigned line = 1; line < at_line; ++line) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos)
      return std::nullopt;
    text.remove_prefix(end + 1);
  }
  text = text.substr(0, text.find_first_of("#\r\n"));
  const auto equals = text.find('=');
  if (equals == std::string_view::npos || text.find_first_of("\"'[{") < equals)
    return std::nullopt;
  const auto first = text.find_first_not_of(" \t", equals + 1);
  if (first == std::string_view::npos)
    return std::nullopt;
  const auto value = text.substr(first, text.find_last_not_of(" \t") + 1 - first);
  const bool is_plain = std::ranges::all_of(value, [](char x) {
    const auto octet = static_cast<unsigned char>(x);
    return octet >= 0x80 || std::isalnum(octet) != 0 ||
           std::string_view("-_.:/%+ ").find(x) != std::string_view::npos;
  });
  if (!is_plain || toml::parse("x = " + std::string(value)))
    return std::nullopt;
  return std::pair(mark{at_line, static_cast<unsigned>(first) + 1}, value);
}

/// Whether a value begins or ends with a quote that a word processor has made.
bool has_typographic_quotes(std::string_view value) {
  constexpr std::array<std::string_view, 6> quotes{"“", "”", "„", "‘", "’", "«"};
  return std::ranges::any_of(quotes, [value](std::string_view each) {
    return value.starts_with(each) || value.ends_with(each);
  });
}

/// What the parser says of a syntax error, in words that name the cure where it is a usual one.
std::string cause_of(std::string_view description) {
  const bool is_unclosed = description.starts_with("Error while parsing string") &&
                           description.find("unescaped control characters") != description.npos;
  return is_unclosed ? "the text is not closed: the quote at its end is missing"
                     : std::string(description);
}

struct describer {
  std::string operator()(const node_table&) const { return "a table"; }
  std::string operator()(const node_array& x) const {
    return x.empty() ? "an empty array" : "an array of " + std::to_string(x.size());
  }
  std::string operator()(const std::string& x) const { return in_quotes(x); }
  std::string operator()(std::int64_t x) const { return std::to_string(x); }
  std::string operator()(double x) const {
    auto text = shown(x);
    return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
  }
  std::string operator()(bool x) const { return x ? "true" : "false"; }
  std::string operator()(const date_or_time&) const { return "a date or time"; }
};

} // namespace

const node* node::find(std::string_view key) const {
  const auto* members = as<node_table>();
  if (members == nullptr)
    return nullptr;
  const auto found = std::find_if(members->begin(), members->end(),
                                  [key](const member& x) { return x.key == key; });
  return found == members->end() ? nullptr : &found->value;
}

std::string describe(const node& x) {
  return std::visit(describer{}, x.content);
}

std::string in_quotes(std::string_view x) {
  constexpr std::size_t octets_max = 60;
  if (x.size() <= octets_max)
    return '"' + std::string(x) + '"';
  auto end = octets_max;
  while (end > 0 && (static_cast<unsigned char>(x[end]) & 0xc0U) == 0x80U)
    --end; // not inside a UTF-8 character
  return '"' + std::string(x.substr(0, end)) + "...\"";
}

std::string shown(double x) {
  std::array<char, 64> text{};
  const bool plain = std::abs(x) >= 1e-6 && std::abs(x) < 1e15;
  const auto format = plain || x == 0 ? std::chars_format::fixed : std::chars_format::general;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), x, format).ptr;
  return {text.data(), end};
}

namespace {

/// A value that is none.
std::string what_is_wrong_with(std::string_view bare) {
  if (has_typographic_quotes(bare))
    return "a text needs straight quotes (\"), not typographic ones: " + std::string(bare);
  const auto digits = bare.substr(bare.starts_with('-') || bare.starts_with('+') ? 1 : 0);
  if (!digits.empty() && digits.find_first_not_of("0123456789_") == std::string_view::npos)
    return "a whole number has 64 bits and no zeros in front: " + in_quotes(bare);
  return "a text needs quotes: " + in_quotes(bare);
}

} // namespace

std::variant<node, problem> parse(std::string_view text, const std::string& file) {
  if (auto reason = unfit(text, file))
    return *std::move(reason);
  if (text.starts_with(byte_order_mark))
    text.remove_prefix(byte_order_mark.size());
  const auto parsed = toml::parse(text);
  if (parsed)
    return to_node(parsed.table());
  complaints found;
  const auto at = to_mark(parsed.error().source());
  if (const auto bare = bare_text(text, at.line))
    found.add(bare->first, what_is_wrong_with(bare->second));
  else
    found.add(at, cause_of(parsed.error().description()));
  return found.of_file(file).front();
}

} // namespace rubicon::config
