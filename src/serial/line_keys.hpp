// The keys of what a file may say about a serial cable.
#pragma once

#include "core/keys.hpp"
#include "serial/line_config.hpp"

namespace rubicon::serial {

inline auto keys_of(const line_config*) {
  return keys::of(keys::optional("baud", &line_config::baud, keys::baud{},
                                 {"10 bit times an octet", "the sink's platform's"}),
                  keys::optional("latency", &line_config::latency, keys::time_span{0s, 10s},
                                 "of adapter and driver, each way"),
                  keys::optional("octet_error", &line_config::octet_error, keys::ratio{},
                                 "chance that one octet is corrupted"),
                  keys::optional("buffer", &line_config::buffer,
                                 keys::whole<std::size_t>{64, 1U << 24U},
                                 "octets waiting to be sent, each way; more are lost and counted"));
}

} // namespace rubicon::serial
