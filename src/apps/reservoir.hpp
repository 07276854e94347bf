// A part of an echo-state network that runs on a mote.
#pragma once

#include <vector>

#include "apps/application.hpp"
#include "apps/synapses.hpp"

namespace rubicon::apps {

/// x(T + 1) = (1 - leak) x(T) + leak tanh(W_in u + W x + W_r r), with the transducers' readings u,
/// scaled to -1..1 by their range so far, and the values r of the in channels. Weights are drawn.
class reservoir final : public application {
public:
  reservoir(reservoir_config config, random_stream dice);

  void on_time(instant now) override { ends_.on_time(layer(), now); }
  [[nodiscard]] std::optional<instant> deadline() const override { return ends_.deadline(); }
  [[nodiscard]] std::vector<figure> figures() const override;

  void joined(mote::island_octet island, std::uint16_t mote, mote::status success) override;
  void createSynChannelOutDone(int channel, mote::status success) override;
  void createSynChannelInDone(int channel, mote::status success) override;
  void synChannelFailed(int channel) override;
  void syn_input_update(int channel, std::uint8_t index, synaptic::input_status status) override;
  void clock_tick(std::uint32_t tick) override;
  void readDone(int stream, byte_view record, mote::status success) override;

private:
  void on_start(instant) override {}
  void compute();

  struct sense {
    int stream = -1;
    double least = 0;
    double most = 0;
    bool is_known = false;
    double value = 0; ///< -1..1
  };

  reservoir_config config_;
  synapses ends_;
  std::vector<sense> senses_;
  std::vector<std::vector<double>> weights_; ///< per unit: senses, units, in channels
  std::vector<double> states_;
  std::size_t awaited_ = 0; ///< readings still to come in this tick
  std::uint64_t ticks_ = 0; ///< with all channels open
  std::uint64_t updated_ = 0;
  std::uint64_t missed_ = 0; ///< vectors
};

} // namespace rubicon::apps
