#include "proxy/rules.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "proxy/tuple_key.hpp"

namespace rubicon::proxy {

namespace {

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || !std::isfinite(value))
    return std::nullopt;
  return value;
}

void add_once(std::vector<std::string>& keys, const std::string& key) {
  if (std::none_of(keys.begin(), keys.end(), [&](const auto& x) { return same_key(x, key); }))
    keys.push_back(key);
}

} // namespace

rules::rules(std::vector<rule> list) {
  for (auto& x : list) {
    if (!x.above)
      x.above = x.below;
    if (!x.below)
      x.below = x.above;
    add_once(watched_, x.when);
    add_once(written_, x.write);
    rules_.push_back({std::move(x), level::unknown});
  }
}

std::vector<write_tuple> rules::on_value(std::string_view key, std::string_view text, instant) {
  std::vector<write_tuple> out;
  const auto watches = [&](const auto& x) { return same_key(x, key); };
  if (std::none_of(watched_.begin(), watched_.end(), watches)) {
    ++counters_.unwatched;
    return out;
  }
  const auto value = parse_number(text);
  if (!value) {
    ++counters_.bad_values;
    return out;
  }
  ++counters_.values;
  for (auto& x : rules_) {
    if (!x.what.above || !same_key(x.what.when, key))
      continue;
    if (*value >= *x.what.above)
      enter(x, level::high, out);
    else if (*value < *x.what.below)
      enter(x, level::low, out);
  }
  return out;
}

std::vector<write_tuple> rules::on_owner(std::string_view key, instant) {
  std::vector<write_tuple> out;
  for (const auto& [target, word] : standing_)
    if (same_key(target, key)) {
      ++counters_.writes;
      out.push_back({target, word});
    }
  return out;
}

void rules::enter(state& x, level next, std::vector<write_tuple>& out) {
  if (x.is == next)
    return;
  x.is = next;
  const auto& word = next == level::high ? x.what.then : x.what.otherwise;
  // The first spelling of a key stands for all.
  const auto key = *std::find_if(written_.begin(), written_.end(),
                                 [&](const auto& k) { return same_key(k, x.what.write); });
  if (word.empty()) {
    standing_.erase(key);
    return;
  }
  standing_.insert_or_assign(key, word);
  ++counters_.writes;
  out.push_back({key, word});
}

} // namespace rubicon::proxy
