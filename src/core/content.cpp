#include "core/content.hpp"

#include <array>
#include <bit>
#include <cstring>

namespace rubicon::detail {

namespace {

std::uint64_t word_at(byte_view octets) {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < octets.size(); ++i)
    word |= static_cast<std::uint64_t>(octets[i]) << (8 * i);
  return word;
}

} // namespace

void fold_octets(fold64& into, byte_view x) {
  into.add(x.size());
  for (; x.size() >= 8; x = x.subspan(8)) {
    std::uint64_t word = 0; // the first octet in the lowest bits, whatever the machine's order
    if constexpr (std::endian::native == std::endian::little)
      std::memcpy(&word, x.data(), 8);
    else
      word = word_at(x.first(8));
    into.add(word);
  }
  if (!x.empty())
    into.add(word_at(x));
}

void fold_text(fold64& into, std::string_view x) {
  fold_octets(into, {reinterpret_cast<const std::uint8_t*>(x.data()), x.size()});
}

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
