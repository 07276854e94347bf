#include "proxy/object_proxy.hpp"

#include <algorithm>

#include "core/text/decimal.hpp"
#include "core/tuples/interface_keys.hpp"
#include "proxy/classes/layout.hpp"
#include "proxy/classes/tuple_key.hpp"

namespace rubicon::proxy {

namespace {

constexpr std::uint16_t memory_channel = 0; ///< fields of objects have no other

std::optional<known_object> known_in(const proxy_class& what, std::string_view id) {
  const auto found =
      std::ranges::find_if(what.objects, [id](const auto& x) { return same_key(x.id, id); });
  return found == what.objects.end() ? std::nullopt : std::optional(*found);
}

} // namespace

object_proxy::object_proxy(proxy_class what, signature percept, object_settings settings)
    : class_(std::move(what)), percept_(std::move(percept)), settings_(settings),
      known_(known_in(class_, percept_.hardware_id)), choice_(settings.hysteresis_db) {
  const auto id = key_part(percept_.hardware_id);
  const auto name = known_ && !known_->name.empty() ? key_part(known_->name) : id;
  prefix_ = fill_prefix(
      class_.prefix, {{"{channel}", key_part(percept_.channel)}, {"{id}", id}, {"{name}", name}});
  name_values names{
      {"channel", percept_.channel},
      {"id", percept_.hardware_id},
      {"name", known_ && !known_->name.empty() ? known_->name : percept_.hardware_id}};
  names.insert(names.end(), class_.properties.begin(), class_.properties.end());
  if (known_)
    names.insert(names.end(), known_->properties.begin(), known_->properties.end());
  templates_ = tuple_templates(class_, std::move(names));
}

object_proxy::outputs object_proxy::start(instant now) {
  outputs out;
  say("class", class_.name, out);
  say("id", percept_.channel + '/' + percept_.hardware_id, out);
  for (const auto& [name, text] : class_.properties)
    say(name, text, out);
  if (known_) {
    for (const auto& [name, text] : known_->properties)
      say(name, text, out);
  }
  for (const auto& field : class_.fields)
    if (!field.unit.empty())
      say(field.name + ".unit", field.unit, out);
  for (auto& [key, text] : templates_.at_start())
    say_under(std::move(key), std::move(text), out);
  lost_at_ = now + settings_.lost_after; // unless it is perceived by then
  say_interface(out);
  say_state(nothing_word, now, out);
  return out;
}

std::vector<std::string> object_proxy::watches() const {
  const interface_key about_it{interface_tuple::rssi, "*", percept_.hardware_id};
  auto memory = about_it;
  memory.what = interface_tuple::memory;
  return {to_string(about_it), to_string(memory),
          to_string(interface_key{interface_tuple::position, "*", {}})};
}

object_proxy::outputs object_proxy::on_tuple(peer_id owner, std::string_view key, byte_view value,
                                             bool deleted, instant now) {
  outputs out;
  const auto parsed = parse_interface_key(key);
  const bool is_ours =
      parsed && (parsed->object.empty() ? parsed->what == interface_tuple::position
                                        : same_key(parsed->object, percept_.hardware_id));
  if (!is_ours) {
    ++counters_.foreign_tuples;
    return out;
  }
  const interface_id from{owner, parsed->name};
  if (parsed->what == interface_tuple::position) {
    if (deleted)
      places_.erase(from);
    else
      places_[from] = tuple_text(value);
    if (choice_.chosen() == from)
      say_interface(out);
  } else if (parsed->what == interface_tuple::memory) {
    if (!deleted)
      read(value, now, out);
  } else if (deleted) {
    follow(choice_.on_gone(from), now, out);
  } else if (const auto dbm = number_in(tuple_text(value))) {
    ++counters_.percepts;
    follow(choice_.on_percept(from, *dbm), now, out);
  } else {
    ++counters_.bad_values;
  }
  return out;
}

object_proxy::outputs object_proxy::on_time(instant now) {
  outputs out;
  if (!lost_at_ || *lost_at_ > now)
    return out;
  lost_at_.reset();
  if (active_) {
    active_ = false;
    say_state("not_perceived", now, out);
  }
  return out;
}

/// What a new percept, or one less, means.
void object_proxy::follow(bool chose_anew, instant now, outputs& out) {
  if (!choice_.chosen()) {
    if (active_ && !lost_at_)
      lost_at_ = now + settings_.lost_after;
    return;
  }
  lost_at_.reset();
  if (chose_anew) {
    ++counters_.switches;
    say_interface(out);
  }
  if (!active_) {
    active_ = true;
    say_state(nothing_word, now, out);
  }
}

/// The object's memory is the same whoever reads it.
void object_proxy::read(byte_view memory, instant now, outputs& out) {
  if (class_.fields.empty() || (memory_ && std::ranges::equal(*memory_, memory)))
    return;
  const auto readings = decode(class_, memory_channel, memory);
  if (!readings) {
    ++counters_.short_memories;
    return;
  }
  memory_ = to_bytes(memory);
  for (const auto& x : *readings) {
    values_[x.name] = x.unit.empty() ? x.text : x.text + ' ' + x.unit;
    say(x.name, x.text, out);
  }
  for (auto& [key, text] : templates_.on_readings(memory_channel, *readings, now))
    say_under(std::move(key), std::move(text), out);
}

std::string object_proxy::interface_name() const {
  return choice_.chosen() ? choice_.chosen()->name : std::string();
}

void object_proxy::say_interface(outputs& out) {
  const auto& chosen = choice_.chosen();
  const auto place = chosen ? places_.find(*chosen) : places_.end();
  values_["interface"] = chosen ? chosen->name : std::string(nothing_word);
  values_["position"] = place == places_.end() ? std::string("unknown") : place->second;
  for (const auto* name : {"interface", "position"})
    say(name, values_[name], out);
}

void object_proxy::say_state(std::string_view cause, instant now, outputs& out) {
  say("status.cause", std::string(cause), out);
  say("status.since", to_text(now), out);
  say("status", std::string(active_ ? "active" : "lost"), out);
}

void object_proxy::say(std::string_view suffix, std::string text, outputs& out) {
  say_under(prefix_ + '.' + key_parts(suffix), std::move(text), out);
}

void object_proxy::say_under(std::string key, std::string text, outputs& out) {
  if (fits_tuple_key(key))
    out.emplace_back(publish{std::move(key), std::move(text)});
  else
    ++counters_.bad_keys;
}

} // namespace rubicon::proxy
