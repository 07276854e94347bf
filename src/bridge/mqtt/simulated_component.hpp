// The bridge beside a kernel in virtual time: its broker is simulated.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "bridge/mqtt/broker_site.hpp"
#include "bridge/mqtt/mqtt_bridge.hpp"
#include "core/component.hpp"

namespace rubicon::bridge {

/// For the report: of the bridge, its objects and its queue. All are counters, so that those of
/// several lives add up.
[[nodiscard]] components::figures figures_of(const mqtt_bridge& x);

class simulated_component final : public components::component {
public:
  /// @param site not nullptr; of one bridge at a time
  simulated_component(mqtt_bridge core, std::shared_ptr<broker_site> site)
      : core_(std::move(core)), site_(std::move(site)) {}
  /// The broker publishes the will.
  ~simulated_component() override;
  simulated_component(const simulated_component&) = delete;
  simulated_component& operator=(const simulated_component&) = delete;
  simulated_component(simulated_component&&) = default;
  simulated_component& operator=(simulated_component&&) = delete;

  [[nodiscard]] components::outputs start(instant now) override;
  [[nodiscard]] components::outputs on_tuple(const components::news& x, instant now) override;
  [[nodiscard]] components::outputs on_written(std::uint64_t token, std::string_view cause,
                                               instant now) override;
  [[nodiscard]] components::outputs on_time(instant now) override;
  [[nodiscard]] std::optional<instant> deadline() const override {
    return earliest(core_.deadline(), site_->deadline());
  }
  [[nodiscard]] components::figures figures() const override;

  /// Another client of the broker publishes this.
  [[nodiscard]] components::outputs publish(const publication& x, bool retain, instant now);
  /// The broker ends and begins again; the bridge connects at once.
  [[nodiscard]] components::outputs restart_broker(bool persistent, instant now);

  [[nodiscard]] const simulated_broker& broker() const { return site_->broker(); }

private:
  [[nodiscard]] simulated_broker::deliveries own_of(simulated_broker::deliveries all) const;
  [[nodiscard]] components::outputs connect(instant now);
  void happen(const simulated_event& x, instant now, components::outputs& out);
  [[nodiscard]] components::outputs perform(mqtt_outputs todo, instant now);

  mqtt_bridge core_;
  std::shared_ptr<broker_site> site_;
  std::uint32_t client_ = 0; ///< its id at the broker; 0 before start()
};

} // namespace rubicon::bridge
