// What other hosts are still to be sent, and when that is looked at (TUP-18).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "core/time.hpp"
#include "peis/subscribers/subscriber_table.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// What a host is still to be sent. It leaves as room and time allow, so that a question about all
/// tuples costs no more at once than one about a single tuple.
struct pending_feed {
  /// Goes through our questions.
  struct question_scan {
    std::uint64_t next = 0; ///< serial
    bool refresh = false;
  };
  /// Folded keys of values and deletions that did not leave, and since when they fail.
  using undelivered_values = std::map<std::string, std::optional<instant>, std::less<>>;

  std::optional<question_scan> questions;
  std::optional<bool> questions_again;              ///< as a refresh or not, when that is through
  std::set<std::uint64_t> undelivered_questions;    ///< serials
  undelivered_values undelivered;                   ///< changed by pending_feeds only
  std::string undelivered_after;                    ///< the last one looked at
  std::map<std::uint64_t, subscriber*> queue_scans; ///< subscriptions whose matches are to be sent
  std::string scanned_after; ///< the last tuple that the first of them has had
  std::optional<instant> not_before;

  [[nodiscard]] bool is_empty() const {
    return !questions && undelivered_questions.empty() && undelivered.empty() &&
           queue_scans.empty();
  }
};

/// The pending feeds of all hosts, and the agenda: whose feed is looked at when. One that waits for
/// an acknowledgement is not in the agenda.
class pending_feeds {
public:
  [[nodiscard]] pending_feed* find(peer_id host); ///< null if nothing is pending
  [[nodiscard]] const pending_feed* find(peer_id host) const;
  pending_feed& open(peer_id host); ///< the one there is, or a new one; it stays where it is
  void close(peer_id host);         ///< forgets it, with what is pending
  [[nodiscard]] std::size_t size() const { return feeds_.size(); }

  /// @returns false if that key was undelivered already; then it fails since it did first
  bool add_undelivered(peer_id host, const std::string& folded,
                       std::optional<instant> failing_since);
  bool remove_undelivered(peer_id host, std::string_view folded); ///< false: it was not there
  void clear_undelivered(peer_id host);
  /// Has this host more undelivered values than `max`, or more than its part of what all may have?
  [[nodiscard]] bool has_too_many(peer_id host, std::size_t max) const;

  /// Its feed is looked at then, or not until something else happens. @pre find(host)
  void schedule(peer_id host, std::optional<instant> due);
  [[nodiscard]] std::optional<instant> due(peer_id host) const;
  /// Takes the host that is due first out of the agenda; nothing if none is.
  [[nodiscard]] std::optional<peer_id> take_due(instant now);
  /// No host is looked at before that, whatever the agenda says.
  void pause(instant until);
  [[nodiscard]] std::optional<instant> deadline() const { return next_; }

private:
  struct entry {
    pending_feed feed;
    std::optional<instant> due; ///< where it is in the agenda
  };

  std::map<peer_id, entry> feeds_;
  std::set<std::pair<instant, peer_id>> agenda_;
  std::optional<instant> next_;
  std::size_t undelivered_ = 0; ///< in all feeds
};

} // namespace rubicon::peis
