#include "network/places/coordinates.hpp"

#include <algorithm>
#include <cstdlib>
#include <tuple>
#include <utility>

namespace rubicon::network {

namespace {

std::uint32_t squared(hop_distance a, hop_distance b) {
  const auto difference = a > b ? a - b : b - a;
  return static_cast<std::uint32_t>(difference * difference);
}

std::uint8_t octet_of(const anchor_entry& x) {
  return x.was ? static_cast<std::uint8_t>(x.hops | anchor_entry::was_bit) : x.hops;
}

/// @returns `least` and one more
hop_distance one_hop_on(hop_distance least) {
  return least > hop_distance_max ? hops_unknown : static_cast<hop_distance>(least + 1);
}

std::array<mote_id, anchor_count> ids(const coordinates_part& x) {
  std::array<mote_id, anchor_count> found;
  std::ranges::transform(x.anchors, found.begin(), &anchor_entry::mote);
  return found;
}

} // namespace

std::uint32_t squared_distance(virtual_coordinates a, virtual_coordinates b) {
  return squared(a.x, b.x) + squared(a.y, b.y) + squared(a.z, b.z);
}

int hops_between(virtual_coordinates a, virtual_coordinates b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

bool is_better(const anchor_candidate& a, const anchor_candidate& b) {
  if (a.mote == no_mote || b.mote == no_mote)
    return a.mote != no_mote;
  return std::tuple(a.score, a.tie, b.mote) > std::tuple(b.score, b.tie, a.mote);
}

void coordinates_part::write(byte_writer& out) const {
  out.big(epoch);
  for (const auto& x : anchors)
    out.big(x.mote.value).big(x.sequence).octet(octet_of(x));
  out.big(candidate.mote.value).octet(candidate.score).octet(candidate.tie);
}

coordinates_part coordinates_part::read(byte_reader& in) {
  coordinates_part x;
  x.epoch = in.big<std::uint16_t>();
  for (auto& entry : x.anchors) {
    entry.mote = mote_id{in.big<std::uint16_t>()};
    entry.sequence = in.big<std::uint16_t>();
    const auto hops = in.octet();
    entry.was = hops != hops_unknown && (hops & anchor_entry::was_bit) != 0;
    entry.hops = entry.was ? hops & hop_distance{0x7f} : hops;
  }
  x.candidate.mote = mote_id{in.big<std::uint16_t>()};
  x.candidate.score = in.octet();
  x.candidate.tie = in.octet();
  return x;
}

coordinates::coordinates(coordinates_config config, instant now)
    : config_(config), first_from_(now + config.first_quiet), quiet_from_(now) {
  if (config_.is_sink)
    states_[anchor_w].mote = config_.self;
  reached_.fill(now);
}

void coordinates::prune(const neighbours& links) {
  if (departures_ == links.departures())
    return;
  departures_ = links.departures();
  std::erase_if(rows_, [&](const row& x) { return !links.find(x.mote); });
}

void coordinates::on_beacon(mote_id source, const coordinates_part& x, const neighbours& links) {
  prune(links);
  settled_.reset();
  take_decisions(x);
  note_own_sequence(x);
  if (!links.find(source))
    return;
  auto at = std::ranges::lower_bound(rows_, source, {}, &row::mote);
  if (at != rows_.end() && at->mote == source)
    at->part = x;
  else
    at = rows_.insert(at, row{source, x});
  if (const auto place = last_place_in(*at))
    at->place = place;
}

void coordinates::take_decisions(const coordinates_part& x) {
  const auto& theirs = x.anchors[anchor_w];
  const auto& ours = states_[anchor_w];
  if (theirs.mote == no_mote)
    return;
  if (theirs.mote == ours.mote) {
    if (is_newer(x.epoch, epoch_))
      decide(x.epoch, ids(x));
    return;
  }
  if (ours.mote != no_mote)
    ++counters_.foreign_sinks;
  const bool is_lost = ours.hops == hops_unknown && theirs.hops != hops_unknown;
  if (!config_.is_sink && (ours.mote == no_mote || is_lost))
    decide(x.epoch, ids(x));
}

void coordinates::decide(std::uint16_t epoch, const std::array<mote_id, anchor_count>& anchors) {
  epoch_ = epoch;
  for (std::size_t i = 0; i < anchor_count; ++i) {
    if (states_[i].mote != anchors[i])
      states_[i] = state{anchors[i], hops_unknown, 0, {}, {}};
  }
  candidate_ = {};
  if (is_complete()) { // places of before mean nothing any more
    place_epoch_ = epoch_;
    last_place_.reset();
    for (auto& x : rows_)
      x.place.reset();
  }
  changed_ = true;
}

/// An anchor that has restarted goes on where its earlier life ended.
void coordinates::note_own_sequence(const coordinates_part& x) {
  for (const auto& entry : x.anchors) {
    if (entry.mote == config_.self && is_newer(entry.sequence, own_sequence_))
      own_sequence_ = entry.sequence;
  }
}

bool coordinates::speaks_of(const row& x, std::size_t anchor) const {
  const auto& theirs = x.part.anchors[anchor];
  return theirs.mote == states_[anchor].mote && !theirs.was && theirs.hops <= hop_distance_max;
}

/// Whether the anchor has shown no sign of life for too long.
bool coordinates::is_stale(const state& x, instant now) const {
  return x.advertised.has_advertised() && now - x.progressed > config_.sequence_patience;
}

/// Whether time alone changes nothing: no anchor is stale, and none was reached that no mote was
/// informed of, of which the time is noted.
bool coordinates::waits(instant now) const {
  return !config_.is_sink && std::ranges::none_of(states_, [&](const state& x) {
    return is_stale(x, now) ||
           (!x.advertised.has_advertised() && x.hops != hops_unknown && x.mote != config_.self);
  });
}

/// Our distance to one anchor. Advertises the oldest sequence number of the nearest neighbours:
/// then each of them can take another's place at once.
void coordinates::measure(std::size_t anchor, const neighbours& links, instant now) {
  auto& mine = states_[anchor];
  mine.hops = hops_unknown;
  if (mine.mote == config_.self) {
    mine.hops = 0;
    mine.sequence = own_sequence_;
    return;
  }
  if (mine.mote == no_mote)
    return;
  const bool must_be_newer = is_stale(mine, now);
  const auto before = mine.sequence;
  for (const auto& x : rows_) {
    const auto& theirs = x.part.anchors[anchor];
    if (!speaks_of(x, anchor) || !mine.advertised.admits(theirs.sequence, theirs.hops) ||
        (must_be_newer && !is_newer(theirs.sequence, before)))
      continue;
    const auto hops = static_cast<hop_distance>(theirs.hops + 1);
    const bool is_nearer =
        hops < mine.hops || (hops == mine.hops && is_newer(mine.sequence, theirs.sequence));
    if (is_nearer && links.good(x.mote)) {
      mine.hops = hops;
      mine.sequence = theirs.sequence;
    }
  }
  if (!mine.advertised.has_advertised() || is_newer(mine.sequence, before))
    mine.progressed = now;
}

bool coordinates::is_complete() const {
  return std::ranges::find(states_, no_mote, &state::mote) == states_.end();
}

anchor_candidate coordinates::own_candidate() const {
  const auto w = states_[anchor_w].hops;
  const auto x = states_[anchor_x].hops;
  const auto y = states_[anchor_y].hops;
  const auto offer = [this](hop_distance score, unsigned tie = 0) {
    return anchor_candidate{config_.self, score, static_cast<std::uint8_t>(std::min(tie, 255U))};
  };
  if (w == hops_unknown)
    return {};
  if (states_[anchor_x].mote == no_mote || is_complete())
    return offer(w); // when complete: to notice growth
  if (x == hops_unknown)
    return {};
  if (states_[anchor_y].mote == no_mote)
    return offer(x);
  if (y == hops_unknown)
    return {};
  return offer(std::min(x, y), static_cast<unsigned>(x) + y);
}

anchor_candidate coordinates::best_candidate(const neighbours& links) const {
  auto best = own_candidate();
  const auto w = states_[anchor_w].hops;
  for (const auto& x : rows_) {
    const auto& theirs = x.part.candidate;
    if (w != hops_unknown && x.part.epoch == epoch_ && speaks_of(x, anchor_w) &&
        x.part.anchors[anchor_w].hops > w && is_better(theirs, best) && links.good(x.mote))
      best = theirs;
  }
  return best;
}

bool coordinates::update(const neighbours& links, instant now) {
  prune(links);
  const bool is_waiting = waits(now);
  if (is_waiting && settled_ == links.changes())
    return false;
  settled_ = is_waiting ? std::optional(links.changes()) : std::nullopt;
  const auto states_before = states_;
  for (std::size_t i = 0; i < anchor_count; ++i)
    measure(i, links, now);
  bool moved = false;
  for (std::size_t i = 0; i < anchor_count; ++i)
    moved = moved || states_[i].hops != states_before[i].hops;
  if (moved)
    ++counters_.changes;
  if (const auto here = place())
    last_place_ = here;
  const auto candidate = best_candidate(links);
  if (candidate != candidate_) {
    candidate_ = candidate;
    quiet_from_ = now;
    changed_ = changed_ || !is_complete();
  }
  if (config_.is_sink)
    elect(links, now);
  return std::exchange(changed_, false) || moved;
}

/// Whether the sink seems to be alone, but has neighbours that it knows too little of.
bool coordinates::may_get_company(const neighbours& links) const {
  const auto is_new = [&](const neighbour& x) { return x.samples < config_.company_samples; };
  return states_[anchor_x].mote == no_mote && candidate_.score == 0 &&
         std::ranges::any_of(links.all(), is_new);
}

/// Whether the sink has had no route to an anchor for too long.
bool coordinates::has_lost_anchor(instant now) {
  bool is_lost = false;
  for (std::size_t i = 0; i < anchor_count; ++i) {
    if (states_[i].mote == no_mote || states_[i].hops != hops_unknown)
      reached_[i] = now;
    is_lost = is_lost || now - reached_[i] > config_.anchor_patience;
  }
  return is_lost;
}

/// The sink's decisions: the next anchor, or all anew.
void coordinates::elect(const neighbours& links, instant now) {
  const bool is_lost = has_lost_anchor(now);
  if (may_get_company(links))
    quiet_from_ = now;
  const bool is_quiet =
      candidate_.mote != no_mote && now >= std::max(first_from_, quiet_from_ + config_.quiet);
  const auto x_hops = states_[anchor_x].hops;
  const bool has_grown = is_complete() && is_quiet && x_hops != hops_unknown &&
                         candidate_.score > x_hops + x_hops / 2 + 1;
  std::array<mote_id, anchor_count> anchors{config_.self, no_mote, no_mote, no_mote};
  if (is_lost || has_grown) {
    ++counters_.elections;
  } else if (is_quiet && !is_complete()) {
    std::ranges::transform(states_, anchors.begin(), &state::mote);
    *std::ranges::find(anchors, no_mote) = candidate_.mote;
  } else {
    return;
  }
  decide(static_cast<std::uint16_t>(epoch_ + 1), anchors);
  quiet_from_ = now;
  reached_.fill(now);
}

std::optional<instant> coordinates::deadline() const {
  if (!config_.is_sink || is_complete() || candidate_.mote == no_mote)
    return {};
  return std::max(first_from_, quiet_from_ + config_.quiet);
}

coordinates_part coordinates::advertise() {
  coordinates_part x;
  settled_.reset();
  ++own_sequence_;
  x.epoch = epoch_;
  for (std::size_t i = 0; i < anchor_count; ++i) {
    auto& mine = states_[i];
    if (mine.mote == config_.self && mine.mote != no_mote)
      mine.sequence = own_sequence_;
    else if (mine.hops != hops_unknown)
      mine.advertised.advertise(mine.sequence, mine.hops);
    x.anchors[i] = {mine.mote, mine.sequence, mine.hops};
  }
  if (last_place_ && place_epoch_ == epoch_) {
    const auto& last = *last_place_;
    const std::array<hop_distance, anchor_count> hops{hops_unknown, last.x, last.y, last.z};
    for (std::size_t i = anchor_x; i < anchor_count; ++i) {
      if (states_[i].hops == hops_unknown && hops[i] <= hop_distance_max)
        x.anchors[i] = {states_[i].mote, states_[i].sequence, hops[i], true};
    }
  }
  x.candidate = candidate_;
  return x;
}

std::optional<virtual_coordinates> coordinates::place() const {
  const virtual_coordinates x{states_[anchor_x].hops, states_[anchor_y].hops,
                              states_[anchor_z].hops};
  if (!is_complete() || std::max({x.x, x.y, x.z}) == hops_unknown)
    return {};
  return x;
}

const coordinates::row* coordinates::find(mote_id neighbour) const {
  const auto at = std::ranges::lower_bound(rows_, neighbour, {}, &row::mote);
  return at == rows_.end() || at->mote != neighbour ? nullptr : &*at;
}

std::optional<virtual_coordinates> coordinates::place_of(mote_id neighbour) const {
  const auto* const x = find(neighbour);
  const bool is_known = x != nullptr && is_complete() && speaks_of(*x, anchor_x) &&
                        speaks_of(*x, anchor_y) && speaks_of(*x, anchor_z);
  return is_known ? last_place_in(*x) : std::nullopt;
}

std::optional<virtual_coordinates> coordinates::likely_place_of(mote_id neighbour) const {
  const auto* const x = find(neighbour);
  return x != nullptr ? x->place : std::nullopt;
}

/// Where its beacon says that it is or was.
std::optional<virtual_coordinates> coordinates::last_place_in(const row& x) const {
  const auto& anchors = x.part.anchors;
  if (!is_complete())
    return {};
  for (std::size_t i = anchor_x; i < anchor_count; ++i) {
    if (anchors[i].mote != states_[i].mote || anchors[i].hops > hop_distance_max)
      return {};
  }
  return virtual_coordinates{anchors[anchor_x].hops, anchors[anchor_y].hops,
                             anchors[anchor_z].hops};
}

std::optional<virtual_coordinates> coordinates::presumed_place() const {
  if (last_place_ || !is_complete())
    return last_place_;
  constexpr virtual_coordinates nowhere{hops_unknown, hops_unknown, hops_unknown};
  auto least = nowhere;
  for (const auto& each : rows_) {
    if (const auto& there = each.place)
      least = {std::min(least.x, there->x), std::min(least.y, there->y),
               std::min(least.z, there->z)};
  }
  if (least == nowhere)
    return {};
  const auto hops = [&](anchor which, hop_distance theirs) {
    const auto ours = states_[which].hops;
    return ours != hops_unknown ? ours : one_hop_on(theirs);
  };
  const virtual_coordinates here{hops(anchor_x, least.x), hops(anchor_y, least.y),
                                 hops(anchor_z, least.z)};
  return std::max({here.x, here.y, here.z}) == hops_unknown ? std::nullopt : std::optional(here);
}

std::optional<mote_id> coordinates::greedy_step(virtual_coordinates destination,
                                                const neighbours& links) const {
  const auto here = place();
  if (!here)
    return {};
  auto least = squared_distance(*here, destination);
  std::optional<mote_id> next;
  for (const auto& x : rows_) {
    const auto there = place_of(x.mote);
    if (!there || !links.good(x.mote) || squared_distance(*there, destination) >= least)
      continue;
    least = squared_distance(*there, destination);
    next = x.mote;
  }
  return next;
}

std::size_t coordinates::footprint(std::size_t capacity) {
  // a row, beside the neighbour's own, which has the id: epoch, which anchors it agrees on with us,
  // sequence and hops of each, candidate
  constexpr std::size_t row_octets = 2 + 1 + anchor_count * 3 + 4 + 3; // and its last place
  // an anchor: id, hops, sequence, when it progressed in seconds, what was advertised
  constexpr std::size_t state_octets = 2 + 1 + 2 + 2 + 4;
  return capacity * row_octets + anchor_count * state_octets + 2 + 2 + 4 + 3 * 4 + 3;
}

} // namespace rubicon::network
