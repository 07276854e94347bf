// A program in the actor of its node: its commands are calls of the ports of the node's layer.
#pragma once

#include <cstddef>
#include <optional>

#include "communication/process.hpp"

namespace rubicon::communication {

struct layer_ports;

class direct_process final : public process {
public:
  /// @param ports outlive this
  direct_process(layer_ports& ports, std::size_t program) : ports_(ports), program_(program) {}

  status refuse() override;

  int create_syn_channel(bool is_out, mote_address other, std::uint8_t size,
                         const synaptic::parameters& params) override;
  status dispose_syn_channel(int channel) override;
  status start_syn_channel(int channel) override;
  status stop_syn_channel(int channel) override;
  status write_output(int channel, std::uint8_t k, float value) override;
  float read_input(int channel, std::uint8_t index) override;

  int open_end(const stream_end& end) override;
  int open_sensor(std::uint8_t transducer, std::uint32_t period_ms, stream::sampling kind) override;
  int open_local() override;
  status close(int desc) override;
  status read(int desc, std::size_t nbytes) override;
  status write(int desc, byte_view record) override;
  [[nodiscard]] bool has_ended(int desc) const override;
  [[nodiscard]] std::optional<duration> latency_bound(int desc) const override;

  std::optional<std::uint32_t> send(mote_address to, byte_view octets, bool reliable,
                                    std::uint8_t am_type) override;
  status provide(std::uint8_t am_type) override;
  void hold(std::uint8_t am_type) override;
  void release(std::uint8_t am_type) override;

  status read_transducers(std::span<const device::quantity> kinds) override;
  status set_actuator(std::string_view name, std::uint8_t state) override;

  status init() override;
  status join(byte_view description) override;
  [[nodiscard]] std::optional<mote_address> address() const override;
  [[nodiscard]] instant now() const override;
  [[nodiscard]] std::optional<duration> network_time() const override;

  void leave() override;

private:
  layer_ports& ports_;
  std::size_t program_; ///< number in program_list
};

} // namespace rubicon::communication
