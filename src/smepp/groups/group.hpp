// One group as one of its members sees it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "smepp/crypto/session_keys.hpp"
#include "smepp/groups/group_description.hpp"
#include "smepp/groups/member_table.hpp"
#include "smepp/weak_sync.hpp"

namespace rubicon::smepp {

/// What a member keeps of a group where it outlasts a loss of power. Holds keys: neither logged nor
/// sent.
struct stored_group {
  group_id id;
  group_description description;
  session_keys session;
  std::uint16_t stamp = 0;         ///< of our own entry among the members
  std::vector<mote_id> neighbours; ///< those that have shown that they are there, the last first

  static constexpr std::size_t neighbours_max = 12;

  friend bool operator==(const stored_group& a, const stored_group& b) {
    return a.id == b.id && a.description == b.description && a.session.id == b.session.id &&
           a.session.keys == b.session.keys && a.stamp == b.stamp && a.neighbours == b.neighbours;
  }
};

struct group {
  static constexpr duration refuser_pause_min = 5s;

  group_id id;
  group_description description;
  session_ring ring;
  member_table members;
  weak_sync sync;

  /// Back after a loss of power: keys may be old, and members, time and subscriptions are not
  /// known.
  bool is_returning = false;
  /// Nothing is sent after this.
  std::optional<instant> leaving_at;
  /// Somebody has left: new session keys are made then, unless we have fetched some that others
  /// have made. What is sent to all (key_refresh) is no such pair: who has left receives it, too.
  std::optional<instant> refresh_at;
  /// Our best pair went from hand to hand: who had those before may be one who has left.
  bool is_best_fetched = false;
  /// Neighbours have sent under keys ahead of ours: these are fetched then, if we have not been
  /// sent them. It need not be true. One place for each neighbour, so none takes another's.
  struct rumour {
    mote_id from;
    session_id best; ///< of ours at that time
    instant due;
  };
  std::vector<rumour> rumours;
  static constexpr std::size_t rumours_max = 4;
  /// Those that did not answer when we wanted keys from them: not asked for a while, longer each
  /// time.
  struct refuser {
    mote_id who;
    instant until;
    duration pause{};
  };
  std::vector<refuser> refusers; ///< the longest ago first
  static constexpr std::size_t refusers_max = 8;
  /// Those that have shown that they are there, now or in a former life, the last first.
  std::vector<mote_id> neighbours;
  /// Of all others one is asked at a time, and after a while, longer after each failure.
  instant guess_from;
  duration guess_pause = refuser_pause_min;
  instant fetch_from; ///< no catch-up before, what is said by a member included
  /// Our time is not sent before this to a part of the group that has a different time.
  instant out_of_step_from;
  /// When all members were last sent to each neighbour, the longest ago first.
  std::vector<std::pair<mote_id, instant>> members_sent;

  /// Joined, but members and subscriptions may still come.
  struct incomplete_join {
    instant until;
    std::size_t members = 0;
    std::size_t subscriptions = 0;
  };
  std::optional<incomplete_join> incomplete;
};

} // namespace rubicon::smepp
