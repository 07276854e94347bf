#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "config/file_readers.hpp"
#include "config/plan/uniqueness.hpp"
#include "core/text/decimal.hpp"
#include "goal/pursuer_keys.hpp"
#include "peis/tuples/meta_tuple.hpp"

namespace rubicon::config {

namespace {

constexpr duration shortest = 1ms;
constexpr duration goal_timeout_max = 24h * 10;
constexpr std::size_t goal_octets_max = 64;

/// Value of an output: a text or a number.
struct initial_value {
  using type = std::string;

  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who) {
    if (const auto* whole_number = x.as<std::int64_t>())
      return std::to_string(*whole_number);
    if (const auto* decimal = x.as<double>(); decimal != nullptr && std::isfinite(*decimal))
      return shown(*decimal);
    if (x.as<std::string>() == nullptr)
      return who.refuse(x, "a text or a number");
    return config::read(text{}, x, who);
  }
  [[nodiscard]] static form takes() {
    return types_form("text of 1 to 100 octets, or number", {"string", "number"});
  }
};

auto goal_input_keys() {
  return keys::of(
      keys::required("name", &goal::input_config::name, name_text{},
                     {"the input is the tuple that the meta tuple `NAME.mi-INPUT` points at", "",
                      "name of up to 29 characters"}),
      keys::optional("from", &goal::input_config::reference, tuple_reference{},
                     {"initial target of that meta tuple", "its own tuple `NAME.INPUT`"}));
}

auto output_start_keys() {
  return keys::of(
      keys::required("name", &goal::output_config::name, name_text{}, "last part of the key"),
      keys::required("value", &goal::output_config::value, initial_value{}, "initial value"));
}

auto condition_keys() {
  return keys::of(
      keys::optional(
          "input", &goal::condition::input, name_text{},
          {"condition for entering the state; until then it waits", "", "name of an input"}),
      keys::optional("equals", &goal::condition::equals, list_of<text>{{}, 1},
                     "the input is one of these"),
      keys::optional("above", &goal::condition::above, real{}, "or a number, this or more"),
      keys::optional("below", &goal::condition::below, real{},
                     {"and less than this", "", "number, more than `above`"}));
}

/// Values of outputs, before they are checked.
struct output_values {
  named_values<std::string> sets;
};

auto keys_of(const output_values*) {
  return keys::of(keys::optional("sets", &output_values::sets, pairs_of<initial_value>{},
                                 {"outputs, and their values when the state is over", "none"}));
}

auto state_name_keys() {
  return keys::of(keys::required(
      "state", &goal::state_config::name, name_text{},
      "published as `NAME.state`; not `idle` or `waiting`, which it publishes in between"));
}

auto goal_keys() {
  return keys::of(
      keys::required("goal", &goal::goal_config::text, text{goal_octets_max},
                     {"text that others write, letter by letter", "",
                      "text of 1 to 64 octets, but not `none`"}),
      keys::optional("timeout", &goal::goal_config::timeout, time_span{shortest, goal_timeout_max},
                     "it has failed after this time; if its last state ends at that moment, it has "
                     "succeeded"));
}

auto pursuer_name_keys() {
  return keys::of(
      keys::optional("name", &goal::pursuer_config::name, name_text{},
                     {"first part of its keys; no two have the same", "that of the peer"}));
}

/// The names below that of one pursuer.
class pursuer_names {
public:
  void add(const table_reader& in, const std::string& name) {
    constexpr std::array<std::string_view, 3> set_by_all{"goal", "state", "outcome"};
    if (std::ranges::find(set_by_all, folded(name)) != set_by_all.end())
      in.problems().add(in.at("name"), '`' + name + "` is a tuple of its own");
    names_.add(name, "name", in.at("name"), in.problems());
  }

private:
  name_uniqueness names_;
};

/// The key of what an input points at first; empty: its own tuple, or nothing.
std::string target_of(std::string_view reference) {
  const auto found = peis::parse_meta(reference);
  return found && *found ? (*found)->name.text() : std::string();
}

void read_input(table_reader& in, pursuer_names& own, goal::pursuer_config& out) {
  goal::input_config found;
  in.all(found, goal_input_keys());
  if (in.is_good("name")) {
    own.add(in, found.name);
    if (is_name("mi-" + found.name))
      own.add(in, "mi-" + found.name);
    else
      in.problems().add(in.at("name"),
                        "`mi-" + found.name + "` would be longer than 32 characters");
  }
  if (const auto target = target_of(found.reference); !target.empty())
    in.shared().seen.uses.push_back(
        {"an input of " + in.shared().seen.peer + " reads", target, in.at("from")});
  out.inputs.push_back(std::move(found));
}

void read_output(table_reader& in, pursuer_names& own, goal::pursuer_config& out) {
  goal::output_config found;
  in.all(found, output_start_keys());
  if (in.is_good("name"))
    own.add(in, found.name);
  const bool has_value = in.is_good("value");
  in.all(found);
  if (has_value && in.has("step") && !number_in(found.value))
    in.problems().add(in.at("step"),
                      "`step` needs a number as `value`, not " + in_quotes(found.value));
  if (in.has("until") && !in.has("step"))
    in.problems().add(in.at("until"), "`until` has no effect without `step`");
  out.outputs.push_back(std::move(found));
}

void note(const table_reader& in, const goal::pursuer_config& own, const goal::condition& x) {
  auto& seen = in.shared().seen;
  const auto input = std::ranges::find(own.inputs, x.input, &goal::input_config::name);
  const auto key = input == own.inputs.end() ? std::string() : target_of(input->reference);
  if (key.empty())
    return;
  tuple_test test{"a state of " + seen.peer, key, texts_at(in, "equals", x.equals)};
  if (x.above)
    test.above = {*x.above, in.at("above")};
  if (x.below)
    test.below = {*x.below, in.at("below")};
  seen.tests.push_back(std::move(test));
}

/// input, equals, above and below of a state.
void read_needs(table_reader& in, const goal::pursuer_config& own, goal::state_config& out) {
  goal::condition found;
  in.all(found, condition_keys());
  const bool has_input = in.is_good("input");
  const bool has_range = in.has("above") || in.has("below");
  const bool known =
      std::ranges::any_of(own.inputs, [&](const auto& x) { return x.name == found.input; });
  if (has_input && !known)
    in.problems().add(in.at("input"), "the app has no input `" + found.input + '`');
  if (has_range && in.has("equals"))
    in.problems().add(in.at("equals"),
                      "a state needs either `equals`, or `above`, `below` or both");
  if (in.has("input") != (has_range || in.has("equals")))
    in.problems().add(in.at(), "`input` and its condition must be given together");
  if (found.above && found.below && *found.below <= *found.above)
    in.problems().add(in.at("below"),
                      "`below` must be more than `above`, which is " + shown(*found.above));
  note(in, own, found);
  if (has_input)
    out.needs = std::move(found);
}

void read_sets(table_reader& in, const goal::pursuer_config& own, goal::state_config& out) {
  output_values found;
  in.all(found);
  for (auto& [name, value] : found.sets) {
    const auto output = std::ranges::find(own.outputs, name.value, &goal::output_config::name);
    if (output == own.outputs.end())
      in.problems().add(name.at, "the app has no output `" + name.value + '`');
    else if (output->step != 0 && !number_in(value))
      in.problems().add(name.at, '`' + name.value + "` has a `step` and must be a number, not " +
                                     in_quotes(value));
    out.sets.emplace_back(name.value, std::move(value));
  }
}

void read_state(table_reader& in, const goal::pursuer_config& own, goal::goal_config& out) {
  goal::state_config found;
  in.all(found, state_name_keys());
  if (in.is_good("state") && (found.name == "idle" || found.name == "waiting"))
    in.problems().add(in.at("state"), '`' + found.name + "` is its value in between");
  in.all(found);
  read_needs(in, own, found);
  read_sets(in, own, found);
  out.states.push_back(std::move(found));
}

void read_goal(table_reader& in, uniqueness<std::string>& goals, goal::pursuer_config& out) {
  goal::goal_config found;
  in.all(found, goal_keys());
  if (in.is_good("goal")) {
    if (found.text == "none")
      in.problems().add(in.at("goal"), "`none` stands for no goal");
    goals.add(found.text, "goal `" + found.text + '`', in.at("goal"), in.problems());
  }
  in.tables(
      "states", "states", "one after the other, see below",
      [&](table_reader& x) { read_state(x, out, found); }, 1);
  out.goals.push_back(std::move(found));
}

} // namespace

goal::pursuer_config read_pursuer(table_reader& in) {
  goal::pursuer_config out;
  pursuer_names own;
  uniqueness<std::string> goals;
  in.all(out, pursuer_name_keys());
  in.tables("inputs", "inputs of a goal app",
            {"see below; also as `[[peer.apps.inputs]]`, as the next two", "none"},
            [&](table_reader& x) { read_input(x, own, out); });
  in.tables("outputs", "outputs of a goal app", {"tuples that it publishes", "none"},
            [&](table_reader& x) { read_output(x, own, out); });
  in.tables("goals", "goals", {"goals that it can pursue; any other goal fails at once", "none"},
            [&](table_reader& x) { read_goal(x, goals, out); });
  return out;
}

} // namespace rubicon::config
