// The readout of an echo-state network: learns, as the run goes on, to say a value one tick ahead.
#pragma once

#include <vector>

#include "apps/application.hpp"
#include "apps/synapses.hpp"

namespace rubicon::apps {

/// Recursive least squares (Haykin, Adaptive Filter Theory, chapter on RLS) over the elements of
/// all in channels and a constant.
class readout final : public application {
public:
  explicit readout(readout_config config);

  void on_time(instant now) override { ends_.on_time(layer(), now); }
  [[nodiscard]] std::optional<instant> deadline() const override { return ends_.deadline(); }

  /// The error is the root of the mean square, as a share of the signal's standard deviation;
  /// beside it that of saying the last value again.
  [[nodiscard]] std::vector<figure> figures() const override;

  void joined(mote::island_octet island, std::uint16_t mote, mote::status success) override;
  void createSynChannelInDone(int channel, mote::status success) override;
  void synChannelFailed(int channel) override;
  void syn_input_update(int channel, std::uint8_t index, synaptic::input_status status) override;
  void clock_tick(std::uint32_t tick) override;

private:
  void on_start(instant) override {}
  void learn(double error);

  readout_config config_;
  synapses ends_;
  std::vector<double> features_; ///< of the tick before
  std::vector<double> weights_;
  std::vector<std::vector<double>> inverse_; ///< of the features' correlation
  double predicted_ = 0;
  double last_ = 0;
  std::uint64_t ticks_ = 0; ///< with all channels open
  std::uint64_t updated_ = 0;
  std::uint64_t missed_ = 0;
  // Sums over the ticks that count.
  std::uint64_t counted_ = 0;
  double squared_error_ = 0;
  double squared_step_ = 0;
  double sum_ = 0;
  double squared_sum_ = 0;
};

} // namespace rubicon::apps
