#include "config/problem.hpp"

#include <algorithm>

namespace rubicon::config {

std::string to_string(const problem& x) {
  if (x.line == 0)
    return x.file + ": " + x.message;
  return x.file + ':' + std::to_string(x.line) + ':' + std::to_string(x.column) + ": " + x.message;
}

std::string place_text(mark x) {
  return "(line " + std::to_string(x.line) + ", column " + std::to_string(x.column) + ')';
}

void complaints::add(mark at, std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; },
      '?');
  found_.emplace_back(at, std::move(message));
}

std::vector<problem> complaints::of_file(const std::string& name) const {
  auto sorted = found_;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  std::vector<problem> all;
  all.reserve(sorted.size());
  for (auto& [at, message] : sorted)
    all.push_back({name, at.line, at.column, std::move(message)});
  return all;
}

} // namespace rubicon::config
