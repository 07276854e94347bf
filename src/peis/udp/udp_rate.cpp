#include "peis/udp/udp_rate.hpp"

#include <algorithm>

namespace rubicon::peis {

namespace {

constexpr duration least_age = 10s;

} // namespace

void udp_rate::on_round_trip(duration taken, instant now) {
  estimate_.add(taken);
  latest_ = taken;
  if (!least_ || least_since_ + least_age <= now) {
    least_before_ = least_;
    least_ = taken;
    least_since_ = now;
  }
  least_ = std::min(*least_, taken);
}

bool udp_rate::queues() const {
  if (!least_)
    return false;
  const auto least = std::min(*least_, least_before_.value_or(*least_));
  return *estimate_.mean() > least * 5 / 4 + config_.queue_delay;
}

void udp_rate::on_report(std::uint64_t newest, std::uint64_t count, std::uint64_t sent,
                         instant now) {
  if (newest < end_ || newest - first_newest_ < interval_datagrams || now - begun_ < interval_min)
    return;
  const auto numbers = static_cast<double>(newest - first_newest_);
  const auto arrived = static_cast<double>(count - std::min(count, first_count_));
  adapt(1 - std::min(1.0, arrived / numbers));
  first_newest_ = newest;
  first_count_ = count;
  end_ = sent;
  begun_ = now;
  limited_ = false;
}

void udp_rate::adapt(double lost) {
  const bool queue = queues();
  lost_ += config_.loss_weight * (lost - lost_);
  if (lost_ > config_.loss_much)
    window_ *= std::max(0.5, 1 - lost_);
  else if (queue && lost > config_.loss_of_queue)
    window_ *= config_.shrink_of_queue;
  else if (limited_ && !queue && lost_ <= config_.loss_borne)
    window_ *= config_.growth;
  window_ = std::clamp(window_, config_.window_min, config_.window_max);
}

duration udp_rate::retry_after(unsigned retries) const {
  const auto bound = estimate_.bound();
  const auto first = bound ? std::clamp<duration>(*bound, retry_min, retry_max) : retry_first;
  constexpr unsigned doublings_max = 7;
  return std::min<duration>(first * (1 << std::min(retries, doublings_max)), retry_max);
}

duration udp_rate::lost_after() const {
  const auto mean = estimate_.mean();
  if (!mean)
    return retry_first;
  return std::max(*mean, latest_) * 5 / 4 + 1ms;
}

} // namespace rubicon::peis
