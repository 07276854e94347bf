#include "config/toml/problem_text.hpp"

#include <algorithm>
#include <cstddef>

#include "core/text/printable.hpp"

namespace rubicon::config {

std::string text_of(const std::vector<problem>& problems, const std::string& file) {
  constexpr std::size_t told_max = 50;
  std::string text;
  for (std::size_t i = 0; i < std::min(problems.size(), told_max); ++i)
    text += to_string(problems[i]) + '\n';
  if (problems.size() > 1)
    text += printable(file) + ": " + std::to_string(problems.size()) + " problems";
  if (problems.size() > told_max)
    text += ", the first " + std::to_string(told_max) + " are above";
  return problems.size() > 1 ? text + '\n' : text;
}

} // namespace rubicon::config
