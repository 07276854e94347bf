// From a request to what has become of the copies of its frame.
#include <algorithm>
#include <cassert>
#include <chrono>
#include <span>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "core/codec.hpp"
#include "radio/channel/channel.hpp"
#include "radio/raw_frame.hpp"

namespace rubicon::radio {

namespace {

outgoing encoded(std::uint64_t token, const frame& header) {
  outgoing x;
  x.token = token;
  x.content = header;
  x.psdu = encode(header);
  x.content.payload = x.psdu.view().subspan(header_size, header.payload.size());
  return x;
}

outgoing pack_raw(std::uint64_t token, byte_view octets, std::uint16_t pan) {
  outgoing x;
  x.token = token;
  x.content = read_header(octets, pan);
  x.psdu = with_fcs(octets);
  return x;
}

/// The frame as it goes on the air from `begin` on.
transmission stamped(radio_index from, const outgoing& x, instant begin) {
  transmission sent{.from = from,
                    .content = x.content,
                    .psdu = x.psdu,
                    .length = air_time(x.psdu.size()),
                    .origin = x.from};
  if (!x.age_at)
    return sent;
  auto octets = to_bytes(x.content.payload);
  const auto field = std::span(octets).subspan(*x.age_at, 4);
  const auto waited = std::chrono::floor<std::chrono::microseconds>(begin + sfd_delay - x.asked);
  byte_writer age;
  age.big(byte_reader(field).big<std::uint32_t>() + static_cast<std::uint32_t>(waited.count()));
  std::ranges::copy(age.finish(), field.begin());
  sent.content.payload = octets;
  sent.psdu = encode(sent.content);
  sent.content.payload = sent.psdu.view().subspan(header_size, octets.size());
  return sent;
}

constexpr std::size_t receivers_usual = 8; ///< of a broadcast: memory for them is taken at once

copy_outcome to_copy_outcome(outcome x) {
  switch (x) {
  case outcome::weak:
    return copy_outcome::weak;
  case outcome::collision:
    return copy_outcome::collision;
  case outcome::captured:
    return copy_outcome::captured;
  case outcome::half_duplex:
    return copy_outcome::half_duplex;
  case outcome::off:
    return copy_outcome::off;
  case outcome::intact:
    break;
  }
  return copy_outcome::delivered;
}

} // namespace

outgoing channel::pack(station& x, const request& what) {
  if (what.is_raw)
    return pack_raw(what.token, what.payload.view(), x.pan);
  frame header;
  header.ack_request = what.ack && what.destination != broadcast_mote;
  header.dsn = x.next_dsn++;
  header.pan = x.pan;
  header.destination = what.destination;
  header.source = x.address;
  header.am_type = what.am_type;
  header.payload = what.payload.view();
  auto frame = encoded(what.token, header);
  frame.age_at = what.age_at;
  frame.in_slot = what.in_slot && !x.sender.repeats();
  return frame;
}

void channel::conclude(radio_index radio, const finished& x, outputs& out) {
  auto& counters = at(radio).counted.requests;
  switch (x.status) {
  case send_status::sent:
    ++counters.sent;
    if (!x.arrived)
      note_loss(x.from, x.acked ? loss::false_ack : loss::not_received);
    break;
  case send_status::no_ack:
    ++counters.failed.no_ack;
    break;
  case send_status::channel_access_failure:
    ++counters.failed.channel_access_failure;
    break;
  case send_status::queue_full:
    ++counters.failed.queue_full;
    break;
  case send_status::aborted:
    ++counters.failed.aborted;
    break;
  }
  out.emplace_back(done{radio, x.token, x.status, x.transmissions, x.arrived, x.last, x.from});
}

void channel::send_current(radio_index radio, instant now) {
  auto& x = at(radio);
  const auto& current = x.sender.current();
  if (current.transmissions == 1) // a repeat costs the MCU nothing: the frame is still in the chip
    medium_.meter(radio).work(x.service_time, now);
  put_on_air(stamped(radio, current, now), now);
}

void channel::put_on_air(transmission x, instant now) {
  const auto from = x.from;
  x.begin = now;
  const auto end = now + x.length;
  ++at(from).counted.transmissions;
  const auto slot = medium_.start(std::move(x), topology_.around(from));
  queue_.push({.at = end,
               .output_at = end,
               .stamp = medium_.stamp(slot),
               .subject = slot,
               .kind = event_kind::frame_end});
}

void channel::end_frame(slot_index slot, instant now, outputs& out) {
  const auto& frame = medium_.content(slot);
  auto& sender = at(frame.from);
  const bool is_ack = frame.content.type == frame_type::ack;
  const bool is_current = !is_ack && sender.sender.now_in() == mac::state::sending;
  const bool guards = guards_ && frame.content.ack_request;
  book_frame(slot);
  const bool filters = filters_most(slot);
  if (filters)
    sender.copies.count_all_filtered();
  overheard seen;
  if (watched_)
    seen = describe(frame);
  // Nearly all copies of a busy place are filtered: that path is short.
  const auto judge = [&](const transmission& sent, const hearer& x, outcome end) {
    if (end != outcome::intact)
      return to_copy_outcome(end);
    if (x.loss != 0 && rng_.chance(static_cast<double>(x.loss) / 65535))
      return copy_outcome::loss;
    if (!disturbances_.empty() && rng_.chance(disturbances_.loss_in(at(x.radio).pan)))
      return copy_outcome::loss;
    if (guards)
      at(x.radio).guarded_until = now + at(x.radio).sender.rules().guard;
    if (is_ack ? !medium_.awaits_ack(x.radio) : !medium_.wanted(x.radio, sent.content))
      return copy_outcome::filtered;
    return is_ack ? on_ack(x.radio, sent.content.dsn, now, out) : on_data(sent, x, now, out);
  };
  const auto on_copy = [&](const transmission& sent, std::size_t place, const hearer& x,
                           outcome end) {
    const auto result = judge(sent, x, end);
    if (filters)
      sender.copies.except(place);
    sender.copies.count(place, result);
    const bool arrived = result == copy_outcome::delivered || result == copy_outcome::duplicate;
    seen.received = seen.received || arrived;
    if (!is_current || !medium_.addressed(x.radio, sent.content))
      return;
    auto& request = sender.sender.current();
    request.last = result;
    request.arrived = request.arrived || arrived;
    seen.outcome = result;
  };
  medium_.end(slot, now, rng_, on_copy, filters);
  if (watched_)
    out.emplace_back(std::move(seen));
}

/// Whether nothing is to be decided about most copies of a frame: they arrive, and are filtered.
bool channel::filters_most(slot_index slot) const {
  const auto& content = medium_.content(slot).content;
  const bool is_for_one = content.type == frame_type::ack || content.destination != broadcast_mote;
  return is_for_one && medium_.is_lone(slot) && disturbances_.empty() && !guards_ && !sleeps_;
}

/// Makes the sender's counters those about the frame's hearers, and counts the frame there.
void channel::book_frame(slot_index slot) {
  auto& counters = at(medium_.content(slot).from).copies;
  if (!counters.is_about(medium_.heard_by(slot))) {
    retire(counters);
    counters.begin(medium_.heard_by(slot));
  }
  counters.count_frame();
}

void channel::retire(const link_counters& x) {
  if (x.to() == nullptr)
    return;
  for (std::size_t place = 0; place < x.to()->size(); ++place)
    at((*x.to())[place].radio).counted.copies += x.link(place);
}

overheard channel::describe(const transmission& x) const {
  const bool is_ack = x.content.type == frame_type::ack;
  return {.pan = at(x.from).pan,
          .begin = x.begin,
          .psdu = is_ack ? payload(encode(x.content)) : x.psdu,
          .from = x.origin};
}

copy_outcome channel::on_ack(radio_index radio, std::uint8_t dsn, instant now, outputs& out) {
  auto& x = at(radio);
  if (!x.sender.awaits(dsn))
    return copy_outcome::filtered;
  ++x.counted.acks_received;
  follow(radio, x.sender.on_ack(now, rng_), now, out);
  return copy_outcome::delivered;
}

copy_outcome channel::on_data(const transmission& sent, const hearer& x, instant now,
                              outputs& out) {
  auto& y = at(x.radio);
  const bool addressed = medium_.addressed(x.radio, sent.content);
  const bool may_repeat = addressed || y.sender.repeats();
  auto outcome = copy_outcome::duplicate;
  switch (y.inbox.on_frame(sent.content, may_repeat, y.service_time, medium_.meter(x.radio), now)) {
  case verdict::overflow:
    return copy_outcome::overflow;
  case verdict::duplicate:
    note_loss(sent.origin, loss::duplicate);
    break;
  case verdict::accepted:
    outcome = copy_outcome::delivered;
    stay_awake(x.radio, now);
    if (out.empty())
      out.reserve(receivers_usual);
    out.emplace_back(delivered{x.radio, sent.psdu, sent.content, x.rssi_dbm, x.lqi, sent.origin});
    break;
  }
  if (sent.content.ack_request && addressed) {
    y.ack_dsn = sent.content.dsn;
    const auto begin = now + y.sender.rules().ack_delay;
    queue_.push({.at = begin,
                 .output_at = begin + air_time(ack_size),
                 .stamp = ++y.ack_stamp,
                 .subject = x.radio.value,
                 .kind = event_kind::ack_due});
    y.sender.on_own_ack(begin + air_time(ack_size), rng_);
    follow(x.radio, {}, now, out);
  }
  return outcome;
}

} // namespace rubicon::radio
