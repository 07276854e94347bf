// The keys of what a file may say about rules.
#pragma once

#include "core/describe/keys.hpp"
#include "proxy/rules/rules_config.hpp"

namespace rubicon::proxy {

inline auto keys_of(const rule*) {
  return keys::of(
      keys::optional("above", &rule::above, keys::real{},
                     "the condition becomes true at or above this"),
      keys::optional("below", &rule::below, keys::real{},
                     {"and becomes false below this", "", "number, at most `above`"}),
      keys::optional("equals", &rule::equals, keys::list_of<keys::text>{{}, 1},
                     "instead: the condition holds while the value is one of these"),
      keys::optional("lasting", &rule::lasting, keys::time_span{},
                     "time that the condition must hold before `then` is written"),
      keys::optional("otherwise_lasting", &rule::otherwise_lasting, keys::time_span{},
                     "time that it must have ended before `otherwise` is written"),
      keys::optional("after", &rule::after, keys::time_span{},
                     "`then` is written this long after the condition became true, or after `at`, "
                     "even if it has ended since (use `lasting` if it must persist); if the "
                     "condition becomes true again before, the time restarts"),
      keys::optional("retry", &rule::retry, keys::flag{},
                     "a value that its owner did not receive, or has lost, is written again when "
                     "the owner is present, and a value that was due `at` a time while the rules "
                     "were not running is written when they run again; otherwise it is lost"));
}

inline auto keys_of(const rules_config*) {
  return keys::of(
      keys::optional("retry", &rules_config::retry, keys::time_span{0s, 1min},
                     "a value that could not be delivered to its owner, or whose "
                     "[`INPUT.outcome`](gateway.md#of-a-proxy) at a proxy is failed, unreachable "
                     "or timed out, is written again after this time, then after twice as long, up "
                     "to 1 min; `\"0s\"`: never, as with `retry = false` in all rules"));
}

} // namespace rubicon::proxy
