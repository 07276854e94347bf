// The bridge to a real MQTT broker, beside a kernel in wall time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "bridge/mqtt/mqtt_bridge.hpp"
#include "bridge/mqtt/mqtt_settings.hpp"
#include "core/component.hpp"
#include "io/mqtt/mqtt_client.hpp"

namespace rubicon {

/// As whom to connect, with the password; or why it cannot be read.
[[nodiscard]] std::variant<io::mqtt_client_settings, std::string>
client_settings(const bridge::mqtt_settings& x);

class mqtt_component final : public components::outside_component {
public:
  mqtt_component(bridge::mqtt_bridge core, io::mqtt_client_settings settings);

  void attach(std::function<void()> wake) override { wake_ = std::move(wake); }
  [[nodiscard]] components::outputs start(instant now) override;
  [[nodiscard]] components::outputs on_input(instant now) override;
  [[nodiscard]] components::outputs on_tuple(const components::news& x, instant now) override;
  [[nodiscard]] components::outputs on_written(std::uint64_t token, std::string_view cause,
                                               instant now) override;
  [[nodiscard]] components::outputs on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override { return core_.deadline(); }
  [[nodiscard]] components::figures figures() const override;

private:
  [[nodiscard]] components::outputs perform(bridge::mqtt_outputs todo);

  bridge::mqtt_bridge core_;
  io::mqtt_client_settings settings_;
  std::function<void()> wake_;
  std::unique_ptr<io::mqtt_client> client_; ///< nullptr before start()
};

} // namespace rubicon
