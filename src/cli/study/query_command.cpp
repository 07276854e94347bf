#include "cli/study/query_command.hpp"

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cli/print/console.hpp"
#include "report/print/csv.hpp"
#include "report/print/text_layout.hpp"
#include "study/store.hpp"

namespace rubicon::cli {

namespace {

std::string csv_of(const study::answer& x) {
  const auto line_of = [](const std::vector<std::string>& cells) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i)
      line += (i == 0 ? "" : ",") + report::csv_field(cells[i]);
    return line + '\n';
  };
  auto text = line_of(x.columns);
  for (const auto& row : x.rows)
    text += line_of(row);
  return text;
}

std::string table_of(const study::answer& x, const console& out) {
  std::vector<report::table::column> columns;
  for (const auto& each : x.columns)
    columns.push_back({report::printable(each), report::align::point});
  report::table table(std::move(columns));
  for (const auto& row : x.rows) {
    std::vector<report::cell> cells;
    for (const auto& each : row)
      cells.emplace_back(report::printable(each));
    table.add(std::move(cells));
  }
  return table.render(out.room(), out.colour);
}

} // namespace

exit_status perform(const query_command& x) {
  auto opened = study::store::open(x.database, study::store::access::read);
  if (const auto* why = std::get_if<std::string>(&opened))
    return refuse(x.database + ' ' + *why);
  const auto found = std::get<study::store>(opened).query(x.sql);
  if (const auto* why = std::get_if<std::string>(&found))
    return refuse("the query is refused: " + *why);
  const auto& rows = std::get<study::answer>(found);
  if (rows.has_more)
    say("only the first " + std::to_string(study::answer::rows_max) + " rows are shown");
  return print(stdout, x.csv ? csv_of(rows) : table_of(rows, console_of(stdout)))
             ? exit_status::good
             : exit_status::refused;
}

} // namespace rubicon::cli
