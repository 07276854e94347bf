#include "config_sample.hpp"

#include <stdexcept>

namespace rubicon::test {

std::vector<std::string> problems_in(const std::string& toml) {
  std::vector<std::string> all;
  for (const auto& each : config::load_text(toml, "t").problems)
    all.push_back(to_string(each).substr(2)); // without `t:`
  return all;
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
