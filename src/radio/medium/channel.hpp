// The radio medium of one place: everything between "send" and a frame in another mote's hands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "radio/energy.hpp"
#include "radio/event_queue.hpp"
#include "radio/frame.hpp"
#include "radio/listener.hpp"
#include "radio/mac.hpp"
#include "radio/mac_rules.hpp"
#include "radio/medium/medium.hpp"
#include "radio/medium/receiver.hpp"
#include "radio/medium/topology.hpp"
#include "radio/parameters.hpp"
#include "radio/radio_counters.hpp"

namespace rubicon::radio {

/// A radio that joins the channel. It is on from the start.
struct radio_config {
  mote_id address;                 ///< unique in its PAN
  std::uint16_t pan = default_pan; ///< one per island; frames of other PANs only disturb
  position place;
  const platform* kind = nullptr; ///< never nullptr; one of platforms(), or outlives the channel
  std::optional<double> transmit_dbm; ///< unset: the platform's full power
  std::optional<double> battery_mah;  ///< > 0; unset: the platform's; infinity: fed by a cable
  bool promiscuous = false;     ///< delivers all data frames received, of any PAN and for any mote
  access_parameters access{};   ///< macMinBE is not above macMaxBE
  listening_config listening{}; ///< the same for all radios of a PAN, but for its `checks`
  /// Radios of other channels neither receive it nor are disturbed; all_channels: of a source of
  /// noise.
  std::uint8_t channel = default_channel;
};

/// A request to send one frame.
struct request {
  std::uint64_t token = 0; ///< comes back in `done`; the channel attaches no meaning
  mote_id destination = broadcast_mote;
  std::uint8_t am_type = 0;
  rubicon::payload payload; ///< at most payload_max octets
  bool ack = true;          ///< unicast only: wait for an ack and repeat without one
  /// Where in the payload a uint32 in network byte order lies, to which each transmission adds the
  /// microseconds from this request to its start-of-frame delimiter (CLK-01; chips with a frame
  /// buffer can do it while they send). @pre four octets of payload follow
  std::optional<std::size_t> age_at = {};
  /// No radio near is to send now, but one is right afterwards: the channel is assessed without
  /// a back-off, and neither a busy channel nor a missing ack leads to another attempt. Where
  /// radios listen at low power it means nothing.
  bool in_slot = false;
  /// `payload` is a whole frame of whatever layout, without its FCS (radio/raw_frame.hpp), and
  /// nothing of the above but the token means anything. @pre it is no ack, and has 3 octets or more
  bool is_raw = false;
};

/// What became of a mote's power.
enum class power : std::uint8_t {
  on,
  off,  ///< crashed or being restarted: the radio is off, the MCU draws its sleep current
  flat, ///< the battery is at its end: nothing is drawn any more. Final: there is no route back to
        ///< on
};

[[nodiscard]] std::string to_string(power x);

/// A frame for the mote of radio `to`.
struct delivered {
  radio_index to;
  payload psdu;             ///< one object for all receivers
  frame content;            ///< views `psdu`, valid as long as any copy of it
  std::int8_t rssi_dbm = 0; ///< whole dBm, as the chips report it
  std::uint8_t lqi = 0;     ///< 50..110 (docs/tinyos.md 4.1)
  provenance from = {};     ///< of the request
};

/// A request has come to its end; each gets exactly one.
struct done {
  radio_index radio;
  std::uint64_t token = 0;
  send_status status = send_status::sent;
  unsigned transmissions = 0; ///< times the frame was put on the air; a train of copies is one
  bool arrived = false;       ///< its destination accepted it, whether or not the sender knows
  copy_outcome last =
      copy_outcome::out_of_reach; ///< of the last copy at its destination; unicast only
  provenance from = {};           ///< of the request
};

/// The battery of a mote is flat. The radio has already been switched to power::flat.
struct exhausted {
  radio_index radio;
};

/// Share of a battery's charge that is left when its mote is warned.
inline constexpr double battery_reserve = 0.05;

/// No more than battery_reserve is left in a mote's battery.
struct running_low {
  radio_index radio;
};

/// A frame has ended; only while the channel is watched.
struct overheard {
  std::uint16_t pan = 0; ///< of its sender
  instant begin;         ///< of its preamble
  payload psdu;          ///< acks included
  bool received = false; ///< by anybody it was meant for
  copy_outcome outcome =
      copy_outcome::out_of_reach; ///< of the copy at its destination; unicast data only
  provenance from = {};           ///< of the request
};

using output = std::variant<delivered, done, exhausted, running_low, overheard>;
using outputs = std::vector<output>;

/// What a mote has used so far.
struct energy_use {
  energy_times times;
  energy_charges charges;
  bool radio_on = false; ///< at this moment
  duration elapsed{};    ///< since it was added, until now or until its battery was flat
  double used_mah = 0;   ///< never above battery_mah by more than 10 ms of current
  double battery_mah = 0;
  instant empty_at; ///< if it goes on doing what it does at this moment
};

/// Radios of one or several islands that share a place: PHY and MAC of all of them, on whatever
/// channels, as one sans-I/O core with an event queue of its own (docs/architecture.md, Actors;
/// NET-15, GEN-03).
///
/// Sending, per radio: a bounded queue, and the medium access that channel_config::macs names for
/// its platform (radio/mac_rules.hpp).
///
/// At low power (listening_config): a radio that is on for its mote is switched on and off by its
/// radio/listener.hpp; copies at one that sleeps end as off. Frames are repeated in trains, and a
/// receiver knows the copies of broadcasts, too, by source and DSN.
///
/// Receiving: the medium decides what arrives unharmed, whichever PAN it is of
/// (radio/medium/medium.hpp). What does is lost with the link's own chance, dropped by the address
/// filter, or takes a receive slot until the MCU has served it; without a free slot it is dropped
/// and not acked. Acks are sent by the transceiver and occupy the air like any frame. They carry no
/// address: a radio takes the ack with the DSN it waits for from anybody.
///
/// Time: `now` of any call must not be before that of an earlier call. Every call that takes inputs
/// first does what was due until then, so its outputs may concern any radio. In virtual time call
/// on_time() at deadline() exactly; when it comes late (wall clock), events still happen at their
/// own times in order.
class channel {
public:
  channel() = default;

  /// @param config its macs name platforms and rules that exist
  /// @param rng decides back-offs, losses and first sequence numbers; what belongs to links and
  /// to the noise of a radio is seeded from it
  channel(const channel_config& config, random_stream rng);

  /// Makes room for so many radios; releases memory reserved for more than have been added.
  void reserve(std::size_t radios);
  void shrink() { topology_.shrink(); }

  /// Frames already on the air do not reach the new radio.
  /// @pre nothing was due before `now`: call on_time(now) first when radios are at work
  radio_index add(const radio_config& config, instant now);

  /// The MCU of a radio's mote computes for so long.
  void compute(radio_index radio, duration length, instant now);

  /// Costs what topology::move() costs. Frames already on the air end where they started.
  /// @pre on_time() has been called for this moment
  void move(radio_index radio, position place);

  /// The chance that a copy from one radio to another is lost, instead of
  /// channel_config::loss. Directed; 0..1 (GEN-03, NET-15). Survives move().
  void set_loss(radio_index from, radio_index to, double loss);

  /// A link is another from now on: topology::change(). Frames already on the air end as they
  /// began.
  /// @pre on_time() has been called for this moment
  void change(const link_override& x);

  /// Lets a radio send what is no frame, or stop: it disturbs all in reach, who sense its energy
  /// but no carrier. It is not counted. @pre the radio is off and does the other now
  [[nodiscard]] outputs set_noise(radio_index from, bool on, instant now);

  /// From now on copies for radios of a PAN, or of all, are lost by this chance besides; several
  /// add up as chances do. @returns its name for end_loss()
  std::uint32_t begin_loss(std::optional<std::uint16_t> pan, double loss);
  void end_loss(std::uint32_t name);

  /// The mote of a radio comes with a battery of which so much is used; its energy is counted from
  /// now on. @pre it is off, and on_time() has been called for this moment
  void restart_energy(radio_index radio, double used_mah, instant now);

  /// Queues a frame. A full queue (queue_full) or a radio that is off (aborted) refuses at once.
  /// @pre what.payload.size() <= payload_max
  [[nodiscard]] outputs send(radio_index radio, request what, instant now);

  /// Switches a mote. Off and flat abort all its open requests, cut off the frame it is sending and
  /// empty its receive slots; switching to the present state does nothing.
  [[nodiscard]] outputs set_power(radio_index radio, power state, instant now);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()

  /// When on_time() is due: there is no output before. What happens on the air until
  /// then happens at its own time when on_time() comes. Nothing while no radio sends and no battery
  /// can end.
  [[nodiscard]] std::optional<instant> deadline();

  /// From now on frames come out as `overheard` too; that changes nothing else.
  void watch() { watched_ = true; }

  [[nodiscard]] radio_counters counted_by(radio_index radio) const;   ///< costs O(links)
  [[nodiscard]] std::vector<radio_counters> counted_by_radio() const; ///< costs O(links)
  [[nodiscard]] radio_counters counted_in_pan(std::uint16_t pan) const;
  [[nodiscard]] radio_counters counted() const; ///< by all radios

  /// The copies on one link while `from` has had it last: they begin anew when `from` gets another
  /// list of hearers, because a radio near it is added or moves or set_loss() concerns it.
  [[nodiscard]] copy_counters counted_on(radio_index from, radio_index to) const;

  /// Whether the counters of every radio and the copies of every link balance, and no copy is
  /// missing from the sum of them. Always true; costs O(links).
  [[nodiscard]] bool balanced() const;

  /// @pre now is not before any earlier call's, and on_time(now) has been called
  [[nodiscard]] energy_use energy(radio_index radio, instant now) const;

  /// No battery is flat before this, whatever the radios and MCUs do; instant::max() if none ends.
  /// Costs O(radios).
  [[nodiscard]] instant batteries_last_until() const;

  [[nodiscard]] power power_of(radio_index radio) const;
  [[nodiscard]] std::size_t radios() const;
  /// Radios within range, in ascending order.
  [[nodiscard]] std::vector<radio_index> neighbours(radio_index radio) const;
  [[nodiscard]] std::uint64_t events() const { return events_; } ///< handled so far

private:
  /// One mote's radio above the medium.
  /// A radio that listens at low power.
  struct listening {
    listening_config config;
    std::optional<listener> ears;  ///< nothing: its mote is off
    std::uint64_t event_stamp = 0; ///< of the event in the queue
  };

  struct station {
    mote_id address;
    std::uint16_t pan = default_pan;
    duration service_time{};
    power supply = power::on;
    std::uint8_t next_dsn = 0;
    mac sender;
    receiver inbox;
    radio_counters
        counted; ///< copies: of links that are no more; requests.open: filled in when asked
    link_counters copies; ///< that it has sent
    instant added_at;
    bool runs_low = false;                ///< its owner knows
    instant lasts_until = instant::max(); ///< at least, as found at the last look at its battery
    instant flat_at = instant::max();
    instant guarded_until;            ///< mac_rules::guard
    std::optional<instant> scheduled; ///< the deadline of `sender` that stands in the event queue
    std::uint64_t mac_stamp = 0;
    std::optional<std::uint8_t> ack_dsn; ///< of the ack it is about to send
    std::uint64_t ack_stamp = 0;
    std::unique_ptr<listening> listens; ///< nullptr: its radio is on as long as its mote is
  };

  [[nodiscard]] static outgoing pack(station& x, const request& what);
  void run_until(instant now, outputs& out);
  [[nodiscard]] const mac_rules* rules_of(const radio_config& config);
  [[nodiscard]] unsigned retries_of(const radio_config& config, const mac_rules& rules) const;
  [[nodiscard]] duration memory_of(const radio_config& config, const mac_rules& rules);
  [[nodiscard]] bool is_current(const event& x) const;
  void handle(const event& x, outputs& out);
  void on_mac_timer(radio_index radio, instant now, outputs& out);
  void on_ack_due(radio_index radio, instant now);
  void on_frame_end(slot_index slot, instant now, outputs& out);
  void on_battery_low(radio_index radio, instant now, outputs& out);
  [[nodiscard]] bool is_disturbed(radio_index radio);
  [[nodiscard]] bool filters_most(slot_index slot) const;
  [[nodiscard]] copy_outcome on_ack(radio_index radio, std::uint8_t dsn, instant now, outputs& out);
  [[nodiscard]] copy_outcome on_data(const transmission& sent, const hearer& x, instant now,
                                     outputs& out);
  void book_frame(slot_index slot);
  void retire(const link_counters& x);
  [[nodiscard]] overheard describe(const transmission& x) const;
  void put_on_air(transmission x, instant now);
  void send_current(radio_index radio, instant now);
  void schedule(const event& x);
  void schedule_mac(radio_index radio, instant due);
  void follow(radio_index radio, const mac_action& todo, instant now, outputs& out);
  void end_frame(slot_index slot, instant now, outputs& out);
  void conclude(radio_index radio, const finished& x, outputs& out);
  void silence(radio_index radio, instant now, outputs& out);
  void begin_listening(radio_index radio, instant now);
  void end_listening(radio_index radio);
  void stay_awake(radio_index radio, instant now);
  void on_listening(radio_index radio, instant now);
  void schedule_listening(radio_index radio);
  void run_down(radio_index radio, instant now);
  void watch_battery(radio_index radio, instant now);

  [[nodiscard]] station& at(radio_index radio) { return stations_[radio.value]; }
  [[nodiscard]] const station& at(radio_index radio) const { return stations_[radio.value]; }

  channel_config config_;
  random_stream rng_;
  topology topology_;
  medium medium_;
  std::uint64_t noise_seed_ = 0;
  bool guards_ = false; ///< somebody's rules have a guard
  bool sleeps_ = false; ///< somebody listens at low power
  /// Of radios with parameters of their own; they stay where they are.
  std::vector<std::unique_ptr<const mac_rules>> own_rules_;
  duration longest_own_{}; ///< for which such a radio may repeat a frame
  struct disturbance {
    std::uint32_t name = 0;
    std::optional<std::uint16_t> pan;
    double loss = 0;
  };
  std::vector<disturbance> disturbances_;
  std::uint32_t disturbances_so_far_ = 0;
  std::vector<station> stations_;
  event_queue queue_;
  /// An assessment that must find the channel clear, unless an event is put before it; with the
  /// moment from which it may have an output if it does not.
  std::optional<event> sure_;
  instant ran_until_ = instant::min();
  std::uint64_t events_ = 0;
  bool watched_ = false;
};

} // namespace rubicon::radio
