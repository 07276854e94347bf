#include "core/tuples/device_keys.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <optional>

#include "core/codec.hpp"

namespace rubicon {

namespace {

constexpr std::string_view leads_word = "leads";
constexpr std::string_view stands_by_word = "stands_by";

constexpr std::array<input_outcome, 5> all_outcomes{
    input_outcome::pending, input_outcome::acknowledged, input_outcome::failed,
    input_outcome::unreachable, input_outcome::sent};

constexpr std::array<std::string_view, 3> presences{"listed", "stale", "left"};

/// A decimal number as we write them: digits only, no leading zero unless it is 0.
template <class T>
std::optional<T> parse_decimal(std::string_view text, T min, T max) {
  T value = 0;
  const auto* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || value < min || value > max)
    return std::nullopt;
  if (text.size() > 1 && text.front() == '0')
    return std::nullopt;
  return value;
}

/// Seconds with six decimals, as to_text() writes them.
std::optional<instant> parse_seconds(std::string_view text) {
  constexpr std::size_t decimals = 6;
  const auto point = text.find('.');
  if (point == std::string_view::npos || text.size() - point - 1 != decimals)
    return std::nullopt;
  const auto whole =
      parse_decimal<std::int64_t>(text.substr(0, point), 0, INT64_MAX / 1'000'000'000);
  std::int64_t micros = 0;
  for (const auto digit : text.substr(point + 1)) {
    if (digit < '0' || digit > '9')
      return std::nullopt;
    micros = 10 * micros + (digit - '0');
  }
  if (!whole)
    return std::nullopt;
  return instant(std::chrono::seconds(*whole) + std::chrono::microseconds(micros));
}

std::optional<mote_id> parse_mote(std::string_view text) {
  const auto value = parse_decimal<std::uint16_t>(text, 0, mote_id_max);
  return value ? std::optional(mote_id{*value}) : std::nullopt;
}

/// Letter case does not distinguish keys (docs/peis-wire.md 15.7); `word` is in lower case.
bool is_word(std::string_view text, std::string_view word) {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(), [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

constexpr std::size_t parts_max = 5;

/// @returns the parts between the dots; more than parts_max are cut off after one too many
std::vector<std::string_view> split(std::string_view key) {
  std::vector<std::string_view> parts;
  while (parts.size() <= parts_max) {
    const auto dot = key.find('.');
    parts.push_back(key.substr(0, dot));
    if (dot == std::string_view::npos)
      break;
    key.remove_prefix(dot + 1);
  }
  return parts;
}

std::optional<device_tuple> kind_of(const std::vector<std::string_view>& parts) {
  switch (parts.size()) {
  case 1:
    return device_tuple::list;
  case 2:
    if (is_word(parts[1], "line"))
      return device_tuple::line;
    if (is_word(parts[1], "role"))
      return device_tuple::role;
    if (is_word(parts[1], "gateways"))
      return device_tuple::gateways;
    return std::nullopt;
  case 3:
    if (is_word(parts[2], "status"))
      return device_tuple::status;
    if (is_word(parts[2], "type"))
      return device_tuple::type;
    if (is_word(parts[2], "descriptor"))
      return device_tuple::descriptor;
    return std::nullopt;
  case 4:
    if (is_word(parts[2], "output"))
      return device_tuple::output;
    if (is_word(parts[2], "input"))
      return device_tuple::input;
    return std::nullopt;
  case 5:
    if (is_word(parts[2], "input") && is_word(parts[4], "status"))
      return device_tuple::input_status;
    if (is_word(parts[2], "output") && is_word(parts[4], "period"))
      return device_tuple::output_period;
    return std::nullopt;
  default:
    return std::nullopt;
  }
}

} // namespace

std::string to_string(const device_key& x) {
  std::string key(devices_key);
  if (x.what == device_tuple::list)
    return key;
  if (x.what == device_tuple::line)
    return std::string(device_line_key);
  if (x.what == device_tuple::role)
    return std::string(device_role_key);
  if (x.what == device_tuple::gateways)
    return std::string(device_gateways_key);
  assert(x.mote.value <= mote_id_max);
  key += '.' + to_string(x.mote);
  switch (x.what) {
  case device_tuple::list:
  case device_tuple::line:
  case device_tuple::role:
  case device_tuple::gateways:
    break;
  case device_tuple::status:
    key += ".status";
    break;
  case device_tuple::type:
    key += ".type";
    break;
  case device_tuple::descriptor:
    key += ".descriptor";
    break;
  case device_tuple::output:
    key += ".output." + std::to_string(x.channel);
    break;
  case device_tuple::output_period:
    key += ".output." + std::to_string(x.channel) + ".period";
    break;
  case device_tuple::input:
    key += ".input." + std::to_string(x.channel);
    break;
  case device_tuple::input_status:
    key += ".input." + std::to_string(x.channel) + ".status";
    break;
  }
  return key;
}

std::string device_type_key(mote_id mote) {
  return to_string(device_key{device_tuple::type, mote, 0});
}

std::string device_descriptor_key(mote_id mote) {
  return to_string(device_key{device_tuple::descriptor, mote, 0});
}

std::string device_status_key(mote_id mote) {
  return to_string(device_key{device_tuple::status, mote, 0});
}

std::string device_output_key(mote_id mote, std::uint16_t channel) {
  return to_string(device_key{device_tuple::output, mote, channel});
}

std::string device_output_period_key(mote_id mote, std::uint16_t channel) {
  return to_string(device_key{device_tuple::output_period, mote, channel});
}

std::string device_input_key(mote_id mote, std::uint16_t channel) {
  return to_string(device_key{device_tuple::input, mote, channel});
}

std::string device_input_status_key(mote_id mote, std::uint16_t channel) {
  return to_string(device_key{device_tuple::input_status, mote, channel});
}

result<device_key> parse_device_key(std::string_view key) {
  const auto parts = split(key);
  const auto kind = kind_of(parts);
  if (!kind || !is_word(parts[0], devices_key))
    return errc::bad_value;
  device_key x{*kind, mote_id{}, 0};
  if (parts.size() > 2) {
    const auto mote = parse_mote(parts[1]);
    if (!mote)
      return errc::bad_value;
    x.mote = *mote;
  }
  if (parts.size() > 3) {
    const auto channel = parse_decimal<std::uint16_t>(parts[3], 0, 0xffff);
    if (!channel)
      return errc::bad_value;
    x.channel = *channel;
  }
  return x;
}

/// The parts between the dots with every wildcard replaced; parse_device_key() does the rest.
result<output_pattern> parse_output_pattern(std::string_view key) {
  constexpr std::string_view wildcard = "*";
  std::string literal;
  bool any_mote = false;
  bool any_channel = false;
  const auto parts = split(key);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool is_any = i > 0 && parts[i] == wildcard;
    any_mote = any_mote || (is_any && i == 1);
    any_channel = any_channel || (is_any && i == 3);
    literal += i == 0 ? "" : ".";
    literal += !is_any ? parts[i] : i == 2 ? "output" : "1";
  }
  const auto parsed = parse_device_key(literal);
  if (!parsed || parsed->what != device_tuple::output)
    return errc::bad_value;
  output_pattern x;
  if (!any_mote)
    x.mote = parsed->mote;
  if (!any_channel)
    x.channel = parsed->channel;
  return x;
}

std::string device_list_text(std::vector<mote_id> motes) {
  std::sort(motes.begin(), motes.end());
  motes.erase(std::unique(motes.begin(), motes.end()), motes.end());
  std::string text = "{";
  for (const auto mote : motes) {
    if (text.size() > 1)
      text += ',';
    text += to_string(mote);
  }
  return text + '}';
}

result<std::vector<mote_id>> parse_device_list(std::string_view text) {
  if (text.size() < 2 || text.front() != '{' || text.back() != '}')
    return errc::bad_value;
  text = text.substr(1, text.size() - 2);
  std::vector<mote_id> motes;
  if (text.empty())
    return motes;
  for (;;) {
    const auto comma = text.find(',');
    const auto mote = parse_mote(text.substr(0, comma));
    if (!mote || (!motes.empty() && *mote <= motes.back()))
      return errc::bad_value;
    motes.push_back(*mote);
    if (comma == std::string_view::npos)
      return motes;
    text.remove_prefix(comma + 1);
  }
}

bytes device_type_octets(std::uint32_t type) {
  return byte_writer().big(type).finish();
}

result<std::uint32_t> parse_device_type(byte_view octets) {
  if (octets.size() != sizeof(std::uint32_t))
    return octets.size() < sizeof(std::uint32_t) ? errc::truncated : errc::too_long;
  return byte_reader(octets).big<std::uint32_t>();
}

std::string to_string(const device_status& x) {
  std::string text(presences[static_cast<std::size_t>(x.presence)]);
  if (x.presence == device_presence::left)
    text += ' ' + x.cause;
  return text + ' ' + to_text(x.since);
}

result<device_status> parse_device_status(std::string_view text) {
  const auto first = text.find(' ');
  const auto last = text.rfind(' ');
  const auto word = std::ranges::find(presences, text.substr(0, first));
  if (last == std::string_view::npos || word == presences.end())
    return errc::bad_value;
  device_status x;
  x.presence = static_cast<device_presence>(word - presences.begin());
  if ((x.presence == device_presence::left) != (first != last))
    return errc::bad_value;
  if (first != last)
    x.cause = text.substr(first + 1, last - first - 1);
  const auto since = parse_seconds(text.substr(last + 1));
  if (!since || x.cause.find(' ') != std::string::npos || (first != last && x.cause.empty()))
    return errc::bad_value;
  x.since = *since;
  return x;
}

std::string device_role_text(bool leads, instant since) {
  return std::string(leads ? leads_word : stands_by_word) + ' ' + to_text(since);
}

result<bool> parse_device_role(std::string_view text) {
  const auto blank = text.find(' ');
  const auto word = text.substr(0, blank);
  if (blank == std::string_view::npos || !parse_seconds(text.substr(blank + 1)) ||
      (word != leads_word && word != stands_by_word))
    return errc::bad_value;
  return word == leads_word;
}

result<std::chrono::milliseconds> parse_output_period(std::string_view text) {
  const auto value = parse_decimal<std::uint32_t>(text, 0, UINT32_MAX);
  if (!value)
    return errc::bad_value;
  return std::chrono::milliseconds(*value);
}

std::string_view to_string(input_outcome x) {
  switch (x) {
  case input_outcome::pending:
    return "pending";
  case input_outcome::acknowledged:
    return "acknowledged";
  case input_outcome::failed:
    return "failed";
  case input_outcome::unreachable:
    return "unreachable";
  case input_outcome::sent:
    return "sent";
  }
  return "unknown";
}

std::string to_string(const input_status& x) {
  return std::to_string(x.sequence).append(1, ' ').append(to_string(x.outcome));
}

result<input_status> parse_input_status(std::string_view text) {
  const auto blank = text.find(' ');
  if (blank == std::string_view::npos)
    return errc::bad_value;
  const auto sequence = parse_decimal<std::uint64_t>(text.substr(0, blank), 1, UINT64_MAX);
  if (!sequence)
    return errc::bad_value;
  for (const auto outcome : all_outcomes)
    if (text.substr(blank + 1) == to_string(outcome))
      return input_status{*sequence, outcome};
  return errc::bad_value;
}

std::string_view tuple_text(byte_view value) {
  if (value.empty())
    return {};
  const std::string_view text(reinterpret_cast<const char*>(value.data()), value.size());
  return text.substr(0, text.find('\0'));
}

} // namespace rubicon
