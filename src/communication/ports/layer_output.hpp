// What the Communication Layer requests of the node below it.
#pragma once

#include <chrono>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "device/transducer_config.hpp"
#include "stream/events.hpp"
#include "transport/messenger.hpp"

namespace rubicon::communication {

/// Who waits for a channel.
struct channel_request {
  bool is_synaptic = false;
  std::uint16_t descriptor = 0;

  friend auto operator<=>(const channel_request&, const channel_request&) = default;
};

/// Open a channel of the island's Network; answered by channel_port::on_connected() or
/// on_connect_failed().
struct channel_wanted {
  channel_request request;
  mote_id destination;
  std::chrono::milliseconds interval{0}; ///< between two packets; 0: at any time
  std::size_t size = 0;                  ///< octets of a packet at most
};

/// Send this over a channel of Network.
struct channel_packet {
  stream::channel_handle channel;
  bytes octets;
  bool in_slot = false; ///< of synaptic_port::set_slot(): no other mote sends now
  provenance from = {};
};

struct channel_unwanted {
  stream::channel_handle channel;
};

/// Read this transducer; answered by device_port::on_sample().
struct sample_wanted {
  stream::descriptor stream;
  std::uint8_t transducer = 0;
};

/// Read these; answered by device_port::on_transducers().
struct transducers_wanted {
  std::size_t process = 0;
  std::vector<device::quantity> kinds;
};

/// Move this; answered by device_port::on_actuator().
struct actuator_wanted {
  std::size_t process = 0;
  std::string name;
  std::uint8_t state = 0;
};

/// A program wants radio and serial line up; answered by layer::on_initialised().
struct init_wanted {};

/// A program wants to join; answered by layer::on_joined().
struct join_wanted {
  bytes description;
};

using layer_output =
    std::variant<transport::to_network, channel_wanted, channel_packet, channel_unwanted,
                 sample_wanted, transducers_wanted, actuator_wanted, init_wanted, join_wanted>;
using layer_outputs = std::vector<layer_output>;

} // namespace rubicon::communication
