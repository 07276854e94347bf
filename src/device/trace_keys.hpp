// The keys of what a file may say about how a trace is written.
#pragma once

#include "core/describe/keys.hpp"
#include "device/trace_file.hpp"

namespace rubicon::device {

inline auto keys_of(const time_form*) {
  return keys::of(
      keys::optional(
          "date_order", &time_form::order,
          keys::word<day_order>{{{"dmy", day_order::day_first}, {"mdy", day_order::month_first}}},
          {"order of dates that end with the year, as in `02/03/2016`",
           "`\"dmy\"` between dots, else what only one order allows"}),
      keys::optional(
          "time_unit", &time_form::per_second,
          keys::word<double>{{{"s", 1}, {"ms", 1e3}, {"us", 1e6}, {"ns", 1e9}}},
          {"unit of numeric times",
           "`\"s\"`, or the one in which it is a time from 1990 to 2060, counted from 1970"}));
}

inline auto keys_of(const trace_format*) {
  return keys::of(
      keys::optional(
          "separator", &trace_format::separator,
          keys::word<char>{{{"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}, {"blanks", ' '}}},
          {"separator of fields",
           "the first of these in the first line: semicolon, tab, comma, blanks"}),
      keys::optional("columns", &trace_format::columns,
                     keys::list_of<keys::text>{{}, 1, trace_columns_max},
                     {"names of the columns, in order", "the first line names them"}),
      keys::optional("time_column", &trace_format::time_column, keys::text{},
                     "numbers or dates, or times of day"),
      keys::optional("date_column", &trace_format::date_column, keys::text{},
                     {"column with the date, if it is separate from the time of day", "none"}),
      keys::optional("mote_column", &trace_format::mote_column, keys::text{},
                     {"numbers from 0 to 4294967295, decimal or, with `0x` or if one has letters, "
                      "hexadecimal",
                      "none: all readings are of one mote"}),
      keys::optional("name_column", &trace_format::name_column, keys::text{},
                     {"of a file with one value per line: names the quantity",
                      "none: a line has one value of each quantity"}),
      keys::optional(
          "name", &trace_format::name, keys::text{},
          {"name of the quantity in that column; only with `name_column`", "the quantity"}),
      keys::optional("column", &trace_format::value_column, keys::text{},
                     {"the values", "the quantity; with `name_column` `\"value\"`"}),
      keys::optional("min", &trace_format::least, keys::real{-trace_value_max, trace_value_max},
                     {"values below it, in the file's unit, are treated as missing", "none"}),
      keys::optional("max", &trace_format::most, keys::real{-trace_value_max, trace_value_max},
                     {"values above it are treated as missing", "none"}));
}

} // namespace rubicon::device
