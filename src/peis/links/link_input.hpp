// Whose octets are handled next, and how many at a time: no neighbour keeps the others waiting.
#pragma once

#include <deque>
#include <optional>
#include <set>
#include <utility>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/overlay/p2p_events.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

class link_input {
public:
  /// Both outlive this.
  link_input(own_peer& own, link_table& links, instant now)
      : own_(own), links_(links), latest_(now) {}

  /// They must stay valid until end_turn().
  void on_octets(connection& x, byte_view octets, instant now);

  /// The link whose turn it is; nothing when the turn's work is done.
  [[nodiscard]] std::optional<link_id> next(instant now);
  /// May the next package of this link be handled?
  [[nodiscard]] static bool may_go_on(const connection& x, instant now) {
    return x.in.credit > 0 && x.in.budget.is_within(now);
  }
  /// A package is handled now.
  static void note_package(connection& x, const received_package& package, instant now);
  void spend(link_id link, work_units work);
  /// What came over a link has cost more than its receipt: the neighbour's budget pays.
  void charge(link_id link, work_units work, instant now);
  /// @param more whole packages wait
  void finish(connection& x, bool more, instant now, events& out);

  /// What is left of the newest octets is kept, and no more is wanted until it has been handled.
  /// @returns a link that has brought too much
  [[nodiscard]] std::optional<link_id> end_turn(instant now, events& out);

  void on_link_closed(const connection& gone);
  void note_time(instant now) { latest_ = now; }
  [[nodiscard]] bool empty() const { return ready_.empty(); }
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  own_peer& own_;
  link_table& links_;
  std::deque<link_id> ready_;                     ///< whose input waits, in turn
  std::set<std::pair<instant, link_id>> resting_; ///< whose neighbour is over its budget
  std::optional<link_id> fed_;                    ///< whose octets are the caller's
  work_units turn_work_ = 0;                      ///< done in this turn
  instant latest_;                                ///< call
};

} // namespace rubicon::peis
