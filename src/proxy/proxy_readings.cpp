// The part of a proxy that publishes what its mote sends: readings, what is made of them, and how
// old they are.
#include <algorithm>
#include <cassert>
#include <utility>

#include "core/serial_number.hpp"
#include "proxy/proxy.hpp"

namespace rubicon::proxy {

namespace {

/// Clocks that are one may differ so much (CLK-01 and a stamp's millisecond); a mote that does not
/// know the network's time yet stamps with its own, which is older than any reading by far.
constexpr duration age_error_max = 10ms;
constexpr duration age_max = 1h;

} // namespace

proxy::outputs proxy::on_output(std::uint16_t channel, byte_view payload, instant now) {
  outputs out;
  sensed(now, out);
  if (!reads(class_, channel)) {
    ++counters_.unread_messages;
    return out;
  }
  auto counts = counts_in(class_, channel, payload);
  if (!counts) {
    ++counters_.short_messages;
    return out;
  }
  ++counters_.messages;
  for (auto& [field, count] : *counts)
    count = field->layout == encoding::stamp ? whole_stamp(count, now) : count;
  say_counts(channel, *counts, now, out);
  if (const auto stamp = stamp_in(class_, channel, payload))
    judge_age(channel, *stamp, now, out);
  return out;
}

/// While the time is not known, the 32 bits are all there is.
std::int64_t proxy::whole_stamp(std::int64_t count, instant now) const {
  if (!network_ahead_)
    return count;
  return unwrapped(static_cast<std::uint32_t>(count),
                   (now.time_since_epoch() + *network_ahead_) / 1ms);
}

proxy::outputs proxy::on_record(std::uint16_t stream, std::int16_t value, std::uint32_t time_ms,
                                instant now) {
  outputs out;
  const reading_source from(stream_input{stream});
  field_counts counts;
  for (const auto& field : class_.fields)
    if (field.source() == from)
      counts.emplace_back(&field, value);
  say_counts(from, counts, now, out);
  judge_age(from, time_ms, now, out);
  return out;
}

void proxy::say_counts(reading_source from, const field_counts& counts, instant now, outputs& out) {
  std::vector<reading> readings;
  for (const auto& [field, count] : counts) {
    const auto mean = means_.find(field->name);
    readings.push_back(reading_of(*field, mean == means_.end() ? count : mean->second.add(count)));
  }
  say_readings(readings, out);
  for (auto& [key, text] : templates_.on_readings(from, readings, now))
    say(std::move(key), std::move(text), out);
  refresh(from, now, out);
  if (program_)
    say_of_program(program_->on_readings(readings, now), out);
}

void proxy::say_readings(std::vector<reading> all, outputs& out) {
  for (auto& x : all) {
    say(key_of(x.name), x.text, out);
    newest_.insert_or_assign(x.name, std::move(x));
  }
}

void proxy::say_of_program(std::vector<reading> all, outputs& out) {
  std::erase_if(all, [this](const reading& x) {
    const bool foreign = !program_names_.contains(x.name);
    counters_.foreign_names += foreign ? 1 : 0;
    return foreign;
  });
  for (const auto& x : all) {
    if (!x.unit.empty() && !std::exchange(program_names_.at(x.name), true))
      say(key_of(x.name + ".unit"), x.unit, out);
  }
  say_readings(std::move(all), out);
}

void proxy::update_program_time(instant now, outputs& out) {
  say_of_program(program_->on_time(now), out);
  assert(program_->deadline().value_or(instant::max()) > now);
}

void proxy::ask_for_period(outputs& out) const {
  for (const auto channel : output_channels())
    out.emplace_back(write_period{who_.mote, channel, class_.settings.period});
}

/// A quarter is added to what is published, so that most readings change nothing.
void proxy::judge_age(reading_source from, std::uint32_t stamp, instant now, outputs& out) {
  if (!network_ahead_)
    return;
  const auto network_now = now.time_since_epoch() + *network_ahead_;
  const auto age = network_now - whole_stamp(stamp, now) * 1ms;
  if (age < -age_error_max || age > age_max) {
    ++counters_.other_times;
    return;
  }
  auto& x = ages_[from];
  counters_.late += x.published && age > *x.published ? 1 : 0;
  x.estimate.add(std::max<duration>(age, 0s));
  const auto bound = *x.estimate.bound() * 5 / 4;
  if (!latency_estimate::replaces(bound, x.published))
    return;
  x.published = bound;
  for (const auto& field : class_.fields)
    if (field.source() == from)
      say(key_of(field.name + ".latency"), to_text(instant(bound)), out);
}

std::optional<duration> proxy::reading_latency() const {
  std::optional<duration> greatest;
  for (const auto& [source, x] : ages_)
    greatest = std::max(greatest, x.published);
  return greatest;
}

void proxy::refresh(reading_source from, instant now, outputs& out) {
  if (class_.settings.stale_after == 0s)
    return;
  const bool was_fresh = stale_at_.contains(from);
  stale_at_.insert_or_assign(from, now + class_.settings.stale_after);
  if (!was_fresh)
    say_freshness(from, "fresh", out);
}

void proxy::mark_stale(instant now, outputs& out) {
  for (auto x = stale_at_.begin(); x != stale_at_.end();) {
    if (x->second > now) {
      ++x;
      continue;
    }
    say_freshness(x->first, "stale", out);
    x = stale_at_.erase(x);
  }
}

void proxy::say_freshness(reading_source from, std::string_view word, outputs& out) {
  for (const auto& field : class_.fields)
    if (field.source() == from)
      say(key_of(field.name + ".freshness"), std::string(word), out);
}

} // namespace rubicon::proxy
