#include "peis/link_url.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace rubicon::peis {

namespace {

using scheme = link_url::scheme;

struct form {
  std::string_view prefix;
  scheme medium;
  char separator; ///< between host and port; NUL: there is no port
  std::uint16_t port_default;
};

constexpr std::array<form, 4> forms = {{
    {"tcp://", scheme::tcp, ':', tcp_port_default},
    {"udp://", scheme::udp, ':', tcp_port_default},
    {"bt://", scheme::bluetooth, ';', bluetooth_port_default},
    {"inproc://", scheme::inproc, '\0', 0},
}};

std::uint32_t big_endian(const std::array<std::uint8_t, 8>& x, std::size_t from, std::size_t size) {
  std::uint32_t value = 0;
  for (auto i = from; i < from + size; ++i)
    value = value << 8 | x[i];
  return value;
}

void put_big_endian(std::array<std::uint8_t, 8>& x, std::size_t from, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i)
    x[from + i] = static_cast<std::uint8_t>(value >> (8 * (3 - i)));
}

bool is_bluetooth_address(std::string_view x) {
  if (x.size() != 17)
    return false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool digit = (x[i] >= '0' && x[i] <= '9') || (x[i] >= 'a' && x[i] <= 'f') ||
                       (x[i] >= 'A' && x[i] <= 'F');
    if (i % 3 == 2 ? x[i] != ':' : !digit)
      return false;
  }
  return true;
}

bool is_host(std::string_view x) {
  return !x.empty() && std::all_of(x.begin(), x.end(), [](char c) {
    return c > ' ' && c < 127 && c != '/' && c != ':' && c != ';';
  });
}

} // namespace

result<link_url> parse_link_url(std::string_view text) {
  const auto found = std::find_if(forms.begin(), forms.end(),
                                  [&](const form& x) { return text.starts_with(x.prefix); });
  if (found == forms.end())
    return errc::bad_value;
  auto host = text.substr(found->prefix.size());
  auto port = found->port_default;
  if (const auto at = found->separator != '\0' ? host.rfind(found->separator) : host.npos;
      at != host.npos) {
    const auto digits = host.substr(at + 1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
    if (error != std::errc() || end != digits.data() + digits.size() || port == 0)
      return errc::bad_value;
    host = host.substr(0, at);
  }
  if (found->medium == scheme::bluetooth ? !is_bluetooth_address(host) : !is_host(host))
    return errc::bad_value;
  return link_url{found->medium, std::string(host), port};
}

std::string to_string(const link_url& x) {
  const auto& form = *std::find_if(forms.begin(), forms.end(),
                                   [&](const auto& f) { return f.medium == x.medium; });
  std::string text(form.prefix);
  text += x.host;
  if (form.separator != '\0')
    text += form.separator + std::to_string(x.port);
  return text;
}

link_url url_of(const low_level_address& x) {
  using kind = low_level_address::kind;
  const auto& a = x.address;
  if (x.type == kind::inproc)
    return {scheme::inproc, std::to_string(big_endian(a, 4, 4)), 0};
  if (x.type == kind::bluetooth) {
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string host;
    for (std::size_t i = 0; i < 6; ++i) {
      host += i == 0 ? "" : ":";
      host += digits[a[i] >> 4];
      host += digits[a[i] & 15];
    }
    return {scheme::bluetooth, host, static_cast<std::uint16_t>(big_endian(a, 6, 2))};
  }
  auto host = std::to_string(a[0]);
  for (std::size_t i = 1; i < 4; ++i)
    host += '.' + std::to_string(a[i]);
  return {x.type == kind::udp_ipv4 ? scheme::udp : scheme::tcp, host,
          static_cast<std::uint16_t>(big_endian(a, 4, 4))};
}

low_level_address tcp_address(std::string device, bool loopback, std::array<std::uint8_t, 4> ipv4,
                              std::uint16_t port) {
  low_level_address x{std::move(device), loopback, low_level_address::kind::tcp_ipv4, {}};
  std::copy(ipv4.begin(), ipv4.end(), x.address.begin());
  put_big_endian(x.address, 4, port);
  return x;
}

low_level_address inproc_address(std::uint32_t process, peer_id id) {
  low_level_address x{"inproc", true, low_level_address::kind::inproc, {}};
  put_big_endian(x.address, 0, process);
  put_big_endian(x.address, 4, static_cast<std::uint32_t>(id.value));
  return x;
}

} // namespace rubicon::peis
