#include "deploy/fault_sentence.hpp"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

namespace rubicon::deploy {

namespace {

std::vector<std::string> words_of(std::string_view sentence) {
  std::istringstream in{std::string(sentence)};
  std::vector<std::string> words;
  for (std::string word; in >> word;)
    words.push_back(word);
  return words;
}

/// A number, a truth or a list stays as it is, all else is a text.
std::string toml_value(const std::string& word) {
  const bool is_number =
      word.find_first_not_of("+-.0123456789") == std::string::npos && word != "-" && word != ".";
  if (is_number || word == "true" || word == "false" || word.starts_with('[') ||
      word.starts_with('"') || word.starts_with('{'))
    return word;
  std::string text = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\')
      text += '\\';
    text += c;
  }
  return text + '"';
}

bool is_key(const std::string& word) {
  return !word.empty() && std::ranges::all_of(word, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

std::variant<std::string, std::string> refuse(std::string why) {
  return std::variant<std::string, std::string>(std::in_place_index<1>, std::move(why));
}

/// A kind of change, or something that cannot change: the reader of changes says why.
bool says_change(const std::string& kind) {
  return std::ranges::find(config::change_kinds, kind) != config::change_kinds.end() ||
         !config::why_fixed(kind).empty();
}

/// The table, or why there is none.
std::variant<std::string, std::string> parsed(std::string_view sentence, const std::string& at) {
  if (sentence.size() > sentence_octets_max)
    return refuse("a fault has at most " + std::to_string(sentence_octets_max) + " characters");
  auto words = words_of(sentence);
  if (words.empty())
    return refuse("which fault? For example `kill peer NAME for 10s`");
  if (words.size() % 2 == 0)
    return refuse("a fault is a kind followed by keys and values, as in `kill peer NAME for 10s`");
  if (words[0] == "kill" && words.size() > 1 && (words[1] == "mote" || words[1] == "sink"))
    words[0] = "crash";
  std::string table = std::string("\n[[") + (says_change(words[0]) ? "change" : "fault") +
                      "]]\nat = " + toml_value(at) + "\nkind = " + toml_value(words[0]) + '\n';
  for (std::size_t i = 1; i < words.size(); i += 2) {
    if (!is_key(words[i]))
      return refuse('`' + words[i] + "` is not a key of a fault");
    table += words[i] + " = " + toml_value(words[i + 1]) + '\n';
  }
  return std::variant<std::string, std::string>(std::in_place_index<0>, std::move(table));
}

/// `"debug", "rate", "link", "proxy_class" or "network_keys"`
std::string change_words() {
  std::string text;
  for (std::size_t i = 0; i < config::change_kinds.size(); ++i)
    text += (i == 0                                ? "\""
             : i + 1 < config::change_kinds.size() ? ", \""
                                                   : " or \"") +
            std::string(config::change_kinds[i]) + '"';
  return text;
}

/// What the reader of faults says of a kind that is none, with the kinds of changes before `not`.
std::string unknown_kind(std::string message) {
  const auto end = std::min(message.rfind(", not "), message.size());
  message.insert(end, ", or of a change " + change_words());
  return message;
}

/// The last of those at 0 s: they are sorted by their times, and otherwise as in the file.
const config::fault_description* last_of(const std::vector<config::fault_description>& planned,
                                         bool change) {
  const auto found = std::find_if(planned.rbegin(), planned.rend(), [change](const auto& each) {
    return each.at == duration{} && config::is_change(each) == change;
  });
  return found == planned.rend() ? nullptr : &*found;
}

bool holds_keys(const config::fault& x) {
  const auto* change = std::get_if<config::change>(&x);
  return change != nullptr && std::holds_alternative<config::network_keys_change>(*change);
}

bool needs_radio_from_the_start(const config::fault& x) {
  return std::holds_alternative<config::noise_fault>(x) ||
         std::holds_alternative<config::mote_double_fault>(x) ||
         std::holds_alternative<config::move_island_fault>(x);
}

} // namespace

bool is_change_sentence(std::string_view sentence) {
  const auto words = words_of(sentence);
  return !words.empty() && says_change(words[0]);
}

std::string table_of(std::string_view sentence, const std::string& at) {
  const auto table = parsed(sentence, at);
  return table.index() == 0 ? std::get<0>(table) : std::string();
}

std::variant<config::fault, std::string> fault_of(const bundle& x, std::string_view sentence,
                                                  const config::extensions& known) {
  const auto table = parsed(sentence, "0s");
  if (table.index() == 1)
    return std::get<1>(table);
  auto with_fault = x;
  const auto lines_before = static_cast<unsigned>(std::ranges::count(with_fault.toml, '\n')) + 1;
  with_fault.toml += std::get<0>(table);
  config::overrides instead;
  instead.mode = config::run_mode::wall;
  const auto loaded = load(with_fault, instead, known);
  for (const auto& each : loaded.problems)
    if (each.line >= lines_before)
      return each.message.starts_with("`kind` must be") ? unknown_kind(each.message) : each.message;
  if (!loaded.ecology)
    return std::string("it does not fit the file");
  const auto* last = last_of(loaded.ecology->faults, is_change_sentence(sentence));
  if (last == nullptr)
    return std::string("it does not fit the file");
  if (holds_keys(last->what))
    return std::string("logs show manual actions, but keys are secret: write them in the file, as "
                       "a [[change]] or in [smepp] with `run --reload`");
  if (needs_radio_from_the_start(last->what))
    return std::string("it needs a radio that exists from the start: plan it in the file");
  return last->what;
}

} // namespace rubicon::deploy
