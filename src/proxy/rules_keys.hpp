// The keys of what a file may say about rules.
#pragma once

#include "core/keys.hpp"
#include "proxy/rules_config.hpp"

namespace rubicon::proxy {

inline auto keys_of(const rule*) {
  return keys::of(
      keys::optional("above", &rule::above, keys::real{}, "the condition holds at or above this"),
      keys::optional("below", &rule::below, keys::real{},
                     {"and has ended below this", "", "number, at most `above`"}),
      keys::optional("equals", &rule::equals, keys::list_of<keys::text>{{}, 1},
                     "instead: the condition holds while the value is one of these"),
      keys::optional("lasting", &rule::lasting, keys::time_span{},
                     "the condition holds for so long before `then` is written"),
      keys::optional("otherwise_lasting", &rule::otherwise_lasting, keys::time_span{},
                     "it has ended for so long before `otherwise` is written"),
      keys::optional("after", &rule::after, keys::time_span{},
                     "`then` is written so long after the condition has come to hold, or after "
                     "`at`, even if it has ended since (`lasting` is for what must go on); if it "
                     "comes to hold again before, the time begins anew"),
      keys::optional(
          "retry", &rule::retry, keys::flag{},
          "what its owner has not got, or has lost, is written again when the owner is "
          "there, and what was due `at` a time while the rules were away is written when "
          "they are back; else it is lost"));
}

inline auto keys_of(const rules_config*) {
  return keys::of(keys::optional(
      "retry", &rules_config::retry, keys::time_span{0s, 1min},
      "what could not be brought to its owner, and what a proxy's "
      "[`INPUT.outcome`](gateway.md#of-a-proxy) tells to have failed, to be unreachable or to have "
      "timed out, is written again after so long, then after twice as long, up to 1 min; "
      "`\"0s\"`: never, as with `retry = false` in all rules"));
}

} // namespace rubicon::proxy
