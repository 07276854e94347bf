#include "proxy/rules.hpp"

#include <algorithm>
#include <utility>

#include "core/decimal.hpp"
#include "proxy/tuple_key.hpp"

namespace rubicon::proxy {

namespace {

void add_once(std::vector<std::string>& keys, const std::string& key) {
  if (std::none_of(keys.begin(), keys.end(), [&](const auto& x) { return same_key(x, key); }))
    keys.push_back(key);
}

constexpr std::string_view outcome_suffix = ".outcome";
constexpr duration day = 24h;

} // namespace

rules::rules(std::vector<rule> list, duration retry) : retry_(retry) {
  for (auto& x : list) {
    if (!x.above)
      x.above = x.below;
    if (!x.below)
      x.below = x.above;
    if (!x.when.empty())
      add_once(watched_, x.when);
    for (const auto& write : x.writes) {
      if (!write.from.empty() && read_from(write.from) == nullptr) {
        add_once(watched_, write.from);
        read_.emplace_back(write.from, "");
      }
      add_once(written_, write.key);
      if (write.meta)
        add_once(meta_, write.key);
    }
    rules_.push_back({std::move(x), level::unknown, level::unknown, {}, {}});
  }
  if (retry_ > 0s) {
    for (const auto& key : written_)
      if (!is_meta(key)) // a reference has no outcome
        add_once(watched_, key + std::string(outcome_suffix));
  }
}

bool rules::is_meta(std::string_view key) const {
  return std::ranges::any_of(meta_, [&](const auto& x) { return same_key(x, key); });
}

void rules::start(instant now) {
  for (auto& x : rules_) {
    if (!x.what.daily)
      continue;
    auto next = instant{} + *x.what.daily;
    while (next < now)
      next += day;
    x.due = next;
  }
}

std::vector<write_tuple> rules::on_value(std::string_view key, std::string_view text, instant now) {
  std::vector<write_tuple> out;
  bool watched = take_outcome(key, text, now);
  if (auto* const newest = read_from(key)) {
    *newest = text;
    watched = true;
  }
  for (auto& x : rules_) {
    if (!same_key(x.what.when, key))
      continue;
    watched = true;
    follow(x, text, now);
  }
  counters_.unwatched += watched ? 0 : 1;
  for (auto& x : on_time(now))
    out.push_back(std::move(x));
  return out;
}

void rules::follow(state& x, std::string_view text, instant now) {
  const auto next = judge(x.what, text);
  if (x.what.daily) {
    x.is = next == level::unknown ? x.is : next;
  } else if (next == level::unknown || next == x.is) {
    x.due.reset();
  } else if (!x.due || x.next != next) {
    x.next = next;
    x.due = now + (next == level::high ? x.what.lasting : x.what.otherwise_lasting);
  }
}

/// `on failed` of a word that stands. @returns whether the key is such a tuple's
bool rules::take_outcome(std::string_view key, std::string_view text, instant now) {
  const auto of = std::ranges::find_if(written_, [&](const auto& x) {
    return retry_ > 0s && same_key(x + std::string(outcome_suffix), key);
  });
  if (of == written_.end())
    return false;
  const auto at = standing_.find(*of);
  const auto blank = text.rfind(' ');
  if (at == standing_.end() || text.substr(0, blank) != at->second.word)
    return true;
  auto& x = at->second;
  const auto outcome = text.substr(blank == std::string_view::npos ? text.size() : blank + 1);
  if (outcome == "acknowledged" || outcome == "sent") {
    x = {x.word, retry_, {}};
  } else if (outcome == "failed" || outcome == "unreachable" || outcome == "timeout") {
    x.due = now + x.pause;
    x.pause = std::min(2 * x.pause, retry_max);
  }
  return true;
}

/// @returns unknown: stays what it is
rules::level rules::judge(const rule& x, std::string_view text) {
  if (!x.equals.empty()) {
    ++counters_.values;
    return std::ranges::find(x.equals, text) == x.equals.end() ? level::low : level::high;
  }
  const auto value = number_in(text);
  if (!value) {
    ++counters_.bad_values;
    return level::unknown;
  }
  ++counters_.values;
  if (!x.above)
    return level::unknown;
  if (*value >= *x.above)
    return level::high;
  return *value < *x.below ? level::low : level::unknown;
}

void rules::on_gone(std::string_view key) {
  if (auto* const newest = read_from(key))
    newest->clear();
  for (auto& x : rules_) {
    if (!same_key(x.what.when, key))
      continue;
    if (x.what.daily)
      x.is = level::unknown;
    else
      x.due.reset();
  }
}

std::vector<write_tuple> rules::on_time(instant now) {
  std::vector<write_tuple> out;
  for (auto& x : rules_)
    on_time_of(x, now, out);
  for (auto& [key, x] : standing_) {
    if (!x.due || *x.due > now)
      continue;
    x.due.reset();
    ++counters_.writes;
    ++counters_.repeats;
    out.push_back({key, x.word, true});
  }
  return out;
}

void rules::on_time_of(state& x, instant now, std::vector<write_tuple>& out) {
  if (x.due && *x.due <= now) {
    if (x.what.daily) {
      *x.due += day;
      enter(x, x.what.when.empty() ? level::high : x.is, now, out);
    } else {
      x.due.reset();
      enter(x, x.next, now, out);
    }
  }
  if (x.then_due && *x.then_due <= now) {
    x.then_due.reset();
    write_then(x.what, out);
  }
}

std::optional<instant> rules::deadline() const {
  std::optional<instant> next;
  for (const auto& x : rules_)
    next = earliest(earliest(next, x.due), x.then_due);
  for (const auto& [key, x] : standing_)
    next = earliest(next, x.due);
  return next;
}

std::vector<write_tuple> rules::on_owner(std::string_view key, instant) {
  std::vector<write_tuple> out;
  for (const auto& [target, x] : standing_)
    if (same_key(target, key)) {
      ++counters_.writes;
      out.push_back({target, x.word, false, is_meta(target)});
    }
  return out;
}

void rules::enter(state& x, level next, instant now, std::vector<write_tuple>& out) {
  x.is = next;
  if (next == level::low) {
    for (const auto& each : x.what.writes)
      write(each.key, each.otherwise, out);
  } else if (next == level::high && x.what.after > 0s) {
    x.then_due = now + x.what.after;
  } else if (next == level::high) {
    write_then(x.what, out);
  }
}

void rules::write_then(const rule& x, std::vector<write_tuple>& out) {
  for (const auto& each : x.writes)
    write(each.key, each.from.empty() ? each.then : *read_from(each.from), out);
}

/// The newest text of a tuple that some rule reads; nullptr: none does.
std::string* rules::read_from(std::string_view key) {
  const auto found =
      std::ranges::find_if(read_, [key](const auto& x) { return same_key(x.first, key); });
  return found == read_.end() ? nullptr : &found->second;
}

void rules::write(const std::string& to, const std::string& word, std::vector<write_tuple>& out) {
  // The first spelling of a key stands for all.
  const auto key = *std::ranges::find_if(written_, [&](const auto& k) { return same_key(k, to); });
  if (word.empty()) {
    standing_.erase(key);
    return;
  }
  standing_.insert_or_assign(key, standing{word, retry_, {}});
  ++counters_.writes;
  out.push_back({key, word, false, is_meta(key)});
}

} // namespace rubicon::proxy
