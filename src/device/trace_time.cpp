#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <system_error>
#include <utility>

#include "device/trace_file.hpp"

namespace rubicon::device {

namespace {

namespace chrono = std::chrono;

constexpr chrono::sys_days origin = chrono::year(2000) / 1 / 1;
constexpr double day_s = 86'400;
constexpr double seconds_max = 60.0 * 365.25 * day_s;
constexpr double epoch_min_s = 631'152'000;   // the beginning of 1990
constexpr double epoch_max_s = 2'871'763'200; // that of 2061
constexpr int year_min = 1940;
constexpr int year_max = 2060;
constexpr std::string_view blanks = " \t";

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

void skip_blanks(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
}

bool take(std::string_view& text, char c) {
  const bool found = text.starts_with(c);
  text.remove_prefix(found ? 1 : 0);
  return found;
}

/// Whatever the letter case. @param word in small letters
bool take_word(std::string_view& text, std::string_view word) {
  if (text.size() < word.size())
    return false;
  for (std::size_t i = 0; i < word.size(); ++i)
    if (lower(text[i]) != word[i])
      return false;
  text.remove_prefix(word.size());
  return true;
}

struct digits {
  int number = 0;
  std::size_t count = 0;
};

/// From one to `most` digits.
std::optional<digits> take_digits(std::string_view& text, std::size_t most) {
  digits out;
  while (out.count < most && out.count < text.size() && text[out.count] >= '0' &&
         text[out.count] <= '9')
    out.number = 10 * out.number + (text[out.count++] - '0');
  text.remove_prefix(out.count);
  return out.count > 0 ? std::optional(out) : std::nullopt;
}

/// One or two digits, from `least` to `most`.
std::optional<int> take_pair(std::string_view& text, int least, int most) {
  const auto found = take_digits(text, 2);
  return found && found->number >= least && found->number <= most ? std::optional(found->number)
                                                                  : std::nullopt;
}

/// `02785`, digits after the ninth being left out.
std::optional<duration> take_fraction(std::string_view& text) {
  const auto all = text.substr(0, text.find_first_not_of("0123456789"));
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

/// `am` or `pm` behind `hour`.
std::optional<int> hour_of_day(std::string_view& text, int hour) {
  const bool am = take_word(text, "am");
  const bool pm = !am && take_word(text, "pm");
  if (!am && !pm)
    return hour;
  if (hour < 1 || hour > 12)
    return std::nullopt;
  return hour % 12 + (pm ? 12 : 0);
}

/// `Z`, `UTC`, `+01:00`, `-0330` or `+01`: how far ahead of UTC.
/// @returns false if there is something else
bool take_zone(std::string_view& text, std::optional<duration>& out) {
  skip_blanks(text);
  if (text.empty())
    return true;
  if (take_word(text, "z") || take_word(text, "utc") || take_word(text, "gmt"))
    out = 0s;
  if (text.empty())
    return true;
  const bool west = take(text, '-');
  if (!west && !take(text, '+'))
    return false;
  const auto hours = take_digits(text, 2);
  if (!hours || hours->number > 14)
    return false;
  const bool colon = take(text, ':');
  const auto minutes = take_pair(text, 0, 59);
  if (colon && !minutes)
    return false;
  const auto ahead = duration(chrono::hours(hours->number)) + chrono::minutes(minutes.value_or(0));
  out = west ? -ahead : ahead;
  return text.empty();
}

/// What is behind a date: nothing, or a time of day and perhaps a zone.
bool take_time_of_day(std::string_view text, trace_time& out) {
  const bool divided =
      take(text, 'T') || take(text, 't') || text.starts_with(' ') || text.starts_with('\t');
  if (text.empty())
    return !divided;
  skip_blanks(text);
  auto hour = divided ? take_pair(text, 0, 23) : std::nullopt;
  const auto minute = hour && take(text, ':') ? take_pair(text, 0, 59) : std::nullopt;
  if (!minute)
    return false;
  duration sum = chrono::minutes(*minute);
  if (take(text, ':')) {
    const auto second = take_pair(text, 0, 59);
    if (!second)
      return false;
    sum += chrono::seconds(*second);
    const auto fraction = take(text, '.') || take(text, ',') ? take_fraction(text) : duration(0);
    if (!fraction)
      return false;
    sum += *fraction;
  }
  skip_blanks(text);
  hour = hour_of_day(text, *hour);
  if (!hour || !take_zone(text, out.zone))
    return false;
  out.since += sum + chrono::hours(*hour) - out.zone.value_or(0s);
  return true;
}

/// Three numbers of a date, in the order of the text.
struct date_parts {
  std::array<digits, 3> at;
  char between = '-';
};

std::optional<date_parts> take_parts(std::string_view& text) {
  date_parts out;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i == 1)
      out.between = text.empty() ? ' ' : text[0];
    if (i > 0 && !(std::string_view("-/.").find(out.between) != std::string_view::npos &&
                   take(text, out.between)))
      return std::nullopt;
    const auto found = take_digits(text, 4);
    if (!found)
      return std::nullopt;
    out.at[i] = *found;
  }
  return out;
}

/// Which of two numbers the day is; unset: it may be either.
day_order order_of(const date_parts& x, day_order said) {
  if (said != day_order::unset)
    return said;
  if (x.between == '.' || x.at[0].number > 12)
    return day_order::day_first;
  return x.at[1].number > 12 ? day_order::month_first : day_order::unset;
}

std::optional<chrono::sys_days> take_date(std::string_view& text, day_order said) {
  const auto parts = take_parts(text);
  if (!parts)
    return std::nullopt;
  auto [year, month, day] = parts->at;
  if (year.count <= 2 && day.count == 4) {
    std::swap(year, day);
    const auto order = order_of(*parts, said);
    if (order == day_order::unset)
      return std::nullopt;
    if (order == day_order::month_first)
      std::swap(month, day);
  }
  if (year.count != 4 || month.count > 2 || day.count > 2 || year.number < year_min ||
      year.number > year_max)
    return std::nullopt;
  const chrono::year_month_day date(chrono::year(year.number),
                                    chrono::month(static_cast<unsigned>(month.number)),
                                    chrono::day(static_cast<unsigned>(day.number)));
  return date.ok() ? std::optional(chrono::sys_days(date)) : std::nullopt;
}

std::optional<trace_time> parse_date(std::string_view text, day_order said) {
  const auto date = take_date(text, said);
  if (!date)
    return std::nullopt;
  trace_time out{true, *date - origin, std::nullopt};
  return take_time_of_day(text, out) ? std::optional(out) : std::nullopt;
}

duration duration_of(double whole, double rest) {
  return chrono::seconds(static_cast<std::int64_t>(whole)) +
         duration(static_cast<std::int64_t>(std::floor(rest * 1e9 + 0.5)));
}

/// `number` units, of which a second has `per_second`.
trace_time time_of(double number, double per_second, bool since_1970) {
  const auto whole = std::floor(number / per_second);
  const auto rest = (number - whole * per_second) / per_second;
  auto out = trace_time{since_1970, duration_of(whole, rest), std::nullopt};
  if (since_1970) {
    out.since -= origin - chrono::sys_days{};
    out.zone = 0s;
  }
  return out;
}

std::optional<trace_time> parse_number(std::string_view text, const time_form& form) {
  const auto number = parse_trace_number(text, form.comma);
  if (!number)
    return std::nullopt;
  for (const double per_second : {1.0, 1e3, 1e6, 1e9}) {
    if (form.per_second != 0 && per_second != form.per_second)
      continue;
    const auto in_s = *number / per_second;
    if (in_s >= epoch_min_s && in_s < epoch_max_s)
      return time_of(*number, per_second, true);
  }
  const auto per_second = form.per_second == 0 ? 1.0 : form.per_second;
  if (!(std::abs(*number / per_second) <= seconds_max))
    return std::nullopt;
  return time_of(*number, per_second, false);
}

bool begins_as_date(std::string_view text) {
  return take_parts(text).has_value();
}

} // namespace

std::optional<double> parse_trace_number(std::string_view x, bool comma) {
  if (x.size() > 1 && x[0] == '+' && x[1] != '-')
    x.remove_prefix(1);
  std::string text;
  if (const auto at = comma ? x.find(',') : std::string_view::npos; at != std::string_view::npos) {
    if (x.find('.') != std::string_view::npos)
      return std::nullopt; // a separator of thousands, in one convention or the other
    text = x;
    text[at] = '.';
    x = text;
  }
  double number = 0;
  const auto* const end = x.data() + x.size();
  const auto done = std::from_chars(x.data(), end, number);
  if (done.ec != std::errc() || done.ptr != end || !std::isfinite(number))
    return std::nullopt;
  return number;
}

std::optional<trace_time> parse_trace_time(std::string_view text, const time_form& form) {
  return begins_as_date(text) ? parse_date(text, form.order) : parse_number(text, form);
}

std::string why_no_trace_time(std::string_view text) {
  const bool is_date = begins_as_date(text);
  if (is_date && parse_date(text, day_order::day_first) && parse_date(text, day_order::month_first))
    return "whose first number may be the day or the month: set `date_order` = \"dmy\" or \"mdy\"";
  if (is_date)
    return "as in 2016-03-01 00:20:00, 2016/03/01 00:20, 01.03.2016 00:20:00.5 or "
           "2016-03-01T00:20:00+01:00, of the years 1940 to 2060";
  if (text.find(':') != std::string_view::npos)
    return "a time of day without its date: is that in a column of its own (`date_column`)?";
  return {};
}

std::string to_text(const trace_time& x) {
  if (!x.is_date)
    return rubicon::to_text(x.since);
  const auto at = chrono::sys_time<duration>(chrono::sys_days(origin)) + x.since;
  const auto day = chrono::floor<chrono::days>(at);
  const chrono::year_month_day date(day);
  const chrono::hh_mm_ss time(chrono::floor<chrono::seconds>(at - day));
  const auto two = [](auto number) {
    const auto text = std::to_string(number);
    return text.size() < 2 ? '0' + text : text;
  };
  const auto text = std::to_string(int(date.year())) + '-' + two(unsigned(date.month())) + '-' +
                    two(unsigned(date.day())) + ' ' + two(time.hours().count()) + ':' +
                    two(time.minutes().count()) + ':' + two(time.seconds().count());
  return text + (x.zone ? " UTC" : "");
}

} // namespace rubicon::device
