// The keys of what a file may say about motes that run plain programs of TinyOS.
#pragma once

#include "core/describe/keys.hpp"
#include "gateway/plain/plain_rule.hpp"

namespace rubicon::gateway {

inline auto keys_of(const address_range*) {
  return keys::of(
      keys::required("first", &address_range::first, keys::whole<std::uint16_t>{0, mote_id_max},
                     "the lowest address of the motes behind it; no simulated mote of the island "
                     "has an address in this range"),
      keys::required("last", &address_range::last, keys::whole<std::uint16_t>{0, mote_id_max},
                     "the highest one; packets of others are dropped and counted"));
}

inline auto keys_of(const plain_rule*) {
  return keys::of(
      keys::optional(
          "am_type", &plain_rule::am_type, keys::whole<std::uint8_t>{0, 255},
          {"AM type of their packets, as 6 of BlinkToRadio and RadioCountToLeds or 147 of "
           "Oscilloscope",
           "none: frames of IEEE 802.15.4 that are no packets of TinyOS, by their `pattern`. Their "
           "payload is all that follows the addresses, and their source the low 16 bits of a long "
           "address"}),
      keys::optional("pattern", &plain_rule::pattern, keys::hex_octets{},
                     {"octets that the payload must have, as \"70696e67\"", "any payload"}),
      keys::optional("pattern_offset", &plain_rule::pattern_offset,
                     keys::whole<std::uint8_t>{0, 124}, "position of these octets in the payload"),
      keys::required("type", &plain_rule::type, keys::whole<std::uint32_t>{1},
                     "number of the mote type that they have as devices, for proxies"),
      keys::optional("first", &plain_rule::first, keys::whole<std::uint16_t>{0, mote_id_max},
                     {"the lowest address of such motes", "`1`; that of `real`, if there is one"}),
      keys::optional("last", &plain_rule::last, keys::whole<std::uint16_t>{0, mote_id_max},
                     {"the highest one; others that send this AM type are not devices",
                      "`65532`; that of `real`, if there is one"}),
      keys::optional(
          "id_offset", &plain_rule::id_offset, keys::whole<std::uint8_t>{0, 112},
          {"position of the mote's address in the payload, 2 octets, big-endian: 4 of Oscilloscope "
           "and of packets of CTP, whose origin it is; 0 of BlinkToRadio",
           "the packet's source, which is 0 in programs that write to the serial line themselves"}),
      keys::optional("channel", &plain_rule::channel, keys::whole<std::uint8_t>{1, 255},
                     "output channel that gets the payload of each packet"),
      keys::optional("input", &plain_rule::input, keys::whole<std::uint8_t>{1, 255},
                     {"input channel: values written to it are sent to the mote as packets. Its "
                      "status is `sent` when the base station has received the packet, since the "
                      "mote acknowledges nothing",
                      "they have none"}),
      keys::optional("input_am_type", &plain_rule::input_am_type, keys::whole<std::uint8_t>{0, 255},
                     {"AM type of such packets", "`am_type`"}),
      keys::optional(
          "input_form", &plain_rule::input_form,
          keys::word<plain_form>{{{"octets", plain_form::octets},
                                  {"count", plain_form::count},
                                  {"blink", plain_form::blink},
                                  {"oscilloscope", plain_form::oscilloscope},
                                  {"mviz", plain_form::mviz}}},
          "format of the packets. `\"octets\"`: the written octets. The others need a number of 2 "
          "octets, `u16` of a proxy: `\"count\"` of RadioCountToLeds and `\"blink\"` of "
          "BlinkToRadio show it with their LEDs, to `\"oscilloscope\"` and `\"mviz\"` it is the "
          "interval in ms, sent with the next version of the mote's settings"));
}

} // namespace rubicon::gateway
