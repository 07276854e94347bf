#include "cli/study/sweep_text.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "cli/study/figure_text.hpp"
#include "core/numbers/random.hpp"
#include "core/text/decimal.hpp"
#include "core/text/json.hpp"
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

shown_figure shown(const study::estimate& x) {
  shown_figure out{x.runs, x.mean, std::nullopt};
  if (x.half_width)
    out.around = study::interval{x.mean - *x.half_width, x.mean + *x.half_width};
  return out;
}

constexpr std::size_t bootstrap_samples = 1000;

/// Of a quantile, by the bootstrap with the same samples each time.
variant_figures quantiles_of(const study_summary& x, const std::vector<double>& all,
                             const std::vector<double>& first, const std::vector<double>& paired) {
  const double q = *x.quantile;
  random_stream random(1);
  variant_figures out;
  if (!all.empty())
    out.own = {all.size(), study::quantile(all, q), std::nullopt};
  if (all.size() > 1)
    out.own.around = study::bootstrap_quantile(all, q, random, bootstrap_samples, x.confidence);
  if (!paired.empty())
    out.difference = {paired.size(), study::quantile(paired, q) - study::quantile(first, q),
                      std::nullopt};
  if (paired.size() > 1)
    out.difference.around =
        study::bootstrap_difference(first, paired, q, random, bootstrap_samples, x.confidence);
  return out;
}

std::string text_of(const shown_figure& x) {
  return x.runs == 0 ? std::string() : number_text(x.value);
}

std::string around(const shown_figure& x) {
  return x.around ? interval_text(*x.around) : std::string();
}

std::string csv_of(const shown_figure& x) {
  const auto text = [](double y) { return shortest_decimal(y); };
  if (x.runs == 0)
    return ",,,";
  return ',' + text(x.value) +
         (x.around ? ',' + text(x.around->low) + ',' + text(x.around->high) : std::string(",,"));
}

report::table empty_table(const study_summary& x) {
  const auto confidence = percent_text(x.confidence);
  std::vector<report::table::column> columns;
  for (const auto& path : x.paths)
    columns.push_back({report::printable(path), report::align::point});
  columns.push_back({"runs", report::align::right});
  columns.push_back({figure_name(x), report::align::point});
  columns.push_back({confidence + " interval"});
  columns.push_back({"from the first", report::align::point});
  columns.push_back({confidence + " interval of that"});
  return report::table(std::move(columns));
}

} // namespace

std::optional<study::run_result> result_of(const std::string& report) {
  study::run_result out;
  try {
    const auto x = parse_json(report);
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

variant_figures figures_of(const study_summary& x, const scalar_values& scalar,
                           std::size_t variant) {
  std::vector<double> all;
  std::vector<double> first;
  std::vector<double> paired;
  const auto& own = scalar.of_variants[variant];
  const auto& others = scalar.of_variants.front();
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (!own[i])
      continue;
    all.push_back(*own[i]);
    if (variant > 0 && i < others.size() && others[i]) {
      first.push_back(*others[i]);
      paired.push_back(*own[i]);
    }
  }
  if (x.quantile)
    return quantiles_of(x, all, first, paired);
  return {shown(study::mean_of(all, x.confidence)),
          shown(study::paired_difference(first, paired, x.confidence))};
}

std::string figure_name(const study_summary& x) {
  return x.quantile ? percent_text(*x.quantile) + " quantile" : "mean";
}

std::string summary_text(const study_summary& x, std::size_t width, bool colour) {
  std::string text;
  for (const auto& scalar : x.scalars) {
    auto table = empty_table(x);
    for (std::size_t i = 0; i < x.variants.size(); ++i) {
      std::vector<report::cell> cells;
      for (const auto& value : x.variants[i])
        cells.emplace_back(report::printable(value));
      const auto [own, difference] = figures_of(x, scalar, i);
      cells.emplace_back(std::to_string(own.runs));
      cells.emplace_back(text_of(own));
      cells.emplace_back(around(own));
      cells.emplace_back(text_of(difference));
      cells.emplace_back(around(difference));
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
  text += "scalar,runs,";
  text += x.quantile ? "quantile" : "mean";
  text += ",low,high,difference,difference_low,difference_high\n";
  for (const auto& scalar : x.scalars)
    for (std::size_t i = 0; i < x.variants.size(); ++i) {
      for (const auto& value : x.variants[i])
        text += report::csv_field(value) + ',';
      const auto [own, difference] = figures_of(x, scalar, i);
      text += report::csv_field(scalar.name) + ',' + std::to_string(own.runs) + csv_of(own) +
              csv_of(difference) + '\n';
    }
  return text;
}

} // namespace rubicon::cli
