#include "config/problem.hpp"

#include <algorithm>

namespace rubicon::config {

namespace {

std::string without_control_characters(std::string x) {
  std::replace_if(
      x.begin(), x.end(), [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; }, '?');
  return x;
}

} // namespace

std::string to_string(const problem& x) {
  if (x.line == 0)
    return x.file + ": " + x.message;
  if (x.column == 0)
    return x.file + ':' + std::to_string(x.line) + ": " + x.message;
  return x.file + ':' + std::to_string(x.line) + ':' + std::to_string(x.column) + ": " + x.message;
}

std::string place_text(mark x) {
  return "(line " + std::to_string(x.line) + ", column " + std::to_string(x.column) + ')';
}

void complaints::add(mark at, std::string message) {
  found_.emplace_back(at, without_control_characters(std::move(message)));
}

void complaints::add(problem x) {
  x.message = without_control_characters(std::move(x.message));
  elsewhere_.push_back(std::move(x));
}

void complaints::warn(problem x) {
  x.message = without_control_characters(std::move(x.message));
  warnings_.push_back(std::move(x));
}

std::vector<problem> complaints::of_file(const std::string& name) const {
  auto sorted = found_;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  std::vector<problem> all;
  all.reserve(sorted.size() + elsewhere_.size());
  for (auto& [at, message] : sorted)
    all.push_back({name, at.line, at.column, std::move(message)});
  all.insert(all.end(), elsewhere_.begin(), elsewhere_.end());
  return all;
}

} // namespace rubicon::config
