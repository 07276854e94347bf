#include "apps/sampler.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "apps/app_keys.hpp"
#include "core/codec.hpp"

namespace rubicon::apps {

sampler::sampler(std::shared_ptr<const sampler_config> config, random_stream rng)
    : config_(std::move(config)), rng_(rng),
      means_(config_->mean_of.begin(), config_->mean_of.end()) {}

std::optional<duration> sampler::period() const {
  const bool asked = wanted_ && wanted_->period.count() > 0;
  if (!in_island_ || (config_->only_subscribed && !wanted_))
    return std::nullopt;
  return asked ? std::max<duration>(wanted_->period, config_->every_min) : config_->every;
}

void sampler::joined(communication::island_octet, std::uint16_t, communication::status success) {
  in_island_ = success == communication::SUCCESS;
  begins_ = true;
}

void sampler::outputsWanted(std::span<const communication::output_wanted> all) {
  wanted_ = communication::wanted_on(all, config_->channel);
  begins_ = begins_ || period() != every_;
}

void sampler::change(const keys::key_changes& settings) {
  auto own = *config_; // others may share that
  keys::apply(settings, own);
  config_ = std::make_shared<const sampler_config>(std::move(own));
  begins_ = begins_ || period() != every_;
}

std::optional<instant> sampler::deadline() const {
  if (begins_)
    return instant{};
  return every_ ? std::optional(due_) : std::nullopt;
}

void sampler::on_time(instant now) {
  if (std::exchange(begins_, false)) {
    every_ = period();
    sent_.clear();
    due_ = next_period_ = every_ ? now + rng_.between(0s, *every_) : now;
  } else if (every_ && due_ <= now) {
    sampled_ = now;
    layer().read_transducers(config_->transducers);
    next_period_ += *every_;
    due_ = next_period_ + rng_.between(0s, config_->jitter);
  }
}

bool sampler::is_news(const std::vector<std::int16_t>& counts) const {
  if (config_->dead_band.empty() || sent_.size() != counts.size() || !every_ ||
      sampled_ + *every_ + config_->jitter > sent_at_ + config_->silence_max)
    return true;
  for (std::size_t i = 0; i < counts.size() && i < config_->dead_band.size(); ++i)
    if (config_->dead_band[i] > 0 && std::abs(counts[i] - sent_[i]) >= config_->dead_band[i])
      return true;
  return false;
}

void sampler::transducersRead(std::span<const std::int16_t> counts, std::uint32_t time_ms) {
  std::vector<std::int16_t> averages(counts.begin(), counts.end());
  for (std::size_t i = 0; i < means_.size() && i < averages.size(); ++i)
    averages[i] = static_cast<std::int16_t>(means_[i].add(averages[i]));
  if (!is_news(averages))
    return;
  byte_writer out;
  for (const auto count : averages)
    out.big(count);
  if (config_->stamped)
    out.big(time_ms);
  layer().send_numbered(own_gateway, out.finish(), config_->reliable,
                        static_cast<std::uint8_t>(config_->channel));
  sent_ = std::move(averages);
  sent_at_ = sampled_;
}

} // namespace rubicon::apps
