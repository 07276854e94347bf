#include "peis/overlay/id_rivalry.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr duration newcomer_for = 30s;
// From the first sign of the other to our leaving: each leaves the one before the time to be gone.
constexpr duration newcomer_leaves = 2s;
constexpr duration lower_newcomer_leaves = 8s;
constexpr duration settled_leaves = 15s;
constexpr duration sign_is_fresh = 3s;
constexpr duration rivalry_ends = 10s; // after the last sign
constexpr duration away_first = 15s;   // doubles each time
constexpr duration away_max = 2min;

} // namespace

id_rivalry::outputs id_rivalry::note(const host_record& other, instant now) {
  outputs out;
  if (std::exchange(reported_, other.magic) != other.magic)
    out.emplace_back(id_taken{other.full_name, {}});
  if (away_until_)
    away_until_ = std::max(*away_until_, now + away_first);
  else if (other_ && other_->record.magic == other.magic)
    other_->last = now;
  else if (!ended_)
    other_ = rival{other, now, now, now};
  return out;
}

/// When we leave the id to the other if it goes on showing that it is there.
std::optional<instant> id_rivalry::yields_at() const {
  const auto& first = other_->first;
  const bool first_to_leave = magic_ > other_->record.magic || !other_->record.marked;
  if (first < joined_ + newcomer_for)
    return first + (first_to_leave ? newcomer_leaves : lower_newcomer_leaves);
  return first_to_leave ? std::optional(first + settled_leaves) : std::nullopt;
}

std::optional<instant> id_rivalry::deadline() const {
  if (away_until_ || !other_)
    return away_until_;
  const auto at = yields_at();
  if (at && *at > other_->checked)
    return at;
  if (at && other_->last > other_->checked)
    return other_->last; // another sign when it was due
  return other_->last + rivalry_ends;
}

id_rivalry::outputs id_rivalry::on_time(instant now) {
  outputs out;
  if (away_until_ && *away_until_ <= now) {
    away_until_.reset();
    joined_ = now;
    reported_.reset(); // reported again if it is still there
    out.emplace_back(id_regained{});
  }
  if (!other_)
    return out;
  other_->checked = now;
  const auto at = yields_at();
  const bool goes_on = other_->last > other_->first && other_->last + sign_is_fresh >= now;
  if (at && *at <= now && goes_on) {
    const bool again = joined_ + newcomer_for > now;
    away_for_ = again ? std::clamp(2 * away_for_, away_first, away_max) : away_first;
    away_until_ = now + away_for_;
    out.emplace_back(id_taken{other_->record.full_name, away_for_});
    other_.reset();
  } else if (other_->last + rivalry_ends <= now)
    other_.reset();
  return out;
}

} // namespace rubicon::peis
