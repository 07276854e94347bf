#include "apps/synaptic/readout.hpp"

#include <cmath>

namespace rubicon::apps {

namespace {

constexpr double certainty_at_first = 100; ///< diagonal of the inverse correlation

} // namespace

readout::readout(readout_config config)
    : synaptic_application(config.from, {}), config_(std::move(config)) {
  std::size_t count = 1;
  for (const auto& x : config_.from)
    count += x.size;
  weights_.resize(count);
  inverse_.resize(count, std::vector<double>(count));
  for (std::size_t i = 0; i < count; ++i)
    inverse_[i][i] = certainty_at_first;
}

void readout::clock_tick(std::uint32_t) {
  if (!all_open()) {
    features_.clear();
    return;
  }
  count_tick();
  std::vector<double> fresh{1};
  for (const auto& x : ends()) {
    for (std::uint8_t i = 0; i < x.what.size; ++i)
      fresh.push_back(layer().read_input(x.channel, i));
  }
  const auto target = fresh[1];
  if (!features_.empty()) {
    const auto error = target - predicted_;
    if (ticks() > config_.warm_up) {
      ++counted_;
      squared_error_ += error * error;
      squared_step_ += (target - last_) * (target - last_);
      sum_ += target;
      squared_sum_ += target * target;
    }
    learn(error);
  }
  features_ = std::move(fresh);
  last_ = target;
  predicted_ = 0;
  for (std::size_t i = 0; i < weights_.size(); ++i)
    predicted_ += weights_[i] * features_[i];
}

void readout::learn(double error) {
  const auto count = weights_.size();
  std::vector<double> spread(count); // inverse times features
  double norm = config_.forgetting;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < count; ++k)
      spread[i] += inverse_[i][k] * features_[k];
    norm += features_[i] * spread[i];
  }
  for (std::size_t i = 0; i < count; ++i) {
    weights_[i] += spread[i] / norm * error;
    for (std::size_t k = 0; k < count; ++k)
      inverse_[i][k] = (inverse_[i][k] - spread[i] * spread[k] / norm) / config_.forgetting;
  }
}

std::vector<figure> readout::figures() const {
  const auto n = static_cast<double>(counted_);
  const auto mean = n > 0 ? sum_ / n : 0;
  const auto variance = n > 0 ? squared_sum_ / n - mean * mean : 0;
  const auto share = [&](double squares) {
    return variance > 0 ? std::sqrt(squares / n / variance) : 0;
  };
  auto all = synaptic_application::figures();
  all.push_back({"prediction error", share(squared_error_), false});
  all.push_back({"error of the last value", share(squared_step_), false});
  return all;
}

} // namespace rubicon::apps
