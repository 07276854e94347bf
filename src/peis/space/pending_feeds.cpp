#include "peis/space/pending_feeds.hpp"

#include <algorithm>

namespace rubicon::peis {

namespace {

constexpr std::size_t undelivered_total_factor = 64; ///< of the limit for one host

} // namespace

pending_feed* pending_feeds::find(peer_id host) {
  const auto at = feeds_.find(host);
  return at == feeds_.end() ? nullptr : &at->second.feed;
}

const pending_feed* pending_feeds::find(peer_id host) const {
  const auto at = feeds_.find(host);
  return at == feeds_.end() ? nullptr : &at->second.feed;
}

pending_feed& pending_feeds::open(peer_id host) {
  return feeds_[host].feed;
}

void pending_feeds::close(peer_id host) {
  const auto at = feeds_.find(host);
  if (at == feeds_.end())
    return;
  undelivered_ -= at->second.feed.undelivered.size();
  if (at->second.due)
    agenda_.erase({*at->second.due, host});
  feeds_.erase(at);
}

bool pending_feeds::add_undelivered(peer_id host, const std::string& folded,
                                    std::optional<instant> failing_since) {
  const auto [at, first] = open(host).undelivered.try_emplace(folded, failing_since);
  if (!first)
    at->second = at->second ? at->second : failing_since;
  undelivered_ += first ? 1 : 0;
  return first;
}

bool pending_feeds::remove_undelivered(peer_id host, std::string_view folded) {
  auto* feed = find(host);
  const auto at = feed != nullptr ? feed->undelivered.find(folded)
                                  : pending_feed::undelivered_values::iterator();
  if (feed == nullptr || at == feed->undelivered.end())
    return false;
  feed->undelivered.erase(at);
  --undelivered_;
  return true;
}

void pending_feeds::clear_undelivered(peer_id host) {
  if (auto* feed = find(host)) {
    undelivered_ -= feed->undelivered.size();
    feed->undelivered.clear();
  }
}

bool pending_feeds::has_too_many(peer_id host, std::size_t max) const {
  const auto* feed = find(host);
  if (feed == nullptr)
    return false;
  const auto count = feed->undelivered.size();
  const bool many_in_all = undelivered_ > undelivered_total_factor * max;
  return count > max || (many_in_all && count > undelivered_ / feeds_.size());
}

void pending_feeds::schedule(peer_id host, std::optional<instant> due) {
  auto& x = feeds_.at(host);
  if (x.due == due)
    return;
  if (x.due)
    agenda_.erase({*x.due, host});
  x.due = due;
  if (due) {
    agenda_.emplace(*due, host);
    next_ = earliest(next_, due);
  }
}

std::optional<instant> pending_feeds::due(peer_id host) const {
  const auto at = feeds_.find(host);
  return at == feeds_.end() ? std::nullopt : at->second.due;
}

std::optional<peer_id> pending_feeds::take_due(instant now) {
  if (agenda_.empty() || agenda_.begin()->first > now)
    return std::nullopt;
  const auto host = agenda_.begin()->second;
  schedule(host, std::nullopt);
  return host;
}

void pending_feeds::pause(instant until) {
  next_.reset();
  if (!agenda_.empty())
    next_ = std::max(agenda_.begin()->first, until);
}

} // namespace rubicon::peis
