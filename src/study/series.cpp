#include "study/series.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include "core/text/decimal.hpp"

namespace rubicon::study {

namespace {

/// Takes the first line of `text` off it. Fields are quoted as in RFC 4180, without newlines.
std::vector<std::string> next_fields(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  const auto line = text.substr(0, end);
  text.remove_prefix(std::min(text.size(), end + 1));
  std::vector<std::string> out(1);
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char x = line[i];
    if (x == '"' && is_quoted && i + 1 < line.size() && line[i + 1] == '"') {
      out.back() += x;
      ++i;
    } else if (x == '"') {
      is_quoted = !is_quoted;
    } else if (x == ',' && !is_quoted) {
      out.emplace_back();
    } else if (x != '\r') {
      out.back() += x;
    }
  }
  return out;
}

std::optional<std::size_t> column_of(const std::vector<std::string>& head, std::string_view name) {
  const auto found = std::ranges::find(head, name);
  return found == head.end() ? std::nullopt
                             : std::optional(static_cast<std::size_t>(found - head.begin()));
}

} // namespace

std::vector<series_point> summed_series(std::string_view csv, std::string_view value,
                                        std::string_view name,
                                        const std::vector<std::string>& columns) {
  const auto head = next_fields(csv);
  const auto time = column_of(head, "time_s");
  const auto summed = column_of(head, value);
  std::vector<std::size_t> parts;
  for (const auto& each : columns)
    if (const auto found = column_of(head, each))
      parts.push_back(*found);
  if (!time || !summed || parts.size() < columns.size())
    return {};
  std::map<std::pair<std::string, double>, double> sums;
  while (!csv.empty()) {
    const auto fields = next_fields(csv);
    if (fields.size() != head.size())
      continue; // a run that was killed leaves half a line
    const auto at = number_in(fields[*time]);
    const auto what = number_in(fields[*summed]);
    if (!at || !what)
      continue;
    std::string full(name);
    for (const auto each : parts)
      full += '.' + fields[each];
    sums[{full, *at}] += *what;
  }
  std::vector<series_point> out;
  out.reserve(sums.size());
  for (const auto& [where, sum] : sums)
    out.push_back({where.first, where.second, sum});
  return out;
}

} // namespace rubicon::study
