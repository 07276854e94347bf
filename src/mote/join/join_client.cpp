#include "mote/join/join_client.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::mote {

join_client::join_client(join_config config, bytes descriptor, std::uint32_t incarnation,
                         random_stream rng, std::uint32_t device)
    : config_(config), descriptor_(std::move(descriptor)), incarnation_(incarnation),
      device_(device), rng_(rng), pause_(config.pause), refused_pause_(config.refused_pause) {
  if (device != 0) // what is for another mote with our address has other numbers, most likely
    sequence_ = static_cast<std::uint16_t>(rng_.below(0x10000));
}

join_outputs join_client::start(unsigned hops, instant now) {
  hops_ = std::max(hops, 1U);
  state_ = state::requesting;
  attempts_ = 0;
  pause_ = config_.pause;
  deadline_ = now + rng_.between(0s, config_.start_jitter + config_.start_jitter_hop * (hops_ - 1));
  return {};
}

join_outputs join_client::leave() {
  const bool was_joined = state_ == state::joined;
  state_ = state::off;
  deadline_.reset();
  if (!was_joined)
    return {};
  return {to_registrar{leave_notice{}}};
}

join_outputs join_client::on_message(mote_id source, const management& message, instant now,
                                     mote_id root) {
  if (const auto* reply = std::get_if<join_reply>(&message)) {
    if (state_ == state::off || state_ == state::refused || reply->sequence != sequence_)
      return {};
    join_outputs out{to_registrar{join_confirm{sequence_, incarnation_, descriptor_}}};
    if (state_ == state::requesting) {
      state_ = state::joined;
      refused_pause_ = config_.refused_pause;
      sink_ = source;
      out.emplace_back(island_joined{reply->island, source, reply->aliases});
      if (condition_ != mote_condition{})
        out.emplace_back(to_registrar{keep_alive{incarnation_, condition_, device_}});
    }
    gap_ = config_.first_keep_alive;
    deadline_ = next_keep_alive(now);
    return out;
  }
  if (const auto* refusal = std::get_if<join_refusal>(&message)) {
    if (state_ != state::requesting || refusal->sequence != sequence_)
      return {};
    state_ = state::refused;
    deadline_ = now + refused_pause_ + rng_.between(0s, refused_pause_ / 2);
    refused_pause_ = std::min(2 * refused_pause_, config_.refused_pause_max);
    return {join_refused{}};
  }
  if (std::holds_alternative<rejoin_prompt>(message) && state_ == state::joined &&
      (source == sink_ || source == root)) {
    join_outputs out{island_lost{}};
    std::ranges::move(start(hops_, now), std::back_inserter(out));
    return out;
  }
  return {};
}

void join_client::on_sent(instant now) {
  if (state_ == state::joined)
    deadline_ = next_keep_alive(now);
}

join_outputs join_client::on_time(instant now) {
  if (!deadline_ || *deadline_ > now)
    return {};
  if (state_ == state::joined) {
    deadline_ = next_keep_alive(now);
    return {to_registrar{keep_alive{incarnation_, condition_, device_}}};
  }
  if (state_ == state::refused) {
    auto out = start(hops_, now);
    out.emplace_back(join_resumed{});
    return out;
  }
  return request(now);
}

join_outputs join_client::report(const mote_condition& x, instant now) {
  if (x == std::exchange(condition_, x) || state_ != state::joined)
    return {};
  deadline_ = next_keep_alive(now);
  return {to_registrar{keep_alive{incarnation_, condition_, device_}}};
}

instant join_client::next_keep_alive(instant now) {
  const auto gap = std::min(gap_, config_.keep_alive);
  gap_ = 2 * gap;
  const auto early = turn_wait_ > 0s ? rng_.between(0s, gap / 4) : 0s;
  return now + gap - early;
}

join_outputs join_client::request(instant now) {
  if (attempts_ < config_.attempts_max) {
    ++attempts_;
    ++sequence_;
    deadline_ = now + config_.reply_wait * hops_ + (1 + hops_) * turn_wait_;
    return {to_registrar{join_request{sequence_, incarnation_, descriptor_}}};
  }
  attempts_ = 0;
  deadline_ = now + pause_ + rng_.between(0s, pause_ / 2);
  pause_ = std::min(2 * pause_, config_.pause_max);
  return {};
}

} // namespace rubicon::mote
