// The keys of what a file may say about a pursuer of goals.
#pragma once

#include "core/describe/keys.hpp"
#include "goal/pursuer_config.hpp"

namespace rubicon::goal {

inline auto keys_of(const output_config*) {
  return keys::of(
      keys::optional("every", &output_config::every, keys::time_span{1ms, 24h * 10},
                     "publication period; it is also published whenever a state sets it"),
      keys::optional("step", &output_config::step, keys::real{},
                     "added each time; `value` must be a number then"),
      keys::optional("until", &output_config::until, keys::real{},
                     {"limit of the steps", "no limit"}));
}

inline auto keys_of(const state_config*) {
  return keys::of(
      keys::required("for", &state_config::length, keys::time_span{1ms, 24h * 10}, "length"),
      keys::optional("jitter", &state_config::jitter, keys::time_span{0s, 24h * 10},
                     "maximum random extension, uniform"),
      keys::optional("failure_rate", &state_config::failure_rate, keys::ratio{},
                     "probability that it ends the goal as failed"));
}

} // namespace rubicon::goal
