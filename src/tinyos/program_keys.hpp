// The keys of what a file may say about plain programs of TinyOS on simulated motes.
#pragma once

#include "core/describe/keys.hpp"
#include "tinyos/program_config.hpp"

namespace rubicon::tinyos {

/// What an interval may be: Oscilloscope has 16 bits of milliseconds for it.
inline constexpr keys::time_span interval{1ms, 60s};

inline auto oscilloscope_keys() {
  return keys::of(keys::required("transducer", &program_config::transducer, keys::quantity_name{},
                                 "source of its readings, as the counts of that transducer"),
                  keys::optional("every", &program_config::every, interval,
                                 {"period of readings, ten to a packet. Packets of Oscilloscope "
                                  "with a higher version change it",
                                  "`\"256ms\"`"}));
}

inline auto counter_keys() {
  return keys::of(keys::optional("every", &program_config::every, interval, "period of packets"));
}

} // namespace rubicon::tinyos
