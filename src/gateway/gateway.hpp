// The basestation's half of the bridge between an island and the PEIS network (D1.1 4.1.1, 5.4).
// It relays octets and knows nothing of what any mote can do (GW-02).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "gateway/gateway_config.hpp"
#include "gateway/island_motes.hpp"
#include "gateway/island_pc.hpp"
#include "gateway/leadership.hpp"
#include "gateway/mote_inputs.hpp"
#include "gateway/occasion.hpp"
#include "gateway/other_islands.hpp"
#include "gateway/others/relay.hpp"
#include "gateway/output_requests.hpp"
#include "gateway/outputs.hpp"
#include "gateway/plain/plain_motes.hpp"
#include "gateway/plain/plain_silence.hpp"
#include "gateway/sink_port.hpp"
#include "network/sink_event.hpp"

namespace rubicon::gateway {

/// PEIS port on which gateways find each other (D1.1 3.1.3).
inline constexpr std::uint16_t announcement_port = 20;

/// The gateway of one island. Motes reach it as the PC of their island (no_mote); its tuples:
///   devices, devices.line,
///   devices.$ID.{status,type,descriptor,output.$CH,input.$CH.status}     written here
///   devices.$ID.input.$CH, devices.$ID.output.$CH.period                 written by others
/// and, of one among several gateways of the island, devices.role and devices.gateways.
/// It requests of motes the output channels that somebody subscribes to (GW-10), and publishes all
/// that comes. Programs on the same PC have the same address; what they do not provide
/// becomes tuples.
///
/// Of several gateways of an island one leads (gateway::leadership): it is the PC of the island.
/// The others know the same motes, publish no outputs, and pass on to it what they are asked for.
///
/// It hands each input to the part whose duty it is, and what a part returns to the next one.
class gateway {
public:
  gateway() = default;
  gateway(gateway_config config, random_stream rng);

  /// Publishes the empty device list and asks the sink who is there; programs are joined.
  [[nodiscard]] outputs start(instant now);

  /// As communication::layer::observe().
  void observe(std::function<void(const communication::program_note&)> observer) {
    pc_.observe(std::move(observer));
  }

  /// A program, as in communication::pc. It is notified of motes that join (MCK-15).
  [[nodiscard]] communication::interface attach(communication::communication_events& events) {
    return pc_.term().attach(events);
  }
  void begin(instant now) {
    now_ = now;
    pc_.term().begin(now);
  }
  [[nodiscard]] outputs flush();

  /// The serial line has delivered a packet from the sink.
  /// @param source mote that it comes from, as the packet says
  [[nodiscard]] outputs on_packet(mote_id source, std::uint8_t am_type, byte_view payload,
                                  instant now);

  /// The same for what a sink would have said of a mote that runs a plain program.
  [[nodiscard]] outputs on_plain_packet(const sink_packet& x, instant now);

  /// The base station has acknowledged a to_plain, or it is lost: what the mote has of it is
  /// unknown. Called once for each.
  [[nodiscard]] outputs on_plain_done(std::uint64_t number, bool acked, instant now);

  /// The line to them is gone: they are stale until they send.
  [[nodiscard]] outputs on_plain_line_lost(instant now);

  /// Somebody has written a message for a mote (`devices.$ID.input.$CH`). Its status tuple says
  /// `N pending` and then, at once or later, how write N ended.
  [[nodiscard]] outputs on_input(mote_id mote, std::uint16_t channel, byte_view octets,
                                 instant now);

  /// Another gateway has sent a message to a PEIS port of gateways: it announces itself (GW-13,
  /// announcement_port), passes something on within the island (relay_port), or sends a message for
  /// this island (WIR-02, any other port); its id is the source island.
  [[nodiscard]] outputs on_message(peer_id source, std::uint16_t port, byte_view octets,
                                   instant now);

  void on_unreachable(peer_id peer) { ///< a to_gateway has failed
    others_.gateways().on_unreachable(peer);
  }

  /// Keys and patterns, in lower case, by which others subscribe to own tuples below `devices`.
  void on_subscribers(std::span<const std::string> keys, instant now) {
    requests_.on_subscribers(keys, now);
  }

  /// Network time is so much ahead of our time from now on; sinks ask for it (CLK-08).
  [[nodiscard]] outputs on_clock(duration offset, instant now);

  /// Somebody has written `devices.$ID.output.$CH.period`.
  void on_period(mote_id mote, std::uint16_t channel, std::string_view text, instant now);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] std::vector<mote_id> devices() const { return motes_.all(); } ///< ascending
  [[nodiscard]] const gateway_counters& counters() const { return counters_; }
  [[nodiscard]] const directory& others() const { return others_.gateways(); }
  [[nodiscard]] const leadership& lead() const { return lead_; }
  [[nodiscard]] const sink_port& sink() const { return sink_; }
  [[nodiscard]] const island_pc& pc() const { return pc_; }

private:
  [[nodiscard]] occasion begun(instant now, outputs& out); ///< of one call
  [[nodiscard]] duration silence_max() const;
  [[nodiscard]] bool is_here(island_id x) const;

  // from the sink
  void on_line_input(const occasion& at);
  void dispatch(mote_id source, std::uint8_t am_type, byte_view payload, const occasion& at);
  void on_island_packet(byte_view payload, const occasion& at);
  void on_packet_for_us(const network::island_packet& x, const occasion& at);
  void on_event(const network::mote_joined& x, const occasion& at);
  void on_event(const network::mote_left& x, const occasion& at);
  void on_event(const network::roster& x, const occasion& at);
  void on_event(const network::describe& x, const occasion& at);
  void on_event(const network::sink_started& x, const occasion& at);
  void on_event(const network::time_request& x, const occasion& at);
  void on_event(const network::time_answer& x, const occasion& at);
  void on_event(const network::gateway_poll& x, const occasion& at);
  void on_event(const network::gateway_answer& x, const occasion& at);

  // among the gateways of the island
  void change_lead(leadership::change x, const occasion& at);
  void on_relay(peer_id source, byte_view octets, const occasion& at);
  void on_relayed(peer_id source, relayed_message x, const occasion& at);
  void on_relayed(peer_id source, const relayed_input& x, const occasion& at);
  void on_relayed(peer_id source, const relayed_outcome& x, const occasion& at);
  void pass_on(island_id source, network::gateway_packet x, const occasion& at);

  // to motes, and to tuples
  void accept(island_id source, network::gateway_packet x, const occasion& at);
  void send(const network::island_packet& x, const occasion& at);
  void submit(const pending_input& x, byte_view octets, const occasion& at);
  void request_outputs(const occasion& at);
  void take(communication::outputs from_pc, const occasion& at);
  void publish_output(const transport::received& x, const occasion& at);

  gateway_config config_;
  leadership lead_;
  island_pc pc_;
  island_motes motes_;
  sink_port sink_;
  other_islands others_;
  mote_inputs inputs_;
  output_requests requests_;
  std::map<transport::ticket, mote_id> requested_; ///< requests in flight
  plain_silence plain_silence_;
  instant now_;
  gateway_counters counters_;
};

} // namespace rubicon::gateway
