#include "smepp/discovery.hpp"

#include <algorithm>

#include "smepp/handshake.hpp"

namespace rubicon::smepp {

void discovery::ask(const group_filter& x, security& security, instant now) {
  found_.clear();
  search_ = {x, security.unique(), now + config_.patience, now};
}

std::optional<group_description> discovery::description_of(mote_id from, const answer& x) const {
  group_description description;
  auto name = x.name;
  if (x.is_private) {
    const auto& master = search_->filter.master;
    if (!master || !is_same(x.proof, discovery_tag(*master, x.nonce, from, x.group)))
      return std::nullopt;
    name = hidden_name(*master, x.nonce, from, x.name);
  }
  description.name = rubicon::to_string(name);
  description.is_closed = x.is_closed;
  description.is_private = x.is_private;
  description.master = search_->filter.master;
  description.management = {std::chrono::milliseconds(x.period_ms),
                            std::chrono::milliseconds(x.length_ms)};
  if (!is_name(description.name, group_description::name_max) ||
      !search_->filter.matches(description))
    return std::nullopt;
  return description;
}

void discovery::on_answer(mote_id from, const answer& x, instant now) {
  if (!search_ || x.nonce != search_->nonce)
    return;
  const auto description = description_of(from, x);
  if (!description)
    return;
  auto found = std::ranges::find(found_, x.group, &found_group::id);
  if (found == found_.end()) {
    if (found_.size() >= config_.groups_max) {
      ++no_room_;
      return;
    }
    found_.push_back({x.group, *description, {}, x.time, now});
    found = found_.end() - 1;
  }
  found->time = x.time;
  found->told_at = now;
  if (std::ranges::find(found->members, from) == found->members.end() &&
      found->members.size() < config_.members_max)
    found->members.push_back(from);
}

void discovery::on_time(actions& out, instant now) {
  if (!search_)
    return;
  if (now >= search_->until) {
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
    question.proof = discovery_tag(*filter.master, search_->nonce, config_.self, network_level);
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
