// What is on the air and what each transceiver makes of it.
#pragma once

#include <cassert>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "radio/energy.hpp"
#include "radio/frame.hpp"
#include "radio/mac_rules.hpp"
#include "radio/medium/filtered_frames.hpp"
#include "radio/medium/noise.hpp"
#include "radio/medium/power.hpp"
#include "radio/medium/reception.hpp"
#include "radio/medium/topology.hpp"
#include "radio/parameters.hpp"

namespace rubicon::radio {

/// What the air has done to one copy of a frame.
enum class outcome : std::uint8_t { intact, weak, collision, captured, half_duplex, off };

/// A frame on the air.
struct transmission {
  radio_index from;
  frame content; ///< views `psdu`
  payload psdu;  ///< empty for acks: only their DSN is ever asked for
  instant begin{};
  duration length{}; ///< preamble, SFD and length octet included
  provenance origin = {};
};

/// A place in the medium's table of frames on the air.
using slot_index = std::uint32_t;

/// What a transceiver receives, and from whom.
struct transceiver_config {
  mote_id address;
  std::uint16_t pan = default_pan;
  bool promiscuous = false;
  double sensitivity_dbm = 0;                 ///< below it nothing is received; not for a unit_disk
  double cca_dbm = 0;                         ///< energy threshold; not for a unit_disk
  power_units noise = 0;                      ///< constant
  power_units own_noise = 0;                  ///< as in topology's site
  std::unique_ptr<noise_source> traced_noise; ///< instead; nullptr: constant
};

/// Transceivers without intelligence. One that has sent is ready to receive timing::turnaround
/// later (IEEE 802.15.4-2006 6.9.2, TX-to-RX). One that listens locks on a frame that arrives with
/// its sensitivity or more and an SINR of -5 dB or more (below, a tenth of the bits are wrong: IEEE
/// 802.15.4-2006 figure E.2), and stays with it to its end. A later frame is interference to it,
/// and captured by it; with channel_config::capture it takes the receiver over if it is 3 dB above
/// everything else (docs/tinyos.md 6: from there on a later frame begins to destroy an earlier
/// one). Interference begins and ends whenever it does: damage is summed up over all parts of a
/// frame (radio/medium/reception.hpp). Under collision_rule::strict any overlap, of frames in reach
/// at all, spoils both; a radio that listens senses a carrier until the last of them has ended.
///
/// Costs O(hearers) for each start and end of a frame; for the end alone if nothing else was on the
/// air and no hearer was switched in between: such a frame is lone, and its hearers are visited
/// once.
class medium {
public:
  medium() = default;
  explicit medium(const channel_config& config);

  void reserve(std::size_t radios) {
    filters_.reserve(radios);
    heads_.reserve(radios);
    tails_.reserve(radios);
  }

  /// A transceiver, listening; its states are the meter's.
  void add(transceiver_config config, const energy_meter& meter, instant now);

  /// @pre the radio is on and not sending
  slot_index start(transmission x, std::shared_ptr<const hearers> heard_by);

  /// What has been sent so far is of no use: its sender was switched off.
  void cut(slot_index slot);

  /// Whether nothing has happened to the hearers of a frame since it began, alone on the air.
  [[nodiscard]] bool is_lone(slot_index slot) const { return lone_ == slot; }

  /// The last octet has left. Calls `on_copy(const transmission&, std::size_t place, const hearer&,
  /// outcome)` for each radio in reach, in ascending order; it must not start a frame.
  /// @param selective not for copies of which nothing is to be decided: they are intact, the link
  /// loses none, and the radio does not want them. Such copies cost next to nothing. @pre
  /// is_lone(), and the frame is an ack or for one mote
  template <class OnCopy>
  void end(slot_index slot, instant now, random_stream& rng, OnCopy on_copy,
           bool selective = false) {
    auto& sent = on_air_[slot];
    assert(sent.heard_by != nullptr);
    assert(!selective || is_lone(slot));
    stop_sending(sent.what.from, now);
    const bool was_lone = lone_ == slot;
    if (was_lone)
      lone_ = nothing;
    if (selective)
      count_filtered(sent, now);
    const auto count = static_cast<std::uint32_t>(sent.heard_by->size());
    for (std::uint32_t place = 0; place < count; ++place) {
      const auto& x = (*sent.heard_by)[place];
      if (selective && is_filtered(x, sent.what.content))
        continue;
      if (selective)
        except(x.radio, sent.what, now);
      const auto result = was_lone ? end_lone_copy(x, sent.what, now, rng)
                                   : leave(x, slot, sent.outcomes[place], now, rng);
      on_copy(sent.what, place, x, result);
    }
    release(slot);
  }

  /// A signal that is no frame begins at all of them, or ends: it cannot be received, but it
  /// disturbs and, as far as its energy is sensed, makes the channel busy. @pre one ends before its
  /// source begins another
  void start_noise(radio_index from, std::shared_ptr<const hearers> heard_by, instant now);
  void end_noise(radio_index from, instant now);

  void switch_on(radio_index radio, instant now);

  /// @pre the radio is not sending: its frame was cut and ended before
  void switch_off(radio_index radio, instant now);

  /// Outcome of a clear-channel assessment over timing::cca until now: not clear if the receiver
  /// was deaf in it. Traced noise counts with its reading of this moment; earlier in the window
  /// signals alone do.
  [[nodiscard]] bool clear(radio_index radio, instant now);

  /// Whether the channel has been busy at any moment since then, while the radio listened all the
  /// time. Traced noise counts with its reading of this moment. @pre no frame since then has come
  /// to a selective end(), but for the last one
  [[nodiscard]] bool was_busy(radio_index radio, instant since, instant now);

  /// Whether it is receiving a frame.
  [[nodiscard]] bool receives(radio_index radio) const {
    const auto* const copy = lone_copy(radio);
    return copy != nullptr ? locks_on_lone(*copy) : heads_[radio.value].locked != nothing;
  }

  /// Whether clear() will be true at `later` if nothing goes on the air until then.
  [[nodiscard]] bool stays_clear(radio_index radio, instant later) const;

  /// Whether an unharmed data frame is for the radio's mote (RTG-06).
  [[nodiscard]] bool wanted(radio_index radio, const frame& x) const {
    const auto& t = filters_[radio.value];
    return (t.flags & promiscuous) != 0 ||
           (t.pan == x.pan && (t.address == x.destination || x.destination == broadcast_mote));
  }

  /// Whether it was sent to the radio's mote alone.
  [[nodiscard]] bool addressed(radio_index radio, const frame& x) const {
    const auto& t = filters_[radio.value];
    return t.pan == x.pan && t.address == x.destination;
  }

  /// A radio that waits for an ack is given acks; for others they are filtered.
  void await_ack(radio_index radio, bool waits) {
    auto& flags = filters_[radio.value].flags;
    flags = static_cast<std::uint8_t>(waits ? flags | waiting : flags & ~waiting);
  }
  [[nodiscard]] bool awaits_ack(radio_index radio) const {
    return (filters_[radio.value].flags & waiting) != 0;
  }

  [[nodiscard]] std::optional<slot_index> sending(radio_index radio) const {
    if (filters_[radio.value].state != mode::sending)
      return std::nullopt;
    return tails_[radio.value].sending;
  }

  /// Changes with every new use of a slot and at the end of each.
  [[nodiscard]] std::uint64_t stamp(slot_index slot) const { return on_air_[slot].stamp; }

  [[nodiscard]] const transmission& content(slot_index slot) const { return on_air_[slot].what; }
  [[nodiscard]] const std::shared_ptr<const hearers>& heard_by(slot_index slot) const {
    return on_air_[slot].heard_by;
  }

  /// Radios in reach summed over all frames that have ended.
  [[nodiscard]] std::uint64_t copies() const { return copies_; }

  [[nodiscard]] energy_meter& meter(radio_index radio) { return tails_[radio.value].meter; }
  [[nodiscard]] const energy_meter& meter(radio_index radio) const {
    return tails_[radio.value].meter;
  }

  /// With the time in reception as a time of its own.
  [[nodiscard]] energy_times times(radio_index radio, instant now) const;

private:
  enum class mode : std::uint8_t { off, listening, sending };
  static constexpr std::uint8_t promiscuous = 1;
  static constexpr std::uint8_t waiting = 2;    ///< for an ack
  static constexpr std::uint8_t interfered = 4; ///< the locked frame was not alone all the time
  static constexpr std::uint8_t turning = 8;    ///< it has sent, and may not be back at receiving
  static constexpr slot_index nothing = std::numeric_limits<slot_index>::max();

  /// Whether a copy is for a radio, and whether the radio is simply listening: all that is asked of
  /// most of them.
  struct filter {
    mote_id address;
    std::uint16_t pan = 0;
    mode state = mode::listening;
    std::uint8_t flags = 0;
  };

  /// What each other copy touches: one cache line.
  struct alignas(64) head {
    power_units power = 0; ///< of all frames of others on the air here
    instant busy_until =
        instant::min(); ///< when the channel last was busy, by the rule for sensing
    instant locked_since;
    duration received{};  ///< time spent locked
    float lock_floor = 0; ///< least power of a frame that it can lock on when alone
    float cca_floor = 0;  ///< least sum of powers that reaches the energy threshold
    slot_index locked = nothing;
    std::uint32_t place = 0;   ///< in the locked frame's list of hearers
    std::uint32_t audible = 0; ///< frames of others on the air here
    /// The end of the last frame of `filtered_` that was not filtered here, or not for sure.
    instant excepted = instant::min();
  };

  /// What only some touch.
  struct tail {
    energy_meter meter;
    std::unique_ptr<noise_source> traced_noise;
    power_units noise = 0;
    power_units own_noise = 0;
    float sensitivity = 0; ///< as a power
    slot_index sending = nothing;
    std::uint32_t filtered = 0; ///< the place of its frames in `filtered_`
    instant sent_until = instant::min();
    instant counted_to;      ///< until when damage to the locked frame has been counted
    double damage = 0;       ///< to it so far, by noise and interference
    double noise_damage = 0; ///< what noise alone would have done
  };

  struct on_air {
    transmission what;
    std::shared_ptr<const hearers> heard_by; ///< nullptr: the slot is free
    std::vector<outcome> outcomes;           ///< one for each hearer, of locked ones provisional
    std::uint64_t stamp = 0;
  };

  [[nodiscard]] slot_index free_slot();
  [[nodiscard]] instant busy_until(radio_index radio) const;
  void count_filtered(const on_air& sent, instant now);
  void except(radio_index radio, const transmission& sent, instant now) {
    heads_[radio.value].received -= now - sent.begin;
    heads_[radio.value].excepted = now;
  }
  /// Whether a copy of a lone frame is received unharmed, for sure, by a radio that does not want
  /// it.
  [[nodiscard]] bool is_filtered(const hearer& x, const frame& content) const {
    const auto& at = filters_[x.radio.value];
    const bool only_listens =
        at.state == mode::listening && (at.flags & (promiscuous | waiting | turning)) == 0;
    const bool is_sure = x.clean_damage == 0 && x.loss == 0 && x.power >= highest_lock_floor_;
    return only_listens && is_sure && (at.address != content.destination || at.pan != content.pan);
  }
  [[nodiscard]] const hearer* lone_copy(radio_index radio) const;
  [[nodiscard]] bool locks_on_lone(const hearer& x) const;
  void visit_hearers();
  void visit_hearers_for(radio_index radio) {
    if (lone_copy(radio) != nullptr)
      visit_hearers();
  }
  [[nodiscard]] bool senses(radio_index radio, instant now);
  [[nodiscard]] outcome meet(const hearer& x, slot_index slot, std::uint32_t place, instant now);
  [[nodiscard]] outcome meet_others(const hearer& x, slot_index slot, std::uint32_t place,
                                    instant now);
  /// When the receiver is ready again after what was sent last: until then it receives nothing.
  [[nodiscard]] instant turned_back(radio_index radio) const {
    return tails_[radio.value].sent_until + timing::turnaround;
  }
  [[nodiscard]] bool turns_back(radio_index radio, instant now);
  [[nodiscard]] outcome overlap(const hearer& x, slot_index slot, std::uint32_t place, instant now);
  [[nodiscard]] instant end_of(slot_index slot) const;
  static void lock(head& at, slot_index slot, std::uint32_t place, instant now) {
    at.locked = slot;
    at.place = place;
    at.locked_since = now;
  }
  static void unlock(head& at, instant now) {
    at.received += now - at.locked_since;
    at.locked = nothing;
  }
  static power_units units_of(const hearer& x) {
    return static_cast<power_units>(
        static_cast<std::int64_t>(x.power)); // signed is one instruction
  }
  void spoil_locked(radio_index radio, outcome cause);
  void count_damage(radio_index radio, instant now);
  [[nodiscard]] outcome leave(const hearer& x, slot_index slot, outcome so_far, instant now,
                              random_stream& rng);
  [[nodiscard]] outcome end_lone_copy(const hearer& x, const transmission& sent, instant now,
                                      random_stream& rng);
  [[nodiscard]] outcome survive(radio_index radio, instant now, random_stream& rng);
  [[nodiscard]] outcome survive_alone(const hearer& x, const transmission& sent, instant now,
                                      random_stream& rng) const;
  [[nodiscard]] power_units reading_at(radio_index radio, instant now);
  [[nodiscard]] power_units noise_at(radio_index radio, instant now);
  void stop_sending(radio_index radio, instant now);
  void release(slot_index slot);

  error_model errors_;
  bool disk_ = true;
  bool strict_ = true;
  bool capture_ = false;
  bool sense_energy_ = true;
  bool sense_carrier_ = true;
  bool whole_window_ = true;
  double lock_ratio_ = 0;    ///< least SINR of a frame to lock on
  double capture_ratio_ = 0; ///< least SINR of a later frame that takes over
  float highest_lock_floor_ = 0;
  std::vector<filter> filters_;
  std::vector<head> heads_;
  std::vector<tail> tails_;
  std::vector<on_air> on_air_;
  std::vector<slot_index> free_;
  /// The only frame on the air, as long as none of its hearers has been visited: what they would
  /// have noted at its beginning is found at its end, or when something else is to happen to them.
  slot_index lone_ = nothing;
  filtered_frames filtered_;      ///< their time is missing from `received` of their receivers
  bool has_traced_noise_ = false; ///< somewhere: it is read when a frame begins
  std::vector<std::pair<radio_index, std::shared_ptr<const hearers>>> noises_; ///< that go on
  std::uint64_t copies_ = 0;
};

inline outcome medium::leave(const hearer& x, slot_index slot, outcome so_far, instant now,
                             random_stream& rng) {
  auto& at = heads_[x.radio.value];
  const bool was_locked = at.locked == slot;
  if (was_locked) {
    if (so_far == outcome::intact &&
        (x.clean_damage > 0 || (filters_[x.radio.value].flags & interfered) != 0))
      so_far = survive(x.radio, now, rng);
    unlock(at, now);
  } else if (at.locked != nothing) {
    count_damage(x.radio, now);
  }
  if ((sense_energy_ && static_cast<float>(at.power) >= at.cca_floor) ||
      (sense_carrier_ && was_locked))
    at.busy_until = now;
  at.power -= units_of(x);
  --at.audible;
  return so_far;
}

/// The end of a lone copy: what meet() and leave() make of one that nothing has disturbed.
inline outcome medium::end_lone_copy(const hearer& x, const transmission& sent, instant now,
                                     random_stream& rng) {
  auto& at = heads_[x.radio.value];
  const auto& who = filters_[x.radio.value];
  auto result = outcome::intact;
  bool was_locked = false;
  if ((who.flags & turning) != 0 && turns_back(x.radio, sent.begin)) {
    result = outcome::half_duplex;
  } else if (who.state != mode::listening) {
    result = who.state == mode::off ? outcome::off : outcome::half_duplex;
  } else if (x.power < at.lock_floor) {
    result = outcome::weak;
  } else {
    was_locked = true;
    at.received += now - sent.begin;
    if (x.clean_damage > 0)
      result = survive_alone(x, sent, now, rng);
  }
  if ((sense_energy_ && x.power >= at.cca_floor) || (sense_carrier_ && was_locked))
    at.busy_until = now;
  return result;
}

} // namespace rubicon::radio
