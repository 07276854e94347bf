#include "proxy/proxy.hpp"

#include <algorithm>
#include <utility>

#include "core/text/decimal.hpp"
#include "core/tuples/interface_keys.hpp"

namespace rubicon::proxy {

namespace {

/// Longest unknown word that an outcome tuple repeats; anybody may write anything to an input.
constexpr std::size_t shown_word_max = 64;

std::string shown(std::string_view word, request_outcome outcome) {
  if (outcome != request_outcome::refused)
    return std::string(word);
  const bool plain =
      word.size() <= shown_word_max &&
      std::all_of(word.begin(), word.end(), [](char c) { return c > ' ' && c <= '~'; });
  return plain ? std::string(word) : "?";
}

std::string words_of(const input& x) {
  std::string text;
  for (const auto& [word, octets] : x.words) {
    if (!text.empty())
      text += ' ';
    text += word;
  }
  return text;
}

std::string range_text(const number_form& x) {
  constexpr int decimals = 6;
  const auto shortest = [](double value) {
    auto text = decimal_text(value, decimals);
    text.erase(text.find_last_not_of('0') + 1);
    return text.ends_with('.') ? text.substr(0, text.size() - 1) : text;
  };
  return shortest(x.min) + ' ' + shortest(x.max);
}

/// What the class's table knows of this mote (PXY-05).
const known_object* known_in(const proxy_class& what, const proxy_identity& who) {
  const auto found = std::ranges::find(what.objects, proxy_id(who.mote), &known_object::id);
  return found == what.objects.end() ? nullptr : &*found;
}

name_values template_names(const proxy_class& what, const proxy_identity& who) {
  auto names = names_of(who);
  names.insert(names.end(), what.properties.begin(), what.properties.end());
  if (const auto* known = known_in(what, who))
    names.insert(names.end(), known->properties.begin(), known->properties.end());
  return names;
}

} // namespace

std::string_view to_string(proxy::state x) {
  switch (x) {
  case proxy::state::active:
    return "active";
  case proxy::state::inactive:
    return "inactive";
  case proxy::state::stale:
    return "stale";
  case proxy::state::lost:
    return "lost";
  }
  return "unknown";
}

proxy::proxy(proxy_class what, proxy_identity who, duration slack)
    : class_(std::move(what)), who_(std::move(who)), slack_(slack),
      prefix_(key_prefix(class_.prefix, who_)), templates_(class_, template_names(class_, who_)) {
  for (const auto& input : class_.inputs)
    channels_.try_emplace(input.channel, answer_timeout(), class_.settings.retry_for);
  for (const auto& field : class_.fields)
    if (field.mean_of > 1 && !field.computed_by_mote)
      means_.emplace(field.name, running_mean(field.mean_of));
  if (!class_.make_program)
    return;
  program_ = class_.make_program();
  for (auto& name : program_->names())
    program_names_.emplace(std::move(name), false);
}

proxy::outputs proxy::start(instant now) {
  outputs out;
  last_sensed_ = now;
  say_prior_information(out);
  if (class_.indirect)
    say_indirect_information(out);
  for (auto& [key, text] : templates_.at_start())
    say(std::move(key), std::move(text), out);
  if (program_)
    say_of_program(program_->start(now), out);
  say_state(now, out);
  return out;
}

proxy::outputs proxy::on_class_changed(const class_change& x) {
  outputs out;
  const auto before = class_.settings;
  ::rubicon::proxy::apply(x, class_);
  const auto& now = class_.settings;
  for (auto& [source, at] : stale_at_)
    at += now.stale_after - before.stale_after;
  if (now.answer_timeout != before.answer_timeout || now.retry_for != before.retry_for) {
    for (auto& [channel, requests] : channels_)
      requests.set_times(answer_timeout(), now.retry_for);
    for (const auto& input : class_.inputs) {
      const auto deadline = to_text(instant(deadline_of(input.channel)));
      say(key_of(input.name + ".deadline"), deadline, out);
      const auto known = latencies_.find(input.channel);
      if (known == latencies_.end() || !known->second.published)
        say(key_of(input.name + ".latency"), deadline, out);
    }
  }
  if (now.period != before.period)
    ask_for_period(out);
  if (keys::find(x.field_settings, "unit") != nullptr)
    say(key_of(x.field + ".unit"), field_named(class_, x.field)->unit, out);
  return out;
}

std::vector<watch> proxy::watches() const {
  std::vector<watch> list;
  for (const auto& input : class_.inputs) {
    if (input.meta)
      list.push_back({watch::source::meta, key_of("mi-" + input.name), input.name});
    else
      list.push_back({watch::source::own, key_of(input.name), input.name});
  }
  for (const auto channel : output_channels())
    list.push_back({watch::source::gateway, device_output_key(who_.mote.mote, channel), {}});
  for (const auto& [channel, requests] : channels_)
    list.push_back({watch::source::gateway, device_input_status_key(who_.mote.mote, channel), {}});
  if (class_.settings.period > 0s && !output_channels().empty())
    list.push_back({watch::source::gateway, device_status_key(who_.mote.mote), {}});
  return list;
}

std::set<std::uint16_t> proxy::output_channels() const {
  std::set<std::uint16_t> channels;
  for (const auto& field : class_.fields)
    if (!field.stream)
      channels.insert(field.channel);
  return channels;
}

bool proxy::consumes(const signature& percept) const {
  return percept.channel == wsn_channel && percept.hardware_id == proxy_id(who_.mote);
}

proxy::outputs proxy::on_gateway_tuple(std::string_view key, byte_view value, instant now) {
  const auto parsed = parse_device_key(key);
  if (parsed && parsed->mote == who_.mote.mote) {
    if (parsed->what == device_tuple::output)
      return on_output(parsed->channel, value, now);
    if (parsed->what == device_tuple::input_status)
      return on_input_status(parsed->channel, tuple_text(value), now);
    if (parsed->what == device_tuple::status && class_.settings.period > 0s) {
      outputs out;
      const auto status = parse_device_status(tuple_text(value));
      if (!status)
        ++counters_.bad_statuses;
      else if (status->presence == device_presence::listed)
        ask_for_period(out); // whoever was started again has forgotten it
      return out;
    }
  }
  ++counters_.foreign_tuples;
  return {};
}

proxy::outputs proxy::on_input_status(std::uint16_t channel, std::string_view text, instant now) {
  outputs out;
  const auto found = channels_.find(channel);
  if (found == channels_.end()) {
    ++counters_.foreign_tuples;
    return out;
  }
  const auto status = parse_input_status(text);
  if (!status) {
    ++counters_.bad_statuses;
    return out;
  }
  if (status->outcome == input_outcome::acknowledged)
    sensed(now, out);
  apply(channel, found->second.on_status(*status, now), out);
  return out;
}

proxy::outputs proxy::on_input(std::string_view name, std::string_view text, instant now) {
  outputs out;
  const auto found = std::find_if(class_.inputs.begin(), class_.inputs.end(),
                                  [&](const auto& x) { return x.name == name; });
  if (found == class_.inputs.end()) {
    ++counters_.foreign_tuples;
    return out;
  }
  const auto index = static_cast<std::size_t>(found - class_.inputs.begin());
  auto octets = encode(*found, text);
  if (!octets && (text.empty() || text == nothing_word))
    return out;
  ++counters_.requested;
  if (!octets)
    publish_outcome(index, text, request_outcome::refused, out);
  else if (state_ == state::lost)
    publish_outcome(index, text, request_outcome::unreachable, out);
  else
    apply(found->channel,
          channels_.at(found->channel).add({index, std::string(text), *std::move(octets)}, now),
          out);
  return out;
}

proxy::outputs proxy::on_presence(device_presence x, std::string_view cause, instant now) {
  outputs out;
  if (x == device_presence::left) {
    if (state_ != state::lost)
      lost_since_ = now;
    const bool is_news = state_ == state::lost && cause_ != cause;
    cause_ = cause;
    enter(state::lost, now, out);
    if (is_news)
      say(key_of("status.cause"), cause_, out);
    for (auto& [channel, requests] : channels_)
      apply(channel, requests.drop_waiting(now), out);
    return out;
  }
  last_sensed_ = now;
  retired_ = false;
  cause_ = nothing_word;
  enter(x == device_presence::stale ? state::stale : state::active, now, out);
  return out;
}

proxy::outputs proxy::on_gateway_changed(std::string name, instant now) {
  outputs out;
  who_.interface_name = std::move(name);
  if (class_.indirect)
    say_indirect_information(out);
  for (auto& [channel, requests] : channels_)
    apply(channel, requests.on_gateway_changed(now), out);
  return out;
}

proxy::outputs proxy::on_time(instant now) {
  outputs out;
  for (auto& [channel, requests] : channels_)
    apply(channel, requests.on_time(now), out);
  mark_stale(now, out);
  if (program_)
    update_program_time(now, out);
  const auto due = presence_deadline();
  if (due && now >= *due) {
    if (state_ == state::lost) {
      retired_ = true;
      out.emplace_back(retire{});
    } else {
      enter(state::inactive, now, out);
    }
  }
  return out;
}

std::optional<instant> proxy::deadline() const {
  auto due = presence_deadline();
  for (const auto& [channel, requests] : channels_)
    due = earliest(due, requests.deadline());
  for (const auto& [source, stale_at] : stale_at_)
    due = earliest(due, stale_at);
  return program_ ? earliest(due, program_->deadline()) : due;
}

std::size_t proxy::open_requests() const {
  std::size_t open = 0;
  for (const auto& [channel, requests] : channels_)
    open += requests.open();
  return open;
}

std::vector<std::pair<std::string, std::string>> proxy::values() const {
  std::vector<std::pair<std::string, std::string>> list;
  for (const auto& [name, x] : newest_)
    list.emplace_back(name, x.unit.empty() ? x.text : x.text + ' ' + x.unit);
  return list;
}

std::string proxy::key_of(std::string_view suffix) const {
  return prefix_ + '.' + key_parts(suffix);
}

void proxy::say(std::string key, std::string text, outputs& out) {
  if (fits_tuple_key(key))
    out.emplace_back(publish{std::move(key), std::move(text)});
  else
    ++counters_.bad_keys;
}

void proxy::say_prior_information(outputs& out) {
  say(key_of("class"), class_.name, out);
  say(key_of("id"), proxy_id(who_.mote), out);
  say(key_of("island"), who_.island_name.empty() ? to_string(who_.mote.island) : who_.island_name,
      out);
  for (const auto& [name, text] : class_.properties)
    say(key_of(name), text, out);
  if (const auto* known = known_in(class_, who_))
    for (const auto& [name, text] : known->properties)
      say(key_of(name), text, out);
  for (const auto& field : class_.fields)
    if (!field.unit.empty())
      say(key_of(field.name + ".unit"), field.unit, out);
  for (const auto& input : class_.inputs) {
    if (!input.words.empty() || !input.numbers)
      say(key_of(input.name + ".words"), words_of(input), out);
    if (input.numbers)
      say(key_of(input.name + ".range"), range_text(*input.numbers), out);
    if (!input.unit.empty())
      say(key_of(input.name + ".unit"), input.unit, out);
    const auto deadline = to_text(instant(deadline_of(input.channel)));
    say(key_of(input.name + ".deadline"), deadline, out);
    say(key_of(input.name + ".latency"), deadline, out);
    say(key_of(input.name), std::string(nothing_word), out);
    if (input.meta)
      declare_meta(input.name, out);
  }
}

/// An unreachable mote is perceived by no interface; where it was put it still is.
void proxy::say_indirect_information(outputs& out) {
  const bool perceived = state_ != state::lost && !who_.interface_name.empty();
  say(key_of("interface"), perceived ? who_.interface_name : std::string(nothing_word), out);
  const auto* known = known_in(class_, who_);
  const bool placed = known != nullptr && known->place;
  const auto place = placed      ? known->place
                     : perceived ? who_.interface_place
                                 : std::optional<position>();
  const auto* accuracy = !place ? "unknown" : placed ? "prior" : "interface";
  say(key_of("position.accuracy"), accuracy, out);
  say(key_of("position"), place ? position_text(*place) : "unknown", out);
}

void proxy::declare_meta(const std::string& input, outputs& out) {
  auto key = key_of("mi-" + input);
  if (fits_tuple_key(key))
    out.emplace_back(declare{std::move(key), key_of(input)});
  else
    ++counters_.bad_keys;
}

void proxy::enter(state next, instant now, outputs& out) {
  if (state_ == next)
    return;
  const bool tells_anew = class_.indirect && (next == state::lost || state_ == state::lost);
  state_ = next;
  if (tells_anew)
    say_indirect_information(out);
  say_state(now, out);
}

void proxy::say_state(instant now, outputs& out) {
  say(key_of("status.cause"), cause_, out);
  say(key_of("status.since"), to_text(now), out);
  say(key_of("status"), std::string(to_string(state_)), out);
}

/// Signs of life keep a proxy active; that a lost mote is back is the manager's to say.
void proxy::sensed(instant now, outputs& out) {
  last_sensed_ = now;
  if (state_ == state::inactive)
    enter(state::active, now, out);
}

duration proxy::answer_timeout() const {
  return class_.settings.answer_timeout + slack_;
}

/// In which a request has its outcome for certain: those before it on the channel come first.
duration proxy::deadline_of(std::uint16_t channel) const {
  const auto before = std::ranges::count(class_.inputs, channel, &input::channel);
  return (before + 1) * (answer_timeout() + class_.settings.retry_for);
}

void proxy::note_latency(std::uint16_t channel, duration taken, outputs& out) {
  auto& x = latencies_[channel];
  x.estimate.add(taken);
  const auto bound = std::min(*x.estimate.bound(), deadline_of(channel));
  if (!latency_estimate::replaces(bound, x.published))
    return;
  x.published = bound;
  for (const auto& input : class_.inputs)
    if (input.channel == channel)
      say(key_of(input.name + ".latency"), to_text(instant(bound)), out);
}

void proxy::apply(std::uint16_t channel, input_channel::outputs todo, outputs& out) {
  for (auto& x : todo) {
    if (auto* const work = std::get_if<submit>(&x)) {
      counters_.retries += work->again ? 1 : 0;
      out.emplace_back(write_device{who_.mote, channel, std::move(work->octets)});
    } else if (const auto* const end = std::get_if<finished>(&x)) {
      publish_outcome(end->input, end->word, end->outcome, out);
      if (end->outcome != request_outcome::acknowledged)
        continue;
      counters_.slowest = std::max(counters_.slowest, end->after);
      counters_.latency.add(end->after);
      note_latency(channel, end->after, out);
    }
  }
}

void proxy::publish_outcome(std::size_t input, std::string_view word, request_outcome outcome,
                            outputs& out) {
  const std::string text(to_string(outcome));
  if (outcome == request_outcome::acknowledged)
    ++counters_.acknowledged;
  else if (outcome == request_outcome::sent)
    ++counters_.sent;
  else
    ++counters_.failed[text];
  say(key_of(class_.inputs[input].name + ".outcome"), shown(word, outcome) + ' ' + text, out);
}

std::optional<instant> proxy::presence_deadline() const {
  if (!last_sensed_ || retired_)
    return std::nullopt;
  if (state_ == state::active && class_.settings.inactive_after)
    return *last_sensed_ + *class_.settings.inactive_after;
  if (state_ == state::lost && class_.settings.retire_after)
    return lost_since_ + *class_.settings.retire_after;
  return std::nullopt;
}

} // namespace rubicon::proxy
