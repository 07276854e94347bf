#include "radio/medium/tossim_files.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>
#include <utility>

namespace rubicon::radio {

namespace {

constexpr std::uint16_t node_max = 65534;
constexpr double dbm_min = -250;
constexpr double dbm_max = 50;
constexpr std::string_view blanks = " \t";
constexpr std::string_view between = " \t,;"; // two fields: some write tables

/// The lines that say something, without the blanks around them and the comments behind them.
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
      line_ = line_.substr(0, std::min(line_.find_first_of("#%"), line_.find("//")));
      trim();
      if (!line_.empty())
        return true;
    }
    return false;
  }

  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] std::size_t number() const { return number_; }

private:
  void trim() {
    if (line_.ends_with('\r'))
      line_.remove_suffix(1);
    line_.remove_prefix(std::min(line_.find_first_not_of(blanks), line_.size()));
    line_.remove_suffix(line_.size() - 1 - line_.find_last_not_of(blanks)); // npos + 1 is 0
  }

  std::string_view rest_;
  std::string_view line_;
  std::size_t number_ = 0;
};

constexpr std::size_t fields_max = 4;

/// More than fields_max are counted as one more.
struct fields {
  std::array<std::string_view, fields_max> at;
  std::size_t count = 0;

  /// The same with one more at the beginning, which is empty.
  [[nodiscard]] fields behind_a_word() const {
    auto out = *this;
    std::ranges::copy_backward(at.begin(), at.end() - 1, out.at.end());
    out.at[0] = {};
    ++out.count;
    return out;
  }

  explicit fields(std::string_view line) {
    while (!line.empty()) {
      if (count == fields_max) {
        ++count;
        return;
      }
      const auto end = std::min(line.find_first_of(between), line.size());
      at[count++] = line.substr(0, end);
      line.remove_prefix(end);
      line.remove_prefix(std::min(line.find_first_not_of(between), line.size()));
    }
  }
};

std::string quoted(std::string_view x) {
  std::string text = "\"";
  for (const char c : x.substr(0, 40))
    text += c >= ' ' && c <= '~' ? c : '?';
  return text + '"';
}

std::optional<double> finite_number(std::string_view x) {
  if (x.size() > 1 && x[0] == '+' && x[1] != '-')
    x.remove_prefix(1);
  double number = 0;
  const auto end = x.data() + x.size();
  const auto done = std::from_chars(x.data(), end, number);
  if (done.ec != std::errc() || done.ptr != end || !std::isfinite(number))
    return std::nullopt;
  return number;
}

std::optional<float> decibels(std::string_view x) {
  const auto number = finite_number(x);
  if (!number || *number < dbm_min || *number > dbm_max)
    return std::nullopt;
  return static_cast<float>(*number);
}

/// @param word in small letters
bool is_word(std::string_view x, std::string_view word) {
  return std::ranges::equal(x, word, {}, [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
}

std::optional<std::uint16_t> node(std::string_view x) {
  std::uint16_t number = 0;
  const auto end = x.data() + x.size();
  const auto done = std::from_chars(x.data(), end, number);
  if (done.ec != std::errc() || done.ptr != end || number > node_max)
    return std::nullopt;
  return number;
}

/// What a line gives, and the number of the line.
using mention = std::pair<std::uint32_t, std::size_t>;

class topology_reader {
public:
  explicit topology_reader(std::string_view text) : lines_(text) {}

  std::variant<gain_table, file_problem> read() {
    std::optional<file_problem> problem;
    while (!problem && lines_.next()) {
      if (auto message = take(fields(lines_.line())); !message.empty())
        problem = file_problem{lines_.number(), std::move(message)};
    }
    // Found by sorting, so only now; what was read ends before the mistake found above.
    for (const auto& again : {repeated_link(), repeated_floor()}) {
      if (again && (!problem || again->line < problem->line))
        problem = again;
    }
    if (problem)
      return *problem;
    if (table_.gains.empty())
      return file_problem{0, "there is no gain in it"};
    sort_table();
    return std::move(table_);
  }

private:
  /// @returns what is wrong, or nothing
  std::string take(const fields& x) {
    if (is_word(x.at[0], "gain"))
      return take_gain(x);
    if (is_word(x.at[0], "noise"))
      return take_noise(x);
    if (finite_number(x.at[0])) // without its word, as in TinyOS's tutorial
      return take_gain(x.behind_a_word());
    return "a line begins with gain, noise or, as in 0 1 -60.0, a node, not " + quoted(x.at[0]);
  }

  std::string take_gain(const fields& x) {
    if (x.count != 4)
      return "gain needs two nodes and a number of dB, not " + arguments(x);
    const auto from = node(x.at[1]);
    const auto to = node(x.at[2]);
    const auto db = decibels(x.at[3]);
    if (!from || !to)
      return "gain needs nodes of 0 to 65534, not " + quoted(from ? x.at[2] : x.at[1]);
    if (!db)
      return "gain needs -250 to 50 dB, not " + quoted(x.at[3]);
    if (*from == *to)
      return "gain needs two nodes, not " + std::to_string(*from) + " twice";
    table_.gains.push_back({*from, *to, *db});
    links_.emplace_back(std::uint32_t{*from} << 16U | *to, lines_.number());
    return {};
  }

  std::string take_noise(const fields& x) {
    if (x.count != 4)
      return "noise needs a node, a floor and a deviation, not " + arguments(x);
    const auto at = node(x.at[1]);
    const auto dbm = decibels(x.at[2]);
    if (!at)
      return "noise needs a node of 0 to 65534, not " + quoted(x.at[1]);
    if (!dbm)
      return "noise needs a floor of -250 to 50 dBm, not " + quoted(x.at[2]);
    if (!finite_number(x.at[3]))
      return "noise needs a deviation in dB, not " + quoted(x.at[3]);
    table_.floors.push_back({*at, *dbm});
    nodes_.emplace_back(*at, lines_.number());
    return {};
  }

  /// The line after its first word.
  [[nodiscard]] std::string arguments(const fields& x) const {
    auto rest = lines_.line().substr(x.at[0].size());
    rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
    return quoted(rest);
  }

  struct repeat {
    std::uint32_t key;
    std::size_t first;
    std::size_t second;
  };

  /// The repeat that comes first in the file.
  static std::optional<repeat> first_repeat(std::vector<mention>& all) {
    std::sort(all.begin(), all.end());
    std::optional<repeat> found;
    for (std::size_t i = 1; i < all.size(); ++i) {
      if (all[i].first == all[i - 1].first && (!found || all[i].second < found->second))
        found = repeat{all[i].first, all[i - 1].second, all[i].second};
    }
    return found;
  }

  std::optional<file_problem> repeated_link() {
    const auto x = first_repeat(links_);
    if (!x)
      return std::nullopt;
    return file_problem{x->second, "the gain from " + std::to_string(x->key >> 16U) + " to " +
                                       std::to_string(x->key & 0xffffU) + " is given in line " +
                                       std::to_string(x->first) + " already"};
  }

  std::optional<file_problem> repeated_floor() {
    const auto x = first_repeat(nodes_);
    if (!x)
      return std::nullopt;
    return file_problem{x->second, "the noise of " + std::to_string(x->key) + " is given in line " +
                                       std::to_string(x->first) + " already"};
  }

  void sort_table() {
    std::sort(table_.gains.begin(), table_.gains.end(), [](const auto& a, const auto& b) {
      return std::pair(a.from, a.to) < std::pair(b.from, b.to);
    });
    std::sort(table_.floors.begin(), table_.floors.end(),
              [](const auto& a, const auto& b) { return a.node < b.node; });
  }

  line_reader lines_;
  gain_table table_;
  std::vector<mention> links_;
  std::vector<mention> nodes_;
};

std::optional<std::int8_t> reading(std::string_view x) {
  const auto number = finite_number(x);
  if (!number || !(std::floor(*number) >= -128 && std::floor(*number) <= 127))
    return std::nullopt;
  return static_cast<std::int8_t>(std::floor(*number));
}

std::optional<file_problem> too_long(std::string_view text) {
  if (text.size() <= tossim_file_octets_max)
    return std::nullopt;
  return file_problem{0, "it has " + std::to_string(text.size()) + " octets, more than " +
                             std::to_string(tossim_file_octets_max)};
}

} // namespace

std::variant<gain_table, file_problem> read_topology(std::string_view text) {
  if (const auto problem = too_long(text))
    return *problem;
  return topology_reader(text).read();
}

std::variant<std::shared_ptr<const noise_trace>, file_problem>
read_noise_trace(std::string_view text) {
  if (const auto problem = too_long(text))
    return *problem;
  std::vector<std::int8_t> readings;
  line_reader lines(text);
  while (lines.next()) {
    const auto x = reading(lines.line());
    if (!x)
      return file_problem{lines.number(),
                          "a line is one reading of -128 to 127 dBm, not " + quoted(lines.line())};
    if (readings.size() == noise_trace::readings_max)
      return file_problem{lines.number(),
                          "more than " + std::to_string(noise_trace::readings_max) + " readings"};
    readings.push_back(*x);
  }
  if (readings.size() < noise_trace::readings_min)
    return file_problem{0, "it has " + std::to_string(readings.size()) + " readings, at least " +
                               std::to_string(noise_trace::readings_min) + " are needed"};
  return std::make_shared<const noise_trace>(std::move(readings));
}

} // namespace rubicon::radio
