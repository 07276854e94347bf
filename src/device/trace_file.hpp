// Reads traces: files of lines with a time, perhaps a mote, and values (STR-21).
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "device/trace_table.hpp"

namespace rubicon::device {

/// A time as a trace gives it.
struct trace_time {
  bool is_date = false;
  duration since{};             ///< the beginning of 2000 for a date, 0 otherwise
  std::optional<duration> zone; ///< ahead of UTC, in which `since` then is; unset: not said

  friend auto operator<=>(const trace_time&, const trace_time&) = default;
};

/// `2016-03-01 00:20:00`, with `UTC` if its zone is known; or `20 min`.
[[nodiscard]] std::string to_text(const trace_time& x);

/// Which number of a date comes first, if the year does not. Between dots it is the day.
enum class day_order : std::uint8_t { unset, day_first, month_first };

/// How times are written, where their text does not show it.
struct time_form {
  day_order order = day_order::unset;
  double per_second =
      0; ///< of the unit of numbers, 1, 1e3, 1e6 or 1e9; 0: inferred from how large they are
  bool comma = false; ///< numbers may have a decimal comma

  friend auto operator<=>(const time_form&, const time_form&) = default;
};

/// A number, as in `12.5`, within 60 years of seconds; or a date of 1940 to 2060 and perhaps a time
/// of day and a zone, as in `2004-02-28 00:59:16.02785`, `2004/2/28 0:59`, `28.02.2004 00:59:16,5`
/// or `02/28/2004 12:59:16 AM`. A zone is `Z`, `UTC` or `+01:00`. A number that is a time of 1990
/// to 2060, since 1970 in seconds, milliseconds, microseconds or nanoseconds, is that date.
[[nodiscard]] std::optional<trace_time> parse_trace_time(std::string_view text,
                                                         const time_form& form = {});

/// What would make a time of a text that is none; empty: it looks like no time at all.
[[nodiscard]] std::string why_no_trace_time(std::string_view text);

/// The number that is the whole of `x`. @param comma a comma may stand in the place of the point
[[nodiscard]] std::optional<double> parse_trace_number(std::string_view x, bool comma);

inline constexpr double trace_value_max = 1e15; ///< and its negative

/// How a trace is written, and which column is wanted.
struct trace_format {
  std::optional<char>
      separator; ///< a blank stands for any blanks and tabs; unset: inferred from line 1
  std::vector<std::string> columns; ///< empty: line 1 names them
  std::string time_column = "time";
  std::string date_column; ///< stands before the time; empty: none
  std::string mote_column; ///< empty: none
  std::string name_column; ///< names what the value of a line is of; empty: lines have all values
  std::string name;        ///< which of these is wanted
  std::string value_column;
  time_form times;
  double least = -trace_value_max; ///< values below are taken for missing,
  double most = trace_value_max;   ///< and so are values above
  /// What is the start of the run; unset: 0 s, or the earliest date in the file.
  std::optional<trace_time> start;

  friend auto operator<=>(const trace_format&, const trace_format&) = default;
};

/// A column, with what only its file knows.
struct dated_trace : trace_table {
  std::uint64_t others = 0; ///< lines of another name than the one that is wanted
  trace_time start;         ///< what is the start of the run
};

/// What is wrong with a file, and where; line 0: with the file as a whole.
struct trace_problem {
  std::size_t line = 0;
  std::string message;
};

inline constexpr std::size_t trace_octets_max = 256U << 20U;
inline constexpr std::size_t trace_readings_max = 1U << 23U;
inline constexpr std::size_t trace_columns_max = 256;

/// Empty lines and those that begin with # are left out; lines may end with CR LF; a field may
/// stand between quotation marks. Without a separator given it is what the first line has, in this
/// order: semicolon, tab, comma, blanks. Lines need no order of time; of two readings of one mote
/// and time the later one counts. A field that is empty, NA, N/A, NaN, null, - or ?, or that a
/// short line does not have, is missing, and its line skipped. Names of columns are found in any
/// letter case, if none has the letters asked for. Unless fields stand between commas, numbers may
/// have a decimal comma. If one mote number is hexadecimal, as in `00a2`, all of them are; one with
/// `0x` is in any case.
///
/// The first mistake ends the reading: unknown column, surplus field, text that is no time, no mote
/// number of 0 to 4294967295 or no number up to 1e15, seconds beside dates, open quotation mark, a
/// limit above exceeded, no reading at all, UTF-16. A quoted text in a message is cut to 40 octets,
/// control characters and octets outside ASCII shown as `?`.
[[nodiscard]] std::variant<std::shared_ptr<const dated_trace>, trace_problem>
read_trace(std::string_view text, const trace_format& format);

} // namespace rubicon::device
