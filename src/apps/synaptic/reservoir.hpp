// A part of an echo-state network that runs on a mote.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/synaptic/synaptic_application.hpp"

namespace rubicon::apps {

/// x(T + 1) = (1 - leak) x(T) + leak tanh(W_in u + W x + W_r r), with the transducers' readings u,
/// scaled to -1..1 by their range so far, and the values r of the in channels. Weights are drawn.
class reservoir final : public synaptic_application {
public:
  reservoir(reservoir_config config, random_stream rng);

  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status success) override;
  void clock_tick(std::uint32_t tick) override;
  void readDone(int stream, byte_view record, communication::status success) override;
  [[nodiscard]] std::vector<figure> figures() const override;

private:
  struct sense {
    int stream = -1;
    double least = 0;
    double most = 0;
    bool is_known = false;
    double value = 0; ///< -1..1
  };

  void open_senses();
  void lose(sense& x);
  void compute();

  reservoir_config config_;
  std::vector<sense> senses_;
  std::vector<std::vector<double>> weights_; ///< per unit: senses, units, in channels
  std::vector<double> states_;
  std::size_t awaited_ = 0;           ///< readings still to come in this tick
  std::optional<instant> senses_due_; ///< those without a stream are opened then
  std::uint64_t senses_refused_ = 0;
};

} // namespace rubicon::apps
