#include "smepp/crypto/session_keys.hpp"

#include <algorithm>
#include <cassert>

#include "network/wire.hpp"

namespace rubicon::smepp {

bool is_better(session_id a, session_id b) {
  if (a.generation != b.generation)
    return network::is_newer(a.generation, b.generation);
  return a.maker < b.maker;
}

bool session_ring::learn(const session_keys& x, instant send_from, instant now) {
  if (find(x.id) != nullptr)
    return false;
  const auto at = std::ranges::find_if(
      pairs_, [&](const pair& other) { return is_better(x.id, other.session.id); });
  const bool is_best = at == pairs_.begin();
  pair added{x, send_from, std::nullopt};
  if (!is_best)
    added.until = std::max(now, best_from()) + grace_;
  pairs_.insert(at, added);
  if (is_best)
    for (std::size_t i = 1; i < pairs_.size(); ++i) {
      const auto until = send_from + grace_;
      pairs_[i].until = pairs_[i].until ? std::min(*pairs_[i].until, until) : until;
    }
  if (pairs_.size() > capacity) {
    pairs_.pop_back();
    ++evicted_;
  }
  return is_best;
}

session_id session_ring::sending(instant now) const {
  assert(!pairs_.empty());
  const auto found =
      std::ranges::find_if(pairs_, [&](const pair& x) { return x.send_from <= now; });
  return found == pairs_.end() ? best().id : found->session.id;
}

const session_keys* session_ring::find(session_id id) const {
  const auto found =
      std::ranges::find_if(pairs_, [&](const pair& x) { return x.session.id == id; });
  return found == pairs_.end() ? nullptr : &found->session;
}

std::vector<session_keys> session_ring::accepted() const {
  std::vector<session_keys> all;
  all.reserve(pairs_.size());
  for (const auto& x : pairs_)
    all.push_back(x.session);
  return all;
}

bool session_ring::on_time(instant now) {
  return std::erase_if(pairs_, [&](const pair& x) { return x.until && *x.until <= now; }) > 0;
}

std::optional<instant> session_ring::deadline() const {
  std::optional<instant> first;
  for (const auto& x : pairs_)
    first = earliest(first, x.until);
  return first;
}

} // namespace rubicon::smepp
