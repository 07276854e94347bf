// The session keys of one group, through the changes from one pair to the next (SMP-13).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "smepp/crypto/key.hpp"

namespace rubicon::smepp {

/// Identifies a pair of session keys within a group.
struct session_id {
  std::uint16_t generation = 0; ///< one more with each change; wraps (RFC 1982)
  mote_id maker;                ///< two motes may make the same generation at once

  friend bool operator==(const session_id&, const session_id&) = default;
};

/// Which of two pairs all members end up with: the newer one, and of two of one generation that of
/// the lower mote. Parts of a group that have been apart agree by it too.
[[nodiscard]] bool is_better(session_id a, session_id b);

struct session_keys {
  session_id id;
  key_pair keys;
};

/// sessionKey and sessionMAC of a group: those in use, those about to be, and those of a moment
/// ago. A new pair is accepted at once, used for sending from its time on, when all members should
/// have it, and then outlives the older ones, which are accepted for one grace period more.
class session_ring {
public:
  static constexpr std::size_t capacity = 4; ///< the worst pair is dropped, counted

  session_ring() = default;
  explicit session_ring(duration grace) : grace_(grace) {}

  /// @param send_from when it is to be used for sending
  /// @returns whether it is news and better than all before: others may not know it
  bool learn(const session_keys& x, instant send_from, instant now);

  /// The pair that all are to have. @pre !empty()
  [[nodiscard]] const session_keys& best() const { return pairs_.front().session; }
  /// When that one is used for sending. @pre !empty()
  [[nodiscard]] instant best_from() const { return pairs_.front().send_from; }
  /// The pair to send under now. @pre !empty()
  [[nodiscard]] session_id sending(instant now) const;
  [[nodiscard]] const session_keys* find(session_id id) const;
  [[nodiscard]] bool empty() const { return pairs_.empty(); }

  /// All that are accepted.
  [[nodiscard]] std::vector<session_keys> accepted() const;

  /// @returns whether a pair has ended
  bool on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] std::uint64_t evicted() const { return evicted_; }
  [[nodiscard]] static std::size_t footprint() { return capacity * (2 * key::size + 4 + 8); }

private:
  struct pair {
    session_keys session;
    instant send_from;
    std::optional<instant> until; ///< nothing: no better one is known
  };

  duration grace_ = 60s;
  std::vector<pair> pairs_; ///< best first
  std::uint64_t evicted_ = 0;
};

} // namespace rubicon::smepp
