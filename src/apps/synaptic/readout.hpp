// The readout of an echo-state network: learns, as the run goes on, to say a value one tick ahead.
#pragma once

#include <vector>

#include "apps/synaptic/synaptic_application.hpp"

namespace rubicon::apps {

/// Recursive least squares (Haykin, Adaptive Filter Theory, chapter on RLS) over the elements of
/// all in channels and a constant.
class readout final : public synaptic_application {
public:
  explicit readout(readout_config config);

  /// The error is the root of the mean square, as a share of the signal's standard deviation;
  /// beside it that of saying the last value again.
  [[nodiscard]] std::vector<figure> figures() const override;

  void clock_tick(std::uint32_t tick) override;

private:
  void learn(double error);

  readout_config config_;
  std::vector<double> features_; ///< of the tick before
  std::vector<double> weights_;
  std::vector<std::vector<double>> inverse_; ///< of the features' correlation
  double predicted_ = 0;
  double last_ = 0;
  // Sums over the ticks that count.
  std::uint64_t counted_ = 0;
  double squared_error_ = 0;
  double squared_step_ = 0;
  double sum_ = 0;
  double squared_sum_ = 0;
};

} // namespace rubicon::apps
