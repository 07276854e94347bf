// What a tuple space may take, and what it counts.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "peis/subscribers/push_window.hpp"
#include "peis/tuples/tuple_record.hpp"

namespace rubicon::peis {

/// The longest value that fits into a message with the longest MIME type.
inline constexpr std::size_t tuple_value_max =
    std::size_t{16384} * 1024 - tuple_record_size - mimetype_length_max;

struct tuple_space_config {
  std::size_t tuples_max = 1'000'000;      ///< own and held ones
  std::size_t subscriptions_max = 100'000; ///< of our own, callbacks included
  // What others can put here. Each limit is shared: one host alone gets four fifths (fair_share).
  // Octets are with all that surrounds a record or tuple in memory; those of all kinds together
  // have a limit that is less than the sum of their own.
  std::size_t others_octets_max = std::size_t{112} << 20U;
  std::size_t subscribers_max = 125'000; ///< records of others
  std::size_t subscribers_octets_max = std::size_t{112} << 20U;
  std::size_t subscribers_per_key_max = 64; ///< prototypes of one host with one key or pattern
  std::size_t held_octets_max = std::size_t{96} << 20U;    ///< tuples of other owners
  std::size_t written_octets_max = std::size_t{24} << 20U; ///< own tuples that others have written
  /// Of these, what writers that are gone may leave behind for longer than `orphan_age`: beyond it
  /// the largest that they have created go.
  std::size_t orphaned_octets_max = std::size_t{2} << 20U;
  duration orphan_age = 30s;
  std::size_t stale_octets_max = std::size_t{16} << 20U; ///< see keep_values_of_dead_hosts
  std::size_t strangers_max = 256; ///< hosts that use this space before the network knows them
  duration stranger_age = 45s;     ///< after this long without a word they are forgotten
  /// What others may make a value grow to by appending: each append copies it.
  std::size_t append_octets_max = std::size_t{1} << 20U;
  std::size_t append_matches_max = 256; ///< tuples that one request of another may change
  push_window_config pushes = {};
  std::size_t missed_max =
      1024;                 ///< values that one host missed, one by one; then all are looked at
  duration lifetime = 60s;  ///< of our subscriptions at marked hosts; 1..255 s
  duration retry_push = 1s; ///< a push that failed is tried again (TUP-18)
  duration give_up_push = 30s;
  std::size_t appends_waiting_max = 64; ///< notices per subscriber and tuple; then a whole push
  std::size_t appends_waiting_octets_max = std::size_t{16} << 20U; ///< of all notices that wait
  duration repair_append = 2s; ///< a whole value that was asked for is asked for again
  unsigned repairs_max = 5;
  bool keep_values_of_dead_hosts = false; ///< marked as stale, instead of removed (TUP-19)
};

/// Each class of the tuple space counts its own part; the sum is reported.
struct tuple_counters {
  std::uint64_t tuples = 0;             ///< held now, own ones included
  std::uint64_t subscriptions = 0;      ///< of ours, now
  std::uint64_t subscribers = 0;        ///< records of others, now
  std::uint64_t subscribers_octets = 0; ///< they take, now
  std::uint64_t held_octets = 0;        ///< tuples of others take, now
  std::uint64_t written_octets = 0;     ///< own tuples written by others take, now
  std::uint64_t pushes_octets = 0;      ///< in flight, now
  std::uint64_t debtors = 0;            ///< hosts that are still to be sent something, now
  std::uint64_t steps = 0;       ///< of deferred work: tuples and subscriptions that were looked at
  std::uint64_t sets = 0;        ///< of own tuples
  std::uint64_t remote_sets = 0; ///< of own tuples, by others
  std::uint64_t pushes_sent = 0;
  std::uint64_t pushes_received = 0;
  std::uint64_t pushes_retried = 0;
  std::uint64_t pushes_given_up = 0;
  std::uint64_t pushes_deferred = 0; ///< had to wait for room: only the newest value leaves then
  /// Values that some subscriber never gets: a newer one took their place while they waited.
  std::uint64_t pushes_overtaken = 0;
  std::uint64_t resyncs = 0; ///< a host missed too many: all it wants is sent again
  std::uint64_t expired = 0;
  std::uint64_t appends = 0; ///< to own tuples, by us and others
  std::uint64_t append_notices_sent = 0;
  std::uint64_t append_notices_received = 0;
  std::uint64_t appends_collapsed = 0; ///< notices given up for a push of the whole value
  std::uint64_t append_gaps = 0;       ///< a notice did not fit what we hold: asked for all of it
  // Dropped.
  std::uint64_t malformed = 0;        ///< a message that is no legal tuple, or not the sender's
  std::uint64_t unwanted = 0;         ///< pushed, but nobody here has subscribed
  std::uint64_t outdated = 0;         ///< pushed, but we hold a newer value (TUP-17)
  std::uint64_t refused = 0;          ///< remote writes of reserved keys (TUP-22), commands refused
  std::uint64_t absent_forgotten = 0; ///< hosts that were away, with what they had subscribed to
  std::uint64_t overflow = 0; ///< no room for a tuple of another or of its writing, value too long
  std::uint64_t subscribers_refused = 0; ///< subscriptions of others without room
  std::uint64_t strangers_refused = 0; ///< messages of hosts that nobody knows, beyond their table
  std::uint64_t orphans_removed = 0;   ///< own tuples whose writers are gone
  std::uint64_t stale_removed = 0;     ///< values of dead hosts, beyond what may be kept
  std::uint64_t appends_refused = 0;   ///< of others: too many tuples, or a value too long
  std::uint64_t append_gaps_given_up = 0; ///< the owner did not send the whole value
  std::uint64_t bad_meta_tuples = 0;      ///< followed, but their text says nothing (META-01)
};
RUBICON_FIELDS(tuple_counters, tuples, subscriptions, subscribers, subscribers_octets, held_octets,
               written_octets, pushes_octets, debtors, steps, sets, remote_sets, pushes_sent,
               pushes_received, pushes_retried, pushes_given_up, pushes_deferred, pushes_overtaken,
               resyncs, expired, appends, append_notices_sent, append_notices_received,
               appends_collapsed, append_gaps, malformed, unwanted, outdated, refused,
               absent_forgotten, overflow, subscribers_refused, strangers_refused, orphans_removed,
               stale_removed, appends_refused, append_gaps_given_up, bad_meta_tuples);

} // namespace rubicon::peis
