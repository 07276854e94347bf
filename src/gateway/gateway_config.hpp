// What a gateway is configured with, and what it counts.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "gateway/others/announcement.hpp"
#include "gateway/others/directory.hpp"
#include "gateway/output_requests.hpp"
#include "transport/answer_slack.hpp"

namespace rubicon::gateway {

struct gateway_config {
  island_id island;
  /// PEIS ids of all gateways of the island, that of the island first; empty: it is the only one.
  std::vector<peer_id> gateways = {};
  std::uint32_t incarnation = 0;           ///< how often it was started before
  std::size_t inputs_outstanding_max = 64; ///< further inputs fail at once
  wire_form form = wire_form::segment;     ///< strict54: with every other gateway (WIR-04)
  std::size_t channels_max = 64;           ///< as communication::pc_config; the next too
  duration ack_wait = 500ms;
  duration lead_lease = 1500ms;     ///< leadership_config::lease
  duration line_silence_max = 25s;  ///< more than two rosters of its sink without a word
  duration shared_silence_max = 5s; ///< the same of one among several, which its sink polls
  duration clock_wait =
      10s; ///< a restarted kernel's clock is not sent before: it first learns others'
  duration rejoin_wait = 60s; ///< a sink that was started again may find its motes until then
  directory_config others{};
  output_requests_config requests{};
  std::chrono::milliseconds tick_period{500}; ///< of the RUBICON clock
  transport::answer_slacks slacks = {};
  std::size_t devices_max = 1000;        ///< motes listed; what a sink has room for
  std::size_t input_channels_max = 4096; ///< channels of motes ever written to; further ones are
                                         ///< refused without a status
  bool has_real_line = false; ///< motes with plain programs are behind a line of their own
  /// They are behind a serial forwarder, which takes packets whatever becomes of them.
  bool is_forwarded = false;
  duration relay_wait = 35s; ///< for the outcome of an input passed on: longer than two messages of
                             ///< Transport take to fail where radios are on
};

struct gateway_counters {
  std::uint64_t malformed = 0;         ///< packets or messages that could not be decoded
  std::uint64_t unknown_type = 0;      ///< serial packets of a type that has no business here
  std::uint64_t devices_refused = 0;   ///< joins of motes for which there is no room
  std::uint64_t outputs_published = 0; ///< messages of motes published
  std::uint64_t inputs = 0;            ///< tuple writes taken for motes
  std::uint64_t inputs_refused = 0;    ///< no room for another channel
  std::uint64_t forwarded_out = 0;     ///< messages of the island sent to other gateways
  std::uint64_t forwarded_in = 0;      ///< messages of other islands sent down
  std::uint64_t undeliverable = 0;     ///< for motes that are not listed, or not of here
  std::uint64_t unsayable = 0; ///< messages from or to a gateway of the strict form that it does
                               ///< not know: reliable ones, streams, synaptic channels
  std::uint64_t requests = 0;  ///< to motes, of what they are to send
  std::uint64_t requests_failed = 0;
  std::uint64_t plain_inputs = 0; ///< of inputs, those for motes with plain programs
  std::uint64_t bad_periods = 0;  ///< texts that are no period: dropped
  std::uint64_t relayed_out = 0;  ///< messages and inputs passed on to the gateway that leads
  std::uint64_t relayed_in = 0;   ///< the same, taken from others
};
RUBICON_FIELDS(gateway_counters, malformed, unknown_type, devices_refused, outputs_published,
               inputs, inputs_refused, forwarded_out, forwarded_in, undeliverable, unsayable,
               requests, requests_failed, plain_inputs, bad_periods, relayed_out, relayed_in);

} // namespace rubicon::gateway
