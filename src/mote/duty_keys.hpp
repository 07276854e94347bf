// The keys of what a file may say about the windows of an island's radios.
#pragma once

#include "core/describe/keys.hpp"
#include "mote/duty_config.hpp"

namespace rubicon::mote {

inline auto keys_of(const duty_config*) {
  return keys::of(keys::optional("period", &duty_config::period, keys::time_span{100ms, 1h},
                                 "period of the windows, in island time"),
                  keys::optional("window", &duty_config::window, keys::time_span{10ms, 1h},
                                 {"its length", "", "time from 10 ms to half the period"}),
                  keys::optional("settling", &duty_config::settling, keys::time_span{0s, 24h},
                                 "island time until which all radios stay on"));
}

} // namespace rubicon::mote
