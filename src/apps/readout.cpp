#include "apps/readout.hpp"

#include <cmath>

namespace rubicon::apps {

namespace {

constexpr double certainty_at_first = 100; ///< diagonal of the inverse correlation

} // namespace

readout::readout(readout_config config) : config_(std::move(config)), ends_(config_.from, {}) {
  std::size_t count = 1;
  for (const auto& x : config_.from)
    count += x.size;
  weights_.resize(count);
  inverse_.resize(count, std::vector<double>(count));
  for (std::size_t i = 0; i < count; ++i)
    inverse_[i][i] = certainty_at_first;
}

void readout::joined(mote::island_octet, std::uint16_t, mote::status success) {
  ends_.close_all(layer());
  if (success == mote::SUCCESS)
    ends_.open_all(layer());
}

void readout::createSynChannelInDone(int channel, mote::status success) {
  ends_.on_created(layer(), channel, success == mote::SUCCESS);
}

void readout::synChannelFailed(int channel) {
  ends_.on_failed(layer(), channel);
}

void readout::syn_input_update(int, std::uint8_t index, synaptic::input_status status) {
  if (index == 0)
    ++(status == synaptic::input_status::updated ? updated_ : missed_);
}

void readout::clock_tick(std::uint32_t) {
  if (!ends_.all_open()) {
    features_.clear();
    return;
  }
  ++ticks_;
  std::vector<double> fresh{1};
  for (const auto& x : ends_.ends()) {
    for (std::uint8_t i = 0; i < x.what.size; ++i)
      fresh.push_back(layer().read_input(x.channel, i));
  }
  const auto target = fresh[1];
  if (!features_.empty()) {
    const auto error = target - predicted_;
    if (ticks_ > config_.warm_up) {
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
  return {{"ticks", static_cast<double>(ticks_)},
          {"vectors updated", static_cast<double>(updated_)},
          {"vectors missed", static_cast<double>(missed_)},
          {"channels lost", static_cast<double>(ends_.failures())},
          {"prediction error", share(squared_error_)},
          {"error of the last value", share(squared_step_)}};
}

} // namespace rubicon::apps
