#include "core/text/printable.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace rubicon {

namespace {

bool is_continuation(char x) {
  return (static_cast<unsigned char>(x) & 0xC0U) == 0x80U;
}

/// @pre one character
char32_t code_of(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1)
    return first;
  char32_t code = first & (0x7FU >> character.size());
  for (const char x : character.substr(1))
    code = code << 6U | (static_cast<unsigned char>(x) & 0x3FU);
  return code;
}

struct range {
  char32_t first;
  char32_t last;
};

/// Beside the controls below blank: DEL and C1; marks and overrides of direction; separators of
/// lines; what nobody sees (Unicode 15, categories Cc, Cf, Zl and Zp, without the joiners that
/// scripts need).
constexpr std::array disturbing{
    range{0x7F, 0x9F},     range{0x61C, 0x61C},    range{0x180E, 0x180E}, range{0x200B, 0x200B},
    range{0x200E, 0x200F}, range{0x2028, 0x202E},  range{0x2060, 0x206F}, range{0xFEFF, 0xFEFF},
    range{0xFFF9, 0xFFFB}, range{0xE0000, 0xE007F}};

bool is_disturbing(char32_t x) {
  return x < 0x20 || std::any_of(disturbing.begin(), disturbing.end(),
                                 [x](range y) { return x >= y.first && x <= y.last; });
}

void append_hex(std::string& to, char32_t x, unsigned digits) {
  for (auto i = digits; i > 0; --i)
    to += "0123456789abcdef"[x >> (4 * (i - 1)) & 0xFU];
}

void append_escaped(std::string& to, char32_t x) {
  if (x == '\n' || x == '\t' || x == '\r') {
    to += x == '\n' ? "\\n" : x == '\t' ? "\\t" : "\\r";
    return;
  }
  const unsigned digits = x < 0x80 ? 2 : x < 0x10000 ? 4 : 6;
  to += digits == 2 ? "\\x" : digits == 4 ? "\\u" : "\\U";
  append_hex(to, x, digits);
}

} // namespace

std::size_t character_size(std::string_view x) {
  const auto octet = [&](std::size_t i) { return static_cast<unsigned char>(x[i]); };
  const auto first = octet(0);
  if (first < 0x80)
    return 1;
  if (first < 0xC2 || first > 0xF4)
    return 0;
  const std::size_t size = first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  if (size > x.size())
    return 0;
  for (std::size_t i = 1; i < size; ++i)
    if (!is_continuation(x[i]))
      return 0;
  const bool overlong = (first == 0xE0 && octet(1) < 0xA0) || (first == 0xF0 && octet(1) < 0x90);
  const bool surrogate = first == 0xED && octet(1) >= 0xA0;
  const bool beyond = first == 0xF4 && octet(1) >= 0x90;
  return overlong || surrogate || beyond ? 0 : size;
}

std::string printable(std::string_view x, std::size_t octets_max) {
  std::string text;
  text.reserve(std::min(x.size(), octets_max));
  while (!x.empty()) {
    if (text.size() >= octets_max)
      return text + "…";
    const auto size = character_size(x);
    if (size == 0) {
      text += "\\x";
      append_hex(text, static_cast<unsigned char>(x[0]), 2);
    } else if (const auto code = code_of(x.substr(0, size)); is_disturbing(code)) {
      append_escaped(text, code);
    } else {
      text.append(x.substr(0, size));
    }
    x.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return text;
}

std::string printable_json(std::string json) {
  const auto is_plain = [](char x) { return static_cast<unsigned char>(x) < 0x7F; };
  if (std::all_of(json.begin(), json.end(), is_plain))
    return json;
  std::string text;
  text.reserve(json.size());
  for (std::string_view rest = json; !rest.empty();) {
    const auto size = std::max<std::size_t>(character_size(rest), 1);
    const auto code = code_of(rest.substr(0, size));
    if (code < 0x20 || !is_disturbing(code)) { // newlines between its elements
      text.append(rest.substr(0, size));
    } else if (code < 0x10000) {
      append_hex(text += "\\u", code, 4);
    } else { // a pair of surrogates (RFC 8259 section 7)
      append_hex(text += "\\u", 0xD800 + ((code - 0x10000) >> 10U), 4);
      append_hex(text += "\\u", 0xDC00 + ((code - 0x10000) & 0x3FFU), 4);
    }
    rest.remove_prefix(size);
  }
  return text;
}

} // namespace rubicon
