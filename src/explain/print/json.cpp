// The answers as JSON: the same facts, nothing left out, times in seconds.
#include <nlohmann/json.hpp>

#include "core/text/json.hpp"
#include "core/text/printable.hpp"
#include "explain/outcome.hpp"
#include "explain/print/text.hpp"
#include "explain/print/words.hpp"

namespace rubicon::explain {

namespace {

using nlohmann::ordered_json;

constexpr std::size_t depth_max = 200;

double in_seconds(instant x) {
  return seconds(x.time_since_epoch());
}

std::string_view word_of(step x) {
  switch (x) {
  case step::sends:
    return "sends";
  case step::hop:
    return "hop";
  case step::receives:
    return "receives";
  case step::acts:
    return "acts";
  case step::learns:
    return "learns";
  case step::asks:
    return "asks";
  case step::sets:
    return "sets";
  case step::notified:
    return "hears";
  }
  return "unknown";
}

std::string_view word_of(medium x) {
  switch (x) {
  case medium::air:
    return "air";
  case medium::serial:
    return "serial";
  case medium::backbone:
    return "backbone";
  case medium::peis:
    return "peis";
  case medium::none:
    break;
  }
  return "none";
}

std::string_view word_of(cargo x) {
  switch (x) {
  case cargo::content:
    return "content";
  case cargo::greeting:
    return "greeting";
  case cargo::answer:
    return "answer";
  case cargo::greeting_answer:
    return "greeting_answer";
  }
  return "unknown";
}

ordered_json value_of(const tuple_value& x) {
  ordered_json value = {{"key", x.key}, {"owner", x.owner.value}, {"deleted", x.is_deletion}};
  if (x.is_text)
    value["text"] = rubicon::to_string(byte_view(x.value));
  else
    value["octets"] = to_hex(x.value);
  return value;
}

ordered_json step_of(const traces& all, node_index n, std::size_t depth) {
  const auto& x = all.nodes[n];
  ordered_json y = {{"step", word_of(x.what)},
                    {"time_s", in_seconds(x.time())},
                    {"at", where(all, x)},
                    {"what", what(all, x)}};
  if (x.about.is_tuple)
    y["tuple"] = all.tuples[x.about.index].key;
  else
    y["message"] = all.messages[x.about.index].name;
  if (x.what == step::hop) {
    y["medium"] = word_of(x.over);
    y["carries"] = word_of(x.of);
    y["from"] = x.from;
    y["to"] = x.to;
    y["arrived"] = x.arrived.has_value();
    y["fragments"] = x.fragments;
    auto& attempts = y["attempts"] = ordered_json::array();
    for (const auto& each : x.attempts)
      attempts.push_back({{"time_s", in_seconds(each.begin)}, {"outcome", each.outcome}});
    if (!x.arrived)
      y["why"] = obstacle(x);
  }
  if (depth < depth_max && !x.children.empty()) {
    auto& then = y["then"] = ordered_json::array();
    for (const auto child : x.children)
      then.push_back(step_of(all, child, depth + 1));
  }
  return y;
}

/// The steps that led to this one, without what else came of them.
ordered_json path_to(const traces& all, node_index n) {
  std::vector<node_index> path;
  for (auto x = all.nodes[n].parent; x != no_node; x = all.nodes[x].parent)
    path.push_back(x);
  auto steps = ordered_json::array();
  for (auto x = path.rbegin(); x != path.rend(); ++x)
    steps.push_back(step_of(all, *x, depth_max));
  return steps;
}

ordered_json summary_of(const traces& all, std::size_t index) {
  const auto& x = all.messages[index];
  const auto y = outcome_of(all, x);
  ordered_json out = {{"message", x.name},
                      {"time_s", in_seconds(all.nodes[x.root].begin)},
                      {"from", all.known.of(x.source)},
                      {"to", all.known.of(x.destination)},
                      {"channel", x.channel},
                      {"reliable", x.is_reliable},
                      {"kind", x.is_on_channel  ? "channel"
                               : x.is_in_tunnel ? "tunnel"
                                                : "message"},
                      {"accounted", x.is_accounted},
                      {"outcome", to_string(y.status)}};
  if (x.content)
    out["octets"] = to_hex(*x.content);
  if (y.took)
    out["took_s"] = seconds(*y.took);
  if (x.acknowledged)
    out["acknowledged_s"] = in_seconds(*x.acknowledged);
  if (x.failed)
    out["failed_s"] = in_seconds(*x.failed);
  if (!y.why.empty())
    out["why"] = y.why;
  if (!y.cause.empty())
    out["cause"] = y.cause;
  if (!y.where.empty())
    out["where"] = y.where;
  out["repeats"] = {{"radio", y.retries.radio},
                    {"serial", y.retries.serial},
                    {"peis", y.retries.peis},
                    {"transport", y.retries.transport}};
  return out;
}

ordered_json audience_json(const traces& all, const tuple_value& x) {
  auto out = ordered_json::array();
  for (const auto& who : audience_of(all, x)) {
    ordered_json one = {{"who", who.who}};
    if (who.after)
      one["after_s"] = seconds(*who.after);
    out.push_back(std::move(one));
  }
  return out;
}

/// What people call motes, islands and peers, by their names; nothing without any.
void add_labels(ordered_json& out, const traces& all) {
  for (const auto& [name, label] : all.about.labels)
    out["labels"][name] = label;
}

std::string text_of(const ordered_json& x) {
  return printable_json(json_lines(x)) + '\n';
}

} // namespace

std::string message_json(const traces& all, std::size_t index) {
  auto out = summary_of(all, index);
  const auto root = all.messages[index].root;
  out["caused_by"] = path_to(all, root);
  out["path"] = step_of(all, root, 0);
  add_labels(out, all);
  return text_of(out);
}

std::string tuple_json(const traces& all, std::size_t index) {
  const auto& x = all.tuples[index];
  auto out = value_of(x);
  out["time_s"] = in_seconds(all.nodes[x.root].begin);
  out["by"] = x.writer;
  out["set"] = x.set.has_value();
  out["heard_by"] = audience_json(all, x);
  out["caused_by"] = path_to(all, x.root);
  out["path"] = step_of(all, x.root, 0);
  add_labels(out, all);
  return text_of(out);
}

std::string values_json(const traces& all, const std::vector<std::size_t>& indices,
                        std::size_t limit) {
  auto out = ordered_json::array();
  const auto first = limit != 0 && indices.size() > limit ? indices.size() - limit : 0;
  for (auto i = first; i < indices.size(); ++i) {
    const auto& x = all.tuples[indices[i]];
    auto value = value_of(x);
    value["time_s"] = in_seconds(all.nodes[x.root].begin);
    value["by"] = x.writer;
    value["set"] = x.set.has_value();
    value["heard_by"] = audience_json(all, x);
    out.push_back(std::move(value));
  }
  return text_of(out);
}

std::string list_json(const traces& all, const listing& asked) {
  ordered_json out = {{"ecology", all.about.ecology},
                      {"seed", all.about.seed},
                      {"length_s", in_seconds(all.end)},
                      {"cut_off", all.cut_off}};
  auto& causes = out["lost"] = ordered_json::object();
  for (const auto& [why, count] : loss_causes(all, asked))
    causes[why] = count;
  auto& list = out["messages"] = ordered_json::array();
  for (const auto i : selected(all, asked))
    list.push_back(summary_of(all, i));
  add_labels(out, all);
  return text_of(out);
}

} // namespace rubicon::explain
