#include <set>
#include <string>
#include <utility>
#include <vector>

#include "config/claims.hpp"
#include "config/file_readers.hpp"

namespace rubicon::config {

namespace {

/// What a rule writes: a word, or where a meta tuple is to point.
rule_write read_rule_write(table_reader& in, const directory& names) {
  rule_write out;
  out.meta = in.has("point");
  in.optional("point", tuple_key{}, out.key);
  if (!out.meta)
    in.required("write", tuple_key{}, out.key);
  else if (in.has("write"))
    in.problems().add(in.at("write"), "a rule has either `write` or `point`");
  in.expect("write");
  for (const auto& [key, text_of] : {std::pair("then", &out.then), {"otherwise", &out.otherwise}}) {
    if (out.meta)
      in.optional(key, tuple_reference{names}, *text_of);
    else
      in.optional(key, text{}, *text_of);
  }
  if (!in.has("then") && !in.has("otherwise"))
    in.problems().add(in.at(), "a rule needs `then`, `otherwise` or both");
  return out;
}

rule read_rule(table_reader& in, const directory& names) {
  rule out;
  std::vector<located<std::string>> texts;
  in.required("when", tuple_key{}, out.when);
  in.optional("above", real{}, out.above);
  in.optional("below", real{}, out.below);
  in.optional("equals", list_of<text>{text{}, 1}, texts);
  out.equals = values_of(std::move(texts));
  in.optional("lasting", time_span{}, out.lasting);
  in.optional("otherwise_lasting", time_span{}, out.otherwise_lasting);
  in.tables(
      "writes", "writes", [&](table_reader& x) { out.writes.push_back(read_rule_write(x, names)); },
      in.has("writes") ? 1 : 0);
  if (!in.has("writes"))
    out.writes.push_back(read_rule_write(in, names));
  const bool has_threshold = in.has("above") || in.has("below");
  if (has_threshold == in.has("equals"))
    in.problems().add(in.at(), "a rule needs either `above`, `below` or both, or `equals`");
  if (out.above && out.below && *out.below > *out.above)
    in.problems().add(in.at("below"),
                      "`below` must not be more than `above`, which is " + shown(*out.above));
  return out;
}

/// A tuple that is pointed somewhere is given no words.
void check_points(const table_reader& in, const rules_app& x) {
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

rules_app read_rules(table_reader& in, const directory& names) {
  rules_app out;
  in.tables(
      "rules", "rules", [&](table_reader& x) { out.rules.push_back(read_rule(x, names)); }, 1);
  in.optional("retry", time_span{0s, 1min}, out.retry);
  check_points(in, out);
  return out;
}

} // namespace rubicon::config
