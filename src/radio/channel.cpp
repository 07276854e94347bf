#include "radio/channel.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::radio {

std::string to_string(power x) {
  switch (x) {
  case power::on:
    return "on";
  case power::off:
    return "off";
  case power::flat:
    return "flat";
  }
  return "unknown";
}

namespace {

/// A battery is asked whether it is flat no more often than this.
constexpr duration battery_check = 10ms;

outgoing pack(std::uint64_t token, const frame& header) {
  outgoing x;
  x.token = token;
  x.psdu = encode(header);
  x.content = *decode(x.psdu.view()); // views the octets that all receivers will share
  return x;
}

} // namespace

channel::channel(const channel_config& config, random_stream dice)
    : config_(config), dice_(dice), topology_(config.range_m, config.loss) {}

radio_index channel::add(const radio_config& config, instant now) {
  assert(config.kind != nullptr);
  assert(queue_.empty() || queue_.top().at >= now);
  const auto radio = topology_.add(config.place);
  medium_.add(energy_meter(config.kind, config.battery_mah.value_or(config.kind->battery_mah), now),
              now);
  station x;
  x.address = config.address;
  x.pan = config.pan;
  x.kind = config.kind;
  x.next_dsn = static_cast<std::uint8_t>(dice_.below(256)); // random on CC2420 (tinyos.md 4.2)
  x.sender = mac(config_.queue, config_.retries_max);
  const auto attempts = static_cast<duration::rep>(config_.retries_max) + 1;
  x.inbox = receiver(config.address, config.pan, config.promiscuous, config.kind->receive_slots,
                     attempts * timing::attempt_max);
  stations_.push_back(std::move(x));
  watch_battery(radio, now);
  return radio;
}

void channel::move(radio_index radio, position place) {
  topology_.move(radio, place);
}

void channel::set_loss(radio_index from, radio_index to, double loss) {
  topology_.set_loss(from, to, loss);
}

outputs channel::send(radio_index radio, request what, instant now) {
  outputs out;
  run_until(now, out);
  auto& x = at(radio);
  ++x.counted.requests.requests;
  if (x.supply != power::on) {
    conclude(radio, {what.token, send_status::aborted, 0}, out);
    return out;
  }
  if (x.sender.full()) {
    conclude(radio, {what.token, send_status::queue_full, 0}, out);
    return out;
  }
  frame header;
  header.ack_request = what.ack && what.destination != broadcast_mote;
  header.dsn = x.next_dsn++;
  header.pan = x.pan;
  header.destination = what.destination;
  header.source = x.address;
  header.am_type = what.am_type;
  header.payload = what.payload;
  x.sender.submit(pack(what.token, header), now, dice_);
  follow(radio, {}, now, out);
  return out;
}

outputs channel::set_power(radio_index radio, power state, instant now) {
  outputs out;
  run_until(now, out);
  auto& x = at(radio);
  if (x.supply == state || x.supply == power::flat)
    return out;
  if (x.supply == power::on)
    silence(radio, now, out);
  x.supply = state;
  switch (state) {
  case power::on:
    medium_.switch_on(radio, now);
    break;
  case power::off:
    break;
  case power::flat:
    medium_.meter(radio).stop(now);
    break;
  }
  return out;
}

outputs channel::on_time(instant now) {
  outputs out;
  run_until(now, out);
  return out;
}

std::optional<instant> channel::deadline() const {
  if (queue_.empty())
    return std::nullopt;
  return queue_.top().at;
}

// ------------------------------------------------------------------------------------------ events

void channel::run_until(instant now, outputs& out) {
  while (!queue_.empty()) {
    const auto next = queue_.top();
    if (is_current(next)) {
      if (next.at > now)
        return;
      queue_.pop();
      ++events_;
      handle(next, out);
    } else {
      queue_.pop();
    }
  }
}

bool channel::is_current(const event& x) const {
  const radio_index radio{x.subject};
  switch (x.kind) {
  case event_kind::mac_timer:
    return at(radio).mac_stamp == x.stamp;
  case event_kind::ack_due:
    return at(radio).ack_stamp == x.stamp;
  case event_kind::frame_end:
    return medium_.stamp(x.subject) == x.stamp;
  case event_kind::battery_low:
    return at(radio).supply != power::flat;
  }
  return false;
}

void channel::handle(const event& x, outputs& out) {
  const radio_index radio{x.subject};
  switch (x.kind) {
  case event_kind::mac_timer:
    return on_mac_timer(radio, x.at, out);
  case event_kind::ack_due:
    return on_ack_due(radio, x.at);
  case event_kind::frame_end:
    return on_frame_end(x.subject, x.at, out);
  case event_kind::battery_low:
    return on_battery_low(radio, x.at, out);
  }
}

void channel::on_mac_timer(radio_index radio, instant now, outputs& out) {
  auto& x = at(radio);
  x.scheduled.reset();
  // An ack of its own that is due keeps a transceiver as busy as one on the air.
  const bool clear = !x.ack_dsn && medium_.clear(radio, now - timing::cca);
  const auto todo = x.sender.on_time(now, clear, dice_);
  follow(radio, todo, now, out);
}

void channel::on_ack_due(radio_index radio, instant now) {
  auto& x = at(radio);
  transmission ack;
  ack.from = radio;
  ack.content.type = frame_type::ack;
  ack.content.dsn = *x.ack_dsn;
  x.ack_dsn.reset();
  ++x.counted.acks;
  put_on_air(std::move(ack), air_time(ack_size), now);
}

void channel::on_frame_end(slot_index slot, instant now, outputs& out) {
  const auto sender = medium_.content(slot).from;
  const bool is_data = medium_.content(slot).content.type == frame_type::data;
  end_frame(slot, now, out);
  if (is_data)
    follow(sender, at(sender).sender.on_sent(now, dice_), now, out);
}

void channel::on_battery_low(radio_index radio, instant now, outputs& out) {
  const auto& meter = medium_.meter(radio);
  if (meter.used_mah(now) < meter.battery_mah()) {
    watch_battery(radio, now);
    return;
  }
  if (at(radio).supply == power::on)
    silence(radio, now, out);
  at(radio).supply = power::flat;
  medium_.meter(radio).stop(now);
  out.emplace_back(exhausted{radio});
}

void channel::watch_battery(radio_index radio, instant now) {
  const auto lasts = medium_.meter(radio).lasts_until(now);
  if (lasts != instant::max())
    queue_.push({.at = std::max(lasts, now + battery_check),
                 .stamp = 0,
                 .subject = radio.value,
                 .kind = event_kind::battery_low});
}

// --------------------------------------------------------------------------------------- reception

void channel::on_copy(const transmission& sent, const hearer& x, fate end, instant now,
                      outputs& out) {
  auto& book = at(x.radio).counted.copies;
  ++book.sent;
  switch (end) {
  case fate::off:
    ++book.off;
    return;
  case fate::half_duplex:
    ++book.half_duplex;
    return;
  case fate::collision:
    ++book.collision;
    return;
  case fate::intact:
    break;
  }
  if (dice_.chance(static_cast<double>(x.loss)))
    ++book.loss;
  else if (sent.content.type == frame_type::ack)
    on_ack(x.radio, sent.content.dsn, now, out);
  else
    on_data(sent, x, now, out);
}

void channel::on_ack(radio_index radio, std::uint8_t dsn, instant now, outputs& out) {
  auto& x = at(radio);
  if (!x.sender.awaits(dsn)) {
    ++x.counted.copies.filtered;
    return;
  }
  ++x.counted.copies.delivered;
  ++x.counted.acks_received;
  follow(radio, x.sender.on_ack(now, dice_), now, out);
}

void channel::on_data(const transmission& sent, const hearer& x, instant now, outputs& out) {
  auto& y = at(x.radio);
  auto& book = y.counted.copies;
  switch (y.inbox.on_frame(sent.content, y.kind->service_time, medium_.meter(x.radio), now)) {
  case verdict::filtered:
    ++book.filtered;
    return;
  case verdict::overflow:
    ++book.overflow;
    return;
  case verdict::duplicate:
    ++book.duplicate;
    break;
  case verdict::accepted:
    ++book.delivered;
    out.emplace_back(delivered{x.radio, sent.psdu, sent.content, x.heard.rssi_dbm, x.heard.lqi});
    break;
  }
  if (!sent.content.ack_request || !y.inbox.addressed(sent.content))
    return;
  y.ack_dsn = sent.content.dsn;
  queue_.push({.at = now + timing::turnaround,
               .stamp = ++y.ack_stamp,
               .subject = x.radio.value,
               .kind = event_kind::ack_due});
}

// ----------------------------------------------------------------------------------------- sending

void channel::follow(radio_index radio, const mac_action& todo, instant now, outputs& out) {
  if (todo.transmit)
    send_current(radio, now);
  if (todo.ended)
    conclude(radio, *todo.ended, out);
  auto& x = at(radio);
  const auto due = x.sender.deadline();
  if (due == x.scheduled)
    return;
  x.scheduled = due;
  ++x.mac_stamp;
  if (due)
    queue_.push(
        {.at = *due, .stamp = x.mac_stamp, .subject = radio.value, .kind = event_kind::mac_timer});
}

void channel::send_current(radio_index radio, instant now) {
  auto& x = at(radio);
  const auto& current = x.sender.current();
  if (current.transmissions == 1) // a repeat costs the MCU nothing: the frame is still in the chip
    medium_.meter(radio).work(x.kind->service_time, now);
  put_on_air({radio, current.content, current.psdu}, air_time(current.psdu.size()), now);
}

void channel::put_on_air(transmission x, duration length, instant now) {
  const auto from = x.from;
  ++at(from).counted.transmissions;
  const auto slot = medium_.start(std::move(x), topology_.around(from), now);
  queue_.push({.at = now + length,
               .stamp = medium_.stamp(slot),
               .subject = slot,
               .kind = event_kind::frame_end});
}

void channel::end_frame(slot_index slot, instant now, outputs& out) {
  medium_.end(slot, now, [&](const transmission& sent, const hearer& x, fate end) {
    on_copy(sent, x, end, now, out);
  });
}

void channel::conclude(radio_index radio, const finished& x, outputs& out) {
  auto& book = at(radio).counted.requests;
  switch (x.status) {
  case send_status::sent:
    ++book.sent;
    break;
  case send_status::no_ack:
    ++book.no_ack;
    break;
  case send_status::channel_access_failure:
    ++book.channel_access_failure;
    break;
  case send_status::queue_full:
    ++book.queue_full;
    break;
  case send_status::aborted:
    ++book.aborted;
    break;
  }
  out.emplace_back(done{radio, x.token, x.status, x.transmissions});
}

/// A radio that was on goes off.
void channel::silence(radio_index radio, instant now, outputs& out) {
  auto& x = at(radio);
  for (const auto& y : x.sender.abort())
    conclude(radio, y, out);
  x.scheduled.reset();
  ++x.mac_stamp;
  x.ack_dsn.reset();
  ++x.ack_stamp;
  x.inbox.reset();
  if (const auto slot = medium_.sending(radio)) {
    medium_.cut(*slot);
    end_frame(*slot, now, out);
  }
  medium_.switch_off(radio, now);
  medium_.meter(radio).drop_work(now);
}

} // namespace rubicon::radio
