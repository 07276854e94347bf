#include "device/trace_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

namespace rubicon::device {

namespace {

constexpr std::string_view spaces = " \t";

void trim(std::string_view& x, std::string_view set) {
  x.remove_prefix(std::min(x.find_first_not_of(set), x.size()));
  x.remove_suffix(x.size() - 1 - x.find_last_not_of(set)); // npos + 1 is 0
}

/// The lines that say something.
class line_reader {
public:
  explicit line_reader(std::string_view text) : rest_(text) {
    if (rest_.starts_with("\xef\xbb\xbf"))
      rest_.remove_prefix(3);
  }

  /// @returns false at the end
  bool next() {
    while (!rest_.empty()) {
      ++number_;
      const auto end = rest_.find('\n');
      line_ = rest_.substr(0, end);
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      if (line_.ends_with('\r'))
        line_.remove_suffix(1);
      const auto first = line_.find_first_not_of(spaces);
      if (first != std::string_view::npos && line_[first] != '#')
        return true;
    }
    return false;
  }

  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] std::size_t number() const { return number_; }

private:
  std::string_view rest_;
  std::string_view line_;
  std::size_t number_ = 0;
};

std::string quoted(std::string_view x) {
  std::string text = "\"";
  for (const char c : x.substr(0, 40))
    text += c >= ' ' && c <= '~' ? c : '?';
  return text + '"';
}

char separator_in(std::string_view line) {
  for (const char each : {';', '\t', ','}) {
    if (line.find(each) != std::string_view::npos)
      return each;
  }
  return ' ';
}

/// Splits lines into fields.
class splitter {
public:
  explicit splitter(char separator) : separator_(separator) {
    if (separator == '\t')
      around_ = " ";
  }

  /// @returns what is wrong with the line, or nothing
  std::string split(std::string_view line, std::vector<std::string_view>& fields) const {
    fields.clear();
    if (separator_ == ' ')
      trim(line, spaces);
    for (bool more = true; more;) {
      if (fields.size() == trace_columns_max)
        return "more than " + std::to_string(trace_columns_max) + " fields";
      line.remove_prefix(std::min(line.find_first_not_of(around_), line.size()));
      const bool is_quoted = line.starts_with('"');
      const auto field = is_quoted ? take_quoted(line) : take_plain(line);
      if (!field)
        return "a quotation mark is not closed, or is followed by text";
      fields.push_back(*field);
      more = !line.empty();
      line.remove_prefix(more ? 1 : 0);
    }
    return {};
  }

private:
  [[nodiscard]] std::size_t end_of_field(std::string_view line) const {
    return std::min(separator_ == ' ' ? line.find_first_of(spaces) : line.find(separator_),
                    line.size());
  }

  std::optional<std::string_view> take_plain(std::string_view& line) const {
    auto field = line.substr(0, end_of_field(line));
    line.remove_prefix(field.size());
    trim(field, around_);
    return field;
  }

  std::optional<std::string_view> take_quoted(std::string_view& line) const {
    const auto end = line.find('"', 1);
    if (end == std::string_view::npos)
      return std::nullopt;
    const auto field = line.substr(1, end - 1);
    line.remove_prefix(end + 1);
    auto behind = line.substr(0, end_of_field(line));
    line.remove_prefix(behind.size());
    trim(behind, around_);
    return behind.empty() ? std::optional(field) : std::nullopt;
  }

  char separator_;
  std::string_view around_ = spaces; ///< what a field does not begin or end with
};

bool is_missing(std::string_view x) {
  constexpr std::array<std::string_view, 8> words{"", "-", "?", "na", "n/a", "nan", "-nan", "null"};
  if (x.size() > 4)
    return false;
  std::string folded(x);
  for (auto& c : folded)
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return std::find(words.begin(), words.end(), folded) != words.end();
}

/// A mote's number. @param base 10 or 16; one with 0x is hexadecimal in any case
std::optional<std::uint32_t> mote_number(std::string_view x, int base) {
  if (x.starts_with("0x") || x.starts_with("0X")) {
    x.remove_prefix(2);
    base = 16;
  } else if (x.size() > 1 && x[0] == '+' && x[1] != '-') {
    x.remove_prefix(1);
  }
  std::uint32_t number = 0;
  const auto* const end = x.data() + x.size();
  const auto done = std::from_chars(x.data(), end, number, base);
  if (done.ec != std::errc() || done.ptr != end)
    return std::nullopt;
  return number;
}

/// `names`, for a message.
std::string listed(const std::vector<std::string_view>& names) {
  constexpr std::size_t listed_max = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), listed_max); ++i)
    text += (i == 0 ? "" : ", ") + quoted(names[i]);
  return text + (names.size() > listed_max ? ", ..." : "");
}

bool same_letters(std::string_view a, std::string_view b) {
  const auto lower = [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  return std::ranges::equal(a, b, {}, lower, lower);
}

/// Where the wanted columns are among the fields of a line.
struct places {
  std::size_t time = 0;
  std::optional<std::size_t> date;
  std::optional<std::size_t> mote;
  std::optional<std::size_t> name;
  std::size_t value = 0;
};

class trace_reader {
public:
  /// @param base of motes' numbers
  trace_reader(std::string_view text, const trace_format& format, int base)
      : lines_(text), format_(format), base_(base) {}

  /// A mote's number was met that is one in another base alone; read() has a problem then.
  [[nodiscard]] bool needs_hex() const { return needs_hex_; }

  std::variant<std::shared_ptr<const dated_trace>, trace_problem> read() {
    bool more = lines_.next();
    if (!more)
      return trace_problem{0, "it has no lines"};
    const auto separator = format_.separator.value_or(separator_in(lines_.line()));
    const splitter columns(separator);
    times_ = format_.times;
    times_.comma = separator != ',';
    auto message = find_columns(columns);
    if (!message.empty())
      return trace_problem{format_.columns.empty() ? lines_.number() : 0, std::move(message)};
    if (format_.columns.empty())
      more = lines_.next();
    for (; more; more = lines_.next()) {
      message = columns.split(lines_.line(), fields_);
      if (message.empty())
        message = take_line();
      if (!message.empty())
        return trace_problem{lines_.number(), std::move(message)};
    }
    if (readings_ == 0 && table_.others > 0)
      return trace_problem{0, "no line has " + quoted(format_.name) + " in the column " +
                                  quoted(format_.name_column) + ": choose one with `name`"};
    if (readings_ == 0)
      return trace_problem{0, "it has no readings"};
    if (format_.start && format_.start->is_date != *dates_)
      return trace_problem{0, *dates_ ? "its times are dates, so `start` must be one too"
                                      : "its times are seconds, so `start` must be too"};
    finish();
    return std::make_shared<const dated_trace>(std::move(table_));
  }

private:
  /// @returns what is wrong, or nothing
  std::string find_columns(const splitter& columns) {
    names_.assign(format_.columns.begin(), format_.columns.end());
    if (names_.empty()) {
      if (auto message = columns.split(lines_.line(), names_); !message.empty())
        return message;
    }
    std::string missing;
    const auto find = [&](const std::string& name, const char* key) -> std::size_t {
      auto found = std::find(names_.begin(), names_.end(), name);
      if (found == names_.end())
        found = std::ranges::find_if(names_, [&](auto x) { return same_letters(x, name); });
      if (found == names_.end() && missing.empty())
        missing = "there is no column " + quoted(name) + ", which `" + key +
                  "` can change; there is " + listed(names_);
      return static_cast<std::size_t>(found - names_.begin());
    };
    places_.time = find(format_.time_column, "time_column");
    if (!format_.date_column.empty())
      places_.date = find(format_.date_column, "date_column");
    if (!format_.mote_column.empty())
      places_.mote = find(format_.mote_column, "mote_column");
    if (!format_.name_column.empty())
      places_.name = find(format_.name_column, "name_column");
    places_.value = find(format_.value_column, "column");
    return missing;
  }

  /// A field of the line; nothing if it is missing.
  [[nodiscard]] std::optional<std::string_view> field(std::size_t i) const {
    if (i >= fields_.size() || is_missing(fields_[i]))
      return std::nullopt;
    return fields_[i];
  }

  /// @returns what is wrong, or nothing
  std::string take_line() {
    if (fields_.size() > names_.size())
      return "a line of " + std::to_string(fields_.size()) + " fields, but there are " +
             std::to_string(names_.size()) + " columns";
    if (places_.name && !same_letters(field(*places_.name).value_or(""), format_.name)) {
      ++table_.others;
      return {};
    }
    const auto text = time_text();
    if (!text)
      return skip();
    const auto time = parse_trace_time(*text, times_);
    if (!time)
      return no_time(*text);
    if (!zone_)
      zone_ = time->zone;
    if (dates_.value_or(time->is_date) != time->is_date)
      return "the times are " + std::string(*dates_ ? "dates" : "seconds") + " before, not " +
             quoted(*text);
    dates_ = time->is_date;
    earliest_ = std::min(earliest_, time->since);
    return take_reading(time->since);
  }

  static std::string no_time(std::string_view text) {
    const auto hint = why_no_trace_time(text);
    return "a time is seconds, or a date and a time of day, not " + quoted(text) +
           (hint.empty() ? "" : ", " + hint);
  }

  std::string take_reading(duration at) {
    const auto who = places_.mote ? field(*places_.mote) : "0";
    const auto what = field(places_.value);
    const auto mote = mote_number(who.value_or("0"), base_);
    const auto value = parse_trace_number(what.value_or("0"), times_.comma);
    needs_hex_ = !mote && mote_number(*who, 16);
    if (!mote)
      return "a mote is a number from 0 to 4294967295, or a hexadecimal one, not " + quoted(*who);
    if (!value || !(std::abs(*value) <= trace_value_max))
      return "a value is a number up to 1e15, not " + quoted(*what);
    if (!who || !what || *value < format_.least || *value > format_.most)
      return skip();
    if (readings_++ == trace_readings_max)
      return "more than " + std::to_string(trace_readings_max) + " readings";
    table_.of_mote[*mote].emplace_back(at, *value);
    return {};
  }

  std::string skip() {
    ++table_.skipped;
    return {};
  }

  std::optional<std::string_view> time_text() {
    const auto time = field(places_.time);
    if (!places_.date || !time)
      return time;
    const auto date = field(*places_.date);
    if (!date)
      return std::nullopt;
    time_text_.assign(*date).append(" ").append(*time);
    return time_text_;
  }

  /// Puts the readings in order, and their times behind the start of the run.
  void finish() {
    table_.start = {*dates_, *dates_ ? earliest_ : duration(0), zone_};
    if (format_.start) {
      table_.start.since = format_.start->since;
      if (!format_.start->zone) // so it is in that of the file
        table_.start.since -= zone_.value_or(0s);
    }
    const auto start = table_.start.since;
    for (auto& [mote, series] : table_.of_mote) {
      std::stable_sort(series.begin(), series.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
      keep_last_of_each_time(series);
      for (auto& reading : series)
        reading.first -= start;
      series.shrink_to_fit();
      const auto last = series.back().first;
      const auto gap = series.size() > 1 ? last - series[series.size() - 2].first : duration(0);
      table_.turn = std::max(table_.turn, last + gap);
    }
  }

  void keep_last_of_each_time(time_series& series) {
    std::size_t last = 0;
    for (std::size_t i = 1; i < series.size(); ++i) {
      if (series[i].first != series[last].first)
        ++last;
      series[last] = series[i];
    }
    table_.repeated += series.size() - (last + 1);
    series.resize(last + 1);
  }

  line_reader lines_;
  const trace_format& format_;
  time_form times_;
  int base_;
  bool needs_hex_ = false;
  std::vector<std::string_view> names_;
  std::vector<std::string_view> fields_;
  places places_;
  std::string time_text_;
  std::optional<duration> zone_; ///< of the first time that has one
  std::optional<bool> dates_;    ///< whether the times are dates, once there was one
  duration earliest_ = duration::max();
  std::size_t readings_ = 0;
  dated_trace table_;
};

} // namespace

std::variant<std::shared_ptr<const dated_trace>, trace_problem>
read_trace(std::string_view text, const trace_format& format) {
  if (text.size() > trace_octets_max)
    return trace_problem{0, "it has " + std::to_string(text.size()) + " octets, more than " +
                                std::to_string(trace_octets_max)};
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    return trace_problem{0, "it is UTF-16: save it as UTF-8"};
  trace_reader reader(text, format, 10);
  auto found = reader.read();
  return reader.needs_hex() ? trace_reader(text, format, 16).read() : std::move(found);
}

} // namespace rubicon::device
