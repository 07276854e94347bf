#include "peis/links/contact_history.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace rubicon::peis {

namespace {

constexpr duration refusing_for = 10min; // what refused us so long ago is forgotten
constexpr std::size_t refusing_max = 256;
constexpr unsigned tries_max = 30;
constexpr unsigned foreign_runs_max = 3; // CLU-02
constexpr unsigned refusals_judged = 2;  // one may be a mistake
constexpr std::size_t announcers_max = 256;
constexpr std::uint64_t dial_cost = 5; // seconds of its sender's account
constexpr duration dial_burst = 50s;

} // namespace

void contact_history::note_contact(peer_id host, instant now) {
  const auto max = own_.config.tables.contacts;
  if (contacts_.size() >= max && !contacts_.contains(host)) {
    std::erase_if(contacts_, [now](const auto& x) {
      return x.second.last + std::chrono::seconds(x.second.tries) <= now;
    });
    if (contacts_.size() >= max)
      return; // it may be tried sooner than it should
  }
  auto& x = contacts_[host];
  x.tries = std::min(x.tries + 1, tries_max);
  x.last = now;
}

duration contact_history::refused_wait(unsigned refusals) const {
  const auto& config = own_.config.connections;
  auto wait = config.refused_retry;
  for (; refusals > 0 && wait < config.refused_retry_max; --refusals)
    wait *= 2;
  return std::min(wait, config.refused_retry_max);
}

/// From the second time on, it and others of its machine that refuse us are tried by one, and ever
/// more rarely: leaves that have lost their master are many.
void contact_history::note_refusal(peer_id host, instant now) {
  const auto known = contacts_.find(host);
  const auto* record = hosts_.last_record_of(host);
  if (known == contacts_.end() || record == nullptr)
    return;
  if (++known->second.refusals < refusals_judged)
    return;
  std::erase_if(refusing_, [now](const auto& x) { return x.second.until + refusing_for <= now; });
  if (refusing_.size() >= refusing_max && !refusing_.contains(record->host_name))
    return;
  auto& machine = refusing_[record->host_name];
  if (machine.until > now)
    return; // others were tried at the same time
  machine.until = now + refused_wait(machine.refusals);
  ++machine.refusals;
}

bool contact_history::is_refused_at(peer_id host, instant now) const {
  const auto known = contacts_.find(host);
  if (known == contacts_.end() || known->second.refusals < refusals_judged)
    return false;
  const auto* record = hosts_.last_record_of(host);
  const auto machine = record == nullptr ? refusing_.end() : refusing_.find(record->host_name);
  return machine != refusing_.end() && machine->second.until > now;
}

bool contact_history::note_foreign_run(peer_id host) {
  return ++contacts_[host].runs_foreign >= foreign_runs_max;
}

/// Those beyond the table share one account.
rate_limit& contact_history::announcer_of(const ipv4_address& from, instant now) {
  if (announcers_.size() >= announcers_max)
    std::erase_if(announcers_,
                  [now](const auto& x) { return x.second.free_at() + dial_burst <= now; });
  const bool full = announcers_.size() >= announcers_max && !announcers_.contains(from);
  return announcers_
      .try_emplace(full ? ipv4_address{} : from, rate_limit(1, dial_burst, dial_cost * 1s))
      .first->second;
}

bool contact_history::has_credit(peer_id host, instant now) {
  const auto* known = hosts_.find(host);
  return known == nullptr || !known->announcer ||
         announcer_of(*known->announcer, now).free_at() <= now;
}

void contact_history::charge_announcer(peer_id host, instant now) {
  if (const auto* known = hosts_.find(host); known != nullptr && known->announcer)
    announcer_of(*known->announcer, now).take(dial_cost, now);
}

bool contact_history::may_try(peer_id host, unsigned wait_max, instant now) {
  if (links_.is_neighbour(host) || is_refused_at(host, now) || !has_credit(host, now))
    return false;
  const auto known = contacts_.find(host);
  return known == contacts_.end() ||
         known->second.last + std::chrono::seconds(std::min(known->second.tries, wait_max)) <= now;
}

} // namespace rubicon::peis
