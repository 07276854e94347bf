#include "peis/udp/udp_session.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr unsigned probes_of_a_retry = 2;
constexpr unsigned retries_of_a_stall = 3;
/// A sender without credit may ask with a part whether there is room again.
constexpr std::size_t parts_to_spare = 16;
constexpr std::size_t bitmap_max = 64; ///< octets
constexpr std::size_t inbox_first = std::size_t{64} * 1024;

/// What a number stands for of which only the last 32 bits were sent: the one nearest to `near`.
std::uint64_t widened(std::uint32_t x, std::uint64_t near) {
  const auto ahead = static_cast<std::int32_t>(x - static_cast<std::uint32_t>(near));
  if (ahead < 0 && near < static_cast<std::uint64_t>(-static_cast<std::int64_t>(ahead)))
    return 0;
  return near + static_cast<std::uint64_t>(static_cast<std::int64_t>(ahead));
}

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
  if (x.expected > first_ + parts_.size() || widened(x.newest, sent_) > sent_) {
    ++counted.impossible;
    return;
  }
  last_word_ = now;
  room_ = std::max<std::uint16_t>(1, x.room);
  const bool is_news = note_report(x, now);
  acknowledge(x, now);
  if (is_news) {
    rate_.on_report(reported_, reported_count_, sent_, now);
    find_losses(now);
  }
  if (x.number != 0)
    take_part(x, counted);
}

/// @returns whether it is later than what has come before
bool udp_session::note_report(const udp_segment& x, instant now) {
  limit_ = std::max(limit_, x.expected + x.credit);
  const auto newest = widened(x.newest, sent_);
  if (newest < reported_ || x.newest == 0)
    return false;
  if (newest > reported_) {
    retries_ = 0;
    retry_at_ = now + rate_.retry_after(0);
  }
  reported_ = newest;
  reported_count_ = std::max(reported_count_, widened(x.count, newest));
  return true;
}

void udp_session::note_arrival(part& x, instant now) {
  if (x.state == part_state::arrived)
    return;
  if (x.number == reported_)
    rate_.on_round_trip(now - x.sent, now);
  if (x.state == part_state::under_way)
    --under_way_;
  else
    --lost_;
  x.state = part_state::arrived;
  acknowledged_ += x.content.size();
  unacknowledged_ -= x.content.size();
}

void udp_session::acknowledge(const udp_segment& x, instant now) {
  for (; first_ < x.expected; ++first_) {
    note_arrival(parts_.front(), now);
    parts_.pop_front();
  }
  if (x.number != 0)
    return;
  for (std::size_t i = 0; i < 8 * x.content.size(); ++i) {
    const auto sequence = x.expected + 1 + i;
    const bool has_come = (x.content[i / 8] >> (7 - i % 8) & 1) != 0;
    if (has_come && sequence >= first_ && sequence - first_ < parts_.size())
      note_arrival(parts_[sequence - first_], now);
  }
}

/// Lost is what was sent before a part that has come, and is out for longer than reordering takes.
void udp_session::find_losses(instant now) {
  loss_at_.reset();
  if (under_way_ == 0)
    return;
  const auto after = rate_.lost_after();
  for (auto& x : parts_) {
    if (x.state != part_state::under_way || x.number >= reported_)
      continue;
    if (x.sent + after <= now) {
      x.state = part_state::lost;
      --under_way_;
      ++lost_;
    } else {
      loss_at_ = earliest(loss_at_, x.sent + after);
    }
  }
}

void udp_session::take_part(const udp_segment& x, udp_counters& counted) {
  ++count_;
  newest_ = std::max(newest_, widened(x.number, newest_));
  report_due_ = true;
  const auto waiting = inbox_.size() / udp_content_max;
  if (x.sequence < expected_ || early_.contains(x.sequence)) {
    ++counted.repeated;
  } else if (x.sequence - expected_ >= config_.parts_max ||
             waiting >= config_.parts_max + parts_to_spare) {
    ++counted.out_of_window;
  } else if (x.sequence != expected_) {
    early_.emplace(x.sequence, to_bytes(x.content));
  } else {
    append_in_order(x.content);
  }
}

void udp_session::append_in_order(byte_view content) {
  if (inbox_.capacity() < inbox_first)
    inbox_.reserve(inbox_first);
  inbox_.insert(inbox_.end(), content.begin(), content.end());
  ++expected_;
  while (!early_.empty() && early_.begin()->first == expected_) {
    const auto& next = early_.begin()->second;
    inbox_.insert(inbox_.end(), next.begin(), next.end());
    early_.erase(early_.begin());
    ++expected_;
  }
}

bytes udp_session::take_received(bytes next) {
  next.clear();
  auto x = std::exchange(inbox_, std::move(next));
  if (given_credit_ < config_.parts_max / 2)
    report_due_ = true; // the other side may be waiting for it
  return x;
}

std::size_t udp_session::take_acknowledged() {
  return std::exchange(acknowledged_, 0);
}

// Time.

bool udp_session::on_time(instant now) {
  if (expects_word() && last_word_ + config_.silence_max <= now)
    return false;
  if (loss_at_ && *loss_at_ <= now)
    find_losses(now);
  if (expects_word() && retry_at_ <= now) {
    ++retries_;
    probes_ = probes_of_a_retry;
    if (retries_ == retries_of_a_stall)
      rate_.on_stall();
    retry_at_ = now + rate_.retry_after(retries_);
  }
  return true;
}

std::optional<instant> udp_session::deadline() const {
  if (!expects_word())
    return std::nullopt;
  return earliest(loss_at_, std::min(retry_at_, last_word_ + config_.silence_max));
}

// What leaves.

void udp_session::flush(instant now, std::uint16_t room, std::vector<udp_batch>& out,
                        udp_counters& counted) {
  if (parts_.empty() && queued_ > 0 && retries_ == 0) { // nothing was waited for
    last_word_ = std::max(last_word_, now);
    retry_at_ = std::max(retry_at_, now + rate_.retry_after(0));
  }
  send_probes(now, room, out, counted);
  send_lost(now, room, out, counted);
  while (may_begin_part()) {
    parts_.push_back({next_content(), 0, {}, part_state::lost});
    ++lost_;
    transmit(first_ + parts_.size() - 1, now, room, out, counted);
  }
  if (queued_ > 0 && under_way_ >= rate_.window())
    rate_.note_limited();
  if (report_due_)
    send_report(room, out, counted);
}

std::size_t udp_session::room_in_window() const {
  const auto most = std::min<std::size_t>(rate_.window(), room_);
  return most - std::min(most, under_way_);
}

bool udp_session::may_begin_part() const {
  return queued_ > 0 && room_in_window() > 0 && parts_.size() < config_.parts_max &&
         first_ + parts_.size() < limit_;
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
  auto& x = parts_[sequence - first_];
  assert(x.state != part_state::arrived);
  if (x.number != 0)
    ++counted.parts_resent;
  ++counted.parts_sent;
  if (x.state == part_state::lost) {
    --lost_;
    ++under_way_;
  }
  x.state = part_state::under_way;
  if (static_cast<std::uint32_t>(++sent_) == 0)
    ++sent_; // it would say that there is no part
  x.number = sent_;
  x.sent = now;
  auto segment = report(room);
  segment.sequence = sequence;
  segment.number = static_cast<std::uint32_t>(sent_);
  segment.content = x.content;
  append(segment, out, counted);
  report_due_ = report_due_ && !early_.empty(); // this one says it, but for the bits
}

/// The two oldest parts that have not come, whatever the window; without credit the next one.
void udp_session::send_probes(instant now, std::uint16_t room, std::vector<udp_batch>& out,
                              udp_counters& counted) {
  if (probes_ == 0)
    return;
  for (std::size_t i = 0; i < parts_.size() && probes_ > 0; ++i) {
    if (parts_[i].state == part_state::arrived)
      continue;
    transmit(first_ + i, now, room, out, counted);
    --probes_;
  }
  if (probes_ > 0 && parts_.empty() && queued_ > 0) {
    parts_.push_back({next_content(), 0, {}, part_state::lost});
    ++lost_;
    transmit(first_, now, room, out, counted);
  }
  probes_ = 0;
}

void udp_session::send_lost(instant now, std::uint16_t room, std::vector<udp_batch>& out,
                            udp_counters& counted) {
  for (std::size_t i = 0; i < parts_.size() && lost_ > 0 && room_in_window() > 0; ++i) {
    if (first_ + i < limit_ && parts_[i].state == part_state::lost)
      transmit(first_ + i, now, room, out, counted);
  }
  if (lost_ > 0)
    rate_.note_limited();
}

void udp_session::send_report(std::uint16_t room, std::vector<udp_batch>& out,
                              udp_counters& counted) {
  auto segment = report(room);
  const auto bits = bitmap();
  segment.content = bits;
  append(segment, out, counted);
  report_due_ = false;
}

udp_segment udp_session::report(std::uint16_t room) {
  udp_segment x;
  x.room = room;
  x.token = token_;
  x.expected = expected_;
  x.newest = static_cast<std::uint32_t>(newest_);
  x.count = count_;
  x.credit = given_credit_ = credit();
  return x;
}

std::uint16_t udp_session::credit() const {
  const auto waiting = std::min(config_.parts_max, inbox_.size() / udp_content_max);
  return static_cast<std::uint16_t>(config_.parts_max - waiting);
}

bytes udp_session::bitmap() const {
  bytes x;
  for (const auto& [sequence, content] : early_) {
    const auto at = sequence - expected_ - 1;
    if (at / 8 >= bitmap_max)
      break;
    x.resize(std::max<std::size_t>(x.size(), at / 8 + 1));
    x[at / 8] = static_cast<std::uint8_t>(x[at / 8] | 0x80U >> at % 8);
  }
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
