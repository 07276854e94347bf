#include "bridge/mqtt/mqtt_bridge.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <nlohmann/json.hpp>

#include "bridge/mqtt/payloads.hpp"
#include "bridge/table/payload.hpp"
#include "core/text/json.hpp"
#include "core/text/name.hpp"

namespace rubicon::bridge {

namespace {

constexpr std::size_t list_max = 1000; ///< names in `bridge/devices`
constexpr std::string_view availability_end = "/availability";

bool is_prefix(std::string_view x) {
  return !x.empty() &&
         std::ranges::all_of(x, [](char c) { return c == '.' || is_name_character(c); });
}

} // namespace

mqtt_bridge::mqtt_bridge(mqtt_config config, std::vector<class_model> classes, random_stream rng)
    : config_(std::move(config)), names_{config_.base, config_.discovery},
      table_(std::move(classes)), rng_(rng), queue_(config_.rate) {}

publication mqtt_bridge::last_will() const {
  return {topic_of("bridge/state"), availability_payload(false)};
}

mqtt_outputs mqtt_bridge::sent(instant now) {
  mqtt_outputs out;
  if (!connected_)
    return out;
  for (auto& each : queue_.take(now)) {
    ++counters_.published;
    out.emplace_back(std::move(each));
  }
  return out;
}

void mqtt_bridge::publish_availability(urgency how, std::string_view name, bool available) {
  queue_.add(how,
             {topic_of(name) + std::string(availability_end), availability_payload(available)});
}

void mqtt_bridge::publish_state(const object& x) {
  queue_.add(urgency::state, {topic_of(x.name), state_document(table_.model(x), x)});
}

void mqtt_bridge::publish_list() {
  auto names = nlohmann::json::array();
  for (const auto* each : table_.all()) {
    if (names.size() == list_max)
      break;
    names.push_back({{"friendly_name", each->name}, {"model", table_.model(*each).name}});
  }
  queue_.add(urgency::state, {topic_of("bridge/devices"), json_line(names)});
}

void mqtt_bridge::announce(const object& x) {
  if (config_.home_assistant) {
    const auto label = config_.labels.find(folded(x.name));
    queue_.add(urgency::announcement,
               {discovery_topic(names_, x.name),
                discovery_document(names_, table_.model(x), x, config_.platforms,
                                   label == config_.labels.end() ? x.name : label->second)});
  }
  publish_availability(urgency::availability, x.name, x.is_available());
  publish_state(x);
}

void mqtt_bridge::announce_all() {
  for (const auto* each : table_.all())
    announce(*each);
  for (const auto& [name, at] : removals_.names())
    publish_availability(urgency::leftover, name, false);
  publish_list();
  queue_.add(urgency::state, {topic_of("bridge/state"), availability_payload(true)});
}

void mqtt_bridge::plan_announcement(instant now) {
  announce_at_ = earliest(announce_at_, now + rng_.between(0s, jitter));
}

void mqtt_bridge::remove(const std::string& name) {
  ++counters_.removed;
  if (config_.home_assistant && table_.find(name) == nullptr) // else in another spelling
    queue_.add(urgency::leftover, {discovery_topic(names_, name), {}});
  queue_.add(urgency::leftover, {topic_of(name) + std::string(availability_end), {}});
  queue_.add(urgency::leftover, {topic_of(name), {}});
}

mqtt_outputs mqtt_bridge::on_tuple(const components::news& x, instant now) {
  for (const auto& each : table_.on_tuple(x)) {
    if (each.what == change_kind::disappeared) {
      list_at_ = earliest(list_at_, now + list_pause);
      const bool waits = removals_.add(each.name, now + config_.remove_after);
      if (connected_ && waits)
        publish_availability(urgency::availability, each.name, false);
      else if (connected_)
        remove(each.name);
      continue;
    }
    const auto* of = table_.find(each.name);
    if (of == nullptr)
      continue;
    if (each.what == change_kind::outcome)
      std::erase_if(open_, [&each](const auto& open) {
        return open.second.name == each.name && open.second.input == each.input;
      });
    if (each.what == change_kind::appeared) {
      removals_.erase(each.name);
      unnamed_.erase(discovery_topic(names_, each.name));
    }
    if (!is_announced_)
      continue; // all of it is published after the connection
    if (each.what == change_kind::appeared) {
      announce(*of);
      list_at_ = earliest(list_at_, now + list_pause);
    } else if (each.what == change_kind::availability)
      publish_availability(urgency::availability, of->name, of->is_available());
    else
      publish_state(*of);
  }
  return sent(now);
}

mqtt_outputs mqtt_bridge::on_written(std::uint64_t token, std::string_view cause, instant now) {
  const auto found = open_.find(token);
  if (found != open_.end() && !cause.empty()) {
    ++counters_.writes_failed;
    if (const auto* of = table_.find(found->second.name)) // the state is published as it was
      publish_state(*of);
    open_.erase(found);
  }
  return sent(now);
}

mqtt_outputs mqtt_bridge::on_connected(instant now) {
  ++counters_.connections;
  queue_.clear();
  connected_ = true;
  flood_.on_connected();
  is_announced_ = false;
  sweep_ends_ = now + sweep_time;
  announce_at_.reset();
  plan_announcement(now);
  mqtt_outputs out;
  for (const auto* rest : {"+/set", "+/set/+", "+/get", "+/availability"})
    out.emplace_back(subscription{topic_of(rest)});
  if (config_.home_assistant) {
    out.emplace_back(subscription{config_.discovery + "/status"});
    out.emplace_back(subscription{config_.discovery + "/device/+/config"});
  }
  for (const auto& each : config_.topics)
    out.emplace_back(subscription{each.topic});
  return out;
}

void mqtt_bridge::on_disconnected() {
  connected_ = false;
  is_announced_ = false;
  queue_.clear();
  announce_at_.reset();
  sweep_ends_.reset();
}

mqtt_outputs mqtt_bridge::on_message(const delivery& x, instant now) {
  ++counters_.received;
  mqtt_outputs out;
  accept_waiting(now, out); // they are older
  if (x.topic.size() > topic_max || x.payload.size() > payload_max)
    ++counters_.oversized;
  else if (flood_.accepts(x.retained, now)) {
    counters_.flooded += waiting_.forget(x.topic) ? 1 : 0;
    accept(x, now, out);
  } else if (x.retained || !has_value(x.topic) || waiting_.keep(x.topic, x.payload))
    ++counters_.flooded;
  auto more = sent(now);
  std::move(more.begin(), more.end(), std::back_inserter(out));
  return out;
}

bool mqtt_bridge::has_value(std::string_view topic) const {
  if (std::ranges::any_of(config_.topics, [&](const auto& x) { return x.topic == topic; }))
    return true;
  if (!topic.starts_with(config_.base + '/'))
    return false;
  const auto rest = topic.substr(config_.base.size() + 1);
  const auto slash = std::min(rest.find('/'), rest.size());
  const auto what = rest.substr(slash);
  return (what == "/set" || what.starts_with("/set/")) &&
         table_.find(rest.substr(0, slash)) != nullptr;
}

void mqtt_bridge::accept_waiting(instant now, mqtt_outputs& out) {
  if (waiting_.empty() || now < flood_.next())
    return;
  for (const auto& [topic, payload] : waiting_.take()) {
    static_cast<void>(flood_.accepts(false, now)); // they count, and are no more than the limit
    accept({topic, payload}, now, out);
  }
}

void mqtt_bridge::accept(const delivery& x, instant now, mqtt_outputs& out) {
  const bool becomes_tuple = convert(x, out);
  if (config_.home_assistant && x.topic == config_.discovery + "/status")
    on_birth(x.payload, now);
  else if (x.topic.starts_with(config_.base + '/'))
    on_own_topic(x, x.topic.substr(config_.base.size() + 1), now, out);
  else if (config_.home_assistant && x.topic.starts_with(config_.discovery + "/device/"))
    on_announced(x, now);
  else if (!becomes_tuple)
    ++counters_.unknown_topics;
}

void mqtt_bridge::on_birth(std::string_view payload, instant now) {
  if (payload != "online")
    return;
  ++counters_.births;
  if (announce_at_)
    return;
  plan_announcement(std::max(now, announced_ + birth_pause));
}

bool mqtt_bridge::convert(const delivery& x, mqtt_outputs& out) {
  bool any = false;
  for (const auto& rule : config_.topics) {
    if (rule.topic != x.topic)
      continue;
    any = true;
    if (const auto text = tuple_text(rule, x.payload))
      out.emplace_back(components::publish{rule.key, to_bytes(std::string_view(*text))});
    else
      ++counters_.bad_payloads;
  }
  return any;
}

/// What an earlier life of this bridge has announced is removed, unless its object appears.
void mqtt_bridge::on_announced(const delivery& x, instant now) {
  const auto own = config_.discovery + "/device/" + device_id(names_, "");
  if (!sweep_ends_ || !x.topic.starts_with(own) || x.payload.empty())
    return;
  static_cast<void>(unnamed_.add(std::string(x.topic), now + config_.remove_after));
}

void mqtt_bridge::on_own_topic(const delivery& x, std::string_view rest, instant now,
                               mqtt_outputs& out) {
  const auto slash = rest.find('/');
  const auto name = rest.substr(0, slash);
  const auto what = slash == std::string_view::npos ? std::string_view() : rest.substr(slash);
  const auto* of = table_.find(name);
  const bool is_set = what == "/set" || what.starts_with("/set/");
  if (what == availability_end) { // of an earlier life, or the bridge's own
    if (x.retained && !x.payload.empty() && (of == nullptr || of->name != name) &&
        is_prefix(name) && removals_.add(std::string(name), now + config_.remove_after))
      publish_availability(urgency::leftover, name, false);
  } else if (of == nullptr && !(is_set && x.retained)) // that is counted as such
    ++counters_.unknown_topics;
  else if (what == "/get") {
    if (!x.retained)
      publish_state(*of);
  } else if (is_set)
    on_set(x, of, what.substr(std::min<std::size_t>(what.size(), 5)), now, out);
  else
    ++counters_.unknown_topics;
}

void mqtt_bridge::on_set(const delivery& x, const object* of, std::string_view input, instant now,
                         mqtt_outputs& out) {
  if (x.payload.empty())
    return; // a retained command has been deleted
  if (x.retained) {
    ++counters_.commands_retained;
    return;
  }
  if (x.payload.size() > command_max) {
    ++counters_.oversized;
    return;
  }
  if (!input.empty()) {
    command(*of, input, x.payload, now, out);
    return;
  }
  const auto parsed = bounded_json(x.payload);
  if (!parsed.is_object() || parsed.empty()) {
    ++counters_.commands_refused;
    return;
  }
  for (const auto& [key, value] : parsed.items())
    command(*of, key, word_in(value).value_or(""), now, out);
}

void mqtt_bridge::command(const object& of, std::string_view input, std::string_view text,
                          instant now, mqtt_outputs& out) {
  const auto* known = input_of(table_.model(of), input);
  if (known == nullptr) {
    ++counters_.unknown_topics;
    return;
  }
  const auto word = accepted(*known, text);
  if (!word || open_.size() >= open_commands_max) {
    ++counters_.commands_refused;
    publish_state(of); // who sent it shows the state as it is
    return;
  }
  ++counters_.commands;
  open_[++last_token_] = {of.name, known->name, now + command_timeout};
  out.emplace_back(
      components::write{of.owner, of.name + '.' + known->name, *word, false, last_token_});
}

mqtt_outputs mqtt_bridge::on_time(instant now) {
  mqtt_outputs out;
  counters_.commands_unanswered +=
      std::erase_if(open_, [now](const auto& each) { return each.second.expires <= now; });
  if (announce_at_ && *announce_at_ <= now) {
    announce_at_.reset();
    announced_ = now;
    is_announced_ = true;
    announce_all();
  }
  if (sweep_ends_ && *sweep_ends_ <= now) {
    sweep_ends_.reset();
    for (const auto* each : table_.all())
      unnamed_.erase(discovery_topic(names_, each->name));
    out.emplace_back(unsubscription{topic_of("+/availability")});
    if (config_.home_assistant)
      out.emplace_back(unsubscription{config_.discovery + "/device/+/config"});
  }
  for (const auto& each : removals_.take(now))
    if (connected_)
      remove(each);
  if (list_at_ && *list_at_ <= now) {
    list_at_.reset();
    if (connected_)
      publish_list();
  }
  accept_waiting(now, out);
  if (!sweep_ends_)
    for (auto& each : unnamed_.take(now))
      if (connected_)
        queue_.add(urgency::leftover, {std::move(each), {}});
  auto more = sent(now);
  std::move(more.begin(), more.end(), std::back_inserter(out));
  return out;
}

std::optional<instant> mqtt_bridge::deadline() const {
  auto out = earliest(announce_at_, sweep_ends_);
  if (connected_)
    out = earliest(out, queue_.deadline());
  out = earliest(out, earliest(list_at_, removals_.deadline()));
  if (!sweep_ends_)
    out = earliest(out, unnamed_.deadline());
  if (!waiting_.empty())
    out = earliest(out, flood_.next());
  if (!open_.empty()) // tokens and times are in the same order
    out = earliest(out, open_.begin()->second.expires);
  return out;
}

} // namespace rubicon::bridge
