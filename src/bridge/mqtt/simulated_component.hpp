// The bridge beside a kernel in virtual time: its broker is simulated.
#pragma once

#include <optional>
#include <utility>

#include "bridge/mqtt/mqtt_bridge.hpp"
#include "bridge/mqtt/simulated_broker.hpp"
#include "core/component.hpp"

namespace rubicon::bridge {

class simulated_component final : public components::component {
public:
  explicit simulated_component(mqtt_bridge core) : core_(std::move(core)) {}

  [[nodiscard]] components::outputs start(instant now) override;
  [[nodiscard]] components::outputs on_tuple(const components::news& x, instant now) override;
  [[nodiscard]] components::outputs on_written(std::uint64_t token, std::string_view cause,
                                               instant now) override;
  [[nodiscard]] components::outputs on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override { return core_.deadline(); }
  [[nodiscard]] components::figures figures() const override;

  /// Another client of the broker publishes this.
  [[nodiscard]] components::outputs publish(const publication& x, bool retain, instant now);
  /// The broker ends and begins again; the bridge connects at once.
  [[nodiscard]] components::outputs restart_broker(bool persistent, instant now);

  [[nodiscard]] const simulated_broker& broker() const { return broker_; }

private:
  [[nodiscard]] components::outputs connect(instant now);
  [[nodiscard]] components::outputs perform(mqtt_outputs todo, instant now);

  mqtt_bridge core_;
  simulated_broker broker_;
};

/// For the report: of the bridge, its objects and its queue.
[[nodiscard]] components::figures figures_of(const mqtt_bridge& x);

} // namespace rubicon::bridge
