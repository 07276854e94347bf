// Connectivity traces in the K7 format: a header in JSON, and a table in CSV of how many of the
// frames of each link arrived, over time.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"
#include "imports/readers.hpp"

namespace rubicon::imports {

namespace {

constexpr double weakest_gain_db = -80; ///< nothing but the ratio is to lose frames
constexpr double usual_gain_db = -60;
constexpr double least_change = 0.01;
constexpr std::size_t samples_max = 2'000'000;
constexpr std::size_t no_column = ~std::size_t{0};

/// Mean of what was measured of a link within a minute.
struct link_minute {
  double arrived = 0;
  double rssi_dbm = 0;
  unsigned count = 0;
  unsigned rssi_count = 0;
};

class k7_reader {
public:
  import_result read(std::string_view text) {
    line_fields lines(text, "");
    if (!lines.next())
      refuse({1, 1}, "the header is missing");
    read_header(lines);
    if (!lines.next())
      refuse({1, 1}, "no names of columns follow this line");
    read_columns(lines);
    while (lines.next())
      if (!lines.fields().empty())
        read_row(lines);
    if (minutes_.empty())
      refuse(lines.end(), "there is no measurement");
    plan_links();
    out_.plan.air = listed_links{};
    return finished(std::move(out_), motes_, notes_);
  }

private:
  void read_header(const line_fields& lines) {
    const auto header = try_parse_json(lines.line());
    if (!header.is_object())
      refuse({1, 1}, "the header must be a line with a JSON object");
    for (const auto& [key, value] : header.items())
      if (key == "location" && value.is_string())
        out_.plan.title = value.get<std::string>();
  }

  void read_columns(const line_fields& lines) {
    const auto find = [&](std::string_view name) {
      const auto& all = lines.fields();
      const auto found = std::ranges::find(all, name, &field::text);
      return found == all.end() ? no_column : static_cast<std::size_t>(found - all.begin());
    };
    const auto need = [&](std::string_view name) {
      const auto found = find(name);
      if (found == no_column)
        refuse(lines.end(), "there is no column `" + std::string(name) + '`');
      return found;
    };
    time_ = need("datetime");
    from_ = need("src");
    to_ = need("dst");
    ratio_ = find("pdr") != no_column ? find("pdr") : need("prr");
    rssi_ = find("mean_rssi");
    width_ = lines.fields().size();
    for (const auto& each : lines.fields())
      if (each.text == "channel")
        notes_.add(each.at, "channels: ratios are means of all of them");
  }

  void read_row(const line_fields& lines) {
    const auto& row = lines.fields();
    if (row.size() != width_)
      refuse(row.front().at, "the row has " + std::to_string(row.size()) + " fields, not " +
                                 std::to_string(width_));
    if (++samples_ > samples_max)
      refuse(row.front().at, "there are more than 2000000 rows");
    const auto minute = minute_of(row[time_]);
    const auto from = motes_.by_name(row[from_].text, row[from_].at);
    const auto to = motes_.by_name(row[to_].text, row[to_].at);
    if (row[from_].text.empty() || row[to_].text.empty() || from == to)
      refuse(row[to_].at, "a link leads from one node to another");
    auto& cell = minutes_[{minute, {from, to}}];
    cell.arrived += real_of(row[ratio_], "a ratio", 0, 1);
    ++cell.count;
    if (rssi_ != no_column && !row[rssi_].text.empty()) {
      cell.rssi_dbm += real_of(row[rssi_], "mean_rssi", -200, 20);
      ++cell.rssi_count;
    }
  }

  /// Minutes since 1970 of `2018-01-11 16:32:15`, with T for the blank or a fraction behind it.
  static std::int64_t minute_of(const field& x) {
    const auto part = [&x](std::size_t at, std::size_t length) {
      const auto found =
          at + length <= x.text.size() ? whole_in(x.text.substr(at, length)) : std::nullopt;
      if (!found)
        refuse(x.at, "expected a time such as 2018-01-11 16:32:15, not " + quoted(x.text));
      return static_cast<unsigned>(*found);
    };
    using namespace std::chrono;
    const year_month_day day{year(static_cast<int>(part(0, 4))), month(part(5, 2)),
                             std::chrono::day(part(8, 2))};
    const auto hour = part(11, 2);
    const auto minute = part(14, 2);
    if (!day.ok() || hour > 23 || minute > 59)
      refuse(x.at, "there is no such time as " + quoted(x.text));
    return sys_days(day).time_since_epoch().count() * std::int64_t{1440} + hour * 60 + minute;
  }

  using link = std::pair<std::size_t, std::size_t>;

  void plan_links() {
    const auto first = minutes_.begin()->first.first;
    const auto last = minutes_.rbegin()->first.first;
    if (last - first > std::int64_t{366} * 1440)
      refuse({}, "it covers more than a year");
    out_.plan.length = std::chrono::minutes(last - first + 1);
    std::map<link, double> loss;
    for (const auto& [when, cell] : minutes_) {
      const auto& [from, to] = when.second;
      const auto now = std::clamp(1 - cell.arrived / cell.count, 0.0, 1.0);
      const auto [known, is_new] = loss.try_emplace(when.second, now);
      if (is_new)
        begin(when.second, when.first == first ? now : 1, cell);
      if ((is_new && when.first != first) ||
          (!is_new && std::abs(now - known->second) >= least_change)) {
        change(std::chrono::minutes(when.first - first), from, to, now);
        known->second = now;
      }
    }
  }

  void begin(const link& x, double loss, const link_minute& cell) {
    if (out_.plan.links.size() == links_max)
      refuse({}, "there are more than 200000 links");
    const auto gain = cell.rssi_count > 0 ? cell.rssi_dbm / cell.rssi_count : usual_gain_db;
    if (gain < weakest_gain_db)
      notes_.add({}, "signals below -80 dBm, which would lose frames in addition to the ratios");
    out_.plan.links.push_back({x.first, x.second, loss, std::max(gain, weakest_gain_db)});
  }

  void change(duration at, std::size_t from, std::size_t to, double loss) {
    if (out_.plan.changes.size() == changes_max)
      return notes_.add({}, "changes of links after the 20000th");
    out_.plan.changes.push_back({at, from, to, loss});
  }

  imported out_;
  mote_list motes_;
  note_list notes_;
  std::size_t time_ = 0;
  std::size_t from_ = 0;
  std::size_t to_ = 0;
  std::size_t ratio_ = 0;
  std::size_t rssi_ = no_column;
  std::size_t width_ = 0;
  std::size_t samples_ = 0;
  std::map<std::pair<std::int64_t, link>, link_minute> minutes_;
};

} // namespace

import_result read_k7(std::string_view text) {
  return k7_reader().read(text);
}

} // namespace rubicon::imports
