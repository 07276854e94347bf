#include "radio/channel.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <span>
#include <utility>

#include "core/codec.hpp"

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
  x.content = header;
  x.psdu = encode(header);
  x.content.payload = x.psdu.view().subspan(header_size, header.payload.size());
  return x;
}

/// The frame as it goes on the air from `begin` on.
transmission stamped(radio_index from, const outgoing& x, instant begin) {
  transmission sent{
      .from = from, .content = x.content, .psdu = x.psdu, .length = air_time(x.psdu.size())};
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

const mac_rules* rules_for(const platform& kind, const channel_config& config) {
  const auto named =
      std::ranges::find(config.macs, kind.name, &std::pair<std::string, std::string>::first);
  const auto* rules = find_mac(named == config.macs.end() ? "standard" : named->second, kind);
  assert(rules != nullptr);
  return rules;
}

mote_address name_of(const radio_config& x) {
  return {island_id{x.pan}, x.address};
}

copy_fate to_copy_fate(fate x) {
  switch (x) {
  case fate::weak:
    return copy_fate::weak;
  case fate::collision:
    return copy_fate::collision;
  case fate::captured:
    return copy_fate::captured;
  case fate::half_duplex:
    return copy_fate::half_duplex;
  case fate::off:
    return copy_fate::off;
  case fate::intact:
    break;
  }
  return copy_fate::delivered;
}

} // namespace

channel::channel(const channel_config& config, random_stream dice)
    : config_(config), dice_(dice), topology_(config, dice_.next()), medium_(config),
      noise_seed_(dice_.next()) {}

void channel::reserve(std::size_t radios) {
  stations_.reserve(radios);
  medium_.reserve(radios);
}

radio_index channel::add(const radio_config& config, instant now) {
  assert(config.kind != nullptr);
  assert(queue_.empty() || queue_.top().at >= now);
  const auto& kind = *config.kind;
  const auto transmit_dbm = config.transmit_dbm.value_or(kind.transmit_dbm_max());
  const auto radio = topology_.add({name_of(config), config.place, transmit_dbm});
  transceiver_config ears;
  ears.address = config.address;
  ears.pan = config.pan;
  ears.promiscuous = config.promiscuous;
  ears.sensitivity_dbm = config_.sensitivity_dbm.value_or(kind.sensitivity_dbm);
  ears.cca_dbm = config_.cca_dbm.value_or(kind.cca_dbm);
  ears.noise = topology_.noise(radio);
  if (const auto* traced = std::get_if<traced_noise>(&config_.noise))
    ears.traced_noise = std::make_unique<noise_source>(
        traced->trace, random_stream(noise_seed_, to_string(name_of(config))));
  medium_.add(std::move(ears),
              energy_meter(&kind, config.battery_mah.value_or(kind.battery_mah), transmit_dbm, now),
              now);
  const auto* rules = rules_for(kind, config_);
  const auto retries = config_.retries_max.value_or(rules->retries_max);
  station x;
  x.address = config.address;
  x.pan = config.pan;
  x.added_at = now;
  x.next_dsn = static_cast<std::uint8_t>(rules->dsn_from_address ? 16 * config.address.value
                                                                 : dice_.below(256));
  x.sender = mac(rules, config_.queue, retries);
  x.inbox = receiver(rules, config_.receive_slots.value_or(kind.receive_slots),
                     rules->repeats_for(retries));
  x.service_time = config_.service_time.value_or(kind.service_time);
  guards_ = guards_ || rules->guard > 0s;
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
    conclude(radio, {.token = what.token, .status = send_status::aborted}, out);
    return out;
  }
  if (x.sender.full()) {
    conclude(radio, {.token = what.token, .status = send_status::queue_full}, out);
    return out;
  }
  frame header;
  header.ack_request = what.ack && what.destination != broadcast_mote;
  header.dsn = x.next_dsn++;
  header.pan = x.pan;
  header.destination = what.destination;
  header.source = x.address;
  header.am_type = what.am_type;
  header.payload = what.payload.view();
  auto frame = pack(what.token, header);
  frame.age_at = what.age_at;
  frame.asked = now;
  x.sender.submit(std::move(frame), now, dice_);
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
    run_down(radio, now);
    break;
  }
  return out;
}

outputs channel::on_time(instant now) {
  outputs out;
  run_until(now, out);
  return out;
}

std::optional<instant> channel::deadline() {
  return queue_.next_told(ran_until_, [this](const event& x) { return is_current(x); });
}

// ------------------------------------------------------------------------------------------ events

void channel::run_until(instant now, outputs& out) {
  ran_until_ = std::max(ran_until_, now);
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
  const bool clear =
      !x.sender.assesses() || (!x.ack_dsn && x.guarded_until <= now && medium_.clear(radio, now));
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
  if (medium_.sending(radio)) // by energy alone it did not sense the frame: its own came first
    return;
  ++x.counted.acks;
  ack.length = air_time(ack_size);
  put_on_air(std::move(ack), now);
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
  run_down(radio, now);
  out.emplace_back(exhausted{radio});
}

void channel::run_down(radio_index radio, instant now) {
  medium_.meter(radio).stop(now);
  at(radio).flat_at = now;
}

void channel::watch_battery(radio_index radio, instant now) {
  const auto lasts = medium_.meter(radio).lasts_until(now);
  if (lasts != instant::max())
    schedule({.at = std::max(lasts, now + battery_check),
              .told_at = std::max(lasts, now + battery_check),
              .stamp = 0,
              .subject = radio.value,
              .kind = event_kind::battery_low});
}

// --------------------------------------------------------------------------------------- reception

copy_fate channel::on_ack(radio_index radio, std::uint8_t dsn, instant now, outputs& out) {
  auto& x = at(radio);
  if (!x.sender.awaits(dsn))
    return copy_fate::filtered;
  ++x.counted.acks_received;
  follow(radio, x.sender.on_ack(now, dice_), now, out);
  return copy_fate::delivered;
}

copy_fate channel::on_data(const transmission& sent, const hearer& x, instant now, outputs& out) {
  auto& y = at(x.radio);
  const bool addressed = medium_.addressed(x.radio, sent.content);
  auto fate = copy_fate::duplicate;
  switch (y.inbox.on_frame(sent.content, addressed, y.service_time, medium_.meter(x.radio), now)) {
  case verdict::overflow:
    return copy_fate::overflow;
  case verdict::duplicate:
    break;
  case verdict::accepted:
    fate = copy_fate::delivered;
    out.emplace_back(delivered{x.radio, sent.psdu, sent.content, x.rssi_dbm, x.lqi});
    break;
  }
  if (sent.content.ack_request && addressed) {
    y.ack_dsn = sent.content.dsn;
    const auto begin = now + y.sender.rules().ack_delay;
    schedule({.at = begin,
              .told_at = begin + air_time(ack_size),
              .stamp = ++y.ack_stamp,
              .subject = x.radio.value,
              .kind = event_kind::ack_due});
  }
  return fate;
}

// ----------------------------------------------------------------------------------------- sending

void channel::follow(radio_index radio, const mac_action& todo, instant now, outputs& out) {
  if (todo.transmit)
    send_current(radio, now);
  if (todo.ended)
    conclude(radio, *todo.ended, out);
  auto& x = at(radio);
  medium_.await_ack(radio, x.sender.now_in() == mac::state::ack_wait);
  const auto due = x.sender.deadline();
  if (due == x.scheduled)
    return;
  x.scheduled = due;
  ++x.mac_stamp;
  if (due)
    schedule_mac(radio, *due);
}

/// Mostly the next assessment of all will find the channel clear, whatever else comes after it. To
/// know that saves waking up for the case that it does not.
void channel::schedule_mac(radio_index radio, instant due) {
  auto& x = at(radio);
  const event cautious{.at = due,
                       .told_at = x.sender.told_at(),
                       .stamp = x.mac_stamp,
                       .subject = radio.value,
                       .kind = event_kind::mac_timer};
  const bool is_next = queue_.empty() || due < queue_.top().at;
  const bool is_sure = is_next && x.sender.assesses() && !x.ack_dsn && x.guarded_until <= due &&
                       medium_.stays_clear(radio, due);
  auto hopeful = cautious;
  if (is_sure)
    hopeful.told_at = x.sender.told_at_if_clear();
  schedule(hopeful);
  if (is_sure)
    sure_ = cautious;
}

void channel::schedule(const event& x) {
  if (sure_ && x.at <= sure_->at) {
    queue_.tell(*sure_);
    sure_.reset();
  }
  queue_.push(x);
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
  schedule({.at = end,
            .told_at = end,
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
  overheard seen;
  if (watched_)
    seen = describe(frame);
  // Nearly all copies of a busy place are filtered: that way is short.
  const auto judge = [&](const transmission& sent, const hearer& x, fate end) {
    if (end != fate::intact)
      return to_copy_fate(end);
    if (x.loss != 0 && dice_.chance(static_cast<double>(x.loss) / 65535))
      return copy_fate::loss;
    if (guards)
      at(x.radio).guarded_until = now + at(x.radio).sender.rules().guard;
    if (is_ack ? !medium_.awaits_ack(x.radio) : !medium_.wanted(x.radio, sent.content))
      return copy_fate::filtered;
    return is_ack ? on_ack(x.radio, sent.content.dsn, now, out) : on_data(sent, x, now, out);
  };
  medium_.end(slot, now, dice_,
              [&](const transmission& sent, std::size_t place, const hearer& x, fate end) {
                const auto result = judge(sent, x, end);
                sender.copies.count(place, result);
                const bool arrived =
                    result == copy_fate::delivered || result == copy_fate::duplicate;
                seen.received = seen.received || arrived;
                if (!is_current || !medium_.addressed(x.radio, sent.content))
                  return;
                auto& request = sender.sender.current();
                request.last = result;
                request.arrived = request.arrived || arrived;
              });
  if (watched_)
    out.emplace_back(std::move(seen));
}

/// Makes the sender's book one about the frame's hearers, and counts the frame there.
void channel::book_frame(slot_index slot) {
  auto& book = at(medium_.content(slot).from).copies;
  if (!book.is_about(medium_.heard_by(slot))) {
    retire(book);
    book.begin(medium_.heard_by(slot));
  }
  book.count_frame();
}

void channel::retire(const link_books& x) {
  if (x.to() == nullptr)
    return;
  for (std::size_t place = 0; place < x.to()->size(); ++place)
    at((*x.to())[place].radio).counted.copies += x.link(place);
}

overheard channel::describe(const transmission& x) const {
  const bool is_ack = x.content.type == frame_type::ack;
  return {.pan = at(x.from).pan,
          .begin = x.begin,
          .psdu = is_ack ? payload(encode(x.content)) : x.psdu};
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
  out.emplace_back(done{radio, x.token, x.status, x.transmissions, x.arrived, x.last});
}

/// A radio that was on goes off.
void channel::silence(radio_index radio, instant now, outputs& out) {
  auto& x = at(radio);
  for (const auto& y : x.sender.abort())
    conclude(radio, y, out);
  x.scheduled.reset();
  ++x.mac_stamp;
  medium_.await_ack(radio, false);
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
