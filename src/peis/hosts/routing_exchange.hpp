// Routing tables that neighbours send, and when ours is sent to them (peis-wire.md 9).
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/links/package_sender.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"

namespace rubicon::peis {

/// Puts the pages of a neighbour's table together, and has it wait if tables come too fast: the
/// newest counts. Ours leaves once a period, and soon after a change that others must know.
class routing_exchange {
public:
  /// All outlive this.
  routing_exchange(own_peer& own, link_table& links, overlay& known, package_sender& sender,
                   instant now);

  /// @returns true if the table of this link is whole, and apply() is due
  [[nodiscard]] bool on_page(connection& from, byte_view data, instant now);
  /// Links whose tables have waited, in turn; may_apply() decides on each.
  [[nodiscard]] std::vector<link_id> take_waiting(instant now);
  [[nodiscard]] bool may_apply(link_id link, instant now);
  /// Enters the table of a link. @pre it is whole
  [[nodiscard]] routing_changes apply(connection& from, instant now);

  void trigger(instant now); ///< our table is to be sent soon
  /// The same, after a change that no other has to know of: the later, the more hosts there are.
  void trigger_calmly(instant now);
  void cancel() { next_trigger_.reset(); }
  void send_due(const occasion& x);
  void send(const occasion& x); ///< to all neighbours
  void send_to(connection& to, link_id origin);

  // A link that is to be closed is drained first: numbers of routes, our own one too, stay over it
  // as they were, so that newer ones over other links take their place, and its end is no news.
  void drain(link_id link, instant until); ///< its neighbour is of our kind
  void end_drain(link_id link) { drains_.erase(link); }
  void end_drains() { drains_.clear(); }
  [[nodiscard]] std::optional<instant> drained_at(link_id link) const; ///< unset: it is not drained

  [[nodiscard]] bool is_period_over(instant now) const { return now >= next_period_; }
  void begin_period(instant now);
  void restart_period(instant now) { next_period_ = now + own_.config.routing_period; }

  [[nodiscard]] std::optional<instant> tables_deadline() const { return next_tables_; }
  [[nodiscard]] std::optional<instant> deadline() const { ///< of what is sent
    return earliest(next_trigger_, next_period_);
  }

private:
  [[nodiscard]] instant may_apply_at(const connection& x) const;

  own_peer& own_;
  link_table& links_;
  overlay& overlay_;
  package_sender& sender_;
  std::optional<instant> next_tables_; ///< that came too soon
  link_id last_table_;                 ///< applied
  rate_limit rate_;                    ///< work of all tables
  instant next_period_;
  std::optional<instant> next_trigger_;
  instant last_trigger_;
  struct draining {
    instant until;
    std::vector<routing_entry> frozen; ///< ascending by id
  };
  std::map<link_id, draining> drains_; ///< of open links
};

} // namespace rubicon::peis
