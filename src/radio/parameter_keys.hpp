// The keys of what a file may say about the air and the radios in it.
#pragma once

#include "core/describe/keys.hpp"
#include "radio/parameters.hpp"

namespace rubicon::radio {

inline auto keys_of(const unit_disk*) {
  return keys::of(keys::optional("range", &unit_disk::range_m, keys::metres{0.1, 100'000},
                                 "a radio farther away receives nothing"));
}

inline auto keys_of(const log_distance*) {
  return keys::of(
      keys::optional("exponent", &log_distance::exponent, keys::real{1, 10},
                     "2 in free space, 3 indoors"),
      keys::optional("reference", &log_distance::reference_db, keys::decibels{0, 200},
                     "loss at the first metre"),
      keys::optional("shadowing", &log_distance::shadowing_db, keys::decibels{0, 30},
                     "standard deviation of the part that both directions of a link share"),
      keys::optional("asymmetry", &log_distance::asymmetry_db, keys::decibels{0, 30},
                     "standard deviation of the part of each direction"));
}

inline auto keys_of(const friis*) {
  return keys::of(keys::optional("frequency", &friis::frequency_mhz, keys::frequency{},
                                 "TinyOS's default channel, 26"));
}

inline auto keys_of(const constant_noise*) {
  return keys::of(keys::optional("floor", &constant_noise::floor_dbm, keys::power_level{},
                                 "the same at every radio"));
}

inline auto medium_keys() {
  return keys::of(
      keys::optional("loss", &channel_config::loss, keys::ratio{},
                     "probability that a copy of a frame is lost, in addition to all other causes"),
      keys::optional("queue", &channel_config::queue, keys::whole<std::size_t>{1, 1024},
                     "frames a radio's transmit queue holds; more are refused and counted"),
      keys::optional(
          "retries", &channel_config::retries_max, keys::whole<unsigned>{0, 7},
          {"repetitions of a frame that is not acknowledged",
           "the medium access's: 3 for `\"standard\"` (macMaxFrameRetries), 0 for TinyOS's"}),
      keys::optional("receive_slots", &channel_config::receive_slots,
                     keys::whole<std::size_t>{1, 1024},
                     {"frames a mote can hold while its MCU is busy; more are dropped and "
                      "counted as `overflow`",
                      "the platform's: 3"}),
      keys::optional("service_time", &channel_config::service_time, keys::time_span{0s, 1s},
                     {"processing time of the MCU for a frame, received or sent",
                      "the platform's: 2 ms MicaZ, 1.5 ms IRIS, 2.5 ms TelosB"}));
}

inline auto keys_of(const access_parameters*) {
  return keys::of(
      keys::optional("min_be", &access_parameters::min_be, keys::whole<unsigned>{0, 8},
                     {"macMinBE: the first back-off is 0 to 2^macMinBE - 1 periods of 320 us; at "
                      "most `max_be`",
                      "3"}),
      keys::optional(
          "max_be", &access_parameters::max_be, keys::whole<unsigned>{3, 8},
          {"macMaxBE: limit of the exponent, which grows by 1 after each busy assessment", "5"}),
      keys::optional("backoffs", &access_parameters::backoffs_max, keys::whole<unsigned>{0, 5},
                     {"macMaxCSMABackoffs: back-offs after the first one; when the channel is busy "
                      "after the last, access has failed",
                      "4"}),
      keys::optional("retries", &access_parameters::retries_max, keys::whole<unsigned>{0, 7},
                     {"macMaxFrameRetries: repetitions of a frame that is not acknowledged, with "
                      "any medium access",
                      "as in `[radio]`"}));
}

inline auto keys_of(const listening_config*) {
  return keys::of(
      keys::optional(
          "interval", &listening_config::interval, keys::time_span{20ms, 1min},
          {"period of channel checks; a frame is repeated for at most this time plus 20 ms",
           "`\"512ms\"`"}),
      keys::optional("check", &listening_config::check, keys::time_span{1ms, 100ms},
                     "time that a radio is on for a channel check; longer than the gap between two "
                     "copies of a frame"),
      keys::optional("awake", &listening_config::awake, keys::time_span{1ms, 10s},
                     "time that it stays on after a check that found a signal, and after each "
                     "frame received or sent"));
}

inline auto reception_keys() {
  return keys::of(
      keys::optional("sensitivity", &channel_config::sensitivity_dbm, keys::power_level{},
                     {"weaker frames are not received; not for a unit disk", "the platform's"}),
      keys::optional("cca_threshold", &channel_config::cca_dbm, keys::power_level{},
                     {"energy at which the channel counts as busy; not for a unit disk with "
                      "`collisions = \"strict\"`, nor with `sensing = \"carrier\"`",
                      "the platform's"}),
      keys::optional("cutoff", &channel_config::cutoff_dbm, keys::power_level{},
                     "weaker frames do not interfere either; not for a unit disk"),
      keys::optional(
          "sensing", &channel_config::sensing,
          keys::word<radio::sensing>{{{"energy", sensing::energy},
                                      {"carrier", sensing::carrier},
                                      {"energy_or_carrier", sensing::energy_or_carrier}}},
          "condition for a busy channel: power at the threshold (CCA mode 1), a frame being "
          "received (mode 2), or either"),
      keys::optional("sensing_window", &channel_config::window,
                     keys::word<sensing_window>{
                         {{"whole", sensing_window::whole}, {"end", sensing_window::end}}},
                     "at any moment of the 128 us of an assessment, or at the last"),
      keys::optional(
          "collisions", &channel_config::collisions,
          keys::word<collision_rule>{
              {{"sinr", collision_rule::sinr}, {"strict", collision_rule::strict}}},
          {"interference causes bit errors while it lasts, or any overlap loses both frames",
           "`\"strict\"` for a unit disk, else `\"sinr\"`"}),
      keys::optional(
          "sensitivity_edge", &channel_config::edge,
          keys::word<sensitivity_edge>{
              {{"sharp", sensitivity_edge::sharp}, {"noise", sensitivity_edge::noise}}},
          "at the sensitivity reception stops abruptly, or fades out: the receiver's own noise "
          "makes it lose 1 % of frames of 20 octets there; not for a unit disk"),
      keys::optional("capture", &channel_config::capture, keys::flag{},
                     "a receiver drops the frame it is receiving for a much stronger later one; "
                     "not with `collisions = \"strict\"`"),
      keys::optional(
          "curve", &channel_config::curve,
          keys::word<error_curve>{{{"oqpsk", error_curve::oqpsk}, {"tossim", error_curve::tossim}}},
          "error model as a function of the signal to noise and interference ratio: bit errors of "
          "IEEE 802.15.4-2006 E.4.1.8, or TOSSIM's probability for a whole frame; not with "
          "`collisions = \"strict\"` without noise"));
}

} // namespace rubicon::radio
