#include "cli/words/describe.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <string_view>

#include <CLI/CLI.hpp>

namespace rubicon::cli {

namespace {

/// What is behind a name of the form `MODE:{virtual,wall}` or `N:UINT in [1 - 256]`.
constexpr std::string_view words_begin = ":{";
constexpr std::string_view range_begin = ":UINT in [";

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string word; std::getline(in, word, ',');)
    out.push_back(word);
  return out;
}

std::vector<std::string> names_of(const std::set<CLI::Option*>& options) {
  std::vector<std::string> out;
  for (const auto* each : options)
    out.push_back(each->get_positional() ? each->get_name(true) : each->get_name());
  std::ranges::sort(out); // the set is in the order of addresses
  return out;
}

completes completed_by(const option_description& x, bool is_argument) {
  constexpr std::array<std::string_view, 4> files{"FILE", "RECORD", "SOURCE", "PATH"};
  const auto& name = is_argument ? x.names.front() : x.value;
  if (!x.words.empty())
    return completes::words;
  if (name == "DIR")
    return completes::folders;
  return std::ranges::find(files, name) == files.end() ? completes::nothing : completes::files;
}

/// Divides what the library says of the value into its name, words and range.
void take_value(std::string text, option_description& x) {
  if (const auto at = text.find(words_begin); at != std::string::npos) {
    const auto begin = at + words_begin.size();
    x.words = split(text.substr(begin, text.find('}', begin) - begin));
    text.resize(at);
  }
  if (const auto at = text.find(range_begin); at != std::string::npos) {
    const auto begin = at + range_begin.size();
    x.range = text.substr(begin, text.find(']', begin) - begin);
    if (const auto dash = x.range.find(" - "); dash != std::string::npos)
      x.range.replace(dash, 3, " to ");
    text.resize(at);
  }
  if (text.starts_with('[') && text.ends_with(']')) // it may be left out
    text = text.substr(1, text.size() - 2);
  x.value = text;
}

option_description description_of(const CLI::Option& option) {
  option_description x;
  const bool is_argument = option.get_positional();
  const bool is_flag = option.get_items_expected_max() == 0;
  for (const auto& name : option.get_lnames())
    x.names.push_back("--" + name);
  for (const auto& name : option.get_snames())
    x.names.push_back("-" + name);
  if (is_argument)
    x.names = {option.get_name(true)};
  x.meaning = option.get_description();
  take_value(option.get_type_name(), x);
  if (is_flag && !x.words.empty()) { // `--control=kernel`
    x.value = "WORD";
    std::erase(x.words, "true");
  } else if (is_flag) {
    x.value.clear();
  }
  x.needs = names_of(option.get_needs());
  x.excludes = names_of(option.get_excludes());
  x.with = completed_by(x, is_argument);
  x.is_required = option.get_required();
  x.is_repeatable = option.get_expected_max() > 1;
  x.has_optional_value = !is_argument && !x.value.empty() && option.get_items_expected_min() == 0;
  return x;
}

} // namespace

command_description describe(const CLI::App& app, const std::vector<std::string>& words) {
  command_description x{words, app.get_description()};
  for (const auto* option : app.get_options()) {
    if (option->get_group().empty()) // not for users
      continue;
    (option->get_positional() ? x.arguments : x.options).push_back(description_of(*option));
  }
  for (const auto* each : app.get_subcommands({})) {
    auto below = words;
    below.push_back(each->get_name());
    x.commands.push_back(describe(*each, below));
  }
  x.footer = app.get_footer();
  return x;
}

} // namespace rubicon::cli
