// The keys of what a file may say about proxy classes.
#pragma once

#include "core/describe/keys.hpp"
#include "proxy/classes/proxy_class.hpp"

namespace rubicon::proxy {

inline auto keys_of(const field*) {
  return keys::of(
      keys::optional("scale", &field::scale, keys::real{}, "factor of the count").changeable(),
      keys::optional("add", &field::add, keys::real{}, "added to the scaled count").changeable(),
      keys::optional("decimals", &field::decimals, keys::whole<int>{0, 6}, "digits after the point")
          .changeable(),
      keys::optional("unit", &field::unit, keys::text{16}, {"published with the value", "none"})
          .replaceable());
}

inline auto keys_of(const proxy_settings*) {
  return keys::of(
      keys::optional(
          "answer_timeout", &proxy_settings::answer_timeout, keys::time_span{1s, 1h},
          "longest time that a write waits for its outcome from the gateway; longer, by as "
          "much as answers take longer, where radios of the mote's island sleep")
          .changeable("for values written from then on"),
      keys::optional("retry_for", &proxy_settings::retry_for, keys::time_span{0s, 24h},
                     "a write that failed, was unreachable or got no answer is repeated until this "
                     "time after the first attempt, and then has its only outcome; a newer word "
                     "for the same input replaces it")
          .changeable(),
      keys::optional("period", &proxy_settings::period, keys::time_span{10ms, 24h * 10},
                     {"period of the messages on the channels of its fields; requested from the "
                      "gateway whenever it lists the mote",
                      "the period of the mote"})
          .replaceable("its proxies request it at once"),
      keys::optional("stale_after", &proxy_settings::stale_after, keys::time_span{10ms, 24h * 10},
                     {"[`FIELD.freshness`](gateway.md#of-a-proxy) becomes `stale` this long after "
                      "the newest message",
                      "never"})
          .replaceable("also for values received before"),
      keys::optional(
          "inactive_after", &proxy_settings::inactive_after, keys::time_span{1s, 24h * 10},
          {"the proxy is `inactive` this long after the last message of its mote", "never"})
          .replaceable(),
      keys::optional(
          "retire_after", &proxy_settings::retire_after, keys::time_span{1s, 24h * 10},
          {"the proxy ends this long after its mote was lost; its tuples remain unchanged",
           "never"})
          .replaceable());
}

} // namespace rubicon::proxy
