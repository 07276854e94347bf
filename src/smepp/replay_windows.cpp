#include "smepp/replay_windows.hpp"

#include <algorithm>
#include <cassert>

namespace rubicon::smepp {

namespace {

constexpr std::uint32_t width = 32;

} // namespace

std::optional<std::size_t> replay_windows::find(mote_id sender, group_id group) const {
  const auto found = std::ranges::find_if(
      windows_, [&](const window& x) { return x.sender == sender && x.group == group; });
  if (found == windows_.end())
    return std::nullopt;
  return static_cast<std::size_t>(found - windows_.begin());
}

replay_windows::window& replay_windows::to_front(std::size_t at) {
  const auto first = windows_.begin();
  std::rotate(first, first + static_cast<std::ptrdiff_t>(at),
              first + static_cast<std::ptrdiff_t>(at) + 1);
  return windows_.front();
}

replay_windows::verdict replay_windows::judge(mote_id sender, group_id group,
                                              std::uint32_t counter) const {
  const auto at = find(sender, group);
  if (!at)
    return verdict::unknown;
  const auto& x = windows_[*at];
  if (counter > x.highest)
    return verdict::fresh;
  const auto behind = x.highest - counter;
  return behind >= width || (x.seen >> behind & 1) != 0 ? verdict::replayed : verdict::fresh;
}

void replay_windows::accept(mote_id sender, group_id group, std::uint32_t counter) {
  assert(judge(sender, group, counter) == verdict::fresh);
  auto& x = to_front(*find(sender, group));
  if (counter > x.highest) {
    const auto step = counter - x.highest;
    x.seen = (step < width ? x.seen << step : 0) | 1;
    x.highest = counter;
  } else {
    x.seen |= std::uint32_t{1} << (x.highest - counter);
  }
}

void replay_windows::begin(mote_id sender, group_id group, std::uint32_t counter) {
  // What came before the proof may be a recording.
  const window begun{sender, group, counter, ~std::uint32_t{0}};
  if (const auto at = find(sender, group)) {
    auto& x = to_front(*at);
    if (counter > x.highest)
      x = begun;
    return;
  }
  if (capacity_ == 0)
    return;
  if (windows_.size() >= capacity_) {
    windows_.pop_back();
    ++evicted_;
  }
  windows_.insert(windows_.begin(), begun);
}

void replay_windows::forget(group_id group) {
  std::erase_if(windows_, [&](const window& x) { return x.group == group; });
}

} // namespace rubicon::smepp
