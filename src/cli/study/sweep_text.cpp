#include "cli/study/sweep_text.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/decimal.hpp"
#include "report/print/csv.hpp"
#include "report/print/text_layout.hpp"
#include "study/statistics.hpp"

namespace rubicon::cli {

namespace {

using nlohmann::json;

void add_numbers(const json& x, const std::string& path, std::map<std::string, double>& out) {
  for (const auto& [key, value] : x.items()) {
    const auto below = path.empty() ? key : path + '.' + key;
    if (value.is_object())
      add_numbers(value, below, out);
    else if (value.is_number() && below != "seed")
      out[below] = value.get<double>();
  }
}

/// Five digits that count.
std::string number_text(double x) {
  constexpr int digits = 5;
  constexpr int decimals_max = 6;
  int decimals = decimals_max;
  if (x != 0)
    decimals = digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(x))));
  return decimal_text(x, std::clamp(decimals, 0, decimals_max));
}

struct row_values {
  study::estimate mean;
  study::estimate difference; ///< from the first variant; without runs for the first itself
};

row_values values_of(const scalar_values& x, std::size_t variant) {
  std::vector<double> all;
  std::vector<double> first;
  std::vector<double> paired;
  const auto& own = x.of_variants[variant];
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (!own[i])
      continue;
    all.push_back(*own[i]);
    if (const auto& other = x.of_variants.front()[i]; variant > 0 && other) {
      first.push_back(*other);
      paired.push_back(*own[i]);
    }
  }
  return {study::mean_of(all), study::paired_difference(first, paired)};
}

std::string interval_text(const study::estimate& x) {
  return x.half_width
             ? number_text(x.mean - *x.half_width) + " to " + number_text(x.mean + *x.half_width)
             : std::string();
}

std::string csv_of(const study::estimate& x) {
  const auto text = [](double y) { return shortest_decimal(y); };
  if (x.runs == 0)
    return ",,,";
  return ',' + text(x.mean) +
         (x.half_width ? ',' + text(x.mean - *x.half_width) + ',' + text(x.mean + *x.half_width)
                       : std::string(",,"));
}

} // namespace

std::optional<study::run_result> result_of(const std::string& report) {
  study::run_result out;
  try {
    const auto x = json::parse(report);
    if (x.at("interrupted").get<bool>())
      return std::nullopt;
    add_numbers(x, {}, out.scalars);
    for (const auto& each : x.at("expectations"))
      out.expectations.push_back(
          {each.at("expect").get<std::string>(),
           each.at("met").is_null() ? std::nullopt : std::optional(each.at("met").get<bool>()),
           each.at("measured").get<std::string>()});
    for (const auto& each : x.at("violations"))
      out.violations.push_back({each.at("at_s").get<double>(),
                                each.at("invariant").get<std::string>(),
                                each.at("detail").get<std::string>()});
  } catch (const json::exception&) {
    return std::nullopt;
  }
  out.scalars["violations"] = static_cast<double>(out.violations.size());
  return out;
}

const std::vector<std::string>& usual_scalars() {
  static const std::vector<std::string> names{"messages.delivery", "radio.transmissions",
                                              "energy.used_mah", "motes.joined", "violations"};
  return names;
}

std::string summary_text(const study_summary& x, std::size_t width, bool colour) {
  std::string text;
  for (const auto& scalar : x.scalars) {
    std::vector<report::table::column> columns;
    for (const auto& path : x.paths)
      columns.push_back({report::printable(path), report::align::point});
    columns.push_back({"runs", report::align::right});
    columns.push_back({"mean", report::align::point});
    columns.push_back({"95 % interval"});
    columns.push_back({"from the first", report::align::point});
    columns.push_back({"95 % interval of that"});
    report::table table(std::move(columns));
    for (std::size_t i = 0; i < x.variants.size(); ++i) {
      std::vector<report::cell> cells;
      for (const auto& value : x.variants[i])
        cells.emplace_back(report::printable(value));
      const auto [mean, difference] = values_of(scalar, i);
      cells.emplace_back(std::to_string(mean.runs));
      cells.emplace_back(mean.runs == 0 ? std::string() : number_text(mean.mean));
      cells.emplace_back(interval_text(mean));
      cells.emplace_back(difference.runs == 0 ? std::string() : number_text(difference.mean));
      cells.emplace_back(interval_text(difference));
      table.add(std::move(cells));
    }
    text += (text.empty() ? "" : "\n") + report::printable(scalar.name) + '\n' +
            table.render(width, colour);
  }
  return text;
}

std::string summary_csv(const study_summary& x) {
  std::string text;
  for (const auto& path : x.paths)
    text += report::csv_field(path) + ',';
  text += "scalar,runs,mean,low,high,difference,difference_low,difference_high\n";
  for (const auto& scalar : x.scalars)
    for (std::size_t i = 0; i < x.variants.size(); ++i) {
      for (const auto& value : x.variants[i])
        text += report::csv_field(value) + ',';
      const auto [mean, difference] = values_of(scalar, i);
      text += report::csv_field(scalar.name) + ',' + std::to_string(mean.runs) + csv_of(mean) +
              csv_of(difference) + '\n';
    }
  return text;
}

} // namespace rubicon::cli
