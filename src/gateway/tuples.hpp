// The own tuples of a gateway, and its requests to the sink.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "core/tuples/device_keys.hpp"
#include "gateway/outputs.hpp"
#include "network/am.hpp"

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

/// A request to the sink to describe one of its motes, or all.
inline to_sink ask_about(mote_id mote) {
  return {mote, network::am::sink_event, network::encode(network::describe{mote})};
}

} // namespace rubicon::gateway
