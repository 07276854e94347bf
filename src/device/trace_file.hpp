// Reads traces: files of lines with a time, perhaps a mote, and values (STR-21).
#pragma once

#include <compare>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "device/trace_table.hpp"

namespace rubicon::device {

/// A time as a trace tells it.
struct trace_time {
  bool is_date = false;
  duration since{}; ///< the beginning of 2000 for a date, 0 otherwise

  friend auto operator<=>(const trace_time&, const trace_time&) = default;
};

/// Seconds, as in `12.5`, within 60 years; or a date of 1940 to 2060 and a time of day, as in
/// `2004-02-28 00:59:16.02785`, with a blank or a T in between, the seconds and a Z left out or
/// not.
[[nodiscard]] std::optional<trace_time> parse_trace_time(std::string_view text);

inline constexpr double trace_value_max = 1e15; ///< and its negative

/// How a trace is written, and which column is wanted.
struct trace_format {
  std::optional<char> separator;    ///< a blank stands for any blanks and tabs; unset: line 1 tells
  std::vector<std::string> columns; ///< empty: line 1 names them
  std::string time_column = "time";
  std::string date_column; ///< stands before the time; empty: none
  std::string mote_column; ///< empty: none
  std::string value_column;
  double least = -trace_value_max; ///< values below are taken for missing,
  double most = trace_value_max;   ///< and so are values above
  /// What is the start of the run; unset: 0 s, or the earliest date in the file.
  std::optional<trace_time> start;

  friend auto operator<=>(const trace_format&, const trace_format&) = default;
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
/// short line does not have, is missing, and its line skipped.
///
/// The first mistake ends the reading: unknown column, surplus field, text that is no time, no mote
/// number of 0 to 4294967295 or no number up to 1e15, seconds beside dates, open quotation mark, a
/// limit above exceeded, no reading at all. A quoted text in a message is cut to 40 octets, control
/// characters and octets outside ASCII shown as `?`.
[[nodiscard]] std::variant<std::shared_ptr<const trace_table>, trace_problem>
read_trace(std::string_view text, const trace_format& format);

} // namespace rubicon::device
