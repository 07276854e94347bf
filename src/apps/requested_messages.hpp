// Sends what a program outside the ecology requests of a mote (`rubicon run --steer`).
#pragma once

#include <cstdint>
#include <map>

#include "apps/application.hpp"

namespace rubicon::apps {

/// Each message has a number of whoever requests it, by which events name its outcome.
class requested_messages final : public application {
public:
  /// As communication::interface::send(). An event follows: refused, or, of a reliable one, whether
  /// it was acknowledged.
  void send(std::uint32_t number, mote_address to, byte_view octets, bool reliable,
            std::uint8_t am_type);

  void ackOf(std::uint32_t number, communication::status success) override;

private:
  void on_start(instant) override {}
  void notify_outcome(std::uint32_t number, const char* outcome);

  std::map<std::uint32_t, std::uint32_t> in_flight_; ///< the layer's numbers to those requested
};

} // namespace rubicon::apps
