// The keys of what a file may say about how a trace is written.
#pragma once

#include "core/keys.hpp"
#include "device/trace_file.hpp"

namespace rubicon::device {

inline auto keys_of(const trace_format*) {
  return keys::of(
      keys::optional(
          "separator", &trace_format::separator,
          keys::word<char>{{{"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}, {"blanks", ' '}}},
          {"what stands between two fields",
           "what the first line has: a semicolon, else a tab, else a comma, else blanks"}),
      keys::optional("columns", &trace_format::columns,
                     keys::list_of<keys::text>{{}, 1, trace_columns_max},
                     {"names of the columns, in order", "the first line names them"}),
      keys::optional("time_column", &trace_format::time_column, keys::text{},
                     "seconds, or a time of day"),
      keys::optional(
          "date_column", &trace_format::date_column, keys::text{},
          {"stands before the time, if date and time of day have a column each", "none"}),
      keys::optional("mote_column", &trace_format::mote_column, keys::text{},
                     {"numbers from 0 to 4294967295", "none: all readings are of one mote"}),
      keys::optional("column", &trace_format::value_column, keys::text{},
                     {"the values", "the quantity"}),
      keys::optional("min", &trace_format::least, keys::real{-trace_value_max, trace_value_max},
                     {"values below it, in the file's unit, are taken for missing", "none"}),
      keys::optional("max", &trace_format::most, keys::real{-trace_value_max, trace_value_max},
                     {"values above it are taken for missing", "none"}));
}

} // namespace rubicon::device
