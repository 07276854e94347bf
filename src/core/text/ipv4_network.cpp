#include "core/text/ipv4_network.hpp"

#include <charconv>
#include <optional>
#include <system_error>

namespace rubicon {

namespace {

/// A whole number without sign or leading zeros, from the start of the text, which it is cut from.
std::optional<unsigned> take_number(std::string_view& text, unsigned max) {
  unsigned x = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  const auto digits = static_cast<std::size_t>(stop - text.data());
  if (error != std::errc{} || x > max || (digits > 1 && text.front() == '0'))
    return std::nullopt;
  text.remove_prefix(digits);
  return x;
}

bool take(std::string_view& text, char x) {
  if (!text.starts_with(x))
    return false;
  text.remove_prefix(1);
  return true;
}

std::optional<ipv4_address> take_address(std::string_view& text) {
  ipv4_address out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (i > 0 && !take(text, '.'))
      return std::nullopt;
    const auto octet = take_number(text, 255);
    if (!octet)
      return std::nullopt;
    out[i] = static_cast<std::uint8_t>(*octet);
  }
  return out;
}

/// Those of the i-th octet that count.
std::uint8_t mask(std::uint8_t prefix, std::size_t i) {
  const int bits = prefix - static_cast<int>(8 * i);
  return static_cast<std::uint8_t>(bits >= 8 ? 0xff : bits <= 0 ? 0 : 0xff << (8 - bits));
}

} // namespace

bool ipv4_network::contains(const ipv4_address& x) const {
  for (std::size_t i = 0; i < x.size(); ++i)
    if ((x[i] & mask(prefix, i)) != address[i])
      return false;
  return true;
}

result<ipv4_address> parse_ipv4_address(std::string_view text) {
  const auto found = take_address(text);
  if (!found || !text.empty())
    return errc::bad_value;
  return *found;
}

result<ipv4_network> parse_ipv4_network(std::string_view text) {
  const auto address = take_address(text);
  if (!address)
    return errc::bad_value;
  ipv4_network out{*address};
  if (take(text, '/')) {
    const auto prefix = take_number(text, 32);
    if (!prefix)
      return errc::bad_value;
    out.prefix = static_cast<std::uint8_t>(*prefix);
  }
  if (!text.empty() || !out.contains(*address))
    return errc::bad_value;
  return out;
}

std::string to_string(const ipv4_network& x) {
  auto text = std::to_string(x.address[0]);
  for (std::size_t i = 1; i < x.address.size(); ++i)
    text += '.' + std::to_string(x.address[i]);
  return x.prefix == 32 ? text : text + '/' + std::to_string(x.prefix);
}

} // namespace rubicon
