// Receives what is sent to its mote on one AM type.
#pragma once

#include "apps/application.hpp"

namespace rubicon::apps {

/// Reports the first message that it receives to the event log.
class listener final : public application {
public:
  explicit listener(listener_config config) : config_(config) {}

  void receiveFrom(mote_address source, byte_view octets, std::uint8_t am_type) override;

private:
  void on_start(instant now) override;

  listener_config config_;
  bool has_received_ = false;
};

} // namespace rubicon::apps
