#include "smepp/crypto/replay_windows.hpp"

#include <algorithm>
#include <cassert>

namespace rubicon::smepp {

namespace {

constexpr std::uint64_t width = 32;

} // namespace

std::optional<std::size_t> replay_windows::find(mote_id sender, group_id group,
                                                key_order under) const {
  const auto found = std::ranges::find_if(windows_, [&](const window& x) {
    return x.sender == sender && x.group == group && x.under == under;
  });
  if (found == windows_.end())
    return std::nullopt;
  return static_cast<std::size_t>(found - windows_.begin());
}

/// It has a window, and these keys were not known when that one began.
bool replay_windows::may_go_on(mote_id sender, group_id group, key_order under) const {
  return std::ranges::any_of(windows_, [&](const window& x) {
    return x.sender == sender && x.group == group && x.newest < under;
  });
}

replay_windows::window& replay_windows::to_front(std::size_t at) {
  const auto first = windows_.begin();
  std::rotate(first, first + static_cast<std::ptrdiff_t>(at),
              first + static_cast<std::ptrdiff_t>(at) + 1);
  return windows_.front();
}

/// All windows of the sender that was silent for longest go at once: one that was left would make
/// it believed under keys whose window has gone.
void replay_windows::make_room() {
  const auto is_of = [](const window& a, const window& b) {
    return a.sender == b.sender && a.group == b.group;
  };
  auto victim = windows_.front();
  for (auto at = windows_.begin(); at != windows_.end(); ++at)
    if (std::none_of(windows_.begin(), at, [&](const window& x) { return is_of(x, *at); }))
      victim = *at;
  std::erase_if(windows_, [&](const window& x) { return is_of(x, victim); });
  ++evicted_;
}

void replay_windows::insert(const window& x) {
  if (capacity_ == 0)
    return;
  if (windows_.size() >= capacity_)
    make_room();
  windows_.insert(windows_.begin(), x);
}

replay_windows::verdict replay_windows::judge(mote_id sender, group_id group, key_order under,
                                              std::uint64_t counter) const {
  const auto at = find(sender, group, under);
  if (!at)
    return may_go_on(sender, group, under) ? verdict::fresh : verdict::unknown;
  const auto& x = windows_[*at];
  if (counter > x.highest)
    return counter - x.highest > jump_max ? verdict::unknown : verdict::fresh;
  const auto behind = x.highest - counter;
  if (behind > jump_max)
    return verdict::unknown;
  return behind >= width || (x.seen >> behind & 1) != 0 ? verdict::replayed : verdict::fresh;
}

void replay_windows::accept(mote_id sender, group_id group, key_order under,
                            std::uint64_t counter) {
  assert(judge(sender, group, under, counter) == verdict::fresh);
  const auto at = find(sender, group, under);
  if (!at) // it goes on under keys that nothing of it has been taken under
    return insert({sender, group, under, under, counter, 1});
  auto& x = to_front(*at);
  if (counter > x.highest) {
    const auto step = counter - x.highest;
    x.seen = (step < width ? x.seen << step : 0) | 1;
    x.highest = counter;
  } else {
    x.seen |= std::uint32_t{1} << (x.highest - counter);
  }
}

void replay_windows::begin(mote_id sender, group_id group, key_order under, key_order newest,
                           std::uint64_t counter) {
  // What came before the proof may be a recording.
  const window begun{sender, group, under, newest, counter, ~std::uint32_t{0}};
  if (const auto at = find(sender, group, under)) {
    const auto before = windows_[*at].newest;
    auto& x = to_front(*at);
    x = begun;
    x.newest = std::max(before, newest);
    return;
  }
  insert(begun);
}

void replay_windows::forget(group_id group, key_order under) {
  std::erase_if(windows_, [&](const window& x) { return x.group == group && x.under == under; });
}

void replay_windows::forget(group_id group) {
  std::erase_if(windows_, [&](const window& x) { return x.group == group; });
}

} // namespace rubicon::smepp
