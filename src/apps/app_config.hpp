// The configuration of programs that use the Mockup interface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "apps/registry.hpp"
#include "core/address.hpp"
#include "core/time.hpp"
#include "device/transducer_config.hpp"

namespace rubicon::apps {

/// Reads transducers and sends their counts, big-endian signed 16 bit, in the order listed.
struct sampler_config {
  std::vector<device::quantity> transducers; ///< at least one, each present on the mote
  duration every = 31s;
  duration jitter = 0s;         ///< each period starts up to this much late, uniform
  std::uint16_t channel = 1;    ///< output channel of section 5.4; equals the AM type, 0..255
  bool reliable = false;        ///< ask for an end-to-end acknowledgement
  bool only_subscribed = false; ///< send while somebody subscribes to the channel only (GW-10)
  duration every_min = 100ms;   ///< at most `every`: no shorter period may be requested (IF-04)
  bool stamped = true;          ///< after the counts: uint32, when that was, as in sensor_record
  /// How many counts of each transducer are averaged here, for a proxy's field with
  /// `computed_by = "mote"` (PXY-17); none: no count is averaged.
  std::vector<std::size_t> mean_of = {};
  /// A message goes only when the count of a transducer is so far, or farther, from the one that
  /// was sent last; 0: that of this transducer decides nothing. Empty: each message goes.
  std::vector<std::int32_t> dead_band = {};
  duration silence_max = 0s; ///< with a dead band: at least every so often, at least `every`
};

/// Sets an actuator from the first octet received on a channel and answers with its new state.
struct actuator_config {
  std::string actuator;
  std::uint16_t channel = 2; ///< input channel; the state goes out on the same channel
};

/// Sends text to another mote, of any island.
struct messenger_config {
  mote_address to;
  std::string text;
  duration every = 30s;
  std::uint8_t am_type = 10;
  bool reliable = true;
  std::optional<std::uint32_t> count = {}; ///< so many messages in a life; unset: without limit
};

/// Reports the first message that it receives on one AM type; the other end of a messenger.
struct listener_config {
  std::uint8_t am_type = 10;
};

/// Samples a transducer and streams the records to another node (STR-07, STR-16).
struct stream_writer_config {
  device::quantity transducer = device::quantity::temperature;
  duration every = 1s;
  mote_address to; ///< no_mote in the mote part: a PC
  std::uint16_t stream = 1;
};

/// The read end: counts what comes, and what does not.
struct stream_reader_config {
  std::uint16_t stream = 1;
  duration every = 1s; ///< as the writer's
};

/// One end of a synaptic channel.
struct synapse {
  mote_address other; ///< no_mote in the mote part: a PC
  std::uint8_t size = 1;
};

/// A part of an echo-state network: at each tick of the RUBICON clock it takes its transducer and
/// its in channels into its units and sends their states out (D1.1 4.2.2).
struct reservoir_config {
  std::vector<device::quantity> transducers; ///< each scaled by its own range so far
  std::vector<synapse> from;
  std::vector<synapse> to; ///< element 0 is the first transducer, if there is one; then the units
  std::uint8_t units = 8;
  double leak = 0.5;   ///< share of the new state, 0..1
  double radius = 0.9; ///< bound of the spectral radius of the units' own weights
};

/// Learns to say one tick ahead what element 0 of its first in channel will be, from all elements
/// of all its in channels.
struct readout_config {
  std::vector<synapse> from;
  std::uint32_t warm_up = 100; ///< ticks before errors count
  double forgetting = 0.9995;  ///< weight of one tick's past, up to 1
};

/// Where a stream leads to.
struct stream_output {
  mote_address to; ///< no_mote in the mote part: a PC
  std::uint16_t stream = 1;
};

/// Makes one stream of several: the mean of their newest values (STR-22).
struct average_config {
  std::vector<std::uint16_t> streams; ///< at least one; they end here
  duration every = 1s;                ///< as the writers', and from one mean to the next
  std::vector<stream_output>
      outputs; ///< at least one; numbers differ, also from those of `streams`
};

/// Commands the app `actuator` of a mote. on_at < off_at: on at that value or less, off at the
/// other or more; on_at > off_at: the reverse.
struct stream_switch_config {
  std::uint16_t stream = 1;
  duration every = 1s; ///< as the writer's
  double on_at = 0;    ///< in counts, as the next one; never equal to it
  double off_at = 1;
  mote_address to;
  std::uint8_t channel = 2; ///< AM type that the actuator's app obeys
};

/// Writes the records of streams to a file, on a PC.
struct recorder_config {
  std::vector<std::uint16_t> streams; ///< at least one; they end here
  duration every = 1s;                ///< as the writers'
  std::string file;
};

using app_config =
    std::variant<stream_writer_config, stream_reader_config, reservoir_config, readout_config,
                 average_config, stream_switch_config, recorder_config, custom_config>;

/// What files and reports call it: `stream_writer`.
[[nodiscard]] inline std::string_view kind_of(const app_config& x) {
  if (const auto* custom = std::get_if<custom_config>(&x))
    return custom->kind->name;
  constexpr std::array<std::string_view, std::variant_size_v<app_config> - 1> kinds{
      "stream_writer", "stream_reader", "reservoir", "readout",
      "average",       "stream_switch", "recorder"};
  return kinds[x.index()];
}

} // namespace rubicon::apps
