// Flows between many motes: one cell each, where lines on a map would cover each other.
#include <algorithm>
#include <map>
#include <string>

#include "page/markup.hpp"
#include "page/parts.hpp"
#include "report/figures.hpp"

namespace rubicon::page {

namespace {

constexpr std::size_t motes_max = 150; ///< of a matrix; of more, those with the worst flows
constexpr double cell_size = 9;
constexpr double headings_width = 130;

bool has_one_receiver(const report::flow_report& x) {
  return x.sent > 0 && !x.to_name.ends_with("/*");
}

/// The names at both ends of the flows; of too many, those at the ends of the worst ones.
std::map<std::string, std::size_t> ends_of(const std::vector<report::flow_report>& flows) {
  std::vector<const report::flow_report*> worst_first;
  for (const auto& each : flows)
    if (has_one_receiver(each))
      worst_first.push_back(&each);
  std::ranges::stable_sort(worst_first, {}, [](const auto* each) { return each->pdr; });
  std::map<std::string, std::size_t> all;
  for (const auto* each : worst_first)
    for (const auto* name : {&each->from_name, &each->to_name})
      if (all.size() < motes_max)
        all.try_emplace(*name, 0);
  std::size_t index = 0;
  for (auto& [name, at] : all)
    at = index++;
  return all;
}

} // namespace

bool has_matrix(const run_page& x) {
  std::map<std::string, bool> names;
  for (const auto& each : x.report.flows)
    if (has_one_receiver(each)) {
      names[each.from_name] = names[each.to_name] = true;
      if (names.size() > lines_motes_max)
        return true;
    }
  return false;
}

std::string matrix_of(const run_page& x) {
  if (!has_matrix(x))
    return {};
  const auto ends = ends_of(x.report.flows);
  const auto size = cell_size * static_cast<double>(ends.size());
  drawing out(
      headings_width + size + 10, headings_width + size + 10,
      "class='matrix' role='img' aria-label='Share delivered from each row to each column'");
  out.rect({headings_width, headings_width}, size, size, "class='frame'");
  for (const auto& [name, at] : ends) {
    const auto middle = headings_width + cell_size * (static_cast<double>(at) + 0.8);
    out.text({headings_width - 4, middle}, "class='soft' text-anchor='end'", name);
    const auto place = px(middle) + ' ' + px(headings_width - 4);
    out.text({middle, headings_width - 4}, "class='soft' transform='rotate(-90 " + place + ")'",
             name);
  }
  for (const auto& each : x.report.flows) {
    const auto from = ends.find(each.from_name);
    const auto to = ends.find(each.to_name);
    if (!has_one_receiver(each) || from == ends.end() || to == ends.end())
      continue;
    out.rect({headings_width + cell_size * static_cast<double>(to->second),
              headings_width + cell_size * static_cast<double>(from->second)},
             cell_size - 1, cell_size - 1, "class='cell " + std::string(class_of(each.pdr)) + '\'',
             each.from_name + " to " + each.to_name + ": " + share(each.pdr) + " of " +
                 report::counted(each.sent, "packet") + " delivered");
  }
  std::string legend = "<div class='legend'>";
  for (const auto& [look, text] :
       {std::pair("good", "99 % and more"), std::pair("fair", "95 % and more"),
        std::pair("poor", "80 % and more"), std::pair("bad", "below 80 %")}) {
    drawing sample(34, 14, "aria-hidden='true'");
    sample.rect({10, 1}, 12, 12, "class='cell " + std::string(look) + '\'');
    legend += "<span>" + sample.finish() + escaped(text) + "</span>\n";
  }
  return section("matrix", "Share delivered, from row to column",
                 wide(out.finish()) + legend + "</div>\n");
}

} // namespace rubicon::page
