#include "config/toml/problem.hpp"

#include <algorithm>

#include "core/text/printable.hpp"

namespace rubicon::config {

std::string to_string(const problem& x) {
  auto place = x.file;
  if (x.line != 0)
    place += ':' + std::to_string(x.line);
  if (x.line != 0 && x.column != 0)
    place += ':' + std::to_string(x.column);
  constexpr std::size_t octets_max = 4096; // a key that is quoted may be as long as the file
  return printable(place + ": " + x.message, octets_max);
}

namespace {
constexpr unsigned settings_begin = 1U << 31U; ///< no file has so many lines (file_octets_max)
} // namespace

mark mark_of_setting(std::size_t index) {
  return {settings_begin + static_cast<unsigned>(index), 0};
}

std::optional<std::size_t> setting_of(mark x) {
  return x.line < settings_begin ? std::nullopt
                                 : std::optional<std::size_t>(x.line - settings_begin);
}

std::string place_text(mark x) {
  if (setting_of(x))
    return "(--set)";
  return "(line " + std::to_string(x.line) + ", column " + std::to_string(x.column) + ')';
}

void complaints::add(mark at, std::string message) {
  found_.emplace_back(at, printable(message));
}

void complaints::add(problem x) {
  x.message = printable(x.message);
  if (std::ranges::find(elsewhere_, x) == elsewhere_.end())
    elsewhere_.push_back(std::move(x));
}

void complaints::skip(problem x) {
  x.message = printable(x.message);
  skipped_.push_back(std::move(x));
}

void complaints::warn(mark at, std::string message) {
  warnings_.emplace_back(at, printable(message));
}

namespace {

/// In order of place, each once.
std::vector<problem> sorted(std::vector<std::pair<mark, std::string>> found,
                            const std::string& name) {
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::vector<problem> all;
  all.reserve(found.size());
  for (auto& [at, message] : found)
    all.push_back({name, at.line, at.column, std::move(message)});
  return all;
}

} // namespace

std::vector<problem> complaints::warnings_of(const std::string& name) const {
  return sorted(warnings_, name);
}

std::vector<problem> complaints::of_file(const std::string& name) const {
  auto all = sorted(found_, name);
  all.insert(all.end(), elsewhere_.begin(), elsewhere_.end());
  return all;
}

} // namespace rubicon::config
