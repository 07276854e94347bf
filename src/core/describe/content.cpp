#include "core/describe/content.hpp"

#include <array>

namespace rubicon::detail {

void print_text(std::string& out, std::string_view x) {
  out += '"';
  for (const char c : x) {
    if (c == '"' || c == '\\')
      out += '\\';
    out += c;
  }
  out += '"';
}

void print_octets(std::string& out, byte_view x) {
  out += to_hex(x);
}

void print_number(std::string& out, double x) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr;
  out.append(digits.data(), end);
}

} // namespace rubicon::detail
