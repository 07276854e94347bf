#include "peis/links/heartbeats.hpp"

#include <algorithm>

namespace rubicon::peis {

namespace {

constexpr int beats_skipped = 10; // while there is traffic, one heartbeat in so many periods
constexpr int one_way_smoothing = 16;

} // namespace

instant heartbeats::next_of(const connection& x) const {
  return std::min(x.out.last_written + own_.config.heartbeat_period,
                  x.signs.beat_sent + beats_skipped * own_.config.heartbeat_period);
}

void heartbeats::expect(const connection& x) {
  if (x.open && health_.is_marked(x))
    next_ = earliest(next_, next_of(x));
}

/// So much before they are due they leave with others: in a large network all links of a peer beat
/// in one moment then.
duration heartbeats::lead() const {
  return hosts_.all().size() < hosts_many ? duration(0) : own_.config.heartbeat_period / 2;
}

void heartbeats::on_time(instant now) {
  if (!next_ || *next_ > now)
    return;
  next_.reset();
  const auto due = now + lead();
  for (auto& [link, x] : links_.all()) {
    const bool beats = next_of(x) <= due;
    if (!x.open || (!beats && next_ && *next_ <= next_of(x)) || !health_.is_marked(x))
      continue;
    if (beats) {
      send(x, now, own_origin);
      x.out.last_written = now; // it leaves with this flush, or the link is stuck
    }
    next_ = earliest(next_, next_of(x));
  }
}

void heartbeats::send(connection& x, instant now, link_id origin) {
  heartbeat message{now, {}, {}};
  if (x.signs.beat) {
    message.echoed = x.signs.beat->sent;
    message.held = now - x.signs.beat_received;
  }
  sender_.send_to_neighbour(x, port::heartbeat, encode(message), origin);
  ++own_.counters.heartbeats_sent;
  x.signs.beat_sent = now;
}

void heartbeats::on_heartbeat(connection& x, byte_view data, instant now) {
  const auto message = decode_heartbeat(data);
  if (!message) {
    ++own_.counters.malformed;
    return;
  }
  auto& signs = x.signs;
  if (message->echoed != instant{}) {
    const auto way = std::max<duration>((now - message->echoed - message->held) / 2, 0s);
    // The least is the least disturbed; it may grow slowly if the way has really changed.
    signs.one_way = !signs.one_way || way < *signs.one_way
                        ? way
                        : *signs.one_way + (way - *signs.one_way) / one_way_smoothing;
  }
  const bool first = !signs.beat;
  signs.beat = *message;
  signs.beat_received = now;
  if (first && health_.is_marked(x)) {
    send(x, now, x.id); // both ends know the round trip at once
    health_.watch_silence(x);
  }
}

} // namespace rubicon::peis
