// The keys of what a file may say about a serial cable.
#pragma once

#include "core/describe/keys.hpp"
#include "serial/cable/line_config.hpp"

namespace rubicon::serial {

inline auto keys_of(const line_config*) {
  return keys::of(
      keys::optional("baud", &line_config::baud, keys::baud{},
                     {"10 bit times an octet", "the sink's platform's"}),
      keys::optional("latency", &line_config::latency, keys::time_span{0s, 10s},
                     "latency of adapter and driver, per direction"),
      keys::optional("octet_error", &line_config::octet_error, keys::ratio{},
                     "probability that an octet is corrupted"),
      keys::optional("buffer", &line_config::buffer, keys::whole<std::size_t>{64, 1U << 24U},
                     "octets waiting to be sent, per direction; more are lost and counted"));
}

inline auto keys_of(const outside_config*) {
  return keys::of(
      keys::optional("device", &outside_config::device, keys::text{200},
                     {"serial port with a real sink, as `/dev/ttyUSB0`; needs `mode = \"wall\"`. "
                      "The island is then real: only its gateway is simulated, and the names and "
                      "types of motes in the file apply to the real ones",
                      "the sink is simulated"}),
      keys::optional(
          "forwarder", &outside_config::forwarder, keys::text{200},
          {"`HOST:PORT` of a TinyOS serial forwarder that has the real sink; as `device`",
           "the sink is simulated"}),
      keys::optional("replay", &outside_config::replay, keys::text{200},
                     {"file written by `rubicon run --record-serial`: the recorded packets of that "
                      "island's sink are replayed; as `device`, but also in virtual time",
                      "the sink is simulated"}),
      keys::optional("speed", &outside_config::speed, keys::real{0.001, 1000},
                     "with `replay`, speed relative to the recording"),
      keys::optional("payload", &outside_config::payload, keys::whole<std::size_t>{1, 114},
                     {"with a real sink, the longest AM payload that its program accepts; longer "
                      "ones are refused, since they would block it",
                      "`28`, as a BaseStation of TinyOS; `114` once it has reported that it runs "
                      "the island's own program"}),
      keys::optional(
          "pty", &outside_config::pty, keys::text{100},
          {"the simulated sink's cable ends in a pseudo-terminal, to which this symbolic link "
           "points, relative to the working directory of rubicon; needs `mode = \"wall\"`. The "
           "gateway is then another program, such as TinyOS's tools",
           "the island has a gateway"}));
}

/// Of a line to a real base station beside a simulated sink.
inline auto real_line_keys(const line_config*) {
  return keys::of(keys::optional("baud", &line_config::baud, keys::baud{},
                                 "speed of the port; or the name of the base station's platform"),
                  keys::optional("buffer", &line_config::buffer,
                                 keys::whole<std::size_t>{64, 1U << 24U},
                                 "octets waiting to be sent; more are lost and counted"));
}

inline auto real_line_keys(const outside_config*) {
  return keys::of(
      keys::optional("device", &outside_config::device, keys::text{200},
                     {"serial port with the base station, as `/dev/ttyUSB0`; needs `mode = "
                      "\"wall\"`. One of this and the next two is required",
                      "none"}),
      keys::optional("forwarder", &outside_config::forwarder, keys::text{200},
                     {"instead, `HOST:PORT` of a TinyOS serial forwarder that has it", "none"}),
      keys::optional(
          "replay", &outside_config::replay, keys::text{200},
          {"instead, a file written by `rubicon run --record-serial`: the packets of such a line "
           "of that island, recorded as `NAME/real`, are replayed; also in virtual time",
           "none"}),
      keys::optional("speed", &outside_config::speed, keys::real{0.001, 1000},
                     "with `replay`, speed relative to the recording"),
      keys::optional("payload", &outside_config::payload, keys::whole<std::size_t>{1, 114},
                     {"the longest AM payload that the base station accepts; longer ones are "
                      "refused, since they would block it",
                      "`28`, as a BaseStation of TinyOS"}));
}

inline auto keys_of(const export_config*) {
  return keys::of(
      keys::required("forwarder", &export_config::forwarder, keys::text{200},
                     "`ADDRESS:PORT` of this computer where a serial forwarder serves TinyOS's "
                     "programs, as `127.0.0.1:9002`; needs `mode = \"wall\"`"));
}

} // namespace rubicon::serial
