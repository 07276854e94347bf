// The radio medium of one place: everything between "send" and a frame in another mote's hands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "radio/channel/channel_counts.hpp"
#include "radio/channel/disturbances.hpp"
#include "radio/channel/output.hpp"
#include "radio/channel/request.hpp"
#include "radio/channel/station.hpp"
#include "radio/event_queue.hpp"
#include "radio/medium/medium.hpp"
#include "radio/medium/topology.hpp"
#include "radio/parameters.hpp"

namespace rubicon::radio {

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
  std::uint32_t begin_loss(std::optional<std::uint16_t> pan, double loss) {
    return disturbances_.begin(pan, loss);
  }
  void end_loss(std::uint32_t name) { disturbances_.end(name); }

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

  [[nodiscard]] channel_counts counts() const { return {stations_, medium_.copies()}; }

  /// Which radios hear which.
  [[nodiscard]] const topology& links() const { return topology_; }

  /// @pre now is not before any earlier call's, and on_time(now) has been called
  [[nodiscard]] energy_use energy(radio_index radio, instant now) const;

  /// No battery is flat before this, whatever the radios and MCUs do; instant::max() if none ends.
  /// Costs O(radios).
  [[nodiscard]] instant batteries_last_until() const;

  [[nodiscard]] power power_of(radio_index radio) const { return at(radio).supply; }
  [[nodiscard]] std::uint64_t events() const { return events_; } ///< handled so far

private:
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
  [[nodiscard]] bool filters_most(slot_index slot) const;
  [[nodiscard]] copy_outcome on_ack(radio_index radio, std::uint8_t dsn, instant now, outputs& out);
  [[nodiscard]] copy_outcome on_data(const transmission& sent, const hearer& x, instant now,
                                     outputs& out);
  void book_frame(slot_index slot);
  void retire(const link_counters& x);
  [[nodiscard]] overheard describe(const transmission& x) const;
  void put_on_air(transmission x, instant now);
  void send_current(radio_index radio, instant now);
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
  disturbances disturbances_;
  std::vector<station> stations_;
  event_queue queue_;
  instant ran_until_ = instant::min();
  std::uint64_t events_ = 0;
  bool watched_ = false;
};

} // namespace rubicon::radio
