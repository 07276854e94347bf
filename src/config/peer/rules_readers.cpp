#include <algorithm>
#include <initializer_list>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "config/file_readers.hpp"
#include "config/plan/uniqueness.hpp"
#include "peis/tuples/meta_tuple.hpp"
#include "proxy/rules/rules_keys.hpp"

namespace rubicon::config {

namespace {

using proxy::rule_write;

auto rule_point_keys() {
  return keys::of(keys::optional("point", &rule_write::key, tuple_key{},
                                 "instead of `write`: the [meta tuple](peis.md#meta-tuples) that "
                                 "is pointed at another tuple"));
}

auto rule_write_keys() {
  return keys::of(
      keys::required_if(true, "write", &rule_write::key, tuple_key{}, "the tuple that is written"));
}

/// @param kind a text, or with `point` a reference
template <class Kind>
auto rule_word_keys(const Kind& kind) {
  return keys::of(keys::optional("then", &rule_write::then, kind,
                                 {"when the condition holds; with `point` a tuple, as in "
                                  "`\"robot:robot.state\"`, or `\"nowhere\"`",
                                  "nothing is written"}),
                  keys::optional("otherwise", &rule_write::otherwise, kind,
                                 {"the same when it has ended", "nothing is written"}));
}

auto rule_source_keys() {
  return keys::of(keys::optional(
      "from", &rule_write::from, tuple_key{},
      {"with `write`, instead of `then`: the value of this tuple, of any owner, at that "
       "moment is written; nothing if no peer has it",
       "none"}));
}

auto rule_when_keys(bool is_required) {
  return keys::of(
      keys::required_if(is_required, "when", &proxy::rule::when, tuple_key{},
                        "the tuple that is watched, of any owner; required without `at`"));
}

/// Time of day of a rule.
struct daily_time {
  duration at{};
};

auto keys_of(const daily_time*) {
  return keys::of(keys::optional(
      "at", &daily_time::at, time_of_day{},
      {"every day at this time of day (see `start` of [`[ecology]`](#ecology)) `then` is "
       "written; with `when` only if its condition holds at that time, else `otherwise`",
       "whenever the condition becomes true or false"}));
}

/// Complains about what means nothing in a table that has, or lacks, another key.
void refuse(const table_reader& in, std::initializer_list<const char*> keys, const char* why) {
  for (const auto* key : keys)
    if (in.has(key))
      in.problems().add(in.at(key), '`' + std::string(key) + "` has no effect " + why);
}

/// The key of what `x` points at; empty: nothing.
std::string target_of(std::string_view x) {
  const auto found = peis::parse_meta(x);
  return found && *found ? (*found)->name.text() : std::string();
}

void note(const table_reader& in, const proxy::rule_write& x) {
  auto& seen = in.shared().seen;
  const auto who = "a rule of " + seen.peer;
  if (x.key.empty())
    return;
  const auto at = in.at(x.meta ? "point" : "write");
  seen.uses.push_back({who + (x.meta ? " points" : " writes"), x.key, at});
  if (!x.from.empty())
    seen.uses.push_back({who + " reads", x.from, in.at("from")});
  tuple_write words{who, x.key, at, {}};
  for (const auto& [key, text] : {std::pair("then", x.then), std::pair("otherwise", x.otherwise)})
    if (const auto target = x.meta ? target_of(text) : ""; !target.empty())
      seen.uses.push_back({who + " points at", target, in.at(key)});
    else if (!x.meta && !text.empty())
      words.words.push_back({text, in.at(key)});
  seen.writes.push_back(std::move(words));
}

/// A rule without one of its thresholds has the other one for both.
void note(const table_reader& in, const proxy::rule& x) {
  auto& seen = in.shared().seen;
  const auto who = "a rule of " + seen.peer;
  if (x.when.empty())
    return;
  seen.uses.push_back({who + " waits for", x.when, in.at("when")});
  tuple_test test{who, x.when, texts_at(in, "equals", x.equals)};
  const bool has_end =
      std::ranges::any_of(x.writes, [](const auto& each) { return !each.otherwise.empty(); });
  if (const auto above = x.above ? x.above : x.below)
    test.above = {*above, in.at(x.above ? "above" : "below")};
  if (const auto below = x.below ? x.below : x.above; below && has_end)
    test.below = {*below, in.at(x.below ? "below" : "above")};
  seen.tests.push_back(std::move(test));
}

/// What a rule writes: a word, the value of another tuple, or the target of a meta tuple.
proxy::rule_write read_rule_write(table_reader& in) {
  proxy::rule_write out;
  out.meta = in.has("point");
  in.all(out, rule_point_keys());
  if (!out.meta)
    in.all(out, rule_write_keys());
  else if (in.has("write"))
    in.problems().add(in.at("write"), "a rule has either `write` or `point`");
  in.expect("write");
  if (out.meta)
    in.all(out, rule_word_keys(tuple_reference{}));
  else
    in.all(out, rule_word_keys(text{}));
  in.all(out, rule_source_keys());
  if (in.has("from"))
    refuse(in, {"then", "point"}, "with `from`");
  if (!in.has("then") && !in.has("otherwise") && !in.has("from"))
    in.problems().add(in.at(), "a rule needs `then`, `otherwise` or both");
  note(in, out);
  return out;
}

/// at, and what then means nothing. `day_begins` is the time of day at the start of the run.
void read_time(table_reader& in, duration day_begins, proxy::rule& out) {
  daily_time found;
  in.all(found);
  if (in.is_good("at"))
    out.daily = (found.at - day_begins + 24h) % 24h;
  if (!in.has("at"))
    return;
  refuse(in, {"lasting", "otherwise_lasting"}, "with `at`");
  if (!in.has("when"))
    refuse(in, {"above", "below", "equals", "otherwise"}, "without `when`");
}

proxy::rule read_rule(table_reader& in, const surroundings& with) {
  proxy::rule out;
  in.all(out, rule_when_keys(!in.has("at")));
  read_time(in, with.day_begins, out);
  in.all(out);
  in.tables(
      "writes", "writes", "instead of these five: several tuples to be written, see below",
      [&](table_reader& x) { out.writes.push_back(read_rule_write(x)); }, in.has("writes") ? 1 : 0);
  if (!in.has("writes"))
    out.writes.push_back(read_rule_write(in));
  const bool has_threshold = in.has("above") || in.has("below");
  if (has_threshold == in.has("equals") && (in.has("when") || !in.has("at")))
    in.problems().add(in.at(), "a rule needs either `above`, `below` or both, or `equals`");
  if (out.above && out.below && *out.below > *out.above)
    in.problems().add(in.at("below"),
                      "`below` must not be more than `above`, which is " + shown(*out.above));
  note(in, out);
  return out;
}

/// A tuple that is pointed somewhere is given no words.
void check_points(const table_reader& in, const proxy::rules_config& x) {
  std::set<std::string> words;
  std::set<std::string> points;
  for (const auto& each : x.rules)
    for (const auto& write : each.writes)
      (write.meta ? points : words).insert(folded(write.key));
  for (const auto& key : points) {
    if (!key.empty() && words.contains(key))
      in.problems().add(in.at("rules"),
                        "`" + key + "` has `write` in one rule and `point` in another");
  }
}

} // namespace

proxy::rules_config read_rules(table_reader& in, const surroundings& with) {
  proxy::rules_config out;
  in.tables(
      "rules", "rules", "see below; also as `[[peer.apps.rules]]`",
      [&](table_reader& x) { out.rules.push_back(read_rule(x, with)); }, 1);
  in.all(out);
  out.clock_changes = in.shared().clock_changes;
  check_points(in, out);
  return out;
}

} // namespace rubicon::config
