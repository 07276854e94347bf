#include "report/expect/expectations.hpp"

#include <utility>
#include <variant>

namespace rubicon::report {

expectations::expectations(const std::vector<config::expectation>& all, duration length)
    : end_(instant{} + length) {
  for (const auto& each : all) {
    auto& x = all_.emplace_back(watched_expectation{each});
    if (const auto* tuple = std::get_if<config::tuple_expectation>(&each)) {
      watches_tuples_ = true;
      if (!tuple->when)
        x.tuples.begin(instant{});
    } else if (const auto* clock = std::get_if<config::clock_expectation>(&each)) {
      x.clocks.next = instant{} + clock->from;
    } else if (const auto* vectors = std::get_if<config::vectors_expectation>(&each)) {
      x.vectors.is_due = vectors->from > 0s;
    } else if (const auto* some = std::get_if<config::sometimes_expectation>(&each)) {
      watches_tuples_ = watches_tuples_ || some->during;
    }
  }
}

// Tuples.

void expectations::on_tuple(std::string_view key, std::string_view text, instant now) {
  const std::string value(text);
  on_value(key, &value, now);
}

void expectations::on_tuple_gone(std::string_view key, instant now) {
  on_value(key, nullptr, now);
}

void expectations::on_value(std::string_view key, const std::string* text, instant now) {
  for (auto& each : all_) {
    if (const auto* some = std::get_if<config::sometimes_expectation>(&each.what))
      each.situation.on_tuple(*some, key, text, now);
    const auto* what = std::get_if<config::tuple_expectation>(&each.what);
    if (what == nullptr)
      continue;
    auto& x = each.tuples;
    if (equal_keys(key, what->then.key)) {
      x.then_holds = holds(what->then, text);
      if (x.then_holds)
        x.come_true(*what, now);
    }
    if (what->when && equal_keys(key, what->when->key)) {
      const bool held = std::exchange(x.when_holds, holds(*what->when, text));
      if (!held && x.when_holds) {
        x.begin(now);
        if (x.then_holds)
          x.come_true(*what, now);
      }
    }
  }
}

// The event log.

void expectations::on_event(const logged_event& x) {
  noticed_.hears_events = true;
  for (auto& each : all_) {
    if (const auto* what = std::get_if<config::event_log_expectation>(&each.what))
      each.log.take(*what, x);
    else if (const auto* some = std::get_if<config::sometimes_expectation>(&each.what))
      each.situation.on_event(*some, x);
  }
}

// Members, clocks and programs.

void expectations::on_joined(const mote_address& mote, instant now) {
  noticed_.joined.emplace(mote, now);
}

std::optional<instant> expectations::next_sample() const {
  std::optional<instant> next;
  for (const auto& each : all_) {
    if (std::holds_alternative<config::clock_expectation>(each.what))
      next = earliest(next, each.clocks.next);
    else if (const auto* x = std::get_if<config::vectors_expectation>(&each.what);
             x != nullptr && each.vectors.is_due)
      next = earliest(next, instant{} + x->from);
  }
  return next && *next <= end_ ? next : std::nullopt;
}

void expectations::on_sample(instant now) {
  for (auto& each : all_) {
    if (const auto* clock = std::get_if<config::clock_expectation>(&each.what)) {
      while (each.clocks.next <= now)
        each.clocks.next += clock->every;
    } else if (const auto* x = std::get_if<config::vectors_expectation>(&each.what);
               x != nullptr && now >= instant{} + x->from) {
      each.vectors.is_due = false;
    }
  }
}

void expectations::on_clock(const mote_address& mote, const std::string& name, duration error,
                            instant now) {
  for (auto& each : all_) {
    const auto* what = std::get_if<config::clock_expectation>(&each.what);
    if (what == nullptr || now < instant{} + what->from || !what->of.contains(mote))
      continue;
    each.clocks.take(*what, name, error, now);
  }
}

void expectations::on_vectors(const std::string& node, std::uint32_t program, std::uint64_t missed,
                              instant now) {
  for (auto& each : all_) {
    const auto* what = std::get_if<config::vectors_expectation>(&each.what);
    if (what != nullptr && what->from > 0s && now <= instant{} + what->from)
      each.vectors.before[{node, program}] = missed;
  }
}

std::vector<expectation_report> expectations::judge(const run_report& x) const {
  std::vector<expectation_report> out;
  for (const auto& each : all_)
    out.push_back(report::judge(each, noticed_, x));
  return out;
}

violation violation_of(const expectation_report& x) {
  return {x.at, std::string(expected) + x.text,
          x.measured + (x.command.empty() ? "" : "; " + x.command)};
}

} // namespace rubicon::report
