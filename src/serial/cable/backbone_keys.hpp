// The keys of what a file may say about a further sink's backbone.
#pragma once

#include "core/describe/keys.hpp"
#include "serial/cable/backbone_config.hpp"

namespace rubicon::serial {

inline auto keys_of(const backbone_config*) {
  return keys::of(
      keys::optional("baud", &backbone_config::baud, keys::baud{},
                     {"of both cables, which each packet crosses one after the other; 10 bit times "
                      "an octet",
                      "the mote's platform's"}),
      keys::optional("latency", &backbone_config::latency, keys::time_span{0s, 10s},
                     "latency of both adapters and drivers together, per direction"),
      keys::optional("jitter", &backbone_config::jitter, keys::time_span{0s, 100ms},
                     "each packet takes up to this much longer: a frame of full-speed USB. Half of "
                     "it is the error of the time that the sink sends"),
      keys::optional("queue", &backbone_config::queue, keys::whole<std::size_t>{1, 4096},
                     "packets in transit, per direction; more are lost and counted"));
}

} // namespace rubicon::serial
