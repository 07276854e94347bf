// Hosts that can be reached but are not described now, and when each is asked about
// (docs/peis-wire.md 10).
#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/time.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Each is asked about at once, then after 1 s, doubling, up to a longest pause.
class stranger_table {
public:
  struct question {
    peer_id host;
    unsigned before = 0; ///< times that it has been asked about
    bool misled = false; ///< a host remembers another incarnation of it
  };

  stranger_table() = default;
  explicit stranger_table(duration longest_pause) : longest_pause_(longest_pause) {}

  /// @param misled counts if it is new
  void note(peer_id host, bool misled, instant now);
  void forget(peer_id host);

  /// A host remembers another incarnation of it: it is asked about anew, once.
  void mislead(peer_id host, instant now);

  [[nodiscard]] bool contains(peer_id host) const { return strangers_.contains(host); }

  /// Which is next, and when; of equal times the lowest.
  [[nodiscard]] std::optional<std::pair<instant, peer_id>> next() const;

  /// It is asked about now. @pre contains(host)
  [[nodiscard]] question ask(peer_id host, instant now);

private:
  struct stranger {
    unsigned questions = 0; ///< asked so far
    bool misled = false;
    instant next; ///< question
  };
  using entry = std::map<peer_id, stranger>::value_type;

  void schedule(entry& x, instant at);

  duration longest_pause_{};
  std::map<peer_id, stranger> strangers_;
  std::set<std::pair<instant, peer_id>> questions_; ///< by time
};

} // namespace rubicon::peis
