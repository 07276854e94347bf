#include "network/tree/neighbours.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace rubicon::network {

namespace {

constexpr int weight_max = 16; ///< of the past against one sample

/// Moves `x` one sample towards all or nothing. `samples` are behind it; half a sample stood at the
/// beginning.
quality moved(quality x, bool success, int samples) {
  const int divisor = std::min(samples + 2, weight_max);
  const int target = success ? quality_max : 0;
  return static_cast<quality>(x + (target - x) / divisor);
}

quality product(quality a, quality b) {
  return static_cast<quality>(static_cast<std::uint32_t>(a) * b / quality_max);
}

constexpr quality start_quality = quality_max / 2;
/// Whoever is new beacons often, and whoever is said to be there but is not makes room soon.
constexpr duration young_gap_max = 24s;
constexpr quality crowd_discount = quality_of(0.75);

/// Numbers start at 1 after a restart: a long gap is one if it is a jump back, or to one of the
/// first numbers. Otherwise so many beacons were missed.
bool is_restart(std::uint16_t sequence, std::uint16_t gap) {
  const bool is_back = gap > std::numeric_limits<std::uint16_t>::max() / 2;
  return is_back || sequence <= neighbours_config::sequence_gap_max;
}

} // namespace

neighbour* neighbours::entry(mote_id mote) {
  const auto* found = find(mote);
  return found ? &table_[static_cast<std::size_t>(found - table_.data())] : nullptr;
}

/// A binary search without branches that cannot be predicted: every frame is looked up several
/// times.
const neighbour* neighbours::find(mote_id mote) const {
  const auto* first = table_.data();
  for (auto count = table_.size(); count > 1;) {
    const auto half = count / 2;
    first += first[half].mote <= mote ? half : 0;
    count -= half;
  }
  return !table_.empty() && first->mote == mote ? first : nullptr;
}

/// Where a neighbour's table has no room for us it cannot report what it receives of us: about as
/// much as we of it, until unicasts show better.
std::optional<quality> neighbours::likely_out(const neighbour& x) {
  if (x.out || !x.crowded)
    return x.out;
  return product(x.in, crowd_discount);
}

quality neighbours::both_ways(const neighbour& x) const {
  const auto out = likely_out(x);
  const std::uint32_t beacons = out ? product(x.in, *out) : 0U;
  const std::uint32_t weight = x.data_weight;
  return static_cast<quality>((beacons * (weight_max - weight) + x.data * weight) / weight_max);
}

/// Whether more beacons in a row are overdue than such a link loses by chance.
bool neighbours::is_silent(const neighbour& x) const {
  const int allowance = (x.in < quality_of(0.75) ? 1 : 0) + (x.in < quality_of(0.5) ? 1 : 0);
  return x.missed >= config_.unusable_missed + allowance;
}

/// Whether the last two unicasts over a backbone were not acknowledged; a beacon gives it its
/// chance again.
bool neighbours::fails(const neighbour& x) {
  return x.data_weight > 0 && x.data < quality_max / 2;
}

duration neighbours::gap_max(const neighbour& x) const {
  const bool is_young = x.samples < config_.good_samples;
  return is_young ? std::min(young_gap_max, config_.beacon_gap_max) : config_.beacon_gap_max;
}

void neighbours::sample(neighbour& x, bool heard) const {
  x.in = moved(x.in, heard, x.samples);
  if (x.samples < 255)
    ++x.samples;
}

/// Decides whether the link is good, with hysteresis.
void neighbours::judge(neighbour& x) const {
  const auto limit = x.good ? config_.bad_below : config_.good_from;
  x.good = x.samples >= config_.good_samples && x.missed < config_.bad_missed && x.in >= limit &&
           x.out && *x.out >= limit && both_ways(x) >= product(limit, limit);
}

void neighbours::take_report(neighbour& x, const link_report& report, instant now) const {
  sample(x, true);
  x.sequence = report.sequence;
  x.crowded = report.is_crowded;
  x.missed = 0;
  x.heard = now;
  x.period = std::min(report.next, gap_max(x));
  x.due = now + x.period + config_.beacon_slack;
  if (x.data_weight > 0)
    --x.data_weight; // a link that fell into disuse gets its chance again
  if (report.hears_us) {
    x.out = static_cast<quality>(*report.hears_us * 257);
    x.unmentioned = 0;
  } else if (++x.unmentioned >= config_.unmentioned_max) {
    x.out.reset();
    x.unmentioned = config_.unmentioned_max;
  }
  judge(x);
}

admission neighbours::on_beacon(const link_report& x, instant now) {
  ++changes_;
  auto* known = entry(x.source);
  if (!known)
    return admit(x, now);
  const auto gap = static_cast<std::uint16_t>(x.sequence - known->sequence);
  if (gap == 0) {
    ++counters_.repeated;
    return admission::repeated;
  }
  if (gap > config_.sequence_gap_max) { // what was known of the link is of another time
    const neighbour old = *known;
    *known = neighbour{};
    known->mote = old.mote;
    known->pinned = old.pinned;
    known->in = start_quality;
    take_report(*known, x, now);
    refresh_deadline();
    if (!is_restart(x.sequence, gap))
      return admission::added;
    ++counters_.restarted;
    return admission::restarted;
  }
  for (int lost = gap - 1 - known->missed; lost > 0; --lost)
    sample(*known, false); // the overdue ones are in already
  const auto was_due = known->due;
  take_report(*known, x, now);
  if (was_due == deadline_ || known->due < *deadline_)
    refresh_deadline();
  return admission::known;
}

admission neighbours::admit(const link_report& x, instant now) {
  const bool was_full = is_full();
  if (was_full && !make_room(x, now)) {
    ++counters_.refused;
    return admission::refused;
  }
  neighbour fresh;
  fresh.mote = x.source;
  fresh.in = start_quality;
  take_report(fresh, x, now);
  table_.insert(std::ranges::lower_bound(table_, x.source, {}, &neighbour::mote), fresh);
  refresh_deadline();
  return was_full && !x.matters ? admission::replaced : admission::added;
}

bool neighbours::evict(std::vector<neighbour>::iterator x) {
  if (x == table_.end())
    return false;
  table_.erase(x);
  ++counters_.evicted;
  return true;
}

bool neighbours::make_room(const link_report& newcomer, instant now) {
  if (!newcomer.matters && replaced_ && now < *replaced_ + config_.replacement_gap)
    return false;
  // The last of the worst: the table ascends by id.
  const auto worst = [this](auto matches, auto badness) {
    auto found = table_.end();
    for (auto at = table_.begin(); at != table_.end(); ++at) {
      if (!at->pinned && matches(*at) && (found == table_.end() || badness(*at) >= badness(*found)))
        found = at;
    }
    return found;
  };
  const auto settled = [this](const neighbour& x) { return x.samples >= config_.good_samples; };
  const auto weakness = [this](const neighbour& x) { return quality_max - both_ways(x); };
  const bool is_done =
      evict(worst([this](const neighbour& x) { return is_silent(x); },
                  [](const neighbour& x) { return x.missed; })) ||
      evict(worst([&](const neighbour& x) { return settled(x) && !x.out; }, weakness)) ||
      evict(worst([&](const neighbour& x) { return settled(x) && !x.good; }, weakness)) ||
      (newcomer.matters && evict(worst(settled, weakness))) ||
      (newcomer.is_sink && evict(worst([](const neighbour&) { return true; }, weakness)));
  if (is_done && !newcomer.matters)
    replaced_ = now;
  return is_done;
}

/// Beacons that are overdue prove nothing against it any more; the next one may take as long as the
/// last was to.
void neighbours::alive(neighbour& x, instant now) {
  const bool was_next = x.due == deadline_;
  x.missed = 0;
  x.heard = now;
  x.due = std::max(x.due, now + x.period + config_.beacon_slack);
  if (was_next)
    refresh_deadline();
}

void neighbours::hear(mote_id from, instant now) {
  auto* x = entry(from);
  if (!x || x->missed == 0)
    return;
  ++changes_;
  alive(*x, now);
  judge(*x);
}

void neighbours::on_sent(mote_id to, bool acked, unsigned transmissions, instant now) {
  auto* x = entry(to);
  if (!x)
    return;
  ++changes_;
  if (acked)
    alive(*x, now);
  if (has_backbone(to)) { // it carries everything, or nothing
    const quality before = x->data_weight > 0 ? x->data : quality_max;
    x->data = acked ? quality_max : before / 2;
    x->data_weight = 1;
    return;
  }
  for (unsigned i = 1; i <= std::min(transmissions, 255U); ++i) {
    if (x->data_weight == 0)
      x->data = start_quality;
    x->data = moved(x->data, acked && i == transmissions, x->data_weight);
    x->data_weight = static_cast<std::uint8_t>(std::min(x->data_weight + 1, weight_max));
  }
  judge(*x);
}

std::vector<mote_id> neighbours::on_time(instant now) {
  std::vector<mote_id> gone;
  if (!deadline_ || now < *deadline_)
    return gone;
  ++changes_;
  for (auto& x : table_) {
    while (now >= x.due && x.missed < config_.dropped_missed) {
      sample(x, false);
      ++x.missed;
      // Its intervals double; when the first is overdue, it is not known where it is in them.
      x.period = std::clamp(3 * x.period, duration(config_.beacon_slack), gap_max(x));
      x.due += x.period;
    }
    judge(x);
    if (x.missed >= config_.dropped_missed)
      gone.push_back(x.mote);
  }
  counters_.dropped += gone.size();
  std::erase_if(table_, [this](const neighbour& x) { return x.missed >= config_.dropped_missed; });
  refresh_deadline();
  return gone;
}

void neighbours::refresh_deadline() {
  deadline_.reset();
  if (!table_.empty())
    deadline_ = std::ranges::min(table_, {}, &neighbour::due).due;
}

void neighbours::pin(mote_id mote, bool pinned) {
  if (auto* x = entry(mote))
    x->pinned = pinned;
}

std::vector<neighbours::heard_entry> neighbours::heard(std::size_t count) {
  std::vector<heard_entry> listed;
  listed.reserve(std::min(count, table_.size()));
  auto at = std::ranges::upper_bound(table_, listed_last_, {}, &neighbour::mote);
  for (std::size_t i = 0; i < table_.size() && listed.size() < count; ++i, ++at) {
    if (at == table_.end())
      at = table_.begin();
    if (at->missed >= config_.bad_missed)
      continue;
    listed.push_back({at->mote, static_cast<std::uint8_t>(at->in / 257)});
    listed_last_ = at->mote;
  }
  return listed;
}

std::optional<etx_cost> neighbours::etx(mote_id mote) const {
  const auto* x = find(mote);
  return x ? etx(*x) : std::nullopt;
}

std::optional<etx_cost> neighbours::etx(const neighbour& x) const {
  if (has_backbone(x.mote))
    return is_silent(x) || fails(x) ? std::nullopt : std::optional(etx_backbone);
  const auto arrives = both_ways(x);
  if (!likely_out(x) || x.samples < config_.usable_samples || is_silent(x) || arrives == 0 ||
      arrives < config_.usable_from)
    return {};
  const auto cost = static_cast<std::uint32_t>(etx_one) * quality_max / arrives;
  return static_cast<etx_cost>(std::min<std::uint32_t>(cost, etx_infinite - 1));
}

bool neighbours::good(mote_id mote) const {
  const auto* x = find(mote);
  return x && x->good;
}

std::size_t neighbours::footprint() const {
  // id, sequence, in, data, samples, out, unmentioned, missed and data_weight in one octet, flags;
  // due as milliseconds of 32 bits, the period in quarters of a second (`heard` decides nothing)
  return config_.capacity * (2 + 2 + 2 + 2 + 1 + 1 + 1 + 1 + 1 + 4 + 1) + 2 + 4;
}

} // namespace rubicon::network
