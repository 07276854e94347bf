// Devices and membership of its node, as a program in an actor of its own uses them.
#pragma once

#include <optional>

#include "communication/process.hpp"
#include "communication/remote/remote_exchange.hpp"
#include "communication/remote_messages.hpp"
#include "core/time.hpp"

namespace rubicon::communication {

class remote_node final : public node_commands {
public:
  explicit remote_node(remote_exchange& exchange) : exchange_(exchange) {}

  status refuse() override { return exchange_.refuse(); }
  status read_transducers(std::span<const device::quantity> kinds) override;
  status set_actuator(std::string_view name, std::uint8_t state) override;
  status init() override;
  status join(byte_view description) override;
  [[nodiscard]] std::optional<mote_address> address() const override { return exchange_.address(); }
  [[nodiscard]] instant now() const override { return exchange_.now(); }
  [[nodiscard]] std::optional<duration> network_time() const override { return std::nullopt; }
  void leave() override;

  void apply(const remote::transducers_read& x);
  void apply(const remote::actuator_changed& x);
  void apply(const remote::initialised& x);
  void apply(const remote::joined& x);
  void apply(const remote::mote_joined& x);
  void apply(const remote::outputs_asked& x);

private:
  remote_exchange& exchange_;
  bool initialised_ = false;
};

} // namespace rubicon::communication
