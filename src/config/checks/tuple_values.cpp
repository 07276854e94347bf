#include "config/checks/tuple_values.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "config/checks/tuple_keys.hpp"
#include "config/plan/counts.hpp"
#include "config/toml/document.hpp"
#include "config/toml/values.hpp"
#include "core/text/decimal.hpp"
#include "core/text/spelling.hpp"
#include "proxy/classes/layout.hpp"
#include "proxy/classes/tuple_key.hpp"

namespace rubicon::config {

namespace {

const std::vector<std::string> statuses{"active", "inactive", "stale", "lost"};
const std::vector<std::string> request_outcomes{"acknowledged", "failed",  "unreachable", "refused",
                                                "superseded",   "timeout", "sent"};
const std::vector<std::string> goal_outcomes{"succeeded", "failed", "preempted"};
const std::vector<std::string> goal_causes{"none",    "timeout", "broken",
                                           "unknown", "newer",   "cancelled"};
constexpr const char* no_goal = "none";

published_values anything() {
  published_values out;
  out.anything = true;
  return out;
}

published_values words_of(std::vector<std::string> words, std::vector<std::string> endings = {}) {
  published_values out;
  out.words = std::move(words);
  out.endings = std::move(endings);
  return out;
}

/// A tuple that its owner alone writes.
tuple_value published_by_owner(published_values values) {
  return {std::move(values), {.anything = false}};
}

double number_of(const proxy::field& field, std::int64_t count) {
  return static_cast<double>(count) * field.scale + field.add;
}

bool has_word(const proxy::field& field, std::int64_t count) {
  return std::ranges::find(field.words, count, [](const auto& x) { return x.first; }) !=
         field.words.end();
}

/// Whether each of the counts has a word.
bool are_words(const proxy::field& field, const count_range& counts) {
  const auto [least, most] = counts;
  if (static_cast<std::uint64_t>(most - least) >= field.words.size())
    return false;
  for (auto count = least; count <= most; ++count)
    if (!has_word(field, count))
      return false;
  return true;
}

/// The part of `key` behind `prefix`, whose parts may be `*`; empty: it begins in another way.
std::string_view behind(std::string_view prefix, std::string_view key) {
  const auto parts = std::ranges::count(prefix, '.') + 1;
  std::size_t end = 0;
  for (std::ptrdiff_t i = 0; i < parts; ++i) {
    end = key.find('.', i == 0 ? 0 : end + 1);
    if (end == std::string_view::npos)
      return {};
  }
  return may_be(prefix, key.substr(0, end)) ? key.substr(end + 1) : std::string_view();
}

tuple_value of_input(const proxy::input& x) {
  tuple_value out;
  out.accepted = {.anything = false, .input = &x};
  if (x.numbers)
    out.published = anything();
  for (const auto& [word, octets] : x.words)
    out.published.words.push_back(word);
  return out;
}

std::vector<std::string> goals_of(const goal::pursuer_config& x) {
  std::vector<std::string> out{no_goal};
  for (const auto& each : x.goals)
    out.push_back(each.text);
  return out;
}

/// What an output is at first and after each state.
published_values of_output(const goal::pursuer_config& x, const goal::output_config& output) {
  if (output.step != 0)
    return anything();
  auto out = words_of({output.value});
  for (const auto& each : x.goals)
    for (const auto& state : each.states)
      for (const auto& [name, value] : state.sets)
        if (name == output.name && std::ranges::find(out.words, value) == out.words.end())
          out.words.push_back(value);
  return out;
}

std::optional<tuple_value> of_pursuer(const goal::pursuer_config& x, std::string_view key) {
  const auto name = behind(x.name, key);
  if (proxy::same_key(name, "goal"))
    return tuple_value{words_of(goals_of(x)), {.anything = false, .pursuer = &x}};
  if (proxy::same_key(name, "outcome"))
    return published_by_owner(words_of({no_goal}, goal_outcomes));
  if (proxy::same_key(name, "outcome.cause"))
    return published_by_owner(words_of(goal_causes));
  if (proxy::same_key(name, "state")) {
    std::vector<std::string> states{"idle", "waiting"};
    for (const auto& each : x.goals)
      for (const auto& state : each.states)
        states.push_back(state.name);
    return published_by_owner(words_of(std::move(states)));
  }
  for (const auto& output : x.outputs)
    if (proxy::same_key(name, output.name))
      return published_by_owner(of_output(x, output));
  for (const auto& input : x.inputs)
    if (proxy::same_key(name, input.name) || proxy::same_key(name, "mi-" + input.name))
      return tuple_value{anything(), {}};
  return std::nullopt;
}

} // namespace

// ------------------------------------------------------------------------------------------------

bool published_values::may_be(std::string_view text) const {
  if (anything || std::ranges::find(words, text) != words.end())
    return true;
  const auto blank = text.rfind(' ');
  if (blank != std::string_view::npos &&
      std::ranges::find(endings, text.substr(blank + 1)) != endings.end())
    return true;
  const auto number = field == nullptr ? std::nullopt : number_in(text);
  if (!number)
    return false;
  const bool has_words = !field->words.empty();
  const auto exact =
      has_words || field->scale == 0 ? *number : (*number - field->add) / field->scale;
  const auto count = std::floor(exact + 0.5);
  return count >= static_cast<double>(counts.first) &&
         count <= static_cast<double>(counts.second) &&
         proxy::reading_of(*field, static_cast<std::int64_t>(count)).text == text;
}

std::optional<std::pair<double, double>> published_values::numbers() const {
  std::optional<std::pair<double, double>> out;
  const auto add = [&out](double x) {
    out = out ? std::pair(std::min(out->first, x), std::max(out->second, x)) : std::pair(x, x);
  };
  for (const auto& word : words)
    if (const auto number = number_in(word))
      add(*number);
  if (field == nullptr || (!field->words.empty() && are_words(*field, counts)))
    return out;
  for (const auto count : {counts.first, counts.second})
    add(field->words.empty() ? number_of(*field, count) : static_cast<double>(count));
  return out;
}

std::string published_values::text() const {
  std::string out = words.empty() ? "" : alternatives(words);
  for (const auto& each : endings)
    out += (out.empty() ? "\"... " : ", \"... ") + each + '"';
  const auto range = field == nullptr ? std::nullopt : numbers();
  if (range)
    out += (out.empty() ? "" : ", or ") + std::string("numbers from ") + shown(range->first) +
           " to " + shown(range->second) + (field->unit.empty() ? "" : ' ' + field->unit) +
           (field->words.empty() && field->decimals > 0
                ? ", as in " + proxy::reading_of(*field, counts.second).text
                : "");
  return out;
}

bool accepted_words::accepts(std::string_view word) const {
  if (input != nullptr)
    return static_cast<bool>(proxy::encode(*input, word));
  return pursuer != nullptr &&
         (word == no_goal || std::ranges::find(pursuer->goals, word, &goal::goal_config::text) !=
                                 pursuer->goals.end());
}

std::string accepted_words::instead_of(std::string_view word) const {
  if (pursuer != nullptr) {
    auto goals = goals_of(*pursuer);
    goals.erase(goals.begin());
    return ", which has no such goal" + suggestion(word, goals);
  }
  if (input == nullptr)
    return ", which only its owner publishes: values written by others have no effect";
  std::vector<std::string> words;
  for (const auto& each : input->words)
    words.push_back(each.first);
  std::string out = words.empty() ? "" : alternatives(words);
  if (input->numbers)
    out += (out.empty() ? "" : ", or ") + std::string("numbers from ") +
           shown(input->numbers->min) + " to " + shown(input->numbers->max) +
           (input->unit.empty() ? "" : ' ' + input->unit);
  return ", which accepts " + out;
}

// ------------------------------------------------------------------------------------------------

tuple_values::tuple_values(const ecology_description& x) : all_(x) {
  for (const auto& peer : x.peers)
    for (const auto& app : peer.apps) {
      if (const auto* manager = std::get_if<proxy_manager_app>(&app))
        add_proxies(*manager);
      else if (const auto* pursuer = std::get_if<goal::pursuer_config>(&app))
        pursuers_.push_back(pursuer);
      else if (const auto* translate = std::get_if<translate_app>(&app))
        for (const auto& rule : translate->rules)
          others_.push_back(without_names(rule.to.empty() ? rule.from + ".history" : rule.to));
    }
  for (const auto& what : x.proxies)
    for (const auto& tuple : what.tuples)
      others_.push_back(without_names(tuple.key));
}

void tuple_values::add_proxies(const proxy_manager_app& x) {
  mote_classes classes(all_);
  for (const auto& island : all_.islands) {
    if (std::ranges::find(x.islands, island.id) == x.islands.end())
      continue;
    for (const auto& mote : island.motes)
      if (const auto* what = classes.of(mote))
        proxies_.push_back({prefix_of(*what, island, mote), what, &mote});
    for (const auto& rule : island.plain) {
      mote_description real;
      real.id = mote_id(rule.first);
      real.type = rule.type;
      if (const auto* what = class_of(all_, island.id, real))
        proxies_.push_back({prefix_of_any(*what, island), what, nullptr});
    }
  }
  for (const auto& what : all_.proxies)
    if (x.objects && !what.ids.empty())
      proxies_.push_back({without_names(what.prefix), &what, nullptr});
}

std::vector<tuple_value> tuple_values::of(std::string_view key) const {
  std::vector<tuple_value> out;
  for (const auto& each : others_)
    if (may_be(each, key))
      out.push_back({anything(), {}});
  for (const auto& each : proxies_)
    if (auto found = of_proxy(each, key))
      out.push_back(*std::move(found));
  for (const auto* each : pursuers_)
    if (auto found = of_pursuer(*each, key))
      out.push_back(*std::move(found));
  return out;
}

std::optional<tuple_value> tuple_values::of_proxy(const proxy_of_mote& x,
                                                  std::string_view key) const {
  const auto name = behind(x.prefix, key);
  if (name.empty())
    return std::nullopt;
  const auto is = [name](const std::string& y) { return proxy::same_key(name, y); };
  for (const auto& field : x.what->fields) {
    if (is(field.name))
      return published_by_owner(of_field(x, field));
    if (is(field.name + ".unit"))
      return published_by_owner(words_of({field.unit}));
    if (is(field.name + ".freshness"))
      return published_by_owner(words_of({"fresh", "stale"}));
  }
  for (const auto& input : x.what->inputs) {
    if (is(input.name))
      return of_input(input);
    if (is(input.name + ".unit"))
      return published_by_owner(words_of({input.unit}));
    if (is(input.name + ".outcome"))
      return published_by_owner(words_of({}, request_outcomes));
    if (is("mi-" + input.name))
      return tuple_value{anything(), {}};
  }
  if (is("status"))
    return published_by_owner(words_of(statuses));
  if (is("class"))
    return published_by_owner(words_of({x.what->name}));
  for (const auto* known : {"status.cause", "status.since", "id", "island"})
    if (is(known))
      return published_by_owner(anything());
  for (const auto& [property, text] : x.what->properties)
    if (is(property))
      return published_by_owner(words_of({text}));
  return tuple_value{anything(), {}}; // of its program, or of this object alone
}

published_values tuple_values::of_field(const proxy_of_mote& x, const proxy::field& field) const {
  if (is_rescaled(*x.what, field))
    return anything();
  published_values out;
  out.field = &field;
  for (const auto& [count, word] : field.words)
    out.words.push_back(word);
  const auto known = x.mote == nullptr ? std::nullopt : counts_of(*x.mote, field);
  out.counts = known.value_or(proxy::range_of(field.layout));
  if (field.stream || field.layout == proxy::encoding::stamp)
    return field.words.empty() ? anything() : out;
  if (!field.words.empty() && are_words(field, out.counts))
    out.field = nullptr;
  return out;
}

/// Whether a change, or a life as another kind of mote, makes it another field.
bool tuple_values::is_rescaled(const proxy::proxy_class& what, const proxy::field& field) const {
  return std::ranges::any_of(all_.faults, [&](const fault_description& x) {
    if (const auto* crash = std::get_if<crash_fault>(&x.what))
      return crash->becomes.has_value();
    const auto* all = std::get_if<change>(&x.what);
    const auto* one = all == nullptr ? nullptr : std::get_if<proxy::class_change>(all);
    return one != nullptr && one->class_name == what.name && one->field == field.name;
  });
}

} // namespace rubicon::config
