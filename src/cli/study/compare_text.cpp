#include "cli/study/compare_text.hpp"

#include <algorithm>
#include <string_view>

#include "cli/study/figure_text.hpp"
#include "core/text/decimal.hpp"
#include "report/figures.hpp"
#include "report/print/csv.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

/// `+12.5 %`
std::string change_text(double relative) {
  return (relative > 0 ? "+" : "") + decimal_text(100 * relative, 1) + " %";
}

std::string chance_text(double p) {
  constexpr double shown_min = 0.0001;
  return p < shown_min ? "< 0.0001" : decimal_text(p, 4);
}

std::string head_of(const shown_comparison& x) {
  std::string text = "A: " + report::printable(x.a) + "\nB: " + report::printable(x.b) + '\n' +
                     report::counted(x.pairs, "pair") + " of runs";
  if (x.single > 0)
    text += " (" + report::counted(x.single, "run") + " of only one side left out)";
  text += ", " + report::counted(x.found.figures, "number") + " compared: ";
  if (x.found.differing.empty())
    return text + "all are equal in all pairs\n";
  return text + report::counted(x.found.differing.size(), "number") +
         " not equal in all pairs, of which " + std::to_string(x.found.sure) +
         " differ for sure\n" +
         "p: chance of such a difference where there is none, corrected (Holm) for " +
         report::counted(x.found.differing.size(), "comparison") + "; sure: p <= 0.05\n";
}

report::table empty_table() {
  using enum report::align;
  return report::table({{"number"},
                        {"variant"},
                        {"A", point},
                        {"B", point},
                        {"B - A", point},
                        {"95 % interval"},
                        {"change", right},
                        {"p", right}});
}

void add_row(report::table& to, const study::difference& x) {
  const auto how = x.is_sure ? report::look::strong : report::look::faint;
  to.add({{report::printable(x.name), how},
          {report::printable(x.variant)},
          {number_text(x.a.mean)},
          {number_text(x.b.mean)},
          {number_text(x.of_pairs.mean)},
          {interval_text(x.of_pairs)},
          {change_text(x.relative())},
          {chance_text(x.p), how}});
}

} // namespace

std::string comparison_text(const shown_comparison& x, bool all, std::size_t width, bool colour) {
  const auto& found = x.found;
  auto table = empty_table();
  const auto shown =
      all ? found.differing.size() : std::min(found.differing.size(), found.sure + unsure_max);
  for (std::size_t i = 0; i < shown; ++i)
    add_row(table, found.differing[i]);
  if (shown < found.differing.size())
    table.add_note(std::to_string(found.differing.size() - shown) +
                   " more are not sure: --full shows them");
  return head_of(x) + (table.empty() ? std::string() : table.render(width, colour));
}

std::string comparison_csv(const study::comparison& x) {
  const auto number = [](double y) { return ',' + shortest_decimal(y); };
  std::string text = "scalar,variant,runs,a,b,difference,low,high,relative,p,sure\n";
  for (const auto& each : x.differing) {
    const auto& pairs = each.of_pairs;
    text += report::csv_field(each.name) + ',' + report::csv_field(each.variant) + ',' +
            std::to_string(pairs.runs) + number(each.a.mean) + number(each.b.mean) +
            number(pairs.mean) +
            (pairs.half_width
                 ? number(pairs.mean - *pairs.half_width) + number(pairs.mean + *pairs.half_width)
                 : std::string(",,")) +
            number(each.relative()) + number(each.p) + (each.is_sure ? ",1\n" : ",0\n");
  }
  return text;
}

} // namespace rubicon::cli
