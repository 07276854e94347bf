#include "unit/config/sample.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "support/catch.hpp"

namespace rubicon::test {

namespace {

/// A piece of a file without its comments about mistakes, and these as problem_in() has them.
struct marked_piece {
  std::string toml;
  std::vector<std::string> problems;
};

/// @param line of the file, the last one before the comment
/// @returns whether `text` is such a comment
bool take_mark(const std::string& text, std::size_t line, std::vector<std::string>& problems) {
  const auto caret = text.find_first_not_of(' ', 1);
  if (!text.starts_with('#') || caret == std::string::npos)
    return false;
  const auto place = [line](std::size_t column) {
    return std::to_string(line) + ':' + std::to_string(column) + ": ";
  };
  if (text.starts_with("#@ "))
    problems.push_back(text.substr(3));
  else if (text.starts_with("#< "))
    problems.push_back(place(1) + text.substr(3));
  else if (text.substr(caret).starts_with("^ "))
    problems.push_back(place(caret + 1) + text.substr(caret + 2));
  else if (caret >= 4 && !problems.empty())
    problems.back() += ' ' + text.substr(caret);
  else
    return false;
  return true;
}

std::vector<marked_piece> pieces_of(std::string_view start, const std::string& text) {
  const auto lines_before = static_cast<std::size_t>(std::count(start.begin(), start.end(), '\n'));
  std::vector<marked_piece> out(1);
  auto at = lines_before;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) {
      out.emplace_back();
      at = lines_before;
    } else if (!take_mark(line, at, out.back().problems)) {
      out.back().toml += line + '\n';
      ++at;
    }
  }
  return out;
}

} // namespace

void check_mistakes(std::string_view start, std::string_view pieces) {
  pieces.remove_prefix(pieces.starts_with('\n') ? 1 : 0);
  for (const auto& [toml, problems] : pieces_of(start, std::string(pieces))) {
    std::string expected = problems.empty() ? "none" : problems.front();
    for (std::size_t i = 1; i < problems.size(); ++i)
      expected += '\n' + problems[i];
    CAPTURE(toml);
    CHECK(problem_after(start, toml) == expected);
  }
}

std::vector<std::string> problems_in(const std::string& toml) {
  std::vector<std::string> all;
  for (const auto& each : config::load_text(toml, "t").problems)
    all.push_back(to_string(each).substr(2)); // without `t:`
  return all;
}

std::string problems_of(const config::loaded& x) {
  std::string text;
  for (const auto& each : x.problems)
    text += (text.empty() ? "" : "\n") + to_string(each);
  return text.empty() ? "none" : text;
}

config::file_text text_in(const std::map<std::string, std::string>& files,
                          const std::string& path) {
  const auto found = files.find(path);
  if (found == files.end())
    return {std::nullopt, "cannot be opened: No such file or directory"};
  return {found->second, {}};
}

std::string problem_in(const std::string& toml) {
  const auto all = problems_in(toml);
  std::string text = all.empty() ? "none" : all.front();
  for (std::size_t i = 1; i < all.size(); ++i)
    text += '\n' + all[i];
  return text;
}

std::string problem_after(std::string_view start, std::string_view rest) {
  return problem_in(std::string(start) + std::string(rest));
}

config::ecology_description good(const std::string& toml) {
  auto found = config::load_text(toml, "t");
  if (!found.ecology)
    throw std::runtime_error(problem_in(toml));
  return *std::move(found.ecology);
}

} // namespace rubicon::test
