#include "peis/udp/udp_session.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr unsigned probes_of_a_retry = 2;
constexpr unsigned retries_of_a_stall = 3;

} // namespace

void udp_session::send(payload octets) {
  if (octets.empty())
    return;
  queued_ += octets.size();
  unacknowledged_ += octets.size();
  queue_.push_back(std::move(octets));
}

// What comes.

void udp_session::on_segment(const udp_segment& x, instant now, udp_counters& counted) {
  if (!parts_.is_possible(x)) {
    ++counted.impossible;
    return;
  }
  last_segment_ = now;
  room_ = std::max<std::uint16_t>(1, x.room);
  on_report(x, now);
  if (x.number != 0)
    on_part(x, counted);
}

void udp_session::on_report(const udp_segment& x, instant now) {
  using news = udp_send_window::news;
  limit_ = std::max(limit_, x.expected + x.credit);
  const auto what = parts_.on_report(x);
  if (what == news::newer) {
    retries_ = 0;
    retry_at_ = now + rate_.retry_after(0);
  }
  const auto arrived = parts_.acknowledge(x, now);
  acknowledged_ += arrived.octets;
  unacknowledged_ -= arrived.octets;
  if (arrived.round_trip)
    rate_.on_round_trip(*arrived.round_trip, now);
  if (what == news::none)
    return;
  rate_.on_report(parts_.newest(), parts_.count(), parts_.sent(), now);
  parts_.find_losses(now, rate_.lost_after());
}

void udp_session::on_part(const udp_segment& x, udp_counters& counted) {
  switch (received_.on_part(x)) {
  case udp_receiver::outcome::repeated:
    ++counted.repeated;
    break;
  case udp_receiver::outcome::out_of_window:
    ++counted.out_of_window;
    break;
  case udp_receiver::outcome::taken:
    break;
  }
}

std::size_t udp_session::take_acknowledged() {
  return std::exchange(acknowledged_, 0);
}

// Time.

bool udp_session::on_time(instant now) {
  if (awaits_report() && last_segment_ + config_.silence_max <= now)
    return false;
  if (parts_.deadline().value_or(instant::max()) <= now)
    parts_.find_losses(now, rate_.lost_after());
  if (awaits_report() && retry_at_ <= now) {
    ++retries_;
    probes_ = probes_of_a_retry;
    if (retries_ == retries_of_a_stall)
      rate_.on_stall();
    retry_at_ = now + rate_.retry_after(retries_);
  }
  return true;
}

std::optional<instant> udp_session::deadline() const {
  if (!awaits_report())
    return std::nullopt;
  return earliest(parts_.deadline(), std::min(retry_at_, last_segment_ + config_.silence_max));
}

// What leaves.

void udp_session::flush(instant now, std::uint16_t room, std::vector<udp_batch>& out,
                        udp_counters& counted) {
  if (parts_.size() == 0 && queued_ > 0 && retries_ == 0) { // nothing was waited for
    last_segment_ = std::max(last_segment_, now);
    retry_at_ = std::max(retry_at_, now + rate_.retry_after(0));
  }
  send_probes(now, room, out, counted);
  send_lost(now, room, out, counted);
  while (may_begin_part()) {
    parts_.add(next_content());
    transmit(parts_.next() - 1, now, room, out, counted);
  }
  if (queued_ > 0 && parts_.under_way() >= rate_.window())
    rate_.note_limited();
  if (received_.is_report_due())
    send_report(room, out, counted);
}

std::size_t udp_session::room_in_window() const {
  const auto most = std::min<std::size_t>(rate_.window(), room_);
  return most - std::min(most, parts_.under_way());
}

bool udp_session::may_begin_part() const {
  return queued_ > 0 && room_in_window() > 0 && parts_.size() < config_.parts_max &&
         parts_.next() < limit_;
}

bytes udp_session::next_content() {
  bytes x;
  x.reserve(std::min(udp_content_max, queued_));
  while (x.size() < udp_content_max && !queue_.empty()) {
    const auto rest = queue_.front().view().subspan(gone_);
    const auto some = rest.first(std::min(rest.size(), udp_content_max - x.size()));
    x.insert(x.end(), some.begin(), some.end());
    gone_ += some.size();
    if (gone_ == queue_.front().size()) {
      queue_.pop_front();
      gone_ = 0;
    }
  }
  queued_ -= x.size();
  return x;
}

void udp_session::transmit(std::uint64_t sequence, instant now, std::uint16_t room,
                           std::vector<udp_batch>& out, udp_counters& counted) {
  const auto x = parts_.transmit(sequence, now);
  counted.parts_resent += x.is_repeated ? 1 : 0;
  ++counted.parts_sent;
  auto segment = report(room);
  segment.sequence = sequence;
  segment.number = static_cast<std::uint32_t>(x.number);
  segment.content = x.content;
  append(segment, out, counted);
  received_.note_reported(false);
}

/// The two oldest parts that have not come, whatever the window; without credit the next one.
void udp_session::send_probes(instant now, std::uint16_t room, std::vector<udp_batch>& out,
                              udp_counters& counted) {
  if (probes_ == 0)
    return;
  for (auto i = parts_.first(); i < parts_.next() && probes_ > 0; ++i) {
    if (parts_.state_of(i) == udp_send_window::state::arrived)
      continue;
    transmit(i, now, room, out, counted);
    --probes_;
  }
  if (probes_ > 0 && parts_.size() == 0 && queued_ > 0) {
    parts_.add(next_content());
    transmit(parts_.first(), now, room, out, counted);
  }
  probes_ = 0;
}

void udp_session::send_lost(instant now, std::uint16_t room, std::vector<udp_batch>& out,
                            udp_counters& counted) {
  const auto end = std::min(parts_.next(), limit_);
  for (auto i = parts_.first(); i < end && parts_.lost() > 0 && room_in_window() > 0; ++i) {
    if (parts_.state_of(i) == udp_send_window::state::lost)
      transmit(i, now, room, out, counted);
  }
  if (parts_.lost() > 0)
    rate_.note_limited();
}

void udp_session::send_report(std::uint16_t room, std::vector<udp_batch>& out,
                              udp_counters& counted) {
  auto segment = report(room);
  const auto bits = received_.bitmap();
  segment.content = bits;
  append(segment, out, counted);
  received_.note_reported(true);
}

udp_segment udp_session::report(std::uint16_t room) {
  udp_segment x;
  x.room = room;
  x.token = token_;
  received_.report_in(x);
  return x;
}

void udp_session::append(const udp_segment& x, std::vector<udp_batch>& out, udp_counters& counted) {
  const auto size = udp_segment_header + x.content.size();
  const bool fits = !out.empty() && out.back().to == other_ && size <= out.back().each &&
                    out.back().octets.size() % out.back().each == 0 &&
                    out.back().octets.size() / out.back().each < batch_max;
  if (!fits) {
    out.push_back({other_, {}, size});
    if (size == udp_datagram_max && queued_ >= udp_content_max)
      out.back().octets.reserve(batch_max * udp_datagram_max);
  }
  encode(x, out.back().octets);
  ++counted.sent;
}

} // namespace rubicon::peis
