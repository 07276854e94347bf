#include "smepp/groups/discovery.hpp"

#include <algorithm>

#include "smepp/crypto/handshake.hpp"

namespace rubicon::smepp {

namespace {

bool is_before(const found_member& a, const found_member& b) {
  if (a.is_proven != b.is_proven)
    return a.is_proven;
  return a.description.management.period < b.description.management.period;
}

bool is_proven(const found_group& x) {
  return x.members.front().is_proven;
}

} // namespace

void discovery::ask(const group_filter& x, security& security, instant now) {
  found_.clear();
  const auto nonce = security.unique();
  search_ = {x, nonce.value_or(0), nonce ? now + config_.patience : now, now};
}

std::optional<found_member> discovery::read(mote_id from, const answer& x, instant now) const {
  const auto& master = search_->filter.master;
  found_member candidate{from, {}, false, x.time, now};
  candidate.is_proven =
      master && x.proof && is_same(*x.proof, answer_tag(*master, config_.self, from, x));
  if (x.is_private && !candidate.is_proven)
    return std::nullopt;
  auto& description = candidate.description;
  description.name =
      rubicon::to_string(x.is_private ? hidden_name(*master, config_.self, from, x) : x.name);
  description.is_closed = x.is_closed;
  description.is_private = x.is_private;
  description.master = master;
  description.management = {std::chrono::milliseconds(x.period_ms),
                            std::chrono::milliseconds(x.length_ms)};
  if (!is_name(description.name, group_description::name_max) ||
      !search_->filter.matches(description))
    return std::nullopt;
  return candidate;
}

/// Nothing: there is no room.
found_group* discovery::place_for(group_id group, bool proven) {
  const auto found = std::ranges::find(found_, group, &found_group::id);
  if (found != found_.end())
    return &*found;
  if (found_.size() >= config_.groups_max) {
    ++no_room_;
    const auto victim = std::ranges::find_if_not(found_, is_proven);
    if (!proven || victim == found_.end())
      return nullptr;
    found_.erase(victim);
  }
  return &found_.emplace_back(found_group{group, {}});
}

void discovery::on_answer(mote_id from, const answer& x, instant now) {
  if (!search_ || x.nonce != search_->nonce)
    return;
  const auto candidate = read(from, x, now);
  if (!candidate)
    return;
  auto* const place = place_for(x.group, candidate->is_proven);
  if (place == nullptr)
    return;
  auto& members = place->members;
  if (!candidate->is_proven && std::ranges::any_of(members, [&](const found_member& each) {
        return each.who == from && each.is_proven;
      }))
    return; // somebody else in its name
  // Two different descriptions in one name are two candidates.
  std::erase_if(members, [&](const found_member& each) {
    return each.who == from && (candidate->is_proven || each.description == candidate->description);
  });
  members.insert(std::ranges::upper_bound(members, *candidate, is_before), *candidate);
  if (members.size() > config_.members_max)
    members.pop_back();
}

void discovery::on_time(actions& out, instant now) {
  if (!search_)
    return;
  if (now >= search_->until) {
    std::stable_partition(found_.begin(), found_.end(), is_proven);
    getGroups_result result;
    for (const auto& x : found_)
      result.groups.push_back(x.id);
    search_.reset();
    out.push_back(signal{result});
    return;
  }
  if (now < search_->next)
    return;
  search_->next = now + config_.interval;
  const auto& filter = search_->filter;
  discover question{search_->nonce, filter.is_closed, filter.is_private, std::nullopt,
                    filter.name.value_or("")};
  if (filter.master)
    question.proof = question_tag(*filter.master, search_->nonce, config_.self);
  out.push_back(to_send{broadcast_mote, network_level, question, slot::at_once});
}

std::optional<instant> discovery::deadline() const {
  if (!search_)
    return std::nullopt;
  return std::min(search_->next, search_->until);
}

const found_group* discovery::find(group_id group) const {
  const auto found = std::ranges::find(found_, group, &found_group::id);
  return found == found_.end() ? nullptr : &*found;
}

} // namespace rubicon::smepp
