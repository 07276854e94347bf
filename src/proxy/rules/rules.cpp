#include "proxy/rules/rules.hpp"

#include <algorithm>
#include <utility>

#include "core/text/decimal.hpp"
#include "core/text/printable.hpp"
#include "proxy/classes/tuple_key.hpp"

namespace rubicon::proxy {

namespace {

void add_once(std::vector<std::string>& keys, const std::string& key) {
  if (std::none_of(keys.begin(), keys.end(), [&](const auto& x) { return same_key(x, key); }))
    keys.push_back(key);
}

constexpr std::string_view outcome_suffix = ".outcome";
constexpr duration day = 24h;

} // namespace

instant next_daily(duration daily, const std::vector<clock_change>& changes, instant from) {
  const auto time_of = [&changes](duration shown) { // by a clock that is never set
    auto begin = instant::min();
    duration ahead{};
    for (const auto& x : changes) {
      const auto at = std::max(begin, instant{} + shown - ahead);
      if (at < x.at)
        return at;
      begin = x.at;
      ahead = x.ahead;
    }
    return std::max(begin, instant{} + shown - ahead);
  };
  auto shown = daily + (from - instant{} - daily) / day * day - 2 * day;
  while (time_of(shown) < from)
    shown += day;
  return time_of(shown);
}

rules::rules(std::vector<rule> list, duration retry, std::vector<clock_change> changes)
    : retry_(retry), clock_changes_(std::move(changes)) {
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
    state one;
    one.what = std::move(x);
    one.number = rules_.size();
    rules_.push_back(std::move(one));
  }
  ended_.resize(rules_.size());
  if (retry_ > 0s) {
    for (const auto& key : written_)
      if (!is_meta(key)) // a reference has no outcome
        add_once(watched_, key + std::string(outcome_suffix));
  }
}

bool rules::is_meta(std::string_view key) const {
  return std::ranges::any_of(meta_, [&](const auto& x) { return same_key(x, key); });
}

void rules::start(instant now, std::optional<instant> away_since) {
  for (auto& x : rules_) {
    if (!x.what.daily)
      continue;
    x.due = next_daily(*x.what.daily, clock_changes_, now);
    const auto previous = next_daily(*x.what.daily, clock_changes_, *x.due - 3 * day / 2);
    if (away_since && previous >= *away_since && previous >= instant{})
      make_up(x, previous, now);
  }
}

/// A time of day has passed while the rules were away.
void rules::make_up(state& x, instant previous, instant now) {
  const auto late = "the time of a rule that writes " + x.what.writes.front().key +
                    " has passed while the rules were away, " + rubicon::to_text(now - previous) +
                    " ago";
  x.is_late = x.what.retry && retry_ > 0s && now - previous <= lateness_max;
  if (!x.is_late)
    ++counters_.times_missed;
  notify(late + (x.is_late ? "" : ": nothing is written"));
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
  counters_.unwatched_keys += watched ? 0 : 1;
  for (auto& x : on_time(now))
    out.push_back(std::move(x));
  return out;
}

void rules::follow(state& x, std::string_view text, instant now) {
  const auto next = judge(x.what, text);
  if (x.what.daily) {
    x.is = next == level::unknown ? x.is : next; // on_time_of() makes up for what is late
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
  take_outcome(*of, at->second,
               text.substr(blank == std::string_view::npos ? text.size() : blank + 1), now);
  return true;
}

void rules::take_outcome(const std::string& key, standing& x, std::string_view outcome,
                         instant now) {
  using stage = standing::stage;
  const bool is_taken = x.is == stage::accepted; // else it may be of the same word before
  if (outcome == "acknowledged" || outcome == "sent") {
    x.due.reset();
    x.pause = retry_;
    x.is = is_taken ? stage::done : x.is;
  } else if (outcome == "failed" || outcome == "unreachable" || outcome == "timeout") {
    again_later(x, now);
  } else if (is_taken && (outcome == "refused" || outcome == "superseded")) {
    auto& ended = ended_[x.rule];
    --ended.accepted;
    ++(outcome == "refused" ? ended.refused : ended.replaced);
    x.is = stage::done;
    notify(key + " = " + x.word + ": " + std::string(outcome) + " by its proxy");
  }
}

void rules::again_later(standing& x, instant now) {
  if (!x.retry)
    return;
  x.due = now + x.pause;
  x.pause = std::min(2 * x.pause, retry_max);
}

/// @returns unknown: stays what it is
rules::level rules::judge(const rule& x, std::string_view text) {
  if (!x.equals.empty()) {
    ++counters_.values;
    return std::ranges::find(x.equals, text) == x.equals.end() ? level::low : level::high;
  }
  const auto value = number_in(text);
  if (!value) {
    ++counters_.unread_values;
    report_unread(x, text);
    return level::unknown;
  }
  ++counters_.values;
  if (!x.above)
    return level::unknown;
  if (*value >= *x.above)
    return level::high;
  return *value < *x.below ? level::low : level::unknown;
}

/// Once for each tuple: it may be published every second.
void rules::report_unread(const rule& x, std::string_view text) {
  constexpr std::size_t shown_max = 40;
  const auto key =
      *std::ranges::find_if(watched_, [&x](const auto& y) { return same_key(y, x.when); });
  if (unread_.insert(key).second)
    notify("cannot read " + key + " = \"" + printable(text.substr(0, shown_max)) +
           (text.size() > shown_max ? "…" : "") + "\": that is no number");
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
  for (auto& [key, x] : standing_)
    on_time_of(key, x, now, out);
  return out;
}

void rules::on_time_of(const std::string& key, standing& x, instant now,
                       std::vector<write_tuple>& out) {
  if (x.report_due && *x.report_due <= now) {
    x.report_due.reset();
    x.is_reported = true;
    notify(key + " = " + x.word + " waits: no peer has that tuple");
  }
  if (!x.due || *x.due > now)
    return;
  x.due.reset();
  ++counters_.repeats;
  x.is = x.is == standing::stage::waiting ? standing::stage::asked : x.is;
  out.push_back({key, x.word, true, is_meta(key)});
}

void rules::on_time_of(state& x, instant now, std::vector<write_tuple>& out) {
  if (x.due && *x.due <= now) {
    if (x.what.daily) {
      x.due = next_daily(*x.what.daily, clock_changes_, *x.due + duration(1));
      enter(x, x.what.when.empty() ? level::high : x.is, now, out);
    } else {
      x.due.reset();
      enter(x, x.next, now, out);
    }
  }
  if (x.is_late && (x.what.when.empty() || x.is != level::unknown)) {
    x.is_late = false;
    enter(x, x.what.when.empty() ? level::high : x.is, now, out);
  }
  if (x.then_due && *x.then_due <= now) {
    x.then_due.reset();
    write_then(x, now, out);
  }
}

std::optional<instant> rules::deadline() const {
  std::optional<instant> next;
  for (const auto& x : rules_)
    next = earliest(earliest(next, x.due), x.then_due);
  for (const auto& [key, x] : standing_)
    next = earliest(earliest(next, x.due), x.report_due);
  return next;
}

rules::standing* rules::standing_at(std::string_view key) {
  const auto found =
      std::ranges::find_if(standing_, [key](const auto& x) { return same_key(x.first, key); });
  return found == standing_.end() ? nullptr : &found->second;
}

std::vector<write_tuple> rules::on_owner(std::string_view key, instant, bool is_back) {
  using stage = standing::stage;
  auto* const x = standing_at(key);
  if (x == nullptr)
    return {};
  const bool is_delivered = x->is == stage::accepted || x->is == stage::done;
  // A reference is where it was by default, and is pointed again; a word may be a command.
  const bool repeats = is_back ? !is_delivered || is_meta(key) : !is_delivered || !x->rule_ended;
  if (!repeats)
    return {};
  x->is = is_delivered ? x->is : stage::asked;
  x->report_due.reset();
  x->due.reset();
  const auto& target =
      *std::ranges::find_if(written_, [key](const auto& k) { return same_key(k, key); });
  return {{target, x->word, is_back || x->is_reported, is_meta(target)}};
}

void rules::on_owner_gone(std::string_view key, instant now) {
  using stage = standing::stage;
  auto* const x = standing_at(key);
  if (x == nullptr || is_meta(key))
    return;
  if (x->is != stage::accepted || now - x->accepted_at > unsure)
    return;
  --ended_[x->rule].accepted;
  lose(std::string(key), *x, "its owner ended, and may not have acted");
}

void rules::on_unowned(std::string_view key, instant now) {
  auto* const x = standing_at(key);
  if (x == nullptr || x->is != standing::stage::asked)
    return;
  x->is = standing::stage::waiting;
  if (!x->is_reported && !x->report_due)
    x->report_due = now + patience;
}

void rules::on_written(std::string_view key, write_end end, std::string_view cause, instant now) {
  using stage = standing::stage;
  auto* const x = standing_at(key);
  if (x == nullptr)
    return;
  if (x->is != stage::asked) { // a repeat of what had been accepted: a proxy had failed
    if (end == write_end::unreached)
      again_later(*x, now);
    else if (x->is == stage::accepted)
      x->accepted_at = now;
    return;
  }
  const auto what = std::string(key) + " = " + x->word;
  if (end == write_end::accepted) {
    ++ended_[x->rule].accepted;
    x->is = stage::accepted;
    x->accepted_at = now;
    x->pause = retry_;
    if (std::exchange(x->is_reported, false))
      notify(what + " has arrived, " + rubicon::to_text(now - x->since) + " late");
  } else if (end == write_end::refused) {
    ++ended_[x->rule].refused;
    x->is = stage::done;
    notify(what + " is refused: " + std::string(cause));
  } else {
    lose(std::string(key), *x, "its owner is away (" + std::string(cause) + ')');
    if (x->is == stage::waiting)
      again_later(*x, now);
  }
}

/// Its owner has it not, or no more.
void rules::lose(const std::string& key, standing& x, std::string_view why) {
  x.is = x.retry ? standing::stage::waiting : standing::stage::done;
  x.due.reset();
  if (!x.retry)
    ++ended_[x.rule].lost;
  if (!std::exchange(x.is_reported, true))
    notify(key + " = " + x.word + (x.retry ? " waits: " : " is lost: ") + std::string(why));
}

void rules::enter(state& x, level next, instant now, std::vector<write_tuple>& out) {
  x.is = next;
  if (next == level::low) {
    for (const auto& each : x.what.writes) {
      end_words_of(x, each.key);
      write(x, each.key, each.otherwise, now, out);
    }
  } else if (next == level::high && x.what.after > 0s) {
    x.then_due = now + x.what.after;
  } else if (next == level::high) {
    write_then(x, now, out);
  }
}

/// What it has written is not repeated to another owner, once one has it.
void rules::end_words_of(const state& x, const std::string& key) {
  if (auto* const word = standing_at(key); word != nullptr && word->rule == x.number)
    word->rule_ended = true;
}

void rules::write_then(const state& x, instant now, std::vector<write_tuple>& out) {
  for (const auto& each : x.what.writes)
    write(x, each.key, each.from.empty() ? each.then : *read_from(each.from), now, out);
}

/// The newest text of a tuple that some rule reads; nullptr: none does.
std::string* rules::read_from(std::string_view key) {
  const auto found =
      std::ranges::find_if(read_, [key](const auto& x) { return same_key(x.first, key); });
  return found == read_.end() ? nullptr : &found->second;
}

void rules::write(const state& by, const std::string& to, const std::string& word, instant now,
                  std::vector<write_tuple>& out) {
  if (word.empty())
    return;
  // The first spelling of a key stands for all.
  const auto key = *std::ranges::find_if(written_, [&](const auto& k) { return same_key(k, to); });
  replace(key, word);
  standing x;
  x.word = word;
  x.rule = by.number;
  x.retry = by.what.retry && retry_ > 0s;
  x.since = now;
  x.pause = retry_;
  standing_.insert_or_assign(key, std::move(x));
  ++ended_[by.number].writes;
  out.push_back({key, word, false, is_meta(key)});
}

/// What stands there is no more, and has not got to its owner.
void rules::replace(const std::string& key, const std::string& word) {
  using stage = standing::stage;
  const auto* const x = standing_at(key);
  if (x == nullptr || x->is == stage::accepted || x->is == stage::done)
    return;
  ++ended_[x->rule].replaced;
  if (x->word != word)
    notify(key + " = " + x->word + " is replaced by " + word + " before its owner had it");
}

/// The queue of notices is bounded, in case they are not taken.
void rules::notify(std::string what) {
  constexpr std::size_t notices_max = 1000;
  if (notices_.size() < notices_max)
    notices_.push_back(std::move(what));
}

} // namespace rubicon::proxy
