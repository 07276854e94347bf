// The keys of what a file may say about programs that measure.
#pragma once

#include "core/describe/keys.hpp"
#include "traffic/flow_config.hpp"

namespace rubicon::traffic {

inline auto keys_of(const sender_config*) {
  constexpr duration every_max = 24h * 10;
  return keys::of(
      keys::optional("payload", &sender_config::payload,
                     keys::whole<std::size_t>{payload_min, payload_max},
                     "octets of MAC payload, TinyOS's network octet and AM type included"),
      keys::optional("pattern", &sender_config::pattern,
                     keys::word<arrivals>{{{"periodic", arrivals::periodic},
                                           {"poisson", arrivals::poisson},
                                           {"saturated", arrivals::saturated}}},
                     "one per period; at random, this far apart on average; or the next as soon as "
                     "one has ended"),
      keys::optional("every", &sender_config::every, keys::time_span{1ms, every_max},
                     "not if saturated"),
      keys::optional("jitter", &sender_config::jitter, keys::time_span{0s, every_max},
                     {"maximum random delay of each; only if periodic", "", "time up to `every`"}),
      keys::optional(
          "start", &sender_config::start, keys::time_span{},
          {"of the first packet", "a random moment of the first `every`; if saturated, at once"}),
      keys::optional("stop", &sender_config::stop, keys::time_span{},
                     {"end of sending", "the end of the run", "time after `start`"}),
      keys::optional("count", &sender_config::count, keys::whole<std::uint64_t>{1, INT64_MAX},
                     {"maximum number of packets", "no limit"}),
      keys::optional("ack", &sender_config::ack, keys::flag{},
                     {"acknowledgement by the medium access", "`true`, for `\"*\"` `false`"}));
}

inline auto keys_of(const relay_config*) {
  return keys::of(keys::optional("ack", &relay_config::ack, keys::flag{}, "as of a sender"));
}

} // namespace rubicon::traffic
