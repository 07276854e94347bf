// The keys of what a file may say about motes that run plain programs of TinyOS.
#pragma once

#include "core/keys.hpp"
#include "gateway/plain_rule.hpp"

namespace rubicon::gateway {

inline auto keys_of(const plain_rule*) {
  return keys::of(
      keys::required(
          "am_type", &plain_rule::am_type, keys::whole<std::uint8_t>{0, 255},
          "AM type of their packets, as 6 of BlinkToRadio and RadioCountToLeds or 147 of "
          "Oscilloscope"),
      keys::required("type", &plain_rule::type, keys::whole<std::uint32_t>{1},
                     "number of the mote type as which they are devices, for proxies"),
      keys::optional("first", &plain_rule::first, keys::whole<std::uint16_t>{1, mote_id_max},
                     "the lowest address of such motes"),
      keys::optional("last", &plain_rule::last, keys::whole<std::uint16_t>{1, mote_id_max},
                     "the highest one; others that send this AM type are none"),
      keys::optional("channel", &plain_rule::channel, keys::whole<std::uint8_t>{1, 255},
                     "output channel that has the payload of each packet"));
}

} // namespace rubicon::gateway
