// What the files of the gateway's core share; nobody else includes it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/tuples/device_keys.hpp"
#include "gateway/gateway.hpp"

namespace rubicon::gateway {

inline publish text_tuple(std::string key, std::string_view text) {
  return {std::move(key), to_bytes(text), true};
}

inline std::string line_text(std::string_view state, instant since) {
  return std::string(state) + ' ' + to_text(since);
}

inline publish presence_tuple(mote_id mote, const device_status& x) {
  return text_tuple(device_status_key(mote), to_string(x));
}

inline publish status_tuple(mote_id mote, std::uint16_t channel, std::uint64_t sequence,
                            input_outcome result) {
  return text_tuple(device_input_status_key(mote, channel),
                    to_string(input_status{sequence, result}));
}

/// @param incarnation of the PC of the island: starts of its only gateway, or the term
inline communication::pc_config pc_of(const gateway_config& config, std::uint32_t incarnation) {
  communication::pc_config x;
  x.self = gateway_of(config.island);
  x.incarnation = incarnation;
  x.ack_wait = config.ack_wait;
  x.sends_max = config.inputs_outstanding_max;
  x.awaits_clock = true;
  x.tick_period = config.tick_period;
  x.slacks = config.slacks;
  x.channels_max = config.channels_max;
  return x;
}

/// The program that exchanges messages between motes and tuples: queues what it receives until the
/// gateway takes it.
class device_messages final : public communication::communication_events {
public:
  void receiveFrom(mote_address source, byte_view buf, std::uint8_t am_type) override {
    received.push_back({source, am_type, to_bytes(buf)});
  }
  void ackOf(std::uint32_t number, communication::status success) override {
    outcomes.push_back({number, success == communication::SUCCESS});
  }

  std::optional<communication::interface> layer;
  std::vector<transport::received> received;
  std::vector<transport::outcome> outcomes;
};

} // namespace rubicon::gateway
