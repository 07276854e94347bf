#include "peis/space/local_subscriptions.hpp"

#include <algorithm>

#include "peis/space/tuple_space_config.hpp"
#include "peis/subscribers/subscriber_table.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis {

local_subscriptions::addition local_subscriptions::add(const prototype& wanted, subscription_id id,
                                                       interest kind) {
  if (by_id_.contains(id))
    return {cause::bad_handle};
  if (by_id_.size() >= max_)
    return {cause::space_full};
  if (wanted.mimetype && wanted.mimetype->size() > mimetype_length_max)
    return {cause::bad_value};
  if (wanted.value && wanted.value->size() > tuple_value_max)
    return {cause::too_long};
  const subscription x{id, wanted, kind};
  by_id_.emplace(id, x);
  by_key_.insert(wanted.name, x);
  ++version_;
  return {cause::none, kind == interest::callback ? nullptr : add_question(wanted)};
}

std::optional<local_subscriptions::subscription> local_subscriptions::remove(subscription_id id) {
  auto gone = by_id_.extract(id);
  if (gone.empty())
    return std::nullopt;
  const auto& x = gone.mapped();
  by_key_.erase_if(x.wanted.name, [id](const subscription& other) { return other.id == id; });
  ++version_;
  if (x.kind == interest::subscription)
    remove_question(x.wanted);
  return std::move(gone.mapped());
}

const local_subscriptions::question* local_subscriptions::add_question(const prototype& wanted) {
  const auto [at, first] = questions_.try_emplace(identity_of(wanted));
  auto& x = at->second;
  ++x.askers;
  if (!first)
    return nullptr;
  x.wanted = wanted;
  x.serial = next_serial_++;
  by_serial_.emplace_hint(by_serial_.end(), x.serial, &x);
  return &x;
}

void local_subscriptions::remove_question(const prototype& wanted) {
  const auto at = questions_.find(identity_of(wanted));
  if (--at->second.askers > 0)
    return;
  by_serial_.erase(at->second.serial);
  questions_.erase(at);
}

bool local_subscriptions::subscribes_to(peer_id owner, const key& wanted) const {
  bool found = false;
  by_key_.for_equal(wanted, [&](const subscription& x) {
    found = found || (x.kind == interest::subscription && x.wanted.owner == owner);
  });
  return found;
}

bool local_subscriptions::wants(const tuple& x) const {
  bool found = false;
  by_key_.for_matching(x.name, [&](const subscription& s) {
    found = found || (s.kind == interest::subscription && s.wanted.matches(x));
  });
  return found;
}

bool local_subscriptions::wants_own(const key& name) const {
  bool found = false;
  by_key_.for_matching(name, [&](const subscription& x) {
    found = found || (x.kind == interest::subscription && concerns_own(x));
  });
  return found;
}

bool local_subscriptions::watches_own(const key& name) const {
  bool found = false;
  by_key_.for_matching(name, [&](const subscription& x) { found = found || concerns_own(x); });
  return found;
}

std::vector<subscription_id> local_subscriptions::interested(const tuple& x) const {
  std::vector<subscription_id> ids;
  by_key_.for_matching(x.name, [&](const subscription& s) {
    if (s.wanted.matches(x))
      ids.push_back(s.id);
  });
  std::sort(ids.begin(), ids.end());
  return ids;
}

void local_subscriptions::notify_changed(const tuple_pointer& x, tuple_events& out) const {
  for (const auto id : interested(*x))
    out.push_back(tuple_changed{id, x});
}

void local_subscriptions::notify_deleted(const tuple_pointer& x, tuple_events& out) const {
  for (const auto id : interested(*x))
    out.push_back(tuple_deleted{id, x});
}

const local_subscriptions::question*
local_subscriptions::find_question(std::uint64_t serial) const {
  const auto at = by_serial_.find(serial);
  return at == by_serial_.end() ? nullptr : at->second;
}

const local_subscriptions::question*
local_subscriptions::next_question(std::uint64_t serial) const {
  const auto at = by_serial_.lower_bound(serial);
  return at == by_serial_.end() ? nullptr : at->second;
}

transmit local_subscriptions::request_to(peer_id host, bool marked, const prototype& wanted,
                                         bool refresh) const {
  subscribe_message message{wanted, std::nullopt};
  if (marked) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(lifetime_).count();
    message.lifetime = lifetime_tag{refresh, static_cast<std::uint8_t>(seconds)};
  }
  return {host, port::subscribe, {encode(message), {}}, no_request};
}

} // namespace rubicon::peis
