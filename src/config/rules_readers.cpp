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
  in.optional(
      "point", tuple_key{}, out.key,
      "instead of `write`: the [meta tuple](peis.md#meta-tuples) that is pointed at another tuple");
  if (!out.meta)
    in.required_if(true, "write", tuple_key{}, out.key, "the tuple that is written");
  else if (in.has("write"))
    in.problems().add(in.at("write"), "a rule has either `write` or `point`");
  in.expect("write");
  const about what{"when the condition holds; with `point` a tuple, as in `\"robot:robot.state\"`, "
                   "or `\"nowhere\"`",
                   "nothing is written"};
  const about or_else{"the same when it has ended", "nothing is written"};
  if (out.meta) {
    in.optional("then", tuple_reference{names}, out.then, what);
    in.optional("otherwise", tuple_reference{names}, out.otherwise, or_else);
  } else {
    in.optional("then", text{}, out.then, what);
    in.optional("otherwise", text{}, out.otherwise, or_else);
  }
  if (!in.has("then") && !in.has("otherwise"))
    in.problems().add(in.at(), "a rule needs `then`, `otherwise` or both");
  return out;
}

rule read_rule(table_reader& in, const directory& names) {
  rule out;
  in.required("when", tuple_key{}, out.when, "the tuple that is watched, of any owner");
  in.optional("above", real{}, out.above, "the condition holds at or above this");
  in.optional("below", real{}, out.below,
              {"and has ended below this", "", "number, at most `above`"});
  in.optional("equals", list_of<text>{{}, 1}, out.equals,
              "instead: the condition holds while the value is one of these");
  in.optional("lasting", time_span{}, out.lasting,
              "the condition holds for so long before `then` is written");
  in.optional("otherwise_lasting", time_span{}, out.otherwise_lasting,
              "it has ended for so long before `otherwise` is written");
  in.tables(
      "writes", "writes", "instead of these four: several tuples to be written, see below",
      [&](table_reader& x) { out.writes.push_back(read_rule_write(x, names)); },
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
      "rules", "rules", "see below; also as `[[peer.apps.rules]]`",
      [&](table_reader& x) { out.rules.push_back(read_rule(x, names)); }, 1);
  in.optional("retry", time_span{0s, 1min}, out.retry,
              "when a proxy's [`INPUT.outcome`](gateway.md#of-a-proxy) tells that what was written "
              "has failed, is unreachable or timed out, it is written again after so long, then "
              "after twice as long, up to 1 min; `\"0s\"`: never");
  check_points(in, out);
  return out;
}

} // namespace rubicon::config
