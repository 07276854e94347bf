// A program in the actor of its node: its commands are calls of the node's layer.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "communication/process.hpp"
#include "transport/messenger.hpp"

namespace rubicon::communication {

class layer;
class communication_events;

class direct_process final : public process {
public:
  direct_process(layer& below, std::size_t number) : below_(below), number_(number) {}

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
  friend class layer;

  [[nodiscard]] bool wants_ticks() const;

  /// A reliable send that has not been reported to its program by ack().
  struct pending_send {
    transport::ticket number = 0;
    std::optional<bool> acked; ///< nothing: it has not ended
  };

  layer& below_;
  std::size_t number_;
  communication_events* events_ = nullptr; ///< nullptr: it has left
  std::string name_;                       ///< for layer::observe(); empty: not observed
  std::vector<pending_send> sends_;        ///< ack() keeps their order
};

} // namespace rubicon::communication
