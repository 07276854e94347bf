#include "core/bytes.hpp"

#include <cassert>

namespace rubicon {

payload::payload(bytes octets) : content_(std::make_shared<const content>(std::move(octets))) {}

payload payload::part(std::size_t offset, std::size_t count) const {
  assert(offset <= size() && count <= size() - offset);
  payload x;
  if (count > 0)
    x.content_ = std::make_shared<const content>(content_, view().subspan(offset, count));
  return x;
}

std::string to_hex(byte_view x) {
  static constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * x.size());
  for (const auto octet : x) {
    text += digits[octet >> 4];
    text += digits[octet & 0x0f];
  }
  return text;
}

namespace {

std::optional<unsigned> digit_value(char c) {
  if (c >= '0' && c <= '9')
    return static_cast<unsigned>(c - '0');
  if (c >= 'a' && c <= 'f')
    return static_cast<unsigned>(c - 'a' + 10);
  if (c >= 'A' && c <= 'F')
    return static_cast<unsigned>(c - 'A' + 10);
  return std::nullopt;
}

} // namespace

std::optional<bytes> from_hex(std::string_view x) {
  bytes octets;
  std::optional<unsigned> high;
  for (const char c : x) {
    if (c == ' ' || c == '\n' || c == '\t')
      continue;
    const auto value = digit_value(c);
    if (!value)
      return std::nullopt;
    if (high) {
      octets.push_back(static_cast<std::uint8_t>(*high << 4 | *value));
      high.reset();
    } else {
      high = value;
    }
  }
  if (high)
    return std::nullopt;
  return octets;
}

} // namespace rubicon
