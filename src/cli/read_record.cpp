#include "cli/read_record.hpp"

#include <fstream>
#include <optional>

#include "explain/record.hpp"

namespace rubicon::cli {

namespace {

/// Line by line: a record may be much longer than what is kept of it.
std::optional<explain::bad_line> read_lines(std::istream& from, explain::decoder& lines) {
  std::string line;
  while (std::getline(from, line)) {
    if (from.eof()) // without a newline
      return lines.finish(line);
    if (auto problem = lines.take(line))
      return problem;
  }
  return lines.finish("");
}

} // namespace

std::variant<explain::traces, std::string> read_record(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return path + ": cannot be read";
  explain::decoder lines;
  if (const auto problem = read_lines(file, lines))
    return path + ':' + std::to_string(problem->line) + ": " + problem->message;
  return explain::follow(lines.result());
}

} // namespace rubicon::cli
