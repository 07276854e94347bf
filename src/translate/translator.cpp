#include "translate/translator.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/text/decimal.hpp"
#include "core/tuples/tuple_key.hpp"
#include "translate/pattern.hpp"

namespace rubicon::translate {

namespace {

constexpr std::string_view history_suffix = ".history";
constexpr std::string_view unit_suffix = ".unit";

/// One field of a line of CSV.
std::string csv(std::string_view text) {
  std::string plain(text.substr(0, translator::history_text_max));
  std::ranges::replace_if(
      plain, [](char c) { return c >= 0 && c < ' '; }, ' ');
  if (plain.find_first_of(",\"") == std::string::npos)
    return plain;
  std::string quoted = "\"";
  for (const char c : plain)
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

} // namespace

translator::translator(std::vector<translation> rules) : rules_(std::move(rules)) {
  for (const auto& x : rules_)
    if (std::ranges::none_of(
            watched_, [&](const auto& known) { return folded_key(known) == folded_key(x.from); }))
      watched_.push_back(x.from);
}

translator::outputs translator::on_value(std::string_view key, std::string_view text, bool own,
                                         instant now) {
  outputs out;
  if (own && is_ours(key)) {
    ++counters_.own_tuples;
    return out;
  }
  for (const auto& rule : rules_) {
    const auto stars = match(rule.from, key);
    if (!stars)
      continue;
    std::string result;
    if (rule.value) {
      const auto number = number_in(text);
      const auto value = number ? (*rule.value)(*number) : std::nullopt;
      counters_.bad_values += value ? 0 : 1;
      if (!value)
        continue;
      result = decimal_text(*value, rule.decimals);
    } else if (text.size() <= text_max) {
      result = text;
    } else {
      ++counters_.long_values;
      continue;
    }
    publish_result(rule, rule.to.empty() ? std::string(key) : filled(rule.to, *stars), key, result,
                   now, out);
  }
  return out;
}

translator::outputs translator::on_gone(std::string_view key, bool own) {
  outputs out;
  if (own && is_ours(key))
    return out;
  for (auto& [target_key, x] : targets_) {
    if (!x.is_published || folded_key(x.source) != folded_key(key))
      continue;
    x.is_published = false;
    out.emplace_back(erase{target_key});
  }
  return out;
}

/// A target itself, its unit or its history.
bool translator::is_ours(std::string_view key) const {
  auto folded = folded_key(key);
  const auto found = targets_.find(folded);
  if (found != targets_.end() && found->second.is_published)
    return true;
  for (const auto suffix : {history_suffix, unit_suffix})
    if (folded.ends_with(suffix) &&
        targets_.contains(folded.substr(0, folded.size() - suffix.size())))
      return true;
  return false;
}

translator::target* translator::target_at(const std::string& key) {
  const auto folded = folded_key(key);
  if (!targets_.contains(folded) && targets_.size() >= targets_max) {
    ++counters_.refused;
    return nullptr;
  }
  return &targets_[folded];
}

void translator::publish_result(const translation& rule, const std::string& base,
                                std::string_view key, std::string_view text, instant now,
                                outputs& out) {
  const bool keeps = rule.history > 0;
  if (!fits_tuple_key(base) || (keeps && !fits_tuple_key(base + std::string(history_suffix))) ||
      (!rule.unit.empty() && !fits_tuple_key(base + std::string(unit_suffix)))) {
    ++counters_.bad_keys;
    return;
  }
  auto* const x = target_at(base);
  if (x == nullptr)
    return;
  ++counters_.translated;
  x->source = key;
  if (!rule.to.empty()) {
    if (!std::exchange(x->is_published, true) && !rule.unit.empty())
      out.emplace_back(publish{base + std::string(unit_suffix), rule.unit});
    out.emplace_back(publish{base, std::string(text)});
  }
  if (!keeps)
    return;
  x->lines.push_back(to_text(now) + ',' + csv(text));
  while (x->lines.size() > rule.history)
    x->lines.pop_front();
  std::string all;
  for (const auto& line : x->lines)
    all += line + '\n';
  out.emplace_back(publish{base + std::string(history_suffix), std::move(all)});
}

} // namespace rubicon::translate
