#include <string>

#include "device/trace_file.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::device;

namespace {

trace_format wants(const std::string& column) {
  trace_format format;
  format.value_column = column;
  return format;
}

dated_trace table(const std::string& text, const trace_format& format) {
  const auto x = read_trace(text, format);
  if (const auto* problem = std::get_if<trace_problem>(&x))
    FAIL(problem->line << ": " << problem->message);
  return *std::get<0>(x);
}

std::string problem(const std::string& text, const trace_format& format = wants("light")) {
  const auto x = read_trace(text, format);
  const auto* found = std::get_if<trace_problem>(&x);
  return found == nullptr ? "none" : std::to_string(found->line) + ": " + found->message;
}

/// As the Intel lab's data are written.
const std::string lab = "2004-02-28 00:59:16.02785 3 1 19.9884 37.0933 45.08 2.69964\n"
                        "2004-02-28 01:00:16.33393 11 1 19.3024 38.4629 46.08 2.68742\n"
                        "2004-02-28 00:59:46.5 4 2 20.5 36 101.2 2.7\n"
                        "2004-02-28 01:03:16 21 2\n";

trace_format lab_format(const std::string& column) {
  trace_format format;
  format.columns = {"date",        "time",     "epoch", "moteid",
                    "temperature", "humidity", "light", "voltage"};
  format.date_column = "date";
  format.mote_column = "moteid";
  format.value_column = column;
  return format;
}

} // namespace

TEST_CASE("a trace of seconds and values is read by the names of its columns", "[device][STR-21]") {
  const auto x = table("time,light,temperature\n0,45.5,20\n1.5,46,\n# a pause\n\n3e1,-4.75e1,21\n",
                       wants("light"));
  CHECK(x.of_mote.at(0) == time_series{{0s, 45.5}, {1500ms, 46}, {30s, -47.5}});
  CHECK(x.turn == 30s + 28500ms);
  CHECK(x.skipped == 0);
  const auto y =
      table("time,light,temperature\n0,45.5,20\n1.5,46,\n3e1,-4.75e1,21\n", wants("temperature"));
  CHECK(y.of_mote.at(0) == time_series{{0s, 20}, {30s, 21}});
  CHECK(y.skipped == 1);
}

TEST_CASE("the data of the Intel lab are read as they are", "[device][STR-21]") {
  const auto light = table(lab, lab_format("light"));
  REQUIRE(light.of_mote.size() == 2);
  CHECK(light.of_mote.at(1) == time_series{{0s, 45.08}, {60'306'080us, 46.08}});
  CHECK(light.of_mote.at(2) == time_series{{30'472'150us, 101.2}});
  CHECK(light.skipped == 1);
  CHECK(light.turn == 2 * 60'306'080us);
  CHECK(table(lab, lab_format("voltage")).of_mote.at(2).front().second == 2.7);
}

TEST_CASE("the start of the run is the earliest date, zero seconds, or what is asked for",
          "[device][STR-21]") {
  auto format = lab_format("light");
  format.start = parse_trace_time("2004-02-28 01:00:00");
  CHECK(table(lab, format).of_mote.at(2).front().first == -13'500ms);
  CHECK(table("time light\n5 1\n7 2\n", wants("light")).of_mote.at(0).front().first == 5s);
  auto later = wants("light");
  later.start = parse_trace_time("6");
  CHECK(table("time light\n5 1\n7 2\n", later).of_mote.at(0) == time_series{{-1s, 1}, {1s, 2}});
  CHECK(problem("time light\n5 1\n", lab_format("light")).starts_with("1: "));
  later.start = parse_trace_time("2004-02-28 01:00:00");
  CHECK(problem("time light\n5 1\n", later) == "0: its times are seconds, so `start` must be too");
  format.start = parse_trace_time("6");
  CHECK(problem(lab, format) == "0: its times are dates, so `start` must be one too");
}

TEST_CASE("separators are found, and blanks around fields and quotation marks are left out",
          "[device][STR-21]") {
  const auto* text =
      GENERATE("time;light\n1;2\n", "time\tlight\n1\t2\n", "time,light\n1,2\n", "time light\n1 2\n",
               "  time  light \r\n\r\n  1 \t 2\r\n", "\xef\xbb\xbftime , light\n 1, 2 ",
               "\"time\",\"light\"\n\"1\" , \"2\"\n", "\"time\" \"light\"\n1 \"2\"",
               "time;light;a,b\n1;2;3,4\n", "x,\"a,b\",time,light\n,\"3,4\",1,2");
  CAPTURE(text);
  CHECK(table(text, wants("light")).of_mote.at(0) == time_series{{1s, 2}});
  auto format = wants("light");
  format.separator = ',';
  CHECK(table("time,light;x\n1,2\n",
              [] {
                auto x = wants("light;x");
                x.separator = ',';
                return x;
              }())
            .of_mote.at(0) == time_series{{1s, 2}});
  CHECK(problem("time;light\n1;2\n", format) ==
        "1: there is no column \"time\", which `time_column` can change; there is \"time;light\"");
}

TEST_CASE("readings are put in order, and the later of two for one time counts",
          "[device][STR-21]") {
  const auto x = table("time light\n3 1\n1 2\n3 3\n2 4\n1 5\n", wants("light"));
  CHECK(x.of_mote.at(0) == time_series{{1s, 5}, {2s, 4}, {3s, 3}});
  CHECK(x.repeated == 2);
  CHECK(x.turn == 4s);
}

TEST_CASE("lines with missing values are skipped and counted", "[device][STR-21]") {
  auto format = wants("light");
  format.mote_column = "mote";
  const auto x = table("time,mote,light\n1,7,5\n2,7,\n3,7,NA\n4,7,nan\n5,7,-\n6,7\n,7,1\n7,,1\n"
                       "8,7,NULL\n9,7,?\n10,7,N/A\n11,7,6\n",
                       format);
  CHECK(x.of_mote.at(7) == time_series{{1s, 5}, {11s, 6}});
  CHECK(x.skipped == 10);
  format.least = 5.5;
  CHECK(table("time,mote,light\n1,7,5\n2,7,6\n3,7,7\n", format).of_mote.at(7).size() == 2);
  format.most = 6;
  const auto y = table("time,mote,light\n1,7,5\n2,7,6\n3,7,7\n", format);
  CHECK(y.of_mote.at(7) == time_series{{2s, 6}});
  CHECK(y.skipped == 2);
}

TEST_CASE("mistakes in a trace are told with their line", "[device][STR-21][GEN-06]") {
  CHECK(problem("") == "0: it has no lines");
  CHECK(problem("# time light\n\n") == "0: it has no lines");
  CHECK(problem("time light\n") == "0: it has no readings");
  CHECK(problem("time light\n1 NA\n") == "0: it has no readings");
  CHECK(problem("\ntime lux\n1 2\n") == "2: there is no column \"light\", which `column` can "
                                        "change; there is \"time\", \"lux\"");
  CHECK(problem("time light\n1 2\n2 bright\n") ==
        "3: a value is a number up to 1e15, not \"bright\"");
  CHECK(problem("time light\n1 inf\n") == "2: a value is a number up to 1e15, not \"inf\"");
  CHECK(problem("time light\n1 1.1e15\n") == "2: a value is a number up to 1e15, not \"1.1e15\"");
  CHECK(problem("time light\n1 2 3\n") == "2: a line of 3 fields, but there are 2 columns");
  CHECK(problem("time light\nsoon 2\n") ==
        "2: a time is seconds, or a date and a time of day, not \"soon\"");
  CHECK(problem("time,light\n2004-02-28 00:59:16,2\n17,2\n") ==
        "3: the times are dates before, not \"17\"");
  CHECK(problem("time,light\n17,2\n2004-02-28 00:59:16,2\n") ==
        "3: the times are seconds before, not \"2004-02-28 00:59:16\"");
  CHECK(problem("time,light\n\"1,2\n") ==
        "2: a quotation mark is not closed, or is followed by text");
  CHECK(problem("time,light\n\"1\"0,2\n") ==
        "2: a quotation mark is not closed, or is followed by text");
  CHECK(problem("time,light\n1," + std::string(50, '\x01') + "\n") ==
        "2: a value is a number up to 1e15, not \"" + std::string(40, '?') + "\"");
  auto format = wants("light");
  format.mote_column = "mote";
  CHECK(problem("time,mote,light\n1,-1,2\n", format) ==
        "2: a mote is a number from 0 to 4294967295, or a hexadecimal one, not \"-1\"");
  format.columns = {"time", "light"};
  CHECK(problem("1,2\n", format) == "0: there is no column \"mote\", which `mote_column` can "
                                    "change; there is \"time\", \"light\"");
  CHECK(problem(std::string(trace_columns_max, ',') + "\n") == "1: more than 256 fields");
}

TEST_CASE("times of a trace are seconds or dates", "[device][STR-21]") {
  const auto since = [](std::string_view text) {
    const auto x = parse_trace_time(text);
    return x ? std::optional(x->since) : std::nullopt;
  };
  CHECK(since("0") == 0s);
  CHECK(since("-1.25") == -1250ms);
  CHECK(since("+1e3") == 1000s);
  CHECK(since("631151999.5") == 631'151'999'500ms);
  CHECK(since("2000-01-01 00:00") == 0s);
  CHECK(since("2000-01-01T00:00:01Z") == 1s);
  CHECK(since("1999-12-31 23:59:59.5") == -500ms);
  CHECK(since("2004-02-29 00:59:16.02785") == 1520 * 24h + 59min + 16s + 27'850us);
  CHECK(since("2000-01-01 00:00:00.1234567891") == 123'456'789ns);
  CHECK(parse_trace_time("5")->is_date == false);
  CHECK(parse_trace_time("2000-01-01 00:00")->is_date);
  for (const auto* bad : {"",
                          "x",
                          "1s",
                          "inf",
                          "nan",
                          "1e10",
                          "-1e10",
                          "2001-02-29 00:00",
                          "2000-13-01 00:00",
                          "2000-01-00 00:00",
                          "1939-01-01 00:00",
                          "2061-01-01 00:00",
                          "2000-01-01 ",
                          "2000-01-01 24:00",
                          "2000-01-01 00:60",
                          "2000-01-01 00:00:60",
                          "2000-01-01 00:00:",
                          "2000-01-01 00:00:00.",
                          "2000-01-01_00:00",
                          "2000-01-01 00:00+",
                          "2000-01-01 00:00+01:",
                          "2000-01-01 00:00+15",
                          "2000-01-01 00:00+01:60",
                          "2000-01-01 00:00 CET",
                          "2000-01-01 13:00 PM",
                          "2000-01-01 00:00 AM",
                          "2000-01/01 00:00",
                          "01.02.00 00:00",
                          "01.13.2000",
                          "01/02/2000",
                          "2000-01",
                          "0.5,5"}) {
    CAPTURE(bad);
    CHECK_FALSE(since(bad));
  }
}

TEST_CASE("dates are read as devices and their programs write them", "[device][STR-21]") {
  const auto since = [](std::string_view text, const time_form& form = {}) {
    const auto x = parse_trace_time(text, form);
    CAPTURE(text);
    REQUIRE(x);
    CHECK(x->is_date);
    return x->since;
  };
  const auto leap_day = since("2000-02-29 13:04:05");
  CHECK(leap_day == 59 * 24h + 13h + 4min + 5s);
  for (const auto* same :
       {"2000/02/29 13:04:05", "2000.02.29 13:04:05", "29.02.2000 13:04:05", "29.2.2000  13:04:05",
        "29/02/2000 13:04:05", "02/29/2000 13:04:05", "29-02-2000 13:04:05", "2/29/2000 1:04:05 PM",
        "2000-02-29T13:04:05Z", "2000-02-29t13:04:05 UTC", "2000-02-29T14:04:05+01:00",
        "2000-02-29 14:04:05+0100", "2000-02-29 14:04:05 +01", "2000-02-29T09:34:05-03:30",
        "2000-03-01 03:04:05+14:00", "951829445", "951829445000", "951829445000000",
        "951829445000000000"}) {
    CAPTURE(same);
    CHECK(since(same) == leap_day);
  }
  CHECK(since("2000-01-01") == 0s);
  CHECK(since("2000-01-01 12:00 AM") == 0s);
  CHECK(since("2000-01-01 12:00pm") == 12h);
  CHECK(since("2000-01-01 00:00:00,25") == 250ms);
  CHECK(since("946684800.25") == 250ms);
  const auto day_first = time_form{.order = day_order::day_first};
  const auto month_first = time_form{.order = day_order::month_first};
  CHECK(since("02/01/2000", day_first) == 24h);
  CHECK(since("02/01/2000", month_first) == 31 * 24h);
  CHECK(since("02.01.2000") == 24h);
  CHECK(since("02.01.2000", month_first) == 31 * 24h);
  CHECK_FALSE(parse_trace_time("13/01/2000", month_first));
  CHECK(parse_trace_time("2000-01-01 00:00")->zone == std::nullopt);
  CHECK(parse_trace_time("2000-01-01 00:00-02:00")->zone == -2h);
  CHECK(to_text(*parse_trace_time("2000-02-29 13:04:05.9")) == "2000-02-29 13:04:05");
  CHECK(to_text(*parse_trace_time("1999-12-31T23:59:59-01:00")) == "2000-01-01 00:59:59 UTC");
  CHECK(to_text(*parse_trace_time("90")) == "1.5 min");
}

TEST_CASE("times that are numbers have a unit", "[device][STR-21]") {
  const auto ms = time_form{.per_second = 1e3};
  CHECK(parse_trace_time("1500", ms) == trace_time{false, 1500ms, {}});
  CHECK(parse_trace_time("1e10", ms)->since == 10'000'000s);
  CHECK(parse_trace_time("951829445000", ms) == parse_trace_time("951829445"));
  CHECK_FALSE(parse_trace_time("951829445000000", ms)); // microseconds
  CHECK(parse_trace_time("0,5", {.comma = true})->since == 500ms);
  CHECK_FALSE(parse_trace_time("0,5"));
  CHECK_FALSE(parse_trace_time("1.000,5", {.comma = true}));
}

TEST_CASE("what is no time is told with what would be one", "[device][STR-21][GEN-06]") {
  CHECK(problem("time,light\n01/02/2016 00:00,1\n") ==
        "2: a time is seconds, or a date and a time of day, not \"01/02/2016 00:00\", whose first "
        "number may be the day or the month: set `date_order` = \"dmy\" or \"mdy\"");
  CHECK(problem("time,light\n2016-02-30 00:00,1\n").find("as in 2016-03-01 00:20:00") !=
        std::string::npos);
  CHECK(problem("time,light\n00:20:00,1\n").find("(`date_column`)") != std::string::npos);
  CHECK(problem("\xff\xfet\0i\0") == "0: it is UTF-16: save it as UTF-8");
}

TEST_CASE("a time of one zone is another in the next", "[device][STR-21]") {
  // As the clocks of Central Europe are put back, 02:30 comes twice.
  const auto x = table("time,light\n2016-10-30T02:30:00+02:00,1\n2016-10-30T02:30:00+01:00,2\n",
                       wants("light"));
  CHECK(x.of_mote.at(0) == time_series{{0s, 1}, {1h, 2}});
  CHECK(x.start == trace_time{true, x.start.since, 2h});
  auto format = wants("light");
  for (const auto* start : {"2016-10-30 02:00:00", "2016-10-30T00:00:00Z"}) { // that of the file
    format.start = parse_trace_time(start);
    CHECK(table("time,light\n2016-10-30T02:30:00+02:00,1\n", format).of_mote.at(0) ==
          time_series{{30min, 1}});
  }
}

TEST_CASE("numbers may have a decimal comma where no comma divides fields", "[device][STR-21]") {
  const auto series = time_series{{1500ms, 20.25}};
  for (const auto* text :
       {"time;light\n1,5;20,25\n", "time\tlight\n1,5\t20,25\n", "time;light\n1.5;20.25\n"}) {
    CAPTURE(text);
    CHECK(table(text, wants("light")).of_mote.at(0) == series);
  }
  CHECK(problem("time,light\n1,\"20,25\"\n") == "2: a value is a number up to 1e15, not \"20,25\"");
  CHECK(problem("time;light\n1;1.020,25\n").starts_with("2: a value is a number"));
}

TEST_CASE("numbers of motes may be hexadecimal", "[device][STR-21]") {
  auto format = wants("light");
  format.mote_column = "mote";
  const auto motes = [&](const std::string& text) {
    std::vector<std::uint32_t> found;
    for (const auto& [mote, series] : table(text, format).of_mote)
      found.push_back(mote);
    return found;
  };
  using ids = std::vector<std::uint32_t>;
  CHECK(motes("time,mote,light\n0,0010,1\n0,00a2,1\n0,FF,2\n") == ids{0x10, 0xa2, 0xff});
  CHECK(motes("time,mote,light\n0,0010,1\n0,0x10,1\n") == ids{10, 16});
  CHECK(problem("time,mote,light\n0,00a2,1\n0,kitchen,1\n", format) ==
        "3: a mote is a number from 0 to 4294967295, or a hexadecimal one, not \"kitchen\"");
}

TEST_CASE("a file may have one value a line, and what it is of", "[device][STR-21]") {
  const std::string text = "Time,Mote,Name,Value\n0,7,temperature,20\n0,7,LIGHT,45\n"
                           "10,8,light,46\n20,7,light,47\n";
  auto format = wants("value");
  format.mote_column = "mote";
  format.name_column = "name";
  format.name = "light";
  const auto x = table(text, format);
  CHECK(x.of_mote.at(7) == time_series{{0s, 45}, {20s, 47}});
  CHECK(x.of_mote.at(8) == time_series{{10s, 46}});
  CHECK(x.others == 1);
  CHECK(x.skipped == 0);
  format.name = "sound";
  CHECK(problem(text, format) ==
        "0: no line has \"sound\" in the column \"name\": choose one with `name`");
}
