#include "peis/wire/link_url.hpp"

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

bool is_host(std::string_view x) {
  return !x.empty() && std::all_of(x.begin(), x.end(), [](char c) {
    return c > ' ' && c < 127 && c != '/' && c != ':' && c != ';';
  });
}

} // namespace

std::string to_string(const bluetooth_address& x) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string text;
  for (const auto octet : x.octets) {
    text += text.empty() ? "" : ":";
    text += digits[octet >> 4];
    text += digits[octet & 15];
  }
  return text;
}

result<bluetooth_address> parse_bluetooth_address(std::string_view text) {
  bluetooth_address x;
  if (text.size() != std::string_view("02:4B:00:1F:A0:07").size())
    return errc::bad_value;
  for (std::size_t i = 0; i < x.octets.size(); ++i) {
    const auto* begin = text.data() + 3 * i;
    const auto [end, error] = std::from_chars(begin, begin + 2, x.octets[i], 16);
    if (error != std::errc() || end != begin + 2 || (i > 0 && begin[-1] != ':'))
      return errc::bad_value;
  }
  return x;
}

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
  if (found->medium == scheme::bluetooth ? !parse_bluetooth_address(host) : !is_host(host))
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

std::optional<peer_id> inproc_peer(const link_url& x) {
  std::int32_t id = 0;
  const auto* const end = x.host.data() + x.host.size();
  const auto [stop, error] = std::from_chars(x.host.data(), end, id);
  if (x.medium != scheme::inproc || error != std::errc() || stop != end)
    return std::nullopt;
  return peer_id{id};
}

std::optional<bluetooth_address> bluetooth_device(const link_url& x) {
  const auto address = parse_bluetooth_address(x.host);
  return x.medium == scheme::bluetooth && address ? std::optional(*address) : std::nullopt;
}

link_url url_of(const low_level_address& x) {
  using kind = low_level_address::kind;
  const auto& a = x.address;
  if (x.type == kind::inproc)
    return {scheme::inproc, std::to_string(big_endian(a, 4, 4)), 0};
  if (x.type == kind::bluetooth) {
    return {scheme::bluetooth, to_string(bluetooth_address_of(x)),
            static_cast<std::uint16_t>(big_endian(a, 6, 2))};
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

low_level_address udp_interface(std::string device, bool loopback, std::array<std::uint8_t, 4> ipv4,
                                std::uint16_t port) {
  auto x = tcp_address(std::move(device), loopback, ipv4, port);
  x.type = low_level_address::kind::udp_ipv4;
  return x;
}

low_level_address inproc_address(std::uint32_t process, peer_id id) {
  low_level_address x{"inproc", true, low_level_address::kind::inproc, {}};
  put_big_endian(x.address, 0, process);
  put_big_endian(x.address, 4, static_cast<std::uint32_t>(id.value));
  return x;
}

low_level_address bluetooth_interface(std::string adapter, const bluetooth_address& address,
                                      std::uint16_t port) {
  low_level_address x{std::move(adapter), false, low_level_address::kind::bluetooth, {}};
  std::copy(address.octets.begin(), address.octets.end(), x.address.begin());
  x.address[6] = static_cast<std::uint8_t>(port >> 8);
  x.address[7] = static_cast<std::uint8_t>(port);
  return x;
}

bluetooth_address bluetooth_address_of(const low_level_address& x) {
  bluetooth_address address;
  std::copy_n(x.address.begin(), address.octets.size(), address.octets.begin());
  return address;
}

} // namespace rubicon::peis
