// The communication layer of one mote: join, Network, and the layer its programs use, over whatever
// carries frames.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "communication/layer.hpp"
#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/shared_list.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"
#include "device/actuator.hpp"
#include "device/transducer_config.hpp"
#include "mote/crystal.hpp"
#include "mote/duty_cycle.hpp"
#include "mote/join/descriptor.hpp"
#include "mote/join/island_member.hpp"
#include "mote/join/join_client.hpp"
#include "mote/nonvolatile.hpp"
#include "mote/packet_service.hpp"
#include "mote/stack/cached_layer.hpp"
#include "mote/stack/channel_pacer.hpp"
#include "mote/stack/mote_devices.hpp"
#include "mote/stack/slot_client.hpp"
#include "mote/vector_slot.hpp"
#include "synaptic/rubicon_clock.hpp"

namespace rubicon::mote {

/// Sizes of tables.
struct node_tables {
  communication::layer_config layer;
  network::router_config network;
};

struct node_config {
  mote_id id;
  std::uint32_t type = 0;
  std::uint32_t device = 0; ///< as in descriptor
  /// Promised in the descriptor: it sends about this often. It sends a keep-alive when it has sent
  /// nothing for half as long again, so that reports on time make that unnecessary.
  duration keep_alive = 2s;
  bool joins_alone = true; ///< else its programs call initCommunications and joinIsland
  shared_list<device::transducer_config> transducers;
  shared_list<device::actuator_config> actuators;
  position place;                    ///< for what its transducers measure
  std::uint64_t transducer_seed = 0; ///< of random walks: the same in all lives of a mote
  /// Never nullptr; motes that are alike share one.
  std::shared_ptr<const node_tables> tables = std::make_shared<const node_tables>();
  network::access_times access; ///< of every radio of the island, at least
  network::backbone_ends backbone;
  duty_config duty;
};

/// The mote is a member of its island, or is one no longer.
struct membership {
  bool joined = false;
  island_id island;
};

/// Its sink has another mote with this address: it is silent, its radio off, and asks again later.
struct address_taken {};

using node_output = std::variant<network::frame_out, radio_switch, membership, actuator_arrived,
                                 store_nonvolatile, address_taken>;
using node_outputs = std::vector<node_output>;

struct node_counters {
  std::uint64_t malformed = 0;    ///< component management that could not be decoded
  std::uint64_t misdirected = 0;  ///< packets for another mote, or before the join
  std::uint64_t channel_full = 0; ///< packets that found no room in their channel's queue
  std::uint64_t paced_out = 0;    ///< packets that newer ones have replaced before their turn
};
RUBICON_FIELDS(node_counters, malformed, misdirected, channel_full, paced_out);

/// Everything a mote does that needs no radio chip. All times are by the mote's own clock
/// (mote::crystal).
class node {
public:
  /// Starts, and looks for its island.
  /// @param store what the mote remembers, of which its incarnation (DIS-07)
  /// @param config not nullptr
  /// @param crystal its own: what transducers see goes by the world's
  node(std::shared_ptr<const node_config> config, crystal crystal, const nonvolatile& store,
       random_stream rng, instant now);
  node(node_config config, const nonvolatile& store, random_stream rng, instant now)
      : node(std::make_shared<const node_config>(std::move(config)), {}, store, rng, now) {}
  ~node();                    // it is large: compiled once
  node(const node&) = delete; // programs point to it
  node& operator=(const node&) = delete;

  /// A program on this mote. Commands that are not given from within an event are followed by
  /// settle(). @param events outlives this
  /// @param name as in layer::attach()
  [[nodiscard]] communication::interface attach(communication::communication_events& events,
                                                std::string name = {});

  /// As layer::observe().
  void observe(communication::program_observer observer) { layer_.observe(std::move(observer)); }

  /// Carries out commands that programs have given at `now`; begin() sets the time they see.
  void begin(instant now) { layer_.use().set_time(now); }
  [[nodiscard]] node_outputs settle(instant now);

  /// Radio and, at a sink, serial line are up (D1.1 5.3.4). A mote that joins alone begins to, and
  /// does as soon as there is a route to the sink. Nothing comes before the new content of its
  /// store.
  [[nodiscard]] node_outputs start(instant now);

  /// Says goodbye and ends every outstanding send as failed.
  [[nodiscard]] node_outputs leave(instant now);

  /// As mote_devices::read(). @param now by the world's time
  [[nodiscard]] std::optional<std::int16_t> read(device::quantity kind, instant now) {
    return devices_.read(kind, now, rng_);
  }
  [[nodiscard]] mote_devices& devices() { return devices_; }
  [[nodiscard]] const mote_devices& devices() const { return devices_; }

  /// Its clock has leapt forward by so much, or back; its timers have not.
  void on_clock_leapt(duration by) { packets_.router().sync().on_clock_leapt(in_us(by)); }

  /// The radio, or a backbone, has delivered a frame for this mote.
  /// @param sfd as in network::router::on_frame()
  [[nodiscard]] node_outputs on_frame(mote_id source, std::uint8_t am_type, byte_view payload,
                                      instant sfd, instant now,
                                      network::medium over = network::medium::radio);

  /// How strongly the frame that was delivered last has come.
  [[nodiscard]] node_outputs on_signal(mote_id source, int rssi_dbm, instant now);

  /// The battery will be flat soon; the sink is notified (IF-13).
  [[nodiscard]] node_outputs on_battery_low(instant now);

  /// A network::frame_out has ended.
  [[nodiscard]] node_outputs on_sent(std::uint64_t token, bool acked, unsigned transmissions,
                                     instant now);

  [[nodiscard]] node_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] instant deadline() const;

  /// Grows whenever programs have received or done something: while it does not, none of them has
  /// anything new to report, nor another deadline.
  [[nodiscard]] std::uint32_t program_turns() const { return layer_.turns(); }

  [[nodiscard]] const island_member& member() const { return member_; }
  [[nodiscard]] const communication::layer& above() const { return layer_.view(); }
  [[nodiscard]] const packet_service& packets() const { return packets_; }
  [[nodiscard]] const node_counters& counters() const { return counters_; }

  /// Octets of protocol state on a mote with these tables (SMP-30).
  [[nodiscard]] std::size_t footprint() const;

private:
  void take(join_outputs from_join, node_outputs& out, instant now);
  void take(packet_service_outputs from_packets, node_outputs& out, instant now);
  void take(network::router_outputs from_router, node_outputs& out, instant now);
  void perform(communication::layer_output& x, node_outputs& out, instant now);
  void on_management(const management_in& x, node_outputs& out, instant now);
  void on_packet(const network::island_packet& x, instant now);
  void ask_to_join(bytes description, node_outputs& out, instant now);

  // The RUBICON clock, and the slot of its ticks.
  void tick(instant now);
  bool follow_ticks(instant now);
  void update_slot(instant now);
  void send_slot_notice(node_outputs& out, instant now);
  void send_slotted(node_outputs& out, instant now);

  // Packets of programs.
  void pace(communication::channel_packet x, node_outputs& out, instant now);
  [[nodiscard]] duration passage_of(const communication::channel_packet& x) const;
  [[nodiscard]] duration passage_of(const transport::to_network& x) const;
  void carry(communication::channel_packet x, bool in_slot, node_outputs& out, instant now);
  void carry(transport::to_network x, bool in_slot, node_outputs& out, instant now);
  template <class Packet>
  void carry_in_slot(Packet x, node_outputs& out, instant now);
  void send_paced(node_outputs& out, instant now);
  void send_on(stream::channel_handle channel, bytes octets, network::departure how,
               node_outputs& out, instant now);
  void route(transport::to_network& x, bool in_slot, node_outputs& out, instant now);
  void connect(const communication::channel_wanted& x, node_outputs& out, instant now);
  void set_latency_bound(network::channel_id channel);
  void update_slack(instant now);

  // Devices.
  void carry_out(const communication::sample_wanted& x, instant now);
  void carry_out(const communication::transducers_wanted& x, instant now);
  void carry_out(const communication::actuator_wanted& x, node_outputs& out, instant now);
  [[nodiscard]] std::uint32_t time_ms(instant now) const;

  void settle(node_outputs& out, instant now);

  std::shared_ptr<const node_config> config_;
  crystal crystal_;
  nonvolatile store_; ///< as it was before this life
  random_stream rng_;
  cached_layer layer_; ///< made before packets_: the order of random numbers
  packet_service packets_;
  island_member member_;
  bool is_silenced_ = false; ///< its radio is off whatever its duty cycle says,
  bool radio_wanted_ = true; ///< which is this
  slot_client slot_;
  synaptic::rubicon_clock clock_;
  duty_cycle duty_;
  channel_pacer pacer_;
  duration slack_{}; ///< as the layer has it
  small_map<network::channel_id, communication::channel_request> connecting_;
  mote_devices devices_;
  node_counters counters_;
};

} // namespace rubicon::mote
