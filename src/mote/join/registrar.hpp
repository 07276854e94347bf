// The sink's side of joining: who is in the island (DIS-03, DIS-06, DIS-08).
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "mote/join/management.hpp"
#include "mote/join/slot_table.hpp"
#include "network/sink_event.hpp"

namespace rubicon::mote {

/// Send this component management message to a mote.
struct to_mote {
  mote_id mote;
  management message;
};

/// A second mote with the id of a member wants to join, and is refused (ADR-04). Once for each.
struct double_refused {
  mote_id mote;
  std::uint32_t device = 0; ///< of the second one
};

using registrar_output = std::variant<to_mote, network::sink_event, double_refused>;
using registrar_outputs = std::vector<registrar_output>;

struct registrar_config {
  island_id island;
  std::vector<island_id> aliases = {}; ///< at most aliases_max; motes receive them at their join
  duration keep_alive_window = 10s;    ///< a mote silent for longer has left
  duration confirm_wait = 500ms;       ///< for each hop of the route: the reply is repeated until
  unsigned replies_max = 5;            ///< confirmed, this often; then the mote is none we know
  /// Further requests get no answer and are counted, unless somebody has been silent for longer
  /// than keep_alive_window, who is then taken for gone.
  std::size_t members_max = 1000;
  duration prompt_pause = 1s; ///< between two rejoin prompts to one mote
  duration roster_period = 10s;
  duration slots_hold = 200s;       ///< a slot is its mote's so long after a slot_notice
  duration roster_page_gap = 250ms; ///< between two pages: a serial queue is short
};

struct registrar_counters {
  std::uint64_t malformed = 0;
  std::uint64_t refused = 0;  ///< no room
  std::uint64_t doubles = 0;  ///< of another device than the member with that id
  std::uint64_t outdated = 0; ///< requests of an earlier life of a member
};
RUBICON_FIELDS(registrar_counters, malformed, refused, doubles, outdated);

/// A mote that is silent for so many of its keep-alive periods has left.
inline constexpr int keep_alives_max = 3;

/// A member's device is distinguished from others by its serial number, where motes send theirs:
/// who has its id and another number is a second mote, and is refused as long as the member sends;
/// who has its number is itself, in a later life if that is higher.
///
/// Keeps the list of members, notifies the gateway of each change, and repeats the whole list now
/// and then, because the serial line may lose an event.
class registrar {
public:
  registrar() = default;
  explicit registrar(registrar_config config) : config_(config), slots_(config.slots_hold) {}

  [[nodiscard]] registrar_outputs start(instant now);

  /// A component management frame from `source`.
  /// @param hops of the route to it, as far as that is known; 0: unknown
  [[nodiscard]] registrar_outputs on_frame(mote_id source, byte_view payload, instant now,
                                           std::size_t hops = 1);

  /// Any other frame from `source`: it lives; an unknown mote is asked to join.
  [[nodiscard]] registrar_outputs on_received(mote_id source, instant now);

  /// The gateway requests the description of this mote again.
  [[nodiscard]] registrar_outputs on_describe(mote_id mote, instant now);

  [[nodiscard]] registrar_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] std::size_t members() const; ///< confirmed ones

  /// Of members who send synaptic vectors.
  [[nodiscard]] const slot_table& slots() const { return slots_; }
  void set_slot_room(std::size_t units) { slots_.set_room(units); }
  [[nodiscard]] const registrar_counters& counters() const { return counters_; }

private:
  struct member {
    bool confirmed = false; ///< of its latest incarnation
    bool announced =
        false; ///< the gateway holds it for a member, perhaps of an earlier incarnation
    std::uint16_t sequence = 0;
    std::uint32_t incarnation = 0;
    std::uint32_t type = 0;
    std::uint32_t device = 0; ///< 0: unknown
    bytes descriptor;
    duration window{};
    mote_condition condition; ///< as last reported
    instant last_received;
    unsigned replies = 0;
    instant reply_due;
    duration confirm_wait{};
  };

  [[nodiscard]] registrar_outputs on_request(mote_id source, const join_request& x, instant now,
                                             std::size_t hops);
  [[nodiscard]] registrar_outputs on_double(mote_id source, std::uint32_t device);
  [[nodiscard]] registrar_outputs on_confirm(mote_id source, const join_confirm& x, instant now);
  [[nodiscard]] bool make_room(registrar_outputs& out, instant now);
  [[nodiscard]] registrar_outputs prompt(mote_id mote, instant now);
  [[nodiscard]] registrar_outputs expire(instant now);
  [[nodiscard]] static network::leave_cause cause_of_silence(const member& x);
  [[nodiscard]] static network::mote_joined event_of(mote_id mote, const member& x);
  [[nodiscard]] registrar_outputs announce(mote_id mote, member& entry);
  [[nodiscard]] std::deque<network::roster> compile_roster();
  [[nodiscard]] network::sink_event next_roster_page(instant now);
  [[nodiscard]] to_mote reply_to(mote_id mote, const member& x, instant now) const;
  [[nodiscard]] registrar_outputs on_slot_notice(mote_id source, const slot_notice& x, instant now);
  void wake_at(instant t);

  registrar_config config_;
  std::map<mote_id, member> members_;
  std::map<mote_id, std::uint32_t> doubles_reported_; ///< devices, of which the last is remembered
  std::map<mote_id, instant> prompted_; ///< when an unknown mote was last asked to join
  std::uint16_t roster_number_ = 0;
  std::deque<network::roster> roster_pages_; ///< that are still to be sent
  instant roster_began_;
  std::optional<instant> roster_due_; ///< the next page, or the next roster
  slot_table slots_;
  std::optional<instant> next_expiry_; ///< no member needs attention before this
  registrar_counters counters_;
};

} // namespace rubicon::mote
