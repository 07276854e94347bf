#include "smepp/groups/member_table.hpp"

#include <algorithm>

#include "core/hash.hpp"
#include "network/wire.hpp"

namespace rubicon::smepp {

namespace {

/// Whether `x` holds against what is known of the same peer.
bool is_news(const member& x, const member& known) {
  if (x.stamp != known.stamp)
    return network::is_newer(x.stamp, known.stamp);
  if (x.has_left != known.has_left)
    return known.has_left;
  if (x.who.transducers != known.who.transducers)
    return x.who.transducers > known.who.transducers;
  return x.identity > known.identity;
}

} // namespace

member_table::change member_table::learn(const member& x) {
  const auto at = std::ranges::lower_bound(all_, x.who.peer, {},
                                           [](const member& each) { return each.who.peer; });
  if (at != all_.end() && at->who.peer == x.who.peer) {
    if (!is_news(x, *at))
      return change::none;
    const bool was_there = !at->has_left;
    const bool is_other = x.identity != at->identity;
    *at = x;
    if (was_there == !x.has_left)
      return was_there && is_other ? change::replaced : change::updated;
    return x.has_left ? change::left : change::joined;
  }
  if (all_.size() >= capacity_) {
    const auto gone = std::ranges::find_if(all_, &member::has_left);
    if (x.has_left || gone == all_.end())
      return change::no_room;
    all_.erase(gone);
    return learn(x);
  }
  all_.insert(at, x);
  return x.has_left ? change::updated : change::joined;
}

const member* member_table::find(mote_id peer) const {
  const auto found =
      std::ranges::find_if(all_, [&](const member& x) { return x.who.peer == peer; });
  return found == all_.end() ? nullptr : &*found;
}

bool member_table::has(mote_id peer) const {
  const auto* const x = find(peer);
  return x != nullptr && !x->has_left;
}

bool member_table::has_room() const {
  return all_.size() < capacity_ || std::ranges::any_of(all_, &member::has_left);
}

std::size_t member_table::present() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(all_, [](const member& x) { return !x.has_left; }));
}

std::size_t member_table::rank(mote_id peer) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      all_, [&](const member& x) { return !x.has_left && x.who.peer < peer; }));
}

std::vector<peer_description> member_table::descriptions() const {
  std::vector<peer_description> present;
  for (const auto& x : all_)
    if (!x.has_left)
      present.push_back(x.who);
  return present;
}

std::uint16_t member_table::digest() const {
  fold64 fold;
  for (const auto& x : all_)
    if (!x.has_left)
      fold.add(x.who.peer.value).add(x.who.transducers).add(x.stamp).add(byte_view(x.identity));
  return static_cast<std::uint16_t>(fold.value());
}

std::vector<member_list> member_table::lists() const {
  std::vector<member_list> lists;
  for (std::size_t i = 0; i < all_.size(); i += member_list::count_max) {
    const auto count = std::min(member_list::count_max, all_.size() - i);
    const auto from = all_.begin() + static_cast<std::ptrdiff_t>(i);
    lists.push_back({{from, from + static_cast<std::ptrdiff_t>(count)}});
  }
  return lists;
}

} // namespace rubicon::smepp
