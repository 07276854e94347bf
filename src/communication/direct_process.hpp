// A program in the actor of its node: its commands are calls of the ports of the node's layer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "communication/process.hpp"

namespace rubicon::communication {

struct layer_ports;

/// The ports, and the number of a program in program_list.
struct direct_program {
  layer_ports& ports; ///< outlive this
  std::size_t number = 0;
};

class direct_synaptic final : public synaptic_commands {
public:
  explicit direct_synaptic(direct_program its) : its_(its) {}

  int create(bool is_out, mote_address other, std::uint8_t size,
             const synaptic::parameters& params) override;
  status dispose(int channel) override;
  status start(int channel) override;
  status stop(int channel) override;
  status write_output(int channel, std::uint8_t k, float value) override;
  float read_input(int channel, std::uint8_t index) override;

private:
  direct_program its_;
};

class direct_streams final : public stream_commands {
public:
  explicit direct_streams(direct_program its) : its_(its) {}

  int open_end(const stream_end& end) override;
  int open_sensor(std::uint8_t transducer, std::uint32_t period_ms, stream::sampling kind) override;
  int open_local() override;
  status close(int desc) override;
  status read(int desc, std::size_t nbytes) override;
  status write(int desc, byte_view record) override;
  [[nodiscard]] bool has_ended(int desc) const override;
  [[nodiscard]] std::optional<duration> latency_bound(int desc) const override;

private:
  direct_program its_;
};

class direct_messages final : public message_commands {
public:
  explicit direct_messages(direct_program its) : its_(its) {}

  std::optional<std::uint32_t> send(mote_address to, byte_view octets, bool reliable,
                                    std::uint8_t am_type) override;
  status provide(std::uint8_t am_type) override;
  void hold(std::uint8_t am_type) override;
  void release(std::uint8_t am_type) override;

private:
  direct_program its_;
};

class direct_node final : public node_commands {
public:
  explicit direct_node(direct_program its) : its_(its) {}

  status refuse() override;
  status read_transducers(std::span<const device::quantity> kinds) override;
  status set_actuator(std::string_view name, std::uint8_t state) override;
  status init() override;
  status join(byte_view description) override;
  [[nodiscard]] std::optional<mote_address> address() const override;
  [[nodiscard]] instant now() const override;
  [[nodiscard]] std::optional<duration> network_time() const override;
  void leave() override;

private:
  direct_program its_;
};

/// At one address: interfaces point to `commands`.
struct direct_process {
  explicit direct_process(direct_program its)
      : synaptic(its), streams(its), messages(its), node(its) {}
  direct_process(const direct_process&) = delete;
  direct_process& operator=(const direct_process&) = delete;

  direct_synaptic synaptic;
  direct_streams streams;
  direct_messages messages;
  direct_node node;
  process commands{synaptic, streams, messages, node};
};

} // namespace rubicon::communication
