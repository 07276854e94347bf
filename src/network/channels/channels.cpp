#include "network/channels/channels.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/account/message_ledger.hpp"

namespace rubicon::network {

namespace {

/// What the radio takes at most for one round: four transmissions, before each five back-offs of at
/// most 7, 15, 31, 31 and 31 periods of 320 us; 4.3 ms on the air, and 0.9 ms until it knows that
/// no acknowledgement comes (IEEE 802.15.4-2006 7.5.1.4).
constexpr duration radio_try_max = 115 * 320us + 4300us + 900us;
constexpr duration radio_round_max = 4 * radio_try_max;

} // namespace

channels::channels(channels_config config, random_stream rng)
    : rng_(rng), next_number_(static_cast<std::uint16_t>(rng_.next())), table_(config),
      setup_(config) {}

channels_outputs channels::connect(channel_id channel, mote_id destination,
                                   std::optional<virtual_coordinates> place,
                                   const channel_schedule& schedule, duration expiry,
                                   const surroundings& around, instant now) {
  channels_outputs out;
  ++table_.counters().connects;
  const bool is_self = destination == table_.config().self;
  if (table_.is_full() || is_self) {
    ++table_.counters().refused;
    out.emplace_back(
        channel_ended{channel, is_self ? channel_end::unreachable : channel_end::no_room});
    return out;
  }
  connect_message request;
  request.destination = destination;
  request.place = place;
  request.schedule = schedule;
  request.expiry_s = static_cast<std::uint16_t>(expiry / 1s);
  setup_.begin(table_, channel, request, {around, out, now});
  table_.pump(out, now);
  return out;
}

std::optional<channels_outputs> channels::send(channel_id channel, bytes content, departure how,
                                               instant now) {
  assert(content.size() <= channel_packet_max);
  auto* const x = table_.find(channel);
  const bool is_open = x != nullptr && x->open;
  const bool is_end = is_open && (!x->previous || !x->next);
  if (!is_end || !table_.waiting().has_room(content.size()))
    return std::nullopt;
  ++table_.counters().packets_sent;
  x->last_packet = now;
  ++x->sent;
  table_.queue(x->next ? *x->next : *x->previous,
               {channel, data_message{x->sent, std::move(content)}}, now, how);
  channels_outputs out;
  table_.pump(out, now);
  return out;
}

channels_outputs channels::disconnect(channel_id channel, instant now) {
  channels_outputs out;
  table_.free(channel, channel_end::disconnected, table_.config().self, out, now);
  table_.pump(out, now);
  return out;
}

channels_outputs channels::refuse(channel_id channel, instant now) {
  channels_outputs out;
  ++table_.counters().refused;
  table_.free(channel, channel_end::no_room, table_.config().self, out, now);
  table_.pump(out, now);
  return out;
}

// What neighbours say.

channels_outputs channels::on_frame(mote_id from, byte_view octets, const surroundings& around,
                                    instant now) {
  channels_outputs out;
  auto message = decode_channel_message(octets);
  if (!message) {
    ++table_.counters().malformed;
    return out;
  }
  const channel_occasion at{around, out, now};
  std::visit([&](auto& x) { take(from, message->channel, x, at); }, message->content);
  table_.pump(out, now);
  return out;
}

void channels::take(mote_id from, channel_id id, const connect_message& x,
                    const channel_occasion& at) {
  setup_.on_connect(table_, from, id, x, at, rng_);
}

void channels::take(mote_id from, channel_id id, const connect_ack_message& x,
                    const channel_occasion& at) {
  setup_.on_ack(table_, from, id, x, at);
}

void channels::take(mote_id from, channel_id id, const dead_end_message&,
                    const channel_occasion& at) {
  setup_.on_dead_end(table_, from, id, at);
}

void channels::take(mote_id from, channel_id id, const end_message& x, const channel_occasion& at) {
  if (table_.find_by(id, from) != nullptr)
    table_.free(id, x.why, from, at.out, at.now);
  else
    ++table_.counters().strays;
}

void channels::take(mote_id from, channel_id id, data_message& x, const channel_occasion& at) {
  auto& counters = table_.counters();
  auto* const here = table_.find_by(id, from);
  if (here == nullptr) {
    ++counters.strays;
    note_loss(loss::channel_lost);
    table_.queue(from, {id, end_message{channel_end::broken}}, at.now);
    return;
  }
  here->last_packet = at.now;
  const bool is_forward = here->previous == from;
  auto& last = is_forward ? here->from_previous : here->from_next;
  if (std::exchange(last, x.sequence) == x.sequence) {
    ++counters.duplicates;
    note_loss(loss::duplicate);
    return;
  }
  const auto& onwards = is_forward ? here->next : here->previous;
  if (!here->open) {
    ++counters.packets_lost;
    note_loss(loss::channel_lost);
  } else if (onwards) {
    ++counters.packets_forwarded;
    table_.queue(*onwards, {id, std::move(x)}, at.now, departure::at_once);
  } else {
    ++counters.packets_received;
    at.out.emplace_back(channel_received{id, std::move(x.content)});
  }
}

channels_outputs channels::on_sent(bool acked, const surroundings& around, instant now) {
  channels_outputs out;
  auto sent = table_.waiting().on_sent();
  if (!sent)
    return out;
  const auto& config = table_.config();
  const auto id = sent->message.channel;
  const auto in_slot = sent->how == departure::in_slot ? 1U : 0U;
  const auto rounds_max = is_data(sent->message)         ? config.data_rounds_max + in_slot
                          : sent->next == broadcast_mote ? setup_.rounds_of_flood(table_, id)
                                                         : config.rounds_max;
  if (auto* const x = table_.find(id); acked && x != nullptr)
    x->losses = 0;
  if (!acked || sent->next == broadcast_mote) {
    if (sent->rounds < rounds_max)
      table_.waiting().repeat(*std::move(sent),
                              now + rng_.between(config.round_pause, 2 * config.round_pause));
    else if (sent->next != broadcast_mote)
      on_lost(*sent, {around, out, now});
  }
  table_.pump(out, now);
  return out;
}

/// The mote at the other end of a hop does not answer: the path is broken there (NET-09).
void channels::on_lost(const waiting_hop& x, const channel_occasion& at) {
  const auto id = x.message.channel;
  if (is_data(x.message)) {
    ++table_.counters().packets_lost;
    note_loss(x.from, loss::gave_up);
    if (auto* const channel = table_.find(id);
        channel != nullptr && ++channel->losses < table_.config().losses_max)
      return;
  }
  auto* const path = table_.find_by(id, x.next);
  if (path == nullptr)
    return;
  if (std::holds_alternative<connect_message>(x.message.content) && path->next == x.next) {
    setup_.on_no_answer(table_, id, *path, at);
    return;
  }
  ++table_.counters().broken;
  table_.free(id, path->open ? channel_end::broken : channel_end::unreachable, x.next, at.out,
              at.now);
}

channels_outputs channels::on_restarted(mote_id neighbour, const surroundings& around,
                                        instant now) {
  channels_outputs out;
  std::vector<channel_id> broken;
  std::vector<channel_id> forgotten;
  for (const auto& [id, x] : table_.all()) {
    if (x.open && (x.next == neighbour || x.previous == neighbour))
      broken.push_back(id);
    else if (x.next == neighbour)
      forgotten.push_back(id);
  }
  for (const auto& id : broken) {
    ++table_.counters().broken;
    table_.free(id, channel_end::broken, neighbour, out, now);
  }
  for (const auto& id : forgotten)
    setup_.go_on(table_, id, *table_.find(id), {around, out, now});
  table_.pump(out, now);
  return out;
}

bool channels::is_looking() const {
  return std::ranges::any_of(table_.all(), [](const auto& x) { return x.second.is_looking(); });
}

channels_outputs channels::look(std::optional<mote_id> heard, const surroundings& around,
                                instant now) {
  channels_outputs out;
  setup_.look(table_, heard, {around, out, now});
  table_.pump(out, now);
  return out;
}

// When time passes.

channels_outputs channels::on_time(instant now) {
  channels_outputs out;
  std::vector<std::pair<channel_id, channel_end>> over;
  for (const auto& [id, x] : table_.all()) {
    if (!x.open && x.setup_end <= now)
      over.emplace_back(id, channel_end::unreachable);
    else if (x.open && x.request.expiry_s > 0 && x.last_packet + x.request.expiry_s * 1s <= now)
      over.emplace_back(id, channel_end::expired);
  }
  for (const auto& [id, why] : over) {
    table_.counters().expired += why == channel_end::expired ? 1 : 0;
    table_.free(id, why, std::nullopt, out, now);
  }
  setup_.on_time(now);
  table_.pump(out, now);
  return out;
}

std::optional<instant> channels::deadline() const {
  auto next = earliest(setup_.deadline(), table_.waiting().deadline());
  for (const auto& [id, x] : table_.all()) {
    if (!x.open)
      next = earliest(next, x.is_looking() ? std::min(x.setup_end, *x.look_end) : x.setup_end);
    else if (x.request.expiry_s > 0)
      next = earliest(next, x.last_packet + x.request.expiry_s * 1s);
  }
  return next;
}

// What is asked.

std::optional<std::uint8_t> channels::hops(channel_id channel) const {
  const auto* const x = table_.find(channel);
  return x != nullptr && x->open ? std::optional(x->request.hops) : std::nullopt;
}

std::optional<duration> channels::latency_bound(channel_id channel) const {
  const auto length = hops(channel);
  if (!length)
    return std::nullopt;
  const auto& config = table_.config();
  const auto own = config.data_rounds_max * radio_round_max +
                   2 * config.round_pause * (config.data_rounds_max - 1);
  const auto frames = static_cast<std::int64_t>(2 * config.queue_max);
  const auto before =
      frames * radio_try_max +
      2 * (frames + static_cast<std::int64_t>(config.data_rounds_max)) * config.wake;
  return *length * (before + own + duration(table_.find(channel)->request.schedule.interval));
}

std::vector<channel_id> channels::table() const {
  std::vector<channel_id> all;
  for (const auto& [id, x] : table_.all())
    all.push_back(id);
  return all;
}

std::size_t channels::footprint() const {
  const auto& config = table_.config();
  // one that waits: next hop, kind, channel, sequence, rounds, when it is due
  return config.entries_max * (36 + 2 * config.tries_max) + config.offers_max * 12 +
         dead_ends::count_max * 6 + config.octets_max + (2 * config.queue_max + 1) * 12 + 16;
}

} // namespace rubicon::network
