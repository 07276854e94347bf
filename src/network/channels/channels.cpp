#include "network/channels/channels.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/account/message_ledger.hpp"

namespace rubicon::network {

namespace {

/// What the radio takes at most for one round: four transmissions, before each five back-offs of at
/// most 7, 15, 31, 31 and 31 periods of 320 us; 4.3 ms on the air, and 0.9 ms until it knows that
/// no acknowledgement comes (IEEE 802.15.4-2006 7.5.1.4).
constexpr duration radio_try_max = 115 * 320us + 4300us + 900us;
constexpr duration radio_round_max = 4 * radio_try_max;

constexpr duration offer_lifetime = 5s; ///< what has not been taken up by then is void
/// Of a squared distance in virtual coordinates: so much farther the next mote may be where none
/// is nearer. Several motes have the same coordinates, and the route leads round them.
constexpr std::uint32_t sidestep = 5;
constexpr int turns_spare =
    6; ///< turns that set-up may take beside one a hop: many take several hops
constexpr int hops_likely = 8;           ///< of a route that is not known
constexpr unsigned flood_rounds = 2;     ///< not acknowledged: each mote sends it so often,
constexpr unsigned flood_rounds_max = 5; ///< and until another has relayed it

bool is_data(const channel_message& x) {
  return std::holds_alternative<data_message>(x.content);
}

/// Of a packet; control messages take no more than their place in the queue.
std::size_t data_octets(const channel_message& x) {
  const auto* data = std::get_if<data_message>(&x.content);
  return data ? data->content.size() : 0;
}

/// As the next mote is to receive it: a packet comes there when it leaves here.
connect_message one_hop_on(connect_message x) {
  const bool is_source = x.hops == 0;
  ++x.hops;
  x.delay_us += is_source ? 0U : static_cast<std::uint32_t>(channel_slot.count());
  return x;
}

/// Of a channel there, about.
int likely_hops(const surroundings& around, const std::optional<virtual_coordinates>& to) {
  if (!around.own_place || !to)
    return hops_likely;
  return hops_between(*around.own_place, *to) + 1;
}

/// What a message there and its answer may wait for their turns.
duration turns_of(const surroundings& around, int hops) {
  return (turns_spare + hops) * around.turn_wait;
}

} // namespace

channels::channels(channels_config config, random_stream rng)
    : config_(config), rng_(rng), next_number_(static_cast<std::uint16_t>(rng_.next())) {}

channels_outputs channels::connect(channel_id channel, mote_id destination,
                                   std::optional<virtual_coordinates> place,
                                   const channel_schedule& schedule, duration expiry,
                                   const surroundings& around, instant now) {
  channels_outputs out;
  ++counters_.connects;
  if (entries_.size() >= config_.entries_max || destination == config_.self) {
    ++counters_.refused;
    out.emplace_back(channel_ended{channel, destination == config_.self ? channel_end::unreachable
                                                                        : channel_end::no_room});
    return out;
  }
  auto& x = entries_[channel];
  x.request.destination = destination;
  x.request.place = place;
  x.request.schedule = schedule;
  x.request.expiry_s = static_cast<std::uint16_t>(expiry / 1s);
  x.last_packet = now;
  x.setup_end = now + config_.connect_timeout + turns_of(around, likely_hops(around, place));
  go_on(channel, x, around, out, now);
  pump(out, now);
  return out;
}

/// The next mote: the destination, if it is a good neighbour; else a good one that is nearer to it.
/// Where there is none, the same among other neighbours: one that has just started is not a good
/// one yet. Then one that is about as far from it as we are, a good one first. Who does not know
/// where it is itself leaves it to the mote above it in the tree.
std::optional<mote_id> channels::nearer(const entry& x, const surroundings& around) {
  const bool is_untried = !x.has_tried(x.request.destination);
  const auto is_destination = [&](const nearby_mote& y) { return y.mote == x.request.destination; };
  for (const auto* among : {&around.motes, &around.heard}) {
    if (std::ranges::any_of(*among, is_destination) && is_untried)
      return x.request.destination;
    if (const auto next = nearest(x, *among, around, 0))
      return next;
  }
  for (const auto* among : {&around.motes, &around.heard}) {
    if (const auto next = nearest(x, *among, around, sidestep))
      return next;
  }
  const bool may_ascend = x.request.place && !around.own_place && around.parent != no_mote &&
                          around.parent != x.previous && !x.has_tried(around.parent);
  return may_ascend ? std::optional(around.parent) : std::nullopt;
}

/// The one nearest to the destination that is nearer than we are, as far as we know where we are.
/// @param slack the squared distance may be so much greater, and less one
std::optional<mote_id> channels::nearest(const entry& x, const std::vector<nearby_mote>& among,
                                         const surroundings& around, std::uint32_t slack) {
  if (!x.request.place)
    return std::nullopt;
  std::optional<mote_id> best;
  auto least = around.own_place ? squared_distance(*around.own_place, *x.request.place) + slack
                                : std::numeric_limits<std::uint32_t>::max();
  for (const auto& y : among) {
    if (!y.place || x.has_tried(y.mote) || y.mote == x.previous)
      continue;
    const auto distance = squared_distance(*y.place, *x.request.place);
    if (distance < least) {
      least = distance;
      best = y.mote;
    }
  }
  return best;
}

bool channels::may_be_near(const entry& x, const surroundings& around) {
  if (!x.request.place || !around.own_place || x.previous || !x.tried.empty())
    return false;
  return hops_between(*x.request.place, *around.own_place) <= 1;
}

/// Whether the connect message is to wait for a neighbour, which it does once: at the source before
/// it goes to everybody, and where we have started lately.
bool channels::waits(entry& x, const surroundings& around, instant now) {
  const bool may_help = x.request.place && (around.is_new || !x.previous);
  if (!x.look_end && may_help)
    x.look_end = now + around.beacon_wait;
  return x.look_end && now < *x.look_end;
}

/// Sends the connect message on: to a neighbour that is nearer, else, from the source, to the
/// destination itself if that may receive it, in a crowd before all others; else, when it has
/// waited for one, back, else to everybody.
void channels::go_on(channel_id id, entry& x, const surroundings& around, channels_outputs& out,
                     instant now) {
  reserve(id, x, out);
  auto next = x.tried.size() < config_.tries_max ? nearer(x, around) : std::nullopt;
  if ((!next || around.is_crowd) && may_be_near(x, around))
    next = x.request.destination;
  if (next) {
    x.next = next;
    queue(*next, {id, one_hop_on(x.request)}, now);
    return;
  }
  x.next.reset();
  if (waits(x, around, now))
    return;
  if (x.previous && x.request.place) {
    ++counters_.backtracks;
    const auto previous = *x.previous;
    entries_.erase(id);
    note_dead_end(id, now + around.beacon_wait);
    out.emplace_back(channel_reserved{id, {}});
    queue(previous, {id, dead_end_message{}}, now);
    return;
  }
  flood(id, x, around, now);
}

bool channels::is_dead_end(channel_id id) const {
  return std::ranges::find(dead_ends_, id, &dead_end::channel) != dead_ends_.end();
}

/// Where there are too many the oldest is forgotten: its message may pass here again.
void channels::note_dead_end(channel_id id, instant until) {
  if (dead_ends_.size() >= config_.dead_ends_max)
    dead_ends_.erase(dead_ends_.begin());
  dead_ends_.push_back({id, until});
}

void channels::flood(channel_id id, entry& x, const surroundings& around, instant now) {
  ++counters_.floods;
  ++(!x.request.place    ? counters_.floods_place_unknown
     : !around.own_place ? counters_.floods_self_unknown
                         : counters_.floods_dead_end);
  x.next.reset();
  x.flooded = true;
  auto request = one_hop_on(x.request);
  request.flooded = true;
  queue(broadcast_mote, {id, request}, now);
}

std::optional<channels_outputs> channels::send(channel_id channel, bytes content, departure how,
                                               instant now) {
  assert(content.size() <= channel_packet_max);
  const auto found = entries_.find(channel);
  const bool is_open = found != entries_.end() && found->second.open;
  const bool is_end = is_open && (!found->second.previous || !found->second.next);
  if (!is_end || !has_room(content.size()))
    return std::nullopt;
  auto& x = found->second;
  ++counters_.packets_sent;
  x.last_packet = now;
  ++x.sent;
  queue(x.next ? *x.next : *x.previous, {channel, data_message{x.sent, std::move(content)}}, now,
        how);
  channels_outputs out;
  pump(out, now);
  return out;
}

channels_outputs channels::disconnect(channel_id channel, instant now) {
  channels_outputs out;
  free(channel, channel_end::disconnected, config_.self, out, now);
  pump(out, now);
  return out;
}

channels_outputs channels::refuse(channel_id channel, instant now) {
  channels_outputs out;
  ++counters_.refused;
  free(channel, channel_end::no_room, config_.self, out, now);
  pump(out, now);
  return out;
}

channels_outputs channels::on_frame(mote_id from, byte_view octets, const surroundings& around,
                                    instant now) {
  channels_outputs out;
  auto message = decode_channel_message(octets);
  if (!message) {
    ++counters_.malformed;
    return out;
  }
  std::visit([&](auto& x) { take(from, message->channel, x, around, out, now); }, message->content);
  pump(out, now);
  return out;
}

void channels::take(mote_id from, channel_id id, connect_message& x, const surroundings& around,
                    channels_outputs& out, instant now) {
  if (x.flooded) {
    take_flooded(from, id, x, around, out, now);
    return;
  }
  const auto known = entries_.find(id);
  if (known != entries_.end()) { // a repeat, or it came round in a circle
    if (known->second.previous != from)
      queue(from, {id, dead_end_message{}}, now);
    else if (known->second.open)
      queue(from, {id, connect_ack_message{known->second.request.hops}}, now);
    return;
  }
  if (is_dead_end(id)) {
    queue(from, {id, dead_end_message{}}, now);
    return;
  }
  if (entries_.size() >= config_.entries_max || x.hops > config_.hops_max) {
    ++counters_.refused;
    queue(from, {id, end_message{channel_end::no_room}}, now);
    return;
  }
  auto& here = entries_[id];
  here.previous = from;
  here.request = x;
  here.last_packet = now;
  here.setup_end = now + config_.setup_timeout + turns_of(around, 2 * hops_likely);
  if (x.destination != config_.self) {
    go_on(id, here, around, out, now);
    return;
  }
  here.open = true;
  ++counters_.accepted;
  reserve(id, here, out);
  queue(from, {id, connect_ack_message{x.hops}}, now);
  out.emplace_back(channel_accepted{id});
}

/// The first copy came the quickest route. Nothing is reserved before the destination has answered.
void channels::take_flooded(mote_id from, channel_id id, const connect_message& x,
                            const surroundings& around, channels_outputs& out, instant now) {
  if (const auto again = offers_.find(id); again != offers_.end()) {
    note_copy(again->second.heard, x.hops, again->second.request.hops);
    if (again->second.heard.copies == config_.flood_copies && around.is_crowd)
      end_flood(id);
    return;
  }
  if (const auto ours = entries_.find(id); ours != entries_.end()) {
    note_copy(ours->second.heard, x.hops, ours->second.request.hops);
    return;
  }
  if (id.source == config_.self)
    return;
  if (x.destination == config_.self) {
    auto plain = x;
    plain.flooded = false;
    take(from, id, plain, around, out, now);
    return;
  }
  if (offers_.size() >= config_.offers_max || entries_.size() >= config_.entries_max ||
      x.hops > config_.hops_max)
    return;
  offers_[id] = {from, x, now + offer_lifetime + turns_of(around, hops_likely), {}};
  const auto is_near = [&](const nearby_mote& y) { return y.mote == x.destination; };
  if (std::ranges::any_of(around.motes, is_near)) // perhaps of all who receive this we alone
    queue(x.destination, {id, one_hop_on(x)}, now);
  else
    queue(broadcast_mote, {id, one_hop_on(x)}, now + rng_.between(0s, config_.flood_spread));
}

/// We say `own_hops + 1`, and who passes it on one more.
void channels::note_copy(flood_copies& x, std::uint8_t hops, std::uint8_t own_hops) {
  ++x.copies;
  x.passed_on = x.passed_on || hops >= own_hops + 2;
}

void channels::end_flood(channel_id id) {
  std::erase_if(queue_, [id](const waiting& x) {
    return x.message.channel == id && x.next == broadcast_mote;
  });
}

/// How often a flood's message is to be said.
unsigned channels::rounds_of_flood(channel_id id) const {
  const auto offered = offers_.find(id);
  const auto ours = entries_.find(id);
  const auto heard = offered != offers_.end() ? offered->second.heard
                     : ours != entries_.end() ? ours->second.heard
                                              : flood_copies{};
  return heard.passed_on || heard.copies >= config_.flood_copies ? flood_rounds : flood_rounds_max;
}

void channels::take(mote_id from, channel_id id, connect_ack_message& ack, const surroundings&,
                    channels_outputs& out, instant now) {
  auto found = entries_.find(id);
  if (found == entries_.end()) {
    const auto offered = offers_.extract(id);
    if (offered.empty() || entries_.size() >= config_.entries_max) {
      ++counters_.strays;
      queue(from, {id, end_message{channel_end::no_room}}, now);
      return;
    }
    found = entries_.emplace(id, entry{}).first;
    found->second.previous = offered.mapped().previous;
    found->second.request = offered.mapped().request;
    found->second.last_packet = now;
  }
  auto& x = found->second;
  if (x.open && x.next != from) { // two of the flood's copies have come to the destination
    queue(from, {id, end_message{channel_end::disconnected}}, now);
    return;
  }
  x.next = from;
  end_flood(id);
  if (std::exchange(x.open, true))
    return;
  x.request.hops = ack.hops;
  reserve(id, x, out);
  if (x.previous) {
    queue(*x.previous, {id, ack}, now);
  } else {
    ++counters_.connected;
    out.emplace_back(channel_connected{id});
  }
}

void channels::take(mote_id from, channel_id id, end_message& x, const surroundings&,
                    channels_outputs& out, instant now) {
  const auto found = entries_.find(id);
  const bool concerns_us =
      found != entries_.end() && (found->second.previous == from || found->second.next == from);
  if (concerns_us)
    free(id, x.why, from, out, now);
  else
    ++counters_.strays;
}

void channels::take(mote_id from, channel_id id, dead_end_message&, const surroundings& around,
                    channels_outputs& out, instant now) {
  const auto found = entries_.find(id);
  if (found == entries_.end() || found->second.next != from || found->second.open) {
    ++counters_.strays;
    return;
  }
  auto& x = found->second;
  x.tried.push_back(from);
  go_on(id, x, around, out, now);
}

void channels::take(mote_id from, channel_id id, data_message& x, const surroundings&,
                    channels_outputs& out, instant now) {
  const auto found = entries_.find(id);
  const bool concerns_us =
      found != entries_.end() && (found->second.previous == from || found->second.next == from);
  if (!concerns_us) {
    ++counters_.strays;
    note_loss(loss::channel_lost);
    queue(from, {id, end_message{channel_end::broken}}, now);
    return;
  }
  auto& here = found->second;
  here.last_packet = now;
  const bool is_forward = here.previous == from;
  if (std::exchange(is_forward ? here.from_previous : here.from_next, x.sequence) == x.sequence) {
    ++counters_.duplicates;
    note_loss(loss::duplicate);
    return;
  }
  const auto& onwards = is_forward ? here.next : here.previous;
  if (!here.open) {
    ++counters_.packets_lost;
    note_loss(loss::channel_lost);
  } else if (onwards) {
    ++counters_.packets_forwarded;
    queue(*onwards, {id, std::move(x)}, now, departure::at_once);
  } else {
    ++counters_.packets_received;
    out.emplace_back(channel_received{id, std::move(x.content)});
  }
}

/// Frees what the channel holds here and notifies its neighbours on the path, but not
/// `informed_by`.
void channels::free(channel_id id, channel_end why, std::optional<mote_id> informed_by,
                    channels_outputs& out, instant now) {
  const auto gone = entries_.extract(id);
  if (gone.empty())
    return;
  const auto& x = gone.mapped();
  std::erase_if(queue_, [id](const waiting& y) {
    const bool goes = y.message.channel == id;
    if (goes)
      note_loss(y.from, loss::channel_lost);
    return goes;
  });
  for (const auto& side : {x.previous, x.next}) {
    if (side && side != informed_by)
      queue(*side, {id, end_message{why}}, now);
  }
  out.emplace_back(channel_reserved{id, {}});
  const bool is_end = !x.previous || x.request.destination == config_.self;
  if (is_end && informed_by != config_.self)
    out.emplace_back(channel_ended{id, why});
}

/// A packet comes here as much later as its route to us takes (NRG-03).
void channels::reserve(channel_id id, const entry& x, channels_outputs& out) const {
  auto schedule = x.request.schedule;
  schedule.first += std::chrono::microseconds(x.request.delay_us);
  out.emplace_back(channel_reserved{id, schedule, x.previous});
}

/// For another packet of so many octets.
bool channels::has_room(std::size_t octets) const {
  auto sum = octets + (in_flight_ ? data_octets(in_flight_->message) : 0);
  for (const auto& x : queue_)
    sum += data_octets(x.message);
  return queue_.size() < config_.queue_max && sum <= config_.octets_max;
}

void channels::queue(mote_id next, channel_message message, instant due, departure how) {
  const auto says_the_same = [&](const waiting& x) {
    return x.next == next && x.message.channel == message.channel &&
           std::holds_alternative<end_message>(x.message.content);
  };
  if (std::holds_alternative<end_message>(message.content) &&
      std::ranges::any_of(queue_, says_the_same))
    return; // strays come faster than radios wake up
  if (is_data(message) && !has_room(data_octets(message))) {
    ++counters_.packets_lost;
    note_loss(loss::queue_full);
  } else if (queue_.size() < 2 * config_.queue_max) { // control messages are few, and matter more
    queue_.push_back({next, std::move(message), 0, due, how});
  } else {
    ++counters_.crowded_out;
  }
}

/// When it may be handed out.
instant channels::due(const waiting& x) const {
  const bool waits = x.how == departure::in_turn || x.rounds > 0;
  return waits ? std::max(x.due, held_until_) : x.due;
}

void channels::pump(channels_outputs& out, instant now) {
  if (in_flight_)
    return;
  const auto next = std::ranges::find_if(queue_, [&](const waiting& x) { return due(x) <= now; });
  if (next == queue_.end())
    return;
  in_flight_ = std::move(*next);
  queue_.erase(next);
  const bool in_slot = in_flight_->how == departure::in_slot && in_flight_->rounds == 0;
  const acting_on its(in_flight_->from);
  out.emplace_back(channel_hop{in_flight_->next, encode(in_flight_->message), in_slot});
}

channels_outputs channels::on_sent(bool acked, const surroundings& around, instant now) {
  channels_outputs out;
  if (!in_flight_)
    return out;
  auto x = *std::exchange(in_flight_, std::nullopt);
  const auto in_slot = x.how == departure::in_slot ? 1U : 0U;
  const auto rounds_max = is_data(x.message)         ? config_.data_rounds_max + in_slot
                          : x.next == broadcast_mote ? rounds_of_flood(x.message.channel)
                                                     : config_.rounds_max;
  ++x.rounds;
  if (const auto found = entries_.find(x.message.channel); acked && found != entries_.end())
    found->second.losses = 0;
  if (!acked || x.next == broadcast_mote) {
    if (x.rounds < rounds_max) {
      x.due = now + rng_.between(config_.round_pause, 2 * config_.round_pause);
      queue_.insert(queue_.begin(), std::move(x));
    } else if (x.next != broadcast_mote) {
      on_lost(x, around, out, now);
    }
  }
  pump(out, now);
  return out;
}

/// The mote at the other end of a hop does not answer: the path is broken there (NET-09).
void channels::on_lost(const waiting& x, const surroundings& around, channels_outputs& out,
                       instant now) {
  const auto found = entries_.find(x.message.channel);
  if (is_data(x.message)) {
    ++counters_.packets_lost;
    note_loss(x.from, loss::gave_up);
    if (found != entries_.end() && ++found->second.losses < config_.losses_max)
      return;
  }
  const bool is_on_path =
      found != entries_.end() && (found->second.next == x.next || found->second.previous == x.next);
  if (!is_on_path)
    return;
  auto& path = found->second;
  const bool asks = std::holds_alternative<connect_message>(x.message.content);
  if (asks && path.next == x.next) {
    path.tried.push_back(*std::exchange(path.next, std::nullopt));
    go_on(x.message.channel, path, around, out, now);
    return;
  }
  ++counters_.broken;
  const bool was_open = found->second.open;
  free(x.message.channel, was_open ? channel_end::broken : channel_end::unreachable, x.next, out,
       now);
}

channels_outputs channels::on_restarted(mote_id neighbour, const surroundings& around,
                                        instant now) {
  channels_outputs out;
  std::vector<channel_id> broken;
  std::vector<channel_id> forgotten;
  for (const auto& [id, x] : entries_) {
    if (x.open && (x.next == neighbour || x.previous == neighbour))
      broken.push_back(id);
    else if (x.next == neighbour)
      forgotten.push_back(id);
  }
  for (const auto& id : broken) {
    ++counters_.broken;
    free(id, channel_end::broken, neighbour, out, now);
  }
  for (const auto& id : forgotten)
    go_on(id, entries_.at(id), around, out, now);
  pump(out, now);
  return out;
}

bool channels::is_looking() const {
  return std::ranges::any_of(entries_, [](const auto& x) { return x.second.is_looking(); });
}

channels_outputs channels::look(std::optional<mote_id> heard, const surroundings& around,
                                instant now) {
  channels_outputs out;
  std::vector<channel_id> looking;
  for (const auto& [id, x] : entries_) {
    if (x.is_looking() && (heard || *x.look_end <= now))
      looking.push_back(id);
  }
  for (const auto& id : looking) {
    auto& x = entries_.at(id);
    if (!heard)
      x.tried.clear(); // its only wait is over: once more from the beginning
    else
      std::erase(x.tried, *heard);
    go_on(id, x, around, out, now);
  }
  pump(out, now);
  return out;
}

channels_outputs channels::on_time(instant now) {
  channels_outputs out;
  std::vector<std::pair<channel_id, channel_end>> over;
  for (const auto& [id, x] : entries_) {
    if (!x.open && x.setup_end <= now)
      over.emplace_back(id, channel_end::unreachable);
    else if (x.open && x.request.expiry_s > 0 && x.last_packet + x.request.expiry_s * 1s <= now)
      over.emplace_back(id, channel_end::expired);
  }
  for (const auto& [id, why] : over) {
    counters_.expired += why == channel_end::expired ? 1 : 0;
    free(id, why, std::nullopt, out, now);
  }
  std::erase_if(offers_, [now](const auto& x) { return x.second.end <= now; });
  std::erase_if(dead_ends_, [now](const dead_end& x) { return x.until <= now; });
  pump(out, now);
  return out;
}

std::optional<instant> channels::deadline() const {
  std::optional<instant> next;
  for (const auto& [id, x] : entries_) {
    if (!x.open)
      next = earliest(next, x.is_looking() ? std::min(x.setup_end, *x.look_end) : x.setup_end);
    else if (x.request.expiry_s > 0)
      next = earliest(next, x.last_packet + x.request.expiry_s * 1s);
  }
  for (const auto& [id, x] : offers_)
    next = earliest(next, x.end);
  for (const auto& x : dead_ends_)
    next = earliest(next, x.until);
  if (!in_flight_) {
    for (const auto& x : queue_)
      next = earliest(next, due(x));
  }
  return next;
}

std::optional<std::uint8_t> channels::hops(channel_id channel) const {
  const auto found = entries_.find(channel);
  return found == entries_.end() || !found->second.open ? std::nullopt
                                                        : std::optional(found->second.request.hops);
}

std::optional<duration> channels::latency_bound(channel_id channel) const {
  const auto length = hops(channel);
  if (!length)
    return std::nullopt;
  const auto& x = entries_.at(channel);
  const auto own = config_.data_rounds_max * radio_round_max +
                   2 * config_.round_pause * (config_.data_rounds_max - 1);
  const auto frames = static_cast<std::int64_t>(2 * config_.queue_max);
  const auto before =
      frames * radio_try_max +
      2 * (frames + static_cast<std::int64_t>(config_.data_rounds_max)) * config_.wake;
  return *length * (before + own + duration(x.request.schedule.interval));
}

std::vector<channel_id> channels::table() const {
  std::vector<channel_id> all;
  for (const auto& [id, x] : entries_)
    all.push_back(id);
  return all;
}

} // namespace rubicon::network
