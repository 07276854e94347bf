// The keys of what a file may say of SMEPP Light.
#pragma once

#include "core/describe/keys.hpp"
#include "smepp/member_config.hpp"
#include "smepp/messages.hpp"

namespace rubicon::smepp {

inline constexpr keys::time_span event_period{10ms, 24h};
inline constexpr keys::real event_rate{0, 50};

inline auto keys_of(const wanted_event*) {
  return keys::of(
      keys::required("event", &wanted_event::event, keys::text{event_name_max}, "its name"),
      keys::optional(
          "rate", &wanted_event::rate, event_rate,
          {"sampling rate of its producers in 1/s, all at the same moments; 0: their own rates", "",
           "number from 0 to 50"}),
      keys::optional("from", &wanted_event::from, keys::time_span{}, "earliest time of the run"),
      keys::optional("expires", &wanted_event::expires, keys::time_span{1s},
                     {"length of the subscription", "never"}),
      keys::optional("until", &wanted_event::until, keys::time_span{},
                     {"time of the run at which it is withdrawn", "never"}),
      keys::optional(
          "frequency", &wanted_event::frequency, event_rate,
          {"rate at which the own radio wakes for it, in 1/s; 0: the producers' sampling rate", "",
           "number from 0 to 50"}),
      keys::optional(
          "channel", &wanted_event::channel, keys::whole<std::uint8_t>{},
          {"each value is forwarded to the gateway, on this output channel, as a reliable message",
           "values are not forwarded"}));
}

inline auto keys_of(const raised_event*) {
  return keys::of(
      keys::required("event", &raised_event::event, keys::text{event_name_max}, "its name"),
      keys::optional("transducer", &raised_event::transducer, keys::quantity_name{},
                     {"its value is the transducer's count, as of a sampler",
                      "a running number of 4 octets", "quantity of the mote"}),
      keys::optional("every", &raised_event::every, event_period,
                     "period for subscriptions without a rate"));
}

inline auto keys_of(const member_config*) {
  return keys::of(
      keys::optional("creates", &member_config::creates, keys::flag{},
                     "it creates the group; others look for it until they find it, and join"),
      keys::optional("leaves", &member_config::leaves, keys::time_span{},
                     {"time of the run at which it leaves the group", "never"}));
}

inline auto keys_of(const energy_config*) {
  return keys::of(
      keys::optional("tolerance", &energy_config::tolerance, keys::time_span{0s, 10s},
                     "the radio stays on between windows that are closer than this"),
      keys::optional("radio_delay", &energy_config::radio_delay, keys::time_span{0s, 1s},
                     "it is switched on this long before a window, and off this long after it"));
}

inline auto keys_of(const group_settings*) {
  return keys::of(
      keys::optional("saves_energy", &group_settings::saves_energy, keys::flag{},
                     "radios sleep outside of the windows; `false`: they are always on"),
      keys::optional("event_window", &group_settings::event_window, keys::time_span{10ms, 10s},
                     "length of a subscription's windows"),
      keys::optional("memory", &group_settings::memory_max, keys::whole<std::size_t>{1},
                     "octets that the protocols of a mote may need with all tables full; a mote "
                     "that needs more is reported in the event log"));
}

} // namespace rubicon::smepp
