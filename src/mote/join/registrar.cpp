#include "mote/join/registrar.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "mote/join/descriptor.hpp"

namespace rubicon::mote {

network::mote_joined registrar::event_of(mote_id mote, const member& x) {
  return {mote, x.incarnation, x.type, x.descriptor};
}

network::leave_cause registrar::cause_of_silence(const member& x) {
  if (x.condition.battery_low)
    return network::leave_cause::battery;
  return x.condition.links_weak ? network::leave_cause::out_of_range
                                : network::leave_cause::silence;
}

namespace {

/// Whether these are known to be two motes.
bool differ(std::uint32_t a, std::uint32_t b) {
  return a != b && a != 0 && b != 0;
}

} // namespace

registrar_outputs registrar::start(instant now) {
  roster_due_ = now + config_.roster_period;
  return {};
}

registrar_outputs registrar::on_frame(mote_id source, byte_view payload, instant now,
                                      std::size_t hops) {
  const auto message = decode_management(payload);
  if (!message) {
    ++counters_.malformed;
    return {};
  }
  if (const auto* request = std::get_if<join_request>(&*message))
    return on_request(source, *request, now, hops);
  if (const auto* confirm = std::get_if<join_confirm>(&*message))
    return on_confirm(source, *confirm, now);
  if (std::holds_alternative<leave_notice>(*message)) {
    const auto found = members_.find(source);
    if (found == members_.end())
      return {};
    const bool announced = found->second.announced;
    members_.erase(found);
    slots_.forget(source);
    if (!announced)
      return {};
    return {network::mote_left{source, network::leave_cause::notice}};
  }
  if (const auto* alive = std::get_if<keep_alive>(&*message)) {
    const auto found = members_.find(source);
    if (found != members_.end() && differ(found->second.device, alive->device)) {
      auto out = on_double(source, alive->device); // it has been a member: it is to ask again
      std::ranges::move(prompt(source, now), std::back_inserter(out));
      return out;
    }
    if (found != members_.end() && found->second.incarnation == alive->incarnation)
      found->second.condition = alive->condition;
    else if (found != members_.end() && found->second.confirmed)
      return prompt(source, now); // what we hold is not of this life
  }
  if (const auto* notice = std::get_if<slot_notice>(&*message))
    return on_slot_notice(source, *notice, now);
  if (std::holds_alternative<keep_alive>(*message))
    return on_received(source, now);
  return {}; // a reply or a prompt of another sink within earshot
}

registrar_outputs registrar::on_request(mote_id source, const join_request& x, instant now,
                                        std::size_t hops) {
  const auto description = decode_descriptor(x.descriptor);
  if (!description) {
    ++counters_.malformed;
    return {};
  }
  const auto found = members_.find(source);
  registrar_outputs out;
  if (found != members_.end() && found->second.last_received + found->second.window > now) {
    if (differ(found->second.device, description->device)) {
      out = on_double(source, description->device);
      out.emplace_back(to_mote{source, join_refusal{x.sequence}});
      return out;
    }
    if (found->second.device != 0 && found->second.device == description->device &&
        x.incarnation < found->second.incarnation) {
      ++counters_.outdated;
      return out;
    }
  }
  if (found == members_.end() && members_.size() >= config_.members_max && !make_room(out, now)) {
    ++counters_.refused;
    return {};
  }
  auto& entry = members_[source];
  const bool same_life = entry.confirmed && entry.incarnation == x.incarnation;
  // A mote is the same all its life: one of the two descriptors is a lie. Ask it.
  const bool contradicts = same_life && entry.descriptor != x.descriptor;
  entry.confirmed = same_life; // a reboot is announced again once it is confirmed
  entry.sequence = x.sequence;
  entry.incarnation = x.incarnation;
  entry.condition = {};
  entry.type = description->type;
  entry.device = description->device;
  entry.descriptor = x.descriptor;
  entry.window =
      std::max<duration>(config_.keep_alive_window,
                         keep_alives_max * std::chrono::milliseconds(description->keep_alive_ms));
  entry.last_received = now;
  entry.replies = 1;
  entry.confirm_wait = config_.confirm_wait * static_cast<int>(std::max<std::size_t>(hops, 1));
  entry.reply_due = now + entry.confirm_wait;
  wake_at(same_life ? now + entry.window : entry.reply_due);
  out.emplace_back(reply_to(source, entry, now));
  if (contradicts) {
    std::ranges::move(prompt(source, now), std::back_inserter(out));
    return out;
  }
  prompted_.erase(source);
  return out;
}

registrar_outputs registrar::on_double(mote_id source, std::uint32_t device) {
  ++counters_.doubles;
  if (!doubles_reported_.contains(source) && doubles_reported_.size() >= config_.members_max)
    return {};
  if (std::exchange(doubles_reported_[source], device) == device)
    return {};
  return {double_refused{source, device}};
}

/// A full list loses whoever has been silent longest, if for longer than a mote may be by default;
/// should it live, it is asked to join when it sends again.
bool registrar::make_room(registrar_outputs& out, instant now) {
  const auto silent =
      std::ranges::min_element(members_, {}, [](const auto& x) { return x.second.last_received; });
  if (silent == members_.end() || silent->second.last_received + config_.keep_alive_window > now)
    return false;
  if (silent->second.announced)
    out.emplace_back(network::mote_left{silent->first, cause_of_silence(silent->second)});
  members_.erase(silent);
  return true;
}

/// Asks a mote to join (again), not too often.
registrar_outputs registrar::prompt(mote_id mote, instant now) {
  const auto last = prompted_.find(mote);
  if (last != prompted_.end() && now - last->second < config_.prompt_pause)
    return {};
  if (last == prompted_.end() && prompted_.size() >= config_.members_max)
    prompted_.clear(); // bounded: forgetting costs at most one early prompt per mote
  prompted_[mote] = now;
  return {to_mote{mote, rejoin_prompt{}}};
}

registrar_outputs registrar::on_confirm(mote_id source, const join_confirm& x, instant now) {
  const auto found = members_.find(source);
  if (found == members_.end() || found->second.incarnation != x.incarnation)
    return on_received(source, now);
  auto& entry = found->second;
  entry.last_received = now;
  wake_at(now + entry.window);
  return announce(source, entry);
}

registrar_outputs registrar::announce(mote_id mote, member& entry) {
  if (entry.confirmed)
    return {};
  entry.confirmed = true;
  entry.announced = true;
  return {event_of(mote, entry)};
}

registrar_outputs registrar::on_received(mote_id source, instant now) {
  const auto found = members_.find(source);
  if (found == members_.end())
    return prompt(source, now);
  auto& entry = found->second;
  entry.last_received = now;
  return announce(source,
                  entry); // its confirm may be lost, but only a mote with our reply sends this
}

/// Who has moved aside for it is notified, too.
registrar_outputs registrar::on_slot_notice(mote_id source, const slot_notice& x, instant now) {
  auto out = on_received(source, now);
  if (!members_.contains(source))
    return out;
  for (const auto mote : slots_.on_notice(source, x.units, x.slot, now))
    out.emplace_back(to_mote{mote, slot_grant{slots_.slot_of(mote)}});
  return out;
}

registrar_outputs registrar::on_describe(mote_id mote, instant now) {
  if (mote == broadcast_mote) {
    roster_pages_.clear();
    return {next_roster_page(now)};
  }
  const auto found = members_.find(mote);
  if (found == members_.end())
    return {network::mote_left{mote, network::leave_cause::silence}};
  const auto& entry = found->second;
  if (!entry.confirmed)
    return {};
  return {event_of(mote, entry)};
}

registrar_outputs registrar::on_time(instant now) {
  registrar_outputs out;
  if (next_expiry_ && *next_expiry_ <= now)
    out = expire(now);
  slots_.on_time(now);
  if (roster_due_ && *roster_due_ <= now)
    out.emplace_back(next_roster_page(now));
  return out;
}

registrar_outputs registrar::expire(instant now) {
  registrar_outputs out;
  next_expiry_.reset();
  for (auto x = members_.begin(); x != members_.end();) {
    auto& [mote, entry] = *x;
    if (entry.confirmed && entry.last_received + entry.window <= now) {
      out.emplace_back(network::mote_left{mote, cause_of_silence(entry)});
      x = members_.erase(x);
      continue;
    }
    if (!entry.confirmed && entry.reply_due <= now) {
      if (entry.replies >= config_.replies_max) {
        if (entry.announced)
          out.emplace_back(network::mote_left{mote, network::leave_cause::silence});
        x = members_.erase(x);
        continue;
      }
      ++entry.replies;
      entry.reply_due = now + entry.confirm_wait;
      out.emplace_back(reply_to(mote, entry, now));
    }
    wake_at(entry.confirmed ? entry.last_received + entry.window : entry.reply_due);
    ++x;
  }
  return out;
}

network::sink_event registrar::next_roster_page(instant now) {
  if (roster_pages_.empty()) {
    roster_pages_ = compile_roster();
    roster_began_ = now;
  }
  auto page = std::move(roster_pages_.front());
  roster_pages_.pop_front();
  const auto next = now + config_.roster_page_gap;
  roster_due_ =
      roster_pages_.empty() ? std::max(next, roster_began_ + config_.roster_period) : next;
  return page;
}

std::deque<network::roster> registrar::compile_roster() {
  std::deque<network::roster> all;
  std::vector<network::roster_entry> entries;
  for (const auto& [mote, entry] : members_) {
    if (entry.announced)
      entries.push_back({mote, entry.incarnation});
  }
  ++roster_number_;
  const auto per_page = network::roster_entries_max;
  const auto pages = std::max<std::size_t>(1, (entries.size() + per_page - 1) / per_page);
  for (std::size_t page = 0; page < pages; ++page) {
    const auto first = page * per_page;
    const auto last = std::min(first + per_page, entries.size());
    network::roster x;
    x.number = roster_number_;
    x.page = static_cast<std::uint8_t>(page);
    x.pages = static_cast<std::uint8_t>(pages);
    x.entries.assign(entries.begin() + static_cast<std::ptrdiff_t>(first),
                     entries.begin() + static_cast<std::ptrdiff_t>(last));
    all.push_back(std::move(x));
  }
  return all;
}

to_mote registrar::reply_to(mote_id mote, const member& x, instant now) const {
  const auto since_start =
      std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch());
  return {mote, join_reply{x.sequence, config_.island, mote,
                           static_cast<std::uint32_t>(since_start.count()), config_.aliases}};
}

void registrar::wake_at(instant t) {
  next_expiry_ = earliest(next_expiry_, t);
}

std::optional<instant> registrar::deadline() const {
  return earliest(slots_.deadline(), earliest(next_expiry_, roster_due_));
}

std::size_t registrar::members() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(members_, [](const auto& x) { return x.second.confirmed; }));
}

} // namespace rubicon::mote
