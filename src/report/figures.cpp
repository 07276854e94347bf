#include "report/figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>

namespace rubicon::report {

namespace {

constexpr const char* nothing = "–";

/// Digits with a comma every three of them, counted from the right.
std::string grouped(std::string_view digits) {
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0)
      text += ',';
    text += digits[i];
  }
  return text;
}

std::string padded_two(std::uint64_t x) {
  return (x < 10 ? "0" : "") + std::to_string(x);
}

} // namespace

std::string with_thousands(std::uint64_t x) {
  return grouped(std::to_string(x));
}

std::string fixed(double x, int decimals) {
  if (!std::isfinite(x))
    return nothing;
  std::array<char, 400> text{};
  const auto length = std::snprintf(text.data(), text.size(), "%.*f", decimals, std::fabs(x));
  const std::string_view digits(text.data(), static_cast<std::size_t>(length));
  const auto point = std::min(digits.find('.'), digits.size());
  const bool is_zero = digits.find_first_of("123456789") == std::string_view::npos;
  return (std::signbit(x) && !is_zero ? "-" : "") +
         grouped(digits.substr(0, point)).append(digits.substr(point));
}

std::string percent(double part, double whole) {
  if (!(whole > 0))
    return nothing;
  const auto share = 100 * part / whole;
  if (part > 0 && share < 0.05)
    return "<0.1%";
  if (part < whole && share >= 99.95)
    return ">99.9%";
  return fixed(share, 1) + "%";
}

std::string speed_factor(duration simulated, double wall_s) {
  if (!(wall_s > 0))
    return nothing;
  const auto factor = seconds(simulated) / wall_s;
  if (factor < 100)
    return fixed(factor, 1) + " ×";
  return with_thousands(static_cast<std::uint64_t>(std::llround(factor))) + " ×";
}

std::string real_time(double wall_s) {
  if (!std::isfinite(wall_s) || wall_s < 0)
    return nothing;
  if (wall_s < 0.0995)
    return fixed(wall_s * 1000, 1) + " ms";
  if (wall_s < 9.995)
    return fixed(wall_s, 2) + " s";
  if (wall_s < 59.95)
    return fixed(wall_s, 1) + " s";
  const auto whole_s = static_cast<std::uint64_t>(std::llround(wall_s));
  if (whole_s < 3600)
    return std::to_string(whole_s / 60) + " min " + padded_two(whole_s % 60) + " s";
  return with_thousands(whole_s / 3600) + " h " + padded_two(whole_s / 60 % 60) + " min";
}

std::string span_text(duration length, instant from) {
  return real_time(seconds(length)) + " from " + clock_text(from.time_since_epoch());
}

std::string clock_text(duration x) {
  const auto whole_s = static_cast<std::uint64_t>(std::max<std::int64_t>(x / 1s, 0));
  if (whole_s < 3600)
    return std::to_string(whole_s / 60) + ':' + padded_two(whole_s % 60);
  return std::to_string(whole_s / 3600) + ':' + padded_two(whole_s / 60 % 60) + ':' +
         padded_two(whole_s % 60);
}

std::string run_time(instant x) {
  const auto since = std::max(x.time_since_epoch(), duration{});
  const auto ms = static_cast<std::uint64_t>(since / 1ms % 1000);
  return clock_text(since) + (ms < 100 ? ".0" : ".") + padded_two(ms);
}

std::string life_time(double hours) {
  if (!std::isfinite(hours) || hours < 0)
    return nothing;
  if (hours < 48)
    return fixed(hours, 1) + " h";
  const auto days = hours / 24;
  if (days < 365)
    return fixed(days, days < 10 ? 1 : 0) + " d";
  return fixed(days / 365.25, 1) + " y";
}

std::string octet_size(std::uint64_t octets) {
  if (octets < 1000)
    return std::to_string(octets) + " B";
  static constexpr std::array<const char*, 3> units{" kB", " MB", " GB"};
  auto size = static_cast<double>(octets) / 1000;
  std::size_t unit = 0;
  for (; size >= 999.95 && unit + 1 < units.size(); ++unit)
    size /= 1000;
  return fixed(size, 1) + units[unit];
}

std::string counted(std::uint64_t count, const std::string& noun) {
  return with_thousands(count) + ' ' + noun + (count == 1 ? "" : "s");
}

} // namespace rubicon::report
