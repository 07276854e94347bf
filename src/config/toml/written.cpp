#include "config/toml/written.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <variant>

#include "core/text/name.hpp"

namespace rubicon::config {

namespace {

std::string in_toml(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out = "\"";
  for (const char x : text) {
    const auto octet = static_cast<unsigned char>(x);
    if (x == '"' || x == '\\')
      out += '\\';
    if (octet < 0x20 || octet == 0x7f)
      out += std::string("\\u00") + digits[octet >> 4U] + digits[octet & 0xfU];
    else
      out += x;
  }
  return out + '"';
}

std::string key_of(const std::string& key) {
  return !key.empty() && std::ranges::all_of(key, is_name_character) ? key : in_toml(key);
}

bool is_tables(const node& x) {
  const auto* elements = x.as<node_array>();
  return elements != nullptr && !elements->empty() &&
         std::ranges::all_of(*elements,
                             [](const node& y) { return y.as<node_table>() != nullptr; });
}

std::string written_value(const node& x);

struct value_writer {
  std::string operator()(const node_table& x) const {
    std::string out;
    for (const auto& each : x)
      out += (out.empty() ? " " : ", ") + key_of(each.key) + " = " + written_value(each.value);
    return '{' + out + (out.empty() ? "}" : " }");
  }
  std::string operator()(const node_array& x) const {
    std::string out;
    for (const auto& each : x)
      out += (out.empty() ? "" : ", ") + written_value(each);
    return '[' + out + ']';
  }
  std::string operator()(const std::string& x) const { return in_toml(x); }
  std::string operator()(std::int64_t x) const { return std::to_string(x); }
  std::string operator()(double x) const {
    if (!std::isfinite(x))
      return std::isnan(x) ? "nan" : x < 0 ? "-inf" : "inf";
    const auto text = shown(x);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
  }
  std::string operator()(bool x) const { return x ? "true" : "false"; }
  std::string operator()(const date_or_time& /*x*/) const { return "\"\""; }
};

std::string written_value(const node& x) {
  return std::visit(value_writer{}, x.content);
}

void write(const node_table& table, const std::string& path, std::string& out) {
  for (const auto& each : table)
    if (each.value.as<node_table>() == nullptr && !is_tables(each.value))
      out += key_of(each.key) + " = " + written_value(each.value) + '\n';
  for (const auto& each : table) {
    const auto below = path + (path.empty() ? "" : ".") + key_of(each.key);
    if (const auto* members = each.value.as<node_table>()) {
      out += "\n[" + below + "]\n";
      write(*members, below, out);
    } else if (is_tables(each.value)) {
      for (const auto& element : *each.value.as<node_array>()) {
        out += "\n[[" + below + "]]\n";
        write(*element.as<node_table>(), below, out);
      }
    }
  }
}

} // namespace

std::string written(const node& root) {
  std::string out;
  write(*root.as<node_table>(), {}, out);
  return out;
}

} // namespace rubicon::config
