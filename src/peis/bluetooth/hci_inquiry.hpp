// What an adapter is asked and answers when it looks for devices (Bluetooth Core Specification,
// volume 4, part E): packets of the host controller interface.
#pragma once

#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/bluetooth/bluetooth.hpp"

namespace rubicon::peis {

/// Command Inquiry (7.1.1), for any number of devices.
/// @param length rounded down to steps of 1.28 s, from one of them to 48
[[nodiscard]] bytes inquiry_command(duration length);

/// The adapter has ended the inquiry, or refuses it.
struct inquiry_ended {
  bool success = false;
};

/// Devices that it has found: none if the packet says something else.
using inquiry_event = std::variant<std::vector<seen_device>, inquiry_ended>;

/// Events Inquiry Complete (7.7.1), Command Status (7.7.15), Inquiry Result with RSSI (7.7.33) and
/// Extended Inquiry Result (7.7.38). A refusal because of another program's inquiry is ignored: its
/// results arrive here too. Results without signal strength are ignored: whether a link is
/// possible could not be judged.
[[nodiscard]] inquiry_event decode_inquiry_event(byte_view packet);

} // namespace rubicon::peis
