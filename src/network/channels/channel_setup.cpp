#include "network/channels/channel_setup.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "network/channels/next_mote.hpp"

namespace rubicon::network {

namespace {

constexpr duration offer_lifetime = 5s;

/// As the next mote is to receive it: a packet comes there when it leaves here.
connect_message one_hop_on(connect_message x) {
  const bool is_source = x.hops == 0;
  ++x.hops;
  x.delay_us += is_source ? 0U : static_cast<std::uint32_t>(channel_slot.count());
  return x;
}

/// Whether the connect message is to wait for a neighbour, which it does once: at the source before
/// it goes to everybody, and where we have started lately.
bool waits(channel_entry& x, const channel_occasion& at) {
  const bool may_help = x.request.place && (at.around.is_new || !x.previous);
  if (!x.look_end && may_help)
    x.look_end = at.now + at.around.beacon_wait;
  return x.look_end && at.now < *x.look_end;
}

void flood(channel_table& table, channel_id id, channel_entry& x, const channel_occasion& at) {
  auto& counters = table.counters();
  ++counters.floods;
  ++(!x.request.place       ? counters.floods_place_unknown
     : !at.around.own_place ? counters.floods_self_unknown
                            : counters.floods_dead_end);
  x.flooded = true;
  auto request = one_hop_on(x.request);
  request.flooded = true;
  table.queue(broadcast_mote, {id, request}, at.now);
}

} // namespace

void channel_setup::begin(channel_table& table, channel_id id, const connect_message& request,
                          const channel_occasion& at) {
  auto& x = table.add(id);
  x.request = request;
  x.last_packet = at.now;
  x.setup_end = at.now + table.config().connect_timeout +
                turns_of(at.around, likely_hops(at.around, request.place));
  go_on(table, id, x, at);
}

/// Sends the connect message on: to a neighbour that is nearer, else, from the source, to the
/// destination itself if that may receive it, in a crowd before all others; else, when it has
/// waited for one, back, else to everybody.
void channel_setup::go_on(channel_table& table, channel_id id, channel_entry& x,
                          const channel_occasion& at) {
  channel_table::reserve(id, x, at.out);
  x.next = x.tried.size() < table.config().tries_max ? next_towards_destination(x, at.around)
                                                     : std::nullopt;
  if ((!x.next || at.around.is_crowd) && may_be_near(x, at.around))
    x.next = x.request.destination;
  if (x.next) {
    table.queue(*x.next, {id, one_hop_on(x.request)}, at.now);
    return;
  }
  if (waits(x, at))
    return;
  if (!x.previous || !x.request.place)
    return flood(table, id, x, at);
  ++table.counters().backtracks;
  const auto previous = *x.previous;
  table.erase(id);
  dead_ends_.add(id, at.now + at.around.beacon_wait);
  at.out.emplace_back(channel_reserved{id, {}});
  table.queue(previous, {id, dead_end_message{}}, at.now);
}

void channel_setup::on_connect(channel_table& table, mote_id from, channel_id id,
                               const connect_message& x, const channel_occasion& at,
                               random_stream& rng) {
  if (x.flooded)
    on_flooded(table, from, id, x, at, rng);
  else
    accept(table, from, id, x, at);
}

/// It comes from the previous mote of the path, or from all to the destination.
void channel_setup::accept(channel_table& table, mote_id from, channel_id id,
                           const connect_message& x, const channel_occasion& at) {
  if (const auto* known = table.find(id)) { // a repeat, or it came round in a circle
    if (known->previous != from)
      table.queue(from, {id, dead_end_message{}}, at.now);
    else if (known->open)
      table.queue(from, {id, connect_ack_message{known->request.hops}}, at.now);
    return;
  }
  if (dead_ends_.contains(id)) {
    table.queue(from, {id, dead_end_message{}}, at.now);
    return;
  }
  const auto& config = table.config();
  if (table.is_full() || x.hops > config.hops_max) {
    ++table.counters().refused;
    table.queue(from, {id, end_message{channel_end::no_room}}, at.now);
    return;
  }
  auto& here = table.add(id);
  here.previous = from;
  here.request = x;
  here.last_packet = at.now;
  here.setup_end = at.now + config.setup_timeout + turns_of(at.around, 2 * hops_likely);
  if (x.destination != config.self) {
    go_on(table, id, here, at);
    return;
  }
  here.open = true;
  ++table.counters().accepted;
  channel_table::reserve(id, here, at.out);
  table.queue(from, {id, connect_ack_message{x.hops}}, at.now);
  at.out.emplace_back(channel_accepted{id});
}

/// The first copy came the quickest route. Nothing is reserved before the destination has answered.
void channel_setup::on_flooded(channel_table& table, mote_id from, channel_id id,
                               const connect_message& x, const channel_occasion& at,
                               random_stream& rng) {
  if (auto* again = offers_.find(id)) {
    again->heard.note(x.hops, again->request.hops);
    if (again->heard.received() == flood_copies::enough && at.around.is_crowd)
      table.waiting().drop_flood(id);
    return;
  }
  if (auto* ours = table.find(id)) {
    ours->heard.note(x.hops, ours->request.hops);
    return;
  }
  const auto& config = table.config();
  if (id.source == config.self)
    return;
  if (x.destination == config.self) {
    auto plain = x;
    plain.flooded = false;
    accept(table, from, id, plain, at);
    return;
  }
  if (offers_.is_full() || table.is_full() || x.hops > config.hops_max)
    return;
  offers_.add(id, {from, x, at.now + offer_lifetime + turns_of(at.around, hops_likely), {}});
  const auto is_near = [&](const nearby_mote& y) { return y.mote == x.destination; };
  if (std::ranges::any_of(at.around.motes, is_near)) // perhaps of all who receive this we alone
    table.queue(x.destination, {id, one_hop_on(x)}, at.now);
  else
    table.queue(broadcast_mote, {id, one_hop_on(x)}, at.now + rng.between(0s, config.flood_spread));
}

void channel_setup::on_ack(channel_table& table, mote_id from, channel_id id,
                           const connect_ack_message& ack, const channel_occasion& at) {
  auto* x = table.find(id);
  if (x == nullptr) {
    const auto offered = offers_.take_up(id);
    if (!offered || table.is_full()) {
      ++table.counters().strays;
      table.queue(from, {id, end_message{channel_end::no_room}}, at.now);
      return;
    }
    x = &table.add(id);
    x->previous = offered->previous;
    x->request = offered->request;
    x->last_packet = at.now;
  }
  if (x->open && x->next != from) { // two of the flood's copies have come to the destination
    table.queue(from, {id, end_message{channel_end::disconnected}}, at.now);
    return;
  }
  x->next = from;
  table.waiting().drop_flood(id);
  if (std::exchange(x->open, true))
    return;
  x->request.hops = ack.hops;
  channel_table::reserve(id, *x, at.out);
  if (x->previous) {
    table.queue(*x->previous, {id, ack}, at.now);
  } else {
    ++table.counters().connected;
    at.out.emplace_back(channel_connected{id});
  }
}

void channel_setup::on_dead_end(channel_table& table, mote_id from, channel_id id,
                                const channel_occasion& at) {
  auto* const x = table.find(id);
  if (x == nullptr || x->next != from || x->open) {
    ++table.counters().strays;
    return;
  }
  x->tried.push_back(from);
  go_on(table, id, *x, at);
}

void channel_setup::on_no_answer(channel_table& table, channel_id id, channel_entry& x,
                                 const channel_occasion& at) {
  x.tried.push_back(*std::exchange(x.next, std::nullopt));
  go_on(table, id, x, at);
}

void channel_setup::look(channel_table& table, std::optional<mote_id> heard,
                         const channel_occasion& at) {
  std::vector<channel_id> looking;
  for (const auto& [id, x] : table.all()) {
    if (x.is_looking() && (heard || *x.look_end <= at.now))
      looking.push_back(id);
  }
  for (const auto& id : looking) {
    auto& x = *table.find(id);
    if (!heard)
      x.tried.clear(); // its only wait is over: once more from the beginning
    else
      std::erase(x.tried, *heard);
    go_on(table, id, x, at);
  }
}

unsigned channel_setup::rounds_of_flood(const channel_table& table, channel_id id) const {
  if (const auto* offered = offers_.find(id))
    return offered->heard.rounds();
  const auto* ours = table.find(id);
  return (ours != nullptr ? ours->heard : flood_copies{}).rounds();
}

void channel_setup::on_time(instant now) {
  offers_.on_time(now);
  dead_ends_.on_time(now);
}

std::optional<instant> channel_setup::deadline() const {
  return earliest(offers_.deadline(), dead_ends_.deadline());
}

} // namespace rubicon::network
