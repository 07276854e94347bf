#include "config/toml/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

namespace rubicon::config {

namespace {

constexpr std::string_view digits = "0123456789";

void skip_blanks(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
}

/// The leading characters of `text` that are in `set`, taken off it.
std::string_view take(std::string_view& text, std::string_view set) {
  const auto head = text.substr(0, text.find_first_not_of(set));
  text.remove_prefix(head.size());
  return head;
}

struct time_unit {
  std::string_view name;
  std::int64_t nanoseconds;
};

constexpr std::array<time_unit, 7> time_units{{{"d", 86'400'000'000'000},
                                               {"h", 3'600'000'000'000},
                                               {"min", 60'000'000'000},
                                               {"s", 1'000'000'000},
                                               {"ms", 1'000'000},
                                               {"us", 1'000},
                                               {"ns", 1}}};

constexpr std::array<std::pair<std::string_view, double>, 4> bit_rate_units{
    {{"bit/s", 1}, {"kbit/s", 1e3}, {"Mbit/s", 1e6}, {"Gbit/s", 1e9}}};

constexpr auto count_max = std::numeric_limits<std::int64_t>::max();

/// `whole`.`decimals` units in nanoseconds, exactly or not at all.
std::optional<std::int64_t> scaled(std::string_view whole, std::string_view decimals,
                                   std::int64_t unit) {
  std::int64_t count = 0;
  const auto [stop, error] = std::from_chars(whole.data(), whole.data() + whole.size(), count);
  if (error != std::errc{} || stop != whole.data() + whole.size() || count > count_max / unit)
    return std::nullopt;
  auto total = count * unit;
  for (const char digit : decimals) {
    if (unit % 10 != 0 && digit != '0')
      return std::nullopt;
    unit /= 10;
    const auto part = (digit - '0') * unit;
    if (part > count_max - total)
      return std::nullopt;
    total += part;
  }
  return total;
}

/// One number and its unit, taken off `text`. The unit must be behind `units_from`, which moves on.
std::optional<std::int64_t> take_part(std::string_view& text, std::size_t& units_from) {
  const auto whole = take(text, digits);
  std::string_view decimals;
  if (text.starts_with('.')) {
    text.remove_prefix(1);
    decimals = take(text, digits);
    if (decimals.empty())
      return std::nullopt;
  }
  skip_blanks(text);
  const auto name = take(text, "dhimnsu");
  for (auto i = units_from; i < time_units.size(); ++i) {
    if (time_units[i].name == name) {
      units_from = i + 1;
      return scaled(whole, decimals, time_units[i].nanoseconds);
    }
  }
  return std::nullopt;
}

/// A plain decimal number, and the unit behind it.
struct measured {
  double number = 0;
  std::string_view unit;
};

std::optional<measured> measure(std::string_view text) {
  const auto number = take(text, "0123456789.");
  measured out;
  const auto end = number.data() + number.size();
  const auto [stop, error] =
      std::from_chars(number.data(), end, out.number, std::chars_format::fixed);
  if (error != std::errc{} || stop != end || number.front() == '.')
    return std::nullopt;
  skip_blanks(text);
  out.unit = text;
  return out;
}

/// The number in front of `unit`, with a minus or none.
std::optional<double> signed_with_unit(std::string_view text, std::string_view unit) {
  const bool negative = text.starts_with('-');
  if (negative)
    text.remove_prefix(1);
  const auto x = measure(text);
  if (!x || x->unit != unit)
    return std::nullopt;
  return negative ? -x->number : x->number;
}

} // namespace

std::optional<duration> parse_duration(std::string_view text) {
  std::int64_t total = 0;
  std::size_t units_from = 0;
  if (text.empty())
    return std::nullopt;
  while (!text.empty()) {
    const auto part = take_part(text, units_from);
    if (!part || *part > count_max - total)
      return std::nullopt;
    total += *part;
    if (!text.empty())
      skip_blanks(text);
  }
  return duration(total);
}

std::optional<double> parse_ratio(std::string_view text) {
  const auto x = measure(text);
  if (!x || x->unit != "%")
    return std::nullopt;
  return x->number / 100;
}

std::optional<double> parse_length_m(std::string_view text) {
  const auto x = measure(text);
  if (!x)
    return std::nullopt;
  if (x->unit == "m")
    return x->number;
  if (x->unit == "km")
    return x->number * 1000;
  if (x->unit == "cm")
    return x->number / 100;
  return std::nullopt;
}

std::optional<double> parse_charge_mah(std::string_view text) {
  constexpr double joules_in_mah = 3.6 * battery_v;
  const auto x = measure(text);
  if (!x)
    return std::nullopt;
  if (x->unit == "J")
    return x->number / joules_in_mah;
  if (x->unit == "kJ")
    return x->number * 1000 / joules_in_mah;
  if (x->unit == "mAh")
    return x->number;
  if (x->unit == "Ah")
    return x->number * 1000;
  return std::nullopt;
}

std::optional<double> parse_dbm(std::string_view text) {
  return signed_with_unit(text, "dBm");
}

std::optional<double> parse_db(std::string_view text) {
  return signed_with_unit(text, "dB");
}

std::optional<double> parse_frequency_mhz(std::string_view text) {
  const auto x = measure(text);
  if (!x)
    return std::nullopt;
  if (x->unit == "MHz")
    return x->number;
  if (x->unit == "GHz")
    return x->number * 1000;
  return std::nullopt;
}

std::optional<double> parse_bit_rate_bps(std::string_view text) {
  const auto x = measure(text);
  if (!x)
    return std::nullopt;
  for (const auto& [unit, factor] : bit_rate_units) {
    if (x->unit == unit)
      return x->number * factor;
  }
  return std::nullopt;
}

std::optional<std::int64_t> parse_baud(std::string_view text) {
  // as TinyOS's own tools call the rates of motes (tinyos.md 1.1)
  static constexpr std::pair<std::string_view, std::int64_t> platforms[] = {
      {"mica", 19200},    {"mica2dot", 19200},    {"mica2", 57600},    {"eyesIFX", 57600},
      {"micaz", 57600},   {"iris", 57600},        {"telos", 115200},   {"telosb", 115200},
      {"tmote", 115200},  {"intelmote2", 115200}, {"shimmer", 115200}, {"tinynode", 115200},
      {"ucmini", 115200},
  };
  for (const auto& [name, rate] : platforms)
    if (text == name)
      return rate;
  const auto number = take(text, digits);
  skip_blanks(text);
  std::int64_t out = 0;
  const auto end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, out);
  if (text != "baud" || error != std::errc{} || stop != end)
    return std::nullopt;
  return out;
}

} // namespace rubicon::config
