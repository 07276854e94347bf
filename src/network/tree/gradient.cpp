#include "network/tree/gradient.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace rubicon::network {

namespace {

constexpr std::uint8_t urgent_bit = 0x80; ///< in the octet of the hops

} // namespace

void gradient_part::write(byte_writer& out) const {
  const auto last = static_cast<std::uint8_t>(hops | (urgent ? urgent_bit : 0));
  out.big(root.value).big(root_sequence).big(parent.value).big(cost).octet(last);
}

gradient_part gradient_part::read(byte_reader& in) {
  gradient_part x;
  x.root = mote_id{in.big<std::uint16_t>()};
  x.root_sequence = in.big<std::uint16_t>();
  x.parent = mote_id{in.big<std::uint16_t>()};
  x.cost = in.big<etx_cost>();
  const auto last = in.octet();
  x.hops = static_cast<std::uint8_t>(last & ~urgent_bit);
  x.urgent = (last & urgent_bit) != 0;
  return x;
}

gradient::gradient(gradient_config config) : config_(config) {
  if (!config_.is_root)
    return;
  root_ = config_.self;
  cost_ = 0;
}

bool gradient::on_beacon(mote_id source, const gradient_part& x, const neighbours& links,
                         bool restarted) {
  prune(links);
  if (!links.find(source))
    return false;
  settled_.reset();
  auto at = std::ranges::lower_bound(rows_, source, {}, &row::mote);
  if (at != rows_.end() && at->mote == source) {
    note_progress(*at, x);
    const bool goes_on =
        !restarted && x.root == at->part.root && x.root_sequence == at->part.root_sequence;
    at->least = goes_on ? std::min(at->least, x.cost) : x.cost;
    at->part = x;
  } else {
    at = rows_.insert(at, row{source, x, x.cost});
  }
  at->lost = x.cost == etx_infinite ? at->lost + 1 : 0;
  if (root_ != no_mote && x.root != no_mote && x.root != root_)
    ++counters_.foreign_roots;
  // A root that has restarted goes on where its earlier life ended.
  if (config_.is_root && x.root == config_.self && is_newer(x.root_sequence, sequence_))
    sequence_ = x.root_sequence;
  return has_route() && x.cost == etx_infinite && links.etx(source);
}

/// Whoever makes a mote believe in a number far ahead must not cut it off until the root gets
/// there, which may take days. No circle of old news counts on: only a root that lives does.
void gradient::note_progress(const row& old, const gradient_part& x) {
  const bool counts_on = x.root == root_ && old.part.root == root_ &&
                         is_newer(x.root_sequence, old.part.root_sequence);
  if (has_route() || config_.is_root || !counts_on)
    return;
  if (advertised_.admits(x.root_sequence, x.cost) && is_newer(x.root_sequence, sequence_)) {
    behind_ = 0;
    return;
  }
  // A little behind is anybody whose beacon has been lost, and perhaps somebody behind us.
  const auto ahead = static_cast<std::uint16_t>(advertised_.sequence() - x.root_sequence);
  if (!is_newer(advertised_.sequence(), x.root_sequence) || ahead <= config_.behind_max ||
      ++behind_ < config_.behind_max)
    return;
  behind_ = 0;
  advertised_ = {};
  sequence_ = x.root_sequence;
  ++counters_.forgotten;
}

void gradient::prune(const neighbours& links) {
  if (departures_ == links.departures())
    return;
  departures_ = links.departures();
  std::erase_if(rows_, [&](const row& x) { return !links.find(x.mote); });
}

gradient::offer gradient::offer_of(const row& x, const neighbours& links, mote_id root,
                                   instant now) const {
  const auto& part = x.part;
  if (part.root != root || part.cost == etx_infinite || part.parent == config_.self ||
      part.hops >= config_.hops_max)
    return {};
  if (root == root_ && !advertised_.admits(part.root_sequence, x.least))
    return {};
  if (root == root_ && is_stale(now) && !is_newer(part.root_sequence, sequence_))
    return {};
  const auto link = links.etx(x.mote);
  if (!link || *link >= etx_infinite - part.cost)
    return {};
  return {&x, static_cast<etx_cost>(part.cost + *link)};
}

/// Whether the root has shown no sign of life for too long.
bool gradient::is_stale(instant now) const {
  return advertised_.has_advertised() && now - progressed_ > config_.root_patience;
}

gradient::offer gradient::kept_offer(const neighbours& links, instant now) const {
  const auto at = std::ranges::lower_bound(rows_, parent_, {}, &row::mote);
  return at != rows_.end() && at->mote == parent_ ? offer_of(*at, links, root_, now) : offer();
}

gradient::offer gradient::best_offer(const neighbours& links, mote_id root, int below,
                                     instant now) const {
  offer best;
  for (const auto& x : rows_) {
    const int least = x.part.cost + links.etx_min(x.mote);
    if (least >= below || (best.from && least > best.cost))
      continue;
    const auto offered = offer_of(x, links, root, now);
    if (offered.from && (!best.from || std::tuple(offered.cost, x.part.hops) <
                                           std::tuple(best.cost, best.from->part.hops)))
      best = offered;
  }
  return best;
}

/// Keeps the parent unless another is better by the hysteresis; turns to another root only when
/// there is no route to ours.
gradient::offer gradient::choose(const neighbours& links, instant now) {
  constexpr int any_cost = 2 * etx_infinite;
  if (const auto kept = kept_offer(links, now); kept.from) {
    const int below = kept.cost - config_.hysteresis;
    const auto best = best_offer(links, root_, below, now);
    return best.from && best.cost < below ? best : kept;
  }
  auto best = best_offer(links, root_, any_cost, now);
  for (const auto& x : rows_) {
    if (best.from || x.part.root == root_ || x.part.root == no_mote)
      continue;
    best = best_offer(links, x.part.root, any_cost, now);
    if (best.from) {
      root_ = x.part.root;
      advertised_ = {};
      parent_ = no_mote;
      sequence_ = x.part.root_sequence;
      progressed_ = now;
    }
  }
  return best;
}

void gradient::follow(const offer& chosen, instant now) {
  const auto& part = chosen.from->part;
  parent_ = chosen.from->mote;
  cost_ = chosen.cost;
  hops_ = static_cast<std::uint8_t>(part.hops + 1);
  if (is_newer(part.root_sequence, sequence_)) {
    progressed_ = now;
    urgent_ = urgent_ || part.urgent;
  }
  if (!advertised_.has_advertised())
    progressed_ = now;
  sequence_ = part.root_sequence;
}

gradient_change gradient::update(const neighbours& links, instant now) {
  prune(links);
  // Time alone changes something only once the root is stale; while nothing was advertised it is
  // noted.
  const bool waits = !is_stale(now) && (advertised_.has_advertised() || !has_route());
  if (config_.is_root || (waits && settled_ == links.changes()))
    return gradient_change::none;
  settled_ = waits ? std::optional(links.changes()) : std::nullopt;
  const auto before = parent_;
  const auto chosen = choose(links, now);
  if (!chosen.from) {
    parent_ = no_mote;
    cost_ = etx_infinite;
    hops_ = 0;
    if (before == no_mote)
      return gradient_change::none;
    ++counters_.losses;
    return gradient_change::lost;
  }
  follow(chosen, now);
  if (parent_ == before)
    return gradient_change::none;
  if (before != no_mote)
    ++counters_.parent_changes;
  return gradient_change::parent;
}

gradient_part gradient::advertise() {
  settled_.reset();
  if (config_.is_root)
    ++sequence_;
  else if (has_route())
    advertised_.advertise(sequence_, cost_);
  return {root_, sequence_, parent_, cost_, hops_, std::exchange(urgent_, false)};
}

bool gradient::starves(mote_id neighbour) const {
  constexpr unsigned beacons_lost = 2; // it may have lost its route before it received ours
  const auto at = std::ranges::lower_bound(rows_, neighbour, {}, &row::mote);
  return at != rows_.end() && at->mote == neighbour && has_route() && at->lost >= beacons_lost &&
         at->part.root == root_ && !is_newer(sequence_, at->part.root_sequence);
}

std::vector<mote_id> gradient::children() const {
  std::vector<mote_id> found;
  for (const auto& x : rows_) {
    if (x.part.parent == config_.self)
      found.push_back(x.mote);
  }
  return found;
}

} // namespace rubicon::network
