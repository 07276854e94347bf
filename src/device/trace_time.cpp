#include <charconv>
#include <chrono>
#include <cmath>
#include <system_error>

#include "device/trace_file.hpp"

namespace rubicon::device {

namespace {

constexpr double seconds_max = 60.0 * 365.25 * 86'400;

/// Exactly `count` digits, taken off `text`.
std::optional<unsigned> take_digits(std::string_view& text, std::size_t count) {
  unsigned number = 0;
  const auto digits = text.substr(0, count);
  const auto end = digits.data() + digits.size();
  const auto done = std::from_chars(digits.data(), end, number);
  if (digits.size() != count || done.ec != std::errc() || done.ptr != end)
    return std::nullopt;
  text.remove_prefix(count);
  return number;
}

/// `separator` and two digits below `bound`.
std::optional<unsigned> take_pair(std::string_view& text, char separator, unsigned bound) {
  if (!text.starts_with(separator))
    return std::nullopt;
  text.remove_prefix(1);
  const auto number = take_digits(text, 2);
  return number && *number < bound ? number : std::nullopt;
}

/// `.02785`, digits after the ninth being left out.
std::optional<duration> take_fraction(std::string_view& text) {
  constexpr auto digits = "0123456789";
  text.remove_prefix(1);
  const auto all = text.substr(0, text.find_first_not_of(digits));
  if (all.empty())
    return std::nullopt;
  duration sum{};
  duration unit = 100ms;
  for (const char digit : all) {
    sum += unit * (digit - '0');
    unit /= 10;
  }
  text.remove_prefix(all.size());
  return sum;
}

std::optional<duration> parse_time_of_day(std::string_view text) {
  const auto hour = text.empty() ? std::nullopt : take_pair(text, text[0], 24);
  const auto minute = hour ? take_pair(text, ':', 60) : std::nullopt;
  if (!minute)
    return std::nullopt;
  auto sum = duration(std::chrono::hours(*hour)) + std::chrono::minutes(*minute);
  if (text.starts_with(':')) {
    const auto second = take_pair(text, ':', 60);
    if (!second)
      return std::nullopt;
    sum += std::chrono::seconds(*second);
    if (text.starts_with('.')) {
      const auto fraction = take_fraction(text);
      if (!fraction)
        return std::nullopt;
      sum += *fraction;
    }
  }
  return text.empty() || text == "Z" ? std::optional(sum) : std::nullopt;
}

std::optional<trace_time> parse_date(std::string_view text) {
  namespace chrono = std::chrono;
  const auto year = take_digits(text, 4);
  const auto month = year ? take_pair(text, '-', 13) : std::nullopt;
  const auto day = month ? take_pair(text, '-', 32) : std::nullopt;
  if (!day || *year < 1940 || *year > 2060)
    return std::nullopt;
  const chrono::year_month_day date(chrono::year(static_cast<int>(*year)), chrono::month(*month),
                                    chrono::day(*day));
  const bool divided = text.starts_with(' ') || text.starts_with('T');
  const auto time = divided ? parse_time_of_day(text) : std::nullopt;
  if (!date.ok() || !time)
    return std::nullopt;
  constexpr chrono::sys_days origin = chrono::year(2000) / 1 / 1;
  return trace_time{true, chrono::sys_days(date) - origin + *time};
}

std::optional<trace_time> parse_seconds(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-"))
    text.remove_prefix(1);
  double number = 0;
  const auto end = text.data() + text.size();
  const auto done = std::from_chars(text.data(), end, number);
  if (done.ec != std::errc() || done.ptr != end || !(std::abs(number) <= seconds_max))
    return std::nullopt;
  const auto whole = std::floor(number);
  const auto rest_ns = std::floor((number - whole) * 1e9 + 0.5);
  return trace_time{false, std::chrono::seconds(static_cast<std::int64_t>(whole)) +
                               duration(static_cast<std::int64_t>(rest_ns))};
}

} // namespace

std::optional<trace_time> parse_trace_time(std::string_view text) {
  const bool is_date = text.size() > 4 && text[4] == '-';
  return is_date ? parse_date(text) : parse_seconds(text);
}

} // namespace rubicon::device
