// Tuples of other owners that this peer holds because it has subscribed to them (TUP-17, TUP-19).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/time.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/space/local_subscriptions.hpp"
#include "peis/space/tuple_events.hpp"
#include "peis/space/tuple_hosts.hpp"
#include "peis/space/tuple_space_config.hpp"
#include "peis/tuples/tuple_clock.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "peis/tuples/tuple_store.hpp"

namespace rubicon::peis {

/// Takes what owners push, never an older value for a newer one, and adds what they append. If an
/// append is missing, it asks the owner for the whole value until that has come. Notifies local
/// subscriptions. Better no value than one that its owner has replaced.
class held_tuples {
public:
  /// @param store with the tuples of all owners. It and the others outlive this
  held_tuples(const tuple_space_config& config, peer_id self, tuple_store& store,
              tuple_hosts& hosts, const local_subscriptions& local, const tuple_clock& clock);

  held_tuples(const held_tuples&) = delete;
  held_tuples& operator=(const held_tuples&) = delete;

  void on_push(peer_id source, const payload& octets, instant now, tuple_events& out);
  void on_append_notice(peer_id source, const payload& octets, instant now, tuple_events& out);

  /// The owner is gone: its values go, or are marked as stale (TUP-19).
  void on_owner_gone(peer_id owner, tuple_events& out);
  void on_expired(const tuple& gone); ///< the store has it no more
  /// A subscription has ended: what no other wants is removed without notice.
  void on_unsubscribed(const prototype& unwanted);

  /// Asks again for values that lack an append.
  void on_time(instant now, tuple_events& out);
  [[nodiscard]] std::optional<instant> deadline() const { return next_repair_; }

  [[nodiscard]] const tuple_counters& counters() const { return counters_; }
  [[nodiscard]] work_units take_work() { return work_.take(); }

private:
  /// A value that lacks an append: the owner was asked for all of it.
  struct incomplete {
    key name;
    std::int32_t seqno = 0;
    std::size_t size = 0; ///< of the value that has the append
    unsigned asked = 0;
    instant ask_again;
  };
  using owned_key = std::pair<peer_id, std::string>; ///< owner, folded key

  [[nodiscard]] static owned_key key_of(const tuple& x) { return {x.owner, x.name.folded()}; }
  [[nodiscard]] bool is_full(const key& name, peer_id owner) const;
  [[nodiscard]] bool replaces(const tuple& x, const tuple& held, bool deletion) const;
  void append(const tuple& held, const payload& added, std::int32_t append_seqno,
              tuple_events& out);
  void remove(const tuple& held, tuple_events& out);
  void note_gap(const append_notice& notice, std::size_t size, instant now, tuple_events& out);
  void check_completeness(const tuple& pushed);
  void repair(instant now, tuple_events& out);

  tuple_space_config config_;
  peer_id self_;
  tuple_store& store_;
  tuple_hosts& hosts_;
  const local_subscriptions& local_;
  const tuple_clock& clock_;
  std::map<owned_key, incomplete> incomplete_;
  std::optional<instant> next_repair_;
  work_meter work_;
  tuple_counters counters_;
};

} // namespace rubicon::peis
