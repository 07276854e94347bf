// The tuples that this peer owns, and who has written them (docs/peis-wire.md 15.3 to 15.5).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/space/tuple_drafts.hpp"
#include "peis/space/tuple_hosts.hpp"
#include "peis/space/tuple_space_config.hpp"
#include "peis/tuples/tuple_clock.hpp"
#include "peis/tuples/tuple_store.hpp"

namespace rubicon::peis {

/// A whole value, new or in the place of another.
struct own_value_set {
  tuple_pointer content;
};

/// It is gone. `last` is what subscribers are sent: the deletion.
struct own_value_deleted {
  tuple_pointer gone;
  tuple last;
};

/// A value that has grown; subscribers get all of it, in order with the notices that follow.
struct own_value_extended {
  tuple_pointer content;
};

/// A value that has grown; subscribers get `added` only.
struct own_value_appended {
  tuple_pointer before;
  tuple_pointer content;
  payload added;
};

/// What has changed: for the feed of the subscribers, then for the users here.
using own_change =
    std::variant<own_value_set, own_value_deleted, own_value_extended, own_value_appended>;

/// What a command or request has come to. A cause other than none: nothing has been done.
struct own_result {
  cause why = cause::none;
  std::optional<own_change> change; ///< none also if a tuple to be deleted does not exist
};

/// Numbers and dates the values of our own tuples, ours and those that others write, within the
/// limits of others. A number is never used twice for one key, also not after a deletion: it is
/// how subscribers know what is newer.
class own_tuples {
public:
  /// @param store with the tuples of all owners. It, `hosts` and `clock` outlive this
  own_tuples(const tuple_space_config& config, peer_id self, tuple_store& store, tuple_hosts& hosts,
             const tuple_clock& clock);

  own_tuples(const own_tuples&) = delete;
  own_tuples& operator=(const own_tuples&) = delete;

  // What users of this peer write.
  [[nodiscard]] own_result set(const key& name, tuple_content content, instant now);
  /// Of the tuple the owner, who must be we, key, value, MIME type, encoding, user time and expiry
  /// count.
  [[nodiscard]] own_result insert(tuple x, instant now);
  [[nodiscard]] std::optional<own_change> remove(const key& name, instant now);

  // What others write.
  /// A set message for one of our tuples; counts what is malformed.
  [[nodiscard]] std::optional<tuple> decode_set(const payload& octets, instant now);
  /// Refused unless `may_write` says otherwise for this key of ours.
  [[nodiscard]] std::optional<own_change> on_set(peer_id source, const tuple& x, bool may_write,
                                                 instant now);

  /// Those that another may append to; nothing if it asks for too many, or too many have to be
  /// looked at for it.
  [[nodiscard]] std::optional<std::vector<tuple_pointer>> find_appendable(const prototype& wanted);

  /// Adds to a value. Text gets its trailing NUL.
  /// @param held one of ours, as it is now
  /// @param writer another host; nothing: we
  /// @param notices subscribers can take the added octets alone
  [[nodiscard]] own_result append(const tuple_pointer& held, const payload& added,
                                  std::optional<peer_id> writer, bool notices);

  // For the feed.
  [[nodiscard]] const tuple_store::entry* find(const key& name) const {
    return store_.find(self_, name);
  }
  /// As tuple_store::walk_on() for our own tuples.
  template <class Visitor>
  bool walk_on(const key& pattern, std::string& after, Visitor visit) const {
    return store_.walk_on(self_, pattern, after, visit);
  }
  /// The same value under a number of its own, if there is one: a holder of the present number
  /// would refuse it. It is no newer to our users than before.
  void renumber(const key& name);
  /// What subscribers are sent of a key that has no tuple.
  [[nodiscard]] tuple deletion_of(const key& name, instant now) const;

  // What becomes of them.
  void on_expired(const tuple& gone); ///< the store has it no more
  /// Its tuples stay: a command is obeyed after the planner has gone (docs/peis-wire.md 15.3).
  void on_writer_gone(peer_id host, instant now);
  /// What writers that are gone have created beyond the limit, the largest first: to be removed.
  [[nodiscard]] std::vector<key> take_orphans(instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return next_orphan_; }

  /// Of each change of the set of keys another.
  [[nodiscard]] std::uint64_t keys_version() const { return keys_version_; }
  [[nodiscard]] const tuple_counters& counters() const { return counters_; }
  [[nodiscard]] work_units take_work() { return work_.take(); }

private:
  [[nodiscard]] own_change store_whole(tuple x, tuple_store::source by);
  tuple_pointer put(tuple x, tuple_store::source by);
  [[nodiscard]] bool is_full(const key& name) const;
  void forget(const tuple& gone);

  tuple_space_config config_;
  peer_id self_;
  tuple_store& store_;
  tuple_hosts& hosts_;
  const tuple_clock& clock_;
  tuple_drafts drafts_;
  std::int32_t first_seqno_ = 0; ///< above every number that a deleted tuple has had
  std::uint64_t keys_version_ = 0;
  std::optional<instant> next_orphan_;
  work_meter work_;
  tuple_counters counters_;
};

} // namespace rubicon::peis
