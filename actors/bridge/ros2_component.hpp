// The bridge to a real rosbridge, beside a kernel in wall time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "bridge/ros2/ros2_bridge.hpp"
#include "bridge/ros2/ros2_settings.hpp"
#include "core/component.hpp"
#include "io/tcp/web_client.hpp"

namespace rubicon {

/// Where to connect to, and whom to believe; or why that is not known.
[[nodiscard]] std::variant<io::web_client_settings, std::string>
client_settings(const bridge::ros2_settings& x);

class ros2_component final : public components::outside_component {
public:
  /// @param self whose kernel it uses
  ros2_component(bridge::ros2_bridge core, peer_id self, io::web_client_settings server);

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
  [[nodiscard]] components::outputs perform(bridge::ros2_outputs todo);

  bridge::ros2_bridge core_;
  peer_id self_;
  io::web_client_settings server_;
  std::function<void()> wake_;
  std::unique_ptr<io::web_client> client_; ///< nullptr before start()
  bool is_reported_ = false;               ///< that there is no connection
};

} // namespace rubicon
