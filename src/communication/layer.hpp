// The Communication Layer of one node above Network: Transport, streams, synaptic channels, and the
// programs that use them (GEN-08, D1.1 5.1). The same on a mote and on a PC; what differs is below
// it, and is its owner's.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "communication/direct_process.hpp"
#include "communication/interface.hpp"
#include "communication/outputs_wanted.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"
#include "stream/sensor_record.hpp"
#include "stream/streams.hpp"
#include "synaptic/channels.hpp"
#include "transport/messenger.hpp"
#include "transport/tunnels.hpp"

namespace rubicon::communication {

/// Who waits for a channel.
struct channel_request {
  bool is_synaptic = false;
  std::uint16_t descriptor = 0;

  friend auto operator<=>(const channel_request&, const channel_request&) = default;
};

/// Open a channel of the island's Network; answered by on_connected() or on_connect_failed().
struct channel_wanted {
  channel_request request;
  mote_id destination;
  std::chrono::milliseconds interval{0}; ///< between two packets; 0: at any time
  std::size_t size = 0;                  ///< octets of a packet at most
};

/// Send this over a channel of Network.
struct channel_packet {
  stream::channel_handle channel;
  bytes octets;
  bool in_slot = false; ///< of set_slot(): no other mote sends now
  provenance from = {};
};

struct channel_unwanted {
  stream::channel_handle channel;
};

/// Read this transducer; answered by on_sample().
struct sample_wanted {
  stream::descriptor stream;
  std::uint8_t transducer = 0;
};

/// Read these; answered by on_transducers().
struct transducers_wanted {
  std::size_t process = 0;
  std::vector<device::quantity> kinds;
};

/// Move this; answered by on_actuator().
struct actuator_wanted {
  std::size_t process = 0;
  std::string name;
  std::uint8_t state = 0;
};

/// A program wants radio and serial line up; answered by on_initialised().
struct init_wanted {};

/// A program wants to join; answered by on_joined().
struct join_wanted {
  bytes description;
};

using layer_output =
    std::variant<transport::to_network, channel_wanted, channel_packet, channel_unwanted,
                 sample_wanted, transducers_wanted, actuator_wanted, init_wanted, join_wanted>;
using layer_outputs = std::vector<layer_output>;

/// What a program has done or received, for whoever observes the node. Views are valid during the
/// call only.
struct program_note {
  enum class kind : std::uint8_t { sent, send_ended, received, actuator_changed };

  kind what = kind::sent;
  std::string_view program = {};
  std::uint32_t number = 0; ///< of a send; 0: refused
  mote_address other = {};  ///< destination, or source
  std::uint8_t am_type = 0;
  byte_view octets = {};
  std::string_view actuator = {};
  std::uint8_t state = 0; ///< of the actuator
  bool yes = false;       ///< sent: reliable; send_ended: acknowledged; actuator_changed: obeyed
};

inline constexpr std::uint8_t transducers_max = 32; ///< bits of a mask

[[nodiscard]] constexpr bool has_transducer(std::uint32_t mask, std::uint8_t number) {
  return number < transducers_max && (mask & (1U << number)) != 0;
}

/// Of the layer itself.
struct own_layer_config {
  mote_id self;                      ///< no_mote: a PC
  island_id home = own_island;       ///< accounts for what is sent before the node has joined one
  std::uint32_t incarnation = 0;     ///< how often this node has been started before
  std::uint32_t transducer_mask = 0; ///< bit n: there is a transducer n
  std::size_t unclaimed_max = 4;     ///< accepted channels that have carried nothing yet
  /// From a tick to its vectors at least: so long programs may take.
  static constexpr duration slot_min = 200us;
};

struct layer_config : own_layer_config {
  transport::messenger_config messages;
  transport::tunnels_config tunnels;
  stream::streams_config streams;
  synaptic::channels_config synaptic;
};

struct layer_counters {
  std::uint64_t unowned = 0;         ///< messages of an AM type that no program provides (AM-01)
  std::uint64_t offered = 0;         ///< messages, accepted or refused
  std::uint64_t unjoined = 0;        ///< of them, refused for want of a join
  std::uint64_t misaddressed = 0;    ///< of them, refused: to nobody
  std::uint64_t refused = 0;         ///< commands that returned FAIL
  std::uint64_t before_join = 0;     ///< of them, for want of a join (MCK-16)
  std::uint64_t unknown_channel = 0; ///< packets on a channel number that is nobody's
  std::uint64_t unclaimed = 0;       ///< accepted channels given up
  std::uint64_t too_slow = 0;  ///< channels given up: their route promises less than was asked
  std::uint64_t malformed = 0; ///< requests of outputs that could not be decoded
};
RUBICON_FIELDS(layer_counters, unowned, offered, unjoined, misaddressed, refused, before_join,
               unknown_channel, unclaimed, too_slow, malformed);

/// Programs are called back from within the on_ functions, and may give commands then. What all
/// that leads to is fetched by the owner with take_outputs(), after each on_ function and after
/// each command given from outside.
class layer {
public:
  layer();
  layer(layer_config config, random_stream rng);
  ~layer();
  layer(const layer&) = delete; // programs point to it
  layer& operator=(const layer&) = delete;

  /// @param events a program's, which outlives this
  /// @param name for observe(); empty: what it receives is not observed
  [[nodiscard]] interface attach(communication_events& events, std::string name = {});

  /// Called at once for what programs send, and for what those with names receive. Must not give
  /// commands.
  void observe(std::function<void(const program_note&)> observer) {
    observer_ = std::move(observer);
  }

  /// The program that gets messages of types that no other provides; at most one.
  [[nodiscard]] interface attach_for_rest(communication_events& events);

  /// Commands given from outside an event happen now.
  void set_time(instant now) { now_ = now; }
  /// The time that peers share is so much ahead of `now`, since 1970.
  void set_network_ahead(duration x) { network_ahead_ = x; }

  void on_initialised(bool success, instant now);
  void on_joined(island_id island, instant now); ///< a PC: at once
  void on_left(instant now);                     ///< reliable sends have failed

  /// Of the island whose gateway this node is: at first, and after each restart (MCK-15).
  void on_mote_joined(mote_id mote, byte_view description, instant now);
  void forget_incarnation(mote_address x) { messages_.forget_incarnation(x); }

  /// A packet with the header of D1.1 5.4 for this node.
  void on_packet(island_id source, std::uint16_t channel, byte_view body, instant now);

  // Channels of Network.
  void on_connected(channel_request who, stream::channel_handle channel, instant now);
  void on_connect_failed(channel_request who, instant now);
  /// Of a channel of Network, before on_connected() or on_accepted(). @param bound how long a
  /// packet is in flight at most
  void set_latency_bound(stream::channel_handle channel, duration bound) {
    latency_bounds_[channel] = bound;
  }
  void on_accepted(stream::channel_handle channel, mote_address source, instant now);
  void on_channel_octets(stream::channel_handle channel, byte_view octets, instant now);
  void on_channel_closed(stream::channel_handle channel, instant now);

  void on_sample(stream::descriptor stream, const stream::sensor_record& x, instant now);
  /// @param process that asked @param counts of all that it asked for
  void on_transducers(std::size_t process, std::vector<std::int16_t> counts, std::uint32_t time_ms,
                      instant now);
  /// @param process that asked @param state what it is now
  void on_actuator(std::size_t process, const std::string& name, std::uint8_t state, bool obeyed,
                   instant now);
  /// Notifies the program that has set it last. @param state what it is now
  void on_actuator_arrived(const std::string& name, std::uint8_t state, instant now);

  void on_tick(std::uint32_t tick, instant now);
  /// Whether on_tick() matters to anybody here: a synaptic channel is open, or a program asks for
  /// it.
  [[nodiscard]] bool wants_ticks() const;
  /// Answers take so much longer from now on, as radios of this island sleep.
  void set_answer_slack(duration x) {
    messages_.set_answer_slack(x);
    streams_.set_answer_slack(x);
    synaptic_.set_answer_slack(x);
  }
  /// Where vectors of this node go, as far as they go to other nodes.
  struct vector_end {
    std::size_t size = 0; ///< elements
    bool connected = false;
    std::optional<stream::channel_handle> channel{}; ///< of Network; nothing: through the sink
  };
  [[nodiscard]] std::vector<vector_end> vector_ends() const;
  void set_slot(duration offset) { synaptic_.set_slot(std::max(offset, config_.slot_min)); }

  void on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] layer_outputs take_outputs();

  /// As interface has it.
  [[nodiscard]] std::optional<duration> latency_bound(stream::descriptor stream) const;

  [[nodiscard]] bool joined() const { return island_.has_value(); }
  [[nodiscard]] const transport::messenger& messages() const { return messages_; }
  [[nodiscard]] const stream::streams& streams() const { return streams_; }
  [[nodiscard]] const synaptic::channels& synaptic() const { return synaptic_; }
  [[nodiscard]] const transport::tunnels& tunnels() const { return tunnels_; }
  [[nodiscard]] const layer_counters& counters() const { return counters_; }
  [[nodiscard]] const own_layer_config& config() const { return config_; }
  [[nodiscard]] bool initialised() const { return initialised_; }

  /// Octets of all state on a mote with the default tables (SMP-30).
  [[nodiscard]] std::size_t footprint() const;

private:
  friend class direct_process;

  /// An event for a program, once the command or input that led to it is over.
  using event = std::function<void(communication_events&)>;

  [[nodiscard]] mote_address self() const;
  status refuse();
  [[nodiscard]] bool may_talk();
  [[nodiscard]] bool owns(std::size_t process, std::uint8_t am_type) const;

  std::optional<std::uint32_t> send(direct_process& from, mote_address to, byte_view buf,
                                    bool reliable, std::uint8_t am_type);
  int create(std::size_t process, bool is_out, mote_address other, std::uint8_t size,
             const synaptic::parameters& params);
  template <class Answer>
  status take_answer(Answer x);
  int take_open(std::size_t process, stream::answer x);

  void take(transport::outputs todo);
  void take(transport::tunnels_outputs todo, bool in_slot = false);
  void take(stream::outputs todo);
  void take(synaptic::outputs todo);
  void connect(channel_request who, mote_address destination, std::chrono::milliseconds interval,
               std::size_t size, std::uint8_t qos);
  [[nodiscard]] std::optional<duration> latency_bound(stream::channel_handle channel) const;
  void send_on(stream::channel_handle channel, bytes octets, bool in_slot = false);
  void disconnect(stream::channel_handle channel);
  void notify(std::size_t process, event x);
  void note(std::size_t process, program_note x) const;
  void notify_all(const event& x);
  template <class Owners>
  void notify_owner(const Owners& owners, typename Owners::key_type of, event x);
  void on_outcome(const transport::outcome& x);
  void on_received(transport::received& x);
  void on_outputs_wanted(const transport::received& x);
  void notify_outputs_wanted(std::size_t process);
  void on_read(stream::read_done& x);
  void dispatch();

  own_layer_config config_;
  transport::messenger messages_;
  transport::tunnels tunnels_;
  stream::streams streams_;
  synaptic::channels synaptic_;
  bool initialised_ = false;
  std::optional<island_id> island_;
  std::vector<output_wanted> outputs_wanted_; ///< by the gateway (GW-10)
  instant now_;
  std::optional<duration> network_ahead_;

  std::vector<std::unique_ptr<direct_process>> programs_; ///< programs point to them
  small_map<std::uint8_t, std::size_t> owners_;           ///< of AM types
  std::optional<std::size_t> rest_owner_;                 ///< of all others
  small_map<std::string, std::size_t> movers_;            ///< who has set an actuator last
  small_map<stream::descriptor, std::size_t> stream_owners_;
  small_map<synaptic::descriptor, std::size_t> synaptic_owners_;
  small_map<transport::ticket, std::size_t> senders_; ///< of reliable sends in flight
  std::uint32_t last_number_ = 0;
  small_map<transport::tunnel_id, channel_request> connecting_;
  small_map<channel_request, duration> latencies_asked_; ///< of channels that are being opened
  small_map<stream::channel_handle, bool> is_synaptic_;  ///< of channels in use
  small_map<stream::channel_handle, duration> latency_bounds_; ///< of channels of Network
  std::vector<std::pair<stream::channel_handle, mote_address>> unclaimed_;

  std::vector<std::pair<std::size_t, event>> events_;
  bool dispatching_ = false;
  std::function<void(const program_note&)> observer_;
  layer_outputs outputs_;
  layer_counters counters_;
};

} // namespace rubicon::communication
