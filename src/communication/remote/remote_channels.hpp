// Synaptic channels of a program in an actor of its own, on its side.
#pragma once

#include <cstdint>
#include <vector>

#include "communication/process.hpp"
#include "communication/remote/remote_exchange.hpp"
#include "communication/remote_messages.hpp"
#include "core/address.hpp"

namespace rubicon::communication {

class remote_channels final : public synaptic_commands {
public:
  explicit remote_channels(remote_exchange& exchange) : exchange_(exchange) {}

  int create(bool is_out, mote_address other, std::uint8_t size,
             const synaptic::parameters& params) override;
  status dispose(int channel) override;
  status start(int channel) override;
  status stop(int channel) override;
  status write_output(int channel, std::uint8_t k, float value) override;
  float read_input(int channel, std::uint8_t index) override;

  void apply(const remote::channel_created& x);
  void apply(const remote::inputs_shown& x);
  void apply(const remote::channel_failed& x);
  void apply(const remote::ticked& x);

private:
  enum class phase : std::uint8_t { opening, open, ended };

  struct row {
    bool is_out = false;
    phase at = phase::opening;
    mote_address other;
    std::vector<float> values; ///< ChOut or ChIn
    bool is_active = false;
  };

  [[nodiscard]] row* open_channel(int channel, bool is_out); ///< nullptr: refused
  void report_created(std::uint16_t channel, bool is_out, bool success);

  remote_exchange& exchange_;
  numbered_rows<row> channels_;
};

} // namespace rubicon::communication
