// The basestation's half of the bridge between an island and the PEIS network (D1.1 4.1.1, 5.4).
// It relays octets and knows nothing of what any mote can do (GW-02).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "communication/pc.hpp"
#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "gateway/alias_talks.hpp"
#include "gateway/directory.hpp"
#include "gateway/leadership.hpp"
#include "gateway/output_requests.hpp"
#include "gateway/plain/plain_motes.hpp"
#include "gateway/relay.hpp"
#include "network/island_packet.hpp"
#include "network/sink_event.hpp"
#include "transport/fragments.hpp"

namespace rubicon::gateway {

/// Set this own tuple. Text goes without a trailing NUL here; the tuple layer adds it.
struct publish {
  std::string key;
  bytes value;
  bool text = false;
};

/// Delete this own tuple.
struct erase {
  std::string key;
};

/// Send this packet down the serial line.
struct to_sink {
  mote_id mote; ///< whom it is for in the end
  std::uint8_t am_type = 0;
  bytes payload; ///< at most network::frame_payload_max octets
  provenance from = {};
};

/// Answer its question at once: it is of no use when it is late.
struct answer_sink {
  network::sink_event answer; ///< `held` of a time_answer is for who knows the line
};

/// What has been written to an input of a mote with a plain program; on_plain_done() says how it
/// has ended.
struct to_plain {
  std::uint64_t number = 0;
  mote_id mote;
  std::uint16_t channel = 0;
  bytes octets;
  provenance from = {};
};

/// Send this to another gateway of the island, PEIS port 22, reliably.
struct relay_to {
  peer_id peer;
  bytes octets;
};

/// This gateway leads its island, or no longer does (GW-14).
struct lead_changed {
  bool leads = false;
  std::uint32_t term = 0;
};

/// Send this message (WIR-02) to another gateway, PEIS port 21.
struct to_gateway {
  peer_id peer;
  bytes octets;
  bool reliable = false; ///< as the sending mote asked (ACK-09)
  provenance from = {};
};

/// Broadcast this on announcement_port.
struct announce {
  bytes octets;
};

/// A mote is listed, listed again after a restart, or no longer listed.
struct member_changed {
  mote_id mote;
  bool listed = false;
  std::uint32_t incarnation = 0;
  network::leave_cause cause = network::leave_cause::notice; ///< when no longer listed
};

/// Nothing has come from the sink for a while, or something again (GW-15).
struct line_changed {
  bool up = false;
  duration silence{}; ///< for how long nothing came, when it is up again
};

using output = std::variant<publish, erase, to_sink, answer_sink, to_plain, to_gateway, relay_to,
                            announce, member_changed, line_changed, lead_changed>;
using outputs = std::vector<output>;

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
  std::uint64_t undeliverable = 0;     ///< for motes that are not listed, or for nobody here
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

class device_messages;

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
class gateway {
public:
  gateway();
  gateway(gateway_config config, random_stream rng);
  gateway(gateway&& x) noexcept;
  gateway& operator=(gateway&& x) noexcept;
  ~gateway();

  /// Publishes the empty device list and asks the sink who is there; programs are joined.
  [[nodiscard]] outputs start(instant now);

  /// As communication::layer::observe().
  void observe(std::function<void(const communication::program_note&)> observer);

  /// A program, as in communication::pc. It is notified of motes that join (MCK-15).
  [[nodiscard]] communication::interface attach(communication::communication_events& events);
  void begin(instant now) {
    now_ = now;
    pc_.begin(now);
  }
  [[nodiscard]] outputs flush() { return take(pc_.flush()); }

  /// The serial line has delivered a packet from the sink.
  /// @param source mote that it comes from, as the packet says
  [[nodiscard]] outputs on_packet(mote_id source, std::uint8_t am_type, byte_view payload,
                                  instant now);

  /// The same for what a sink would have said of a mote that runs a plain program.
  [[nodiscard]] outputs on_plain_packet(const sink_packet& x, instant now);

  /// The base station has acknowledged a to_plain, or it is lost: what the mote has of it, nobody
  /// knows. Called once for each.
  [[nodiscard]] outputs on_plain_done(std::uint64_t number, bool acked, instant now);

  /// The line to them is gone: they are stale until they send.
  [[nodiscard]] outputs on_plain_line_lost(instant now);

  /// Somebody has written a message for a mote (`devices.$ID.input.$CH`). Its status tuple says
  /// `N pending` and then, at once or later, how write N ended.
  [[nodiscard]] outputs on_input(mote_id mote, std::uint16_t channel, byte_view octets,
                                 instant now);

  /// Another gateway has sent a message for this island (WIR-02); its id is the source island.
  [[nodiscard]] outputs on_message(peer_id source, byte_view octets, instant now);

  /// Another gateway has announced itself (GW-13).
  void on_announcement(peer_id source, byte_view octets, instant now) {
    others_.on_announcement(source, octets, now);
  }

  /// Another gateway of the island has passed something on, PEIS port 22.
  [[nodiscard]] outputs on_relay(peer_id source, byte_view octets, instant now);

  void on_unreachable(peer_id peer) { others_.on_unreachable(peer); } ///< a to_gateway has failed

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

  [[nodiscard]] std::vector<mote_id> devices() const; ///< ascending
  /// The sink at the line has said something that only the islands' own program says.
  [[nodiscard]] bool has_own_sink() const { return has_own_sink_; }
  [[nodiscard]] const gateway_counters& counters() const { return counters_; }
  [[nodiscard]] const directory& others() const { return others_; }
  [[nodiscard]] std::optional<duration> clock_offset() const { return clock_offset_; }
  [[nodiscard]] std::size_t outstanding() const { return above().messages().outstanding(); }
  [[nodiscard]] transport::messenger_counters messages() const; ///< of all its terms
  /// The same: messages of its programs.
  [[nodiscard]] communication::layer_counters offers() const;
  [[nodiscard]] const leadership& lead() const { return lead_; }
  [[nodiscard]] const communication::layer& above() const { return pc_.above(); }
  [[nodiscard]] const communication::pc& pc() const { return pc_; }
  [[nodiscard]] const transport::assembly& from_sink() const { return fragments_; }

private:
  struct device {
    std::uint32_t incarnation = 0;
    std::uint64_t said = 0; ///< hash of its type and descriptor
    bool stale = false;     ///< nothing received since the line was lost, or the sink started again
    bool plain = false;     ///< it understands nothing that a gateway says
    std::set<std::uint16_t> output_channels; ///< those with a tuple, erased when the mote leaves
    std::set<std::uint16_t> input_channels;
  };

  struct pending_input {
    mote_id mote;
    std::uint16_t channel = 0;
    std::uint64_t sequence = 0;
    std::optional<peer_id> asker =
        {}; ///< the gateway that has passed it on; sequence is its number
  };

  /// Passed on to the gateway that leads.
  struct waiting_input {
    pending_input what;
    instant expires;
  };

  [[nodiscard]] outputs on_island_packet(byte_view payload, instant now);
  [[nodiscard]] outputs dispatch(mote_id source, std::uint8_t am_type, byte_view payload,
                                 instant now);
  [[nodiscard]] bool is_plain(mote_id x) const;
  [[nodiscard]] bool is_plain_silent() const;
  [[nodiscard]] outputs on_packet_for_us(const network::island_packet& x, instant now);
  [[nodiscard]] outputs on_event(const network::mote_joined& x, instant now);
  [[nodiscard]] outputs on_event(const network::mote_left& x, instant now);
  [[nodiscard]] outputs on_event(const network::roster& x, instant now);
  [[nodiscard]] outputs on_event(const network::describe& x, instant now);
  [[nodiscard]] outputs on_event(const network::sink_started& x, instant now);
  [[nodiscard]] outputs on_event(const network::time_request& x, instant now);
  [[nodiscard]] outputs on_event(const network::time_answer& x, instant now);
  [[nodiscard]] outputs on_event(const network::gateway_poll& x, instant now);
  [[nodiscard]] outputs on_event(const network::gateway_answer& x, instant now);
  [[nodiscard]] outputs on_relayed(peer_id source, relayed_message x);
  [[nodiscard]] outputs on_relayed(peer_id source, relayed_input x);
  [[nodiscard]] outputs on_relayed(peer_id source, const relayed_outcome& x);
  void start_sharing(outputs& out);
  void change_lead(leadership::change x, outputs& out);
  void take_lead(outputs& out);
  void end_work(outputs& out);
  void report_outcome(const pending_input& x, input_outcome outcome, outputs& out) const;
  void submit(const pending_input& x, byte_view octets, outputs& out);
  void pass_on(const pending_input& x, byte_view octets, outputs& out);
  [[nodiscard]] outputs pass_on(island_id source, network::gateway_packet x);
  void fail_waiting(instant now, outputs& out);
  [[nodiscard]] outputs accept(island_id source, network::gateway_packet x);
  [[nodiscard]] bool is_here(island_id x) const;
  [[nodiscard]] duration silence_max() const;
  void on_line_input(outputs& out);
  void refresh(mote_id mote, outputs& out);
  void make_stale(outputs& out);
  void make_stale(device& x, mote_id mote, outputs& out);
  [[nodiscard]] outputs take(communication::outputs from_pc);
  void publish_output(const transport::received& x, outputs& out);
  void publish_outcome(const transport::outcome& x, outputs& out);
  [[nodiscard]] outputs remove(mote_id mote, network::leave_cause cause);
  [[nodiscard]] publish device_list() const;
  [[nodiscard]] static to_sink ask_about(mote_id mote);
  void ask_for_outputs(outputs& out, instant now);
  [[nodiscard]] wire_form form_with(peer_id peer) const;
  void send_out(island_id island, network::gateway_packet x, bool reliable, outputs& out);
  void down(const network::island_packet& x, outputs& out);

  gateway_config config_;
  leadership lead_;
  random_stream rng_; ///< of the terms
  transport::messenger_counters earlier_terms_;
  communication::layer_counters earlier_offers_;
  std::map<std::uint32_t, waiting_input> waiting_; ///< by the number given
  std::uint32_t relay_number_ = 0;
  alias_talks talks_;
  communication::pc pc_;
  std::function<void(const communication::program_note&)> observer_;
  std::unique_ptr<device_messages> messages_;
  transport::assembly fragments_; ///< of packets from the sink
  std::uint8_t tag_ = 0;
  instant now_;
  std::map<mote_id, device> devices_;
  std::map<std::pair<mote_id, std::uint16_t>, std::uint64_t> input_sequences_;
  std::map<transport::ticket, pending_input> pending_;
  std::map<std::uint64_t, pending_input> plain_pending_; ///< by the number given
  std::uint64_t plain_number_ = 0;
  std::optional<instant> last_plain_input_; ///< a plain mote
  duration plain_pause_{};                  ///< the longest between two of their packets
  bool is_plain_said_ = false;              ///< while what on_plain_packet() was given is handled
  directory others_;
  std::uint16_t strict_counter_ = 0; ///< of what came in the strict form
  output_requests requests_;
  std::map<transport::ticket, mote_id> asked_; ///< requests in flight
  std::optional<duration> clock_offset_;
  instant clock_valid_from_;
  std::optional<instant> last_line_input_; ///< nothing: never
  bool line_up_ = false;
  bool has_own_sink_ = false;
  instant rejoin_until_; ///< before this the sink, started again, may not know all its motes
  std::optional<std::uint16_t> roster_number_; ///< of the roster being received
  std::set<mote_id> roster_seen_;
  std::uint8_t roster_pages_seen_ = 0;
  gateway_counters counters_;
};

} // namespace rubicon::gateway
