// What actors' counters become in the report.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "actors/messages/supervision.hpp"
#include "communication/layer_totals.hpp"
#include "core/describe/fields.hpp"
#include "mote/node.hpp"
#include "mote/sink.hpp"
#include "radio/radio_counters.hpp"
#include "report/report.hpp"
#include "transport/messenger.hpp"

namespace rubicon {

/// What became of the frames of radios.
[[nodiscard]] report::radio_report report_of(const radio::radio_counters& x);

/// What became of the messages of a node's programs.
/// @param open reliable sends still waiting for their outcome
/// @param ended the node's life is over: what was open has failed
[[nodiscard]] report::message_report report_of(const transport::messenger_counters& x,
                                               const communication::layer_counters& offers,
                                               std::size_t open, bool ended);

/// The same of a whole node.
[[nodiscard]] message_status messages_of(mote_address who, const communication::layer& x,
                                         bool ended);

/// What the Communication Layer of a node has counted, module by module.
void add_layer(report::cause_counts& to, const communication::layer_totals& x);

/// Sends what modules of a node have counted in one life, if that is anything.
/// @param who the node's name in the report
template <class Self>
void send_modules(Self* self, const ecology_actor& ecology, const std::string& who,
                  report::cause_counts x) {
  if (!x.empty())
    self->send(ecology, module_status{who, std::move(x)});
}

/// What of a mote's or a sink's packets and channels has gone nowhere, by cause.
struct packet_losses {
  std::uint64_t channel_full = 0;
  std::uint64_t channel_lost = 0;
  std::uint64_t channel_no_room = 0;
  std::uint64_t channel_strays = 0;
  std::uint64_t gave_up = 0;
  std::uint64_t id_taken = 0;
  std::uint64_t malformed = 0;
  std::uint64_t misdirected = 0;
  std::uint64_t no_route = 0;
  std::uint64_t paced_out = 0;
  std::uint64_t queue_full = 0;
  std::uint64_t too_far = 0;
  std::uint64_t unclaimed = 0;
  std::uint64_t unknown_channel = 0;
  std::uint64_t unowned = 0;
};
RUBICON_FIELDS(packet_losses, channel_full, channel_lost, channel_no_room, channel_strays, gave_up,
               id_taken, malformed, misdirected, no_route, paced_out, queue_full, too_far,
               unclaimed, unknown_channel, unowned);

[[nodiscard]] packet_losses losses_of(const mote::node& x);
[[nodiscard]] packet_losses losses_of(const mote::sink& x);

/// The same, as the report has it.
template <described Losses>
[[nodiscard]] report::cause_counts lost_of(const Losses& x) {
  report::cause_counts lost;
  for_each_field(x,
                 [&lost](std::string_view cause, auto count) { lost[std::string(cause)] = count; });
  return lost;
}

/// @param own what the clock of this mote or sink shows `now`
[[nodiscard]] network_status status_of(mote_address address, const mote::node& x, instant own,
                                       instant now);

[[nodiscard]] network_status status_of(mote_address address, const mote::sink& x, instant own,
                                       instant now);

/// A sample of what that tells about a clock.
[[nodiscard]] inline sample_status sample_of(std::uint64_t number, const network_status& x) {
  sample_status sample;
  sample.sample = number;
  sample.has_address = true;
  sample.address = x.address;
  sample.is_sink = x.is_sink;
  sample.has_clock = x.has_clock;
  sample.clock_ahead_us = x.clock_ahead_us;
  return sample;
}

} // namespace rubicon
