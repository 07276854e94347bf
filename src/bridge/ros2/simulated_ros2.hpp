// The bridge to ROS 2 beside a kernel in virtual time: its rosbridge is simulated.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "bridge/ros2/ros2_bridge.hpp"
#include "bridge/ros2/simulated_rosbridge.hpp"
#include "core/component.hpp"

namespace rubicon::bridge {

class simulated_ros2 final : public components::component {
public:
  /// @param self whose kernel it uses
  simulated_ros2(ros2_bridge core, peer_id self) : core_(std::move(core)), self_(self) {}

  [[nodiscard]] components::outputs start(instant now) override;
  [[nodiscard]] components::outputs on_tuple(const components::news& x, instant now) override;
  [[nodiscard]] components::outputs on_written(std::uint64_t token, std::string_view cause,
                                               instant now) override;
  [[nodiscard]] components::outputs on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override { return core_.deadline(); }
  [[nodiscard]] components::figures figures() const override { return figures_of(core_); }

  /// A node behind the server publishes this.
  [[nodiscard]] components::outputs publish(const std::string& topic, const std::string& message,
                                            instant now);
  /// A node calls a service of the bridge.
  [[nodiscard]] components::outputs call(const std::string& service, const std::string& id,
                                         const std::string& arguments, instant now);
  /// The server ends; while it is off, attempts to connect fail.
  [[nodiscard]] components::outputs stop_server(instant now);
  void start_server() { is_on_ = true; }

  [[nodiscard]] const simulated_rosbridge& server() const { return server_; }
  [[nodiscard]] const ros2_bridge& core() const { return core_; }

private:
  [[nodiscard]] components::outputs perform(ros2_outputs todo, instant now);
  [[nodiscard]] components::outputs deliver(const simulated_rosbridge::texts& all, instant now);

  ros2_bridge core_;
  peer_id self_;
  simulated_rosbridge server_;
  bool is_on_ = true;
};

} // namespace rubicon::bridge
