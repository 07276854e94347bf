// Who can be reached over which link (docs/peis-wire.md 9).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"
#include "peis/wire/routing_page.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// The route to one host. A lost one keeps its place until it has aged out.
struct route {
  std::int32_t seqno = 0;
  std::int32_t magic = 0;
  std::uint8_t hops = 0; ///< metric below the limit; 250..253 while lost
  std::uint8_t connections = connections_unknown;
  std::optional<link_id> via;      ///< unset while lost
  std::uint8_t neighbour_hops = 0; ///< the neighbour's own metric
  instant news;                    ///< when this number of this incarnation was first received

  [[nodiscard]] bool lost() const { return !via; }
  /// What is maximised when routes are compared (RTE-06): newer information, fewer hops.
  [[nodiscard]] std::int64_t merit() const { return std::int64_t{seqno} - hops; }
};

/// What a neighbour's table or the end of a link has changed.
struct routing_change {
  enum class kind : std::uint8_t {
    appeared, ///< reachable, was not
    lost,     ///< not reachable, was
    moved,    ///< the route was lost and another one taken
    reborn,   ///< reachable under another magic number than before
  };
  peer_id host;
  kind what;
};
using routing_changes = std::vector<routing_change>;

/// The main table and one table per link: the neighbour's, with the cost of the link added. Our own
/// entry is not in the tables; it is added when they are sent.
///
/// When a route is lost, what neighbours still send may lead back to us, in ever longer circles
/// (count to infinity, docs/peis-wire.md 9.4). A route is sound if it comes by newer information
/// than the last one had, or by as new and from nearer to the host than we were. A real kernel
/// takes any; we take an unsound one on probation: the owner probes the host, which a real kernel
/// answers as well, and reports it unanswered(), or not.
///
/// What is sent of a marked host that was lost is in doubt: neighbours that have yet to lose it may
/// have received newer numbers of it than we have. It is entered when the host gives a sign of
/// life, for which the owner probes it as well, or is the neighbour itself.
class routing_table {
public:
  routing_table() = default;

  /// @param metric_limit routes of this many hops or more count as none
  /// @param routes_max further hosts are not taken up; a link brings at most as many as are free
  routing_table(peer_id self, std::int32_t magic, std::uint8_t metric_limit,
                std::size_t routes_max = std::numeric_limits<std::size_t>::max())
      : self_(self), magic_(magic), metric_limit_(metric_limit), routes_max_(routes_max) {}

  /// A neighbour's whole table has arrived over a link of this cost (docs/peis-wire.md 9.4).
  [[nodiscard]] routing_changes on_table(link_id link, std::uint8_t cost,
                                         std::span<const routing_entry> entries, instant now);

  /// Hosts of that table for which there was no room, since the last call.
  [[nodiscard]] std::size_t take_refused() { return std::exchange(refused_, 0); }

  /// Hosts whose lost routes made room since the last call; they may have been found again.
  [[nodiscard]] std::vector<peer_id> take_evicted() { return std::exchange(evicted_, {}); }

  [[nodiscard]] routing_changes on_link_closed(link_id link, instant now);

  /// The host is of our kind: it is given up sooner.
  void mark(peer_id host);

  /// A host without a route has said over a link that it is there, through a neighbour that has yet
  /// to announce it. An unsound route until it does.
  [[nodiscard]] routing_changes on_heard(link_id link, peer_id host, std::int32_t magic,
                                         std::uint8_t hops, instant now);

  [[nodiscard]] bool is_unsound(peer_id host) const { return unsound_.contains(host); }

  /// Hosts to which an unsound route was taken, or one is in doubt, since the last call.
  [[nodiscard]] std::set<peer_id> take_unsound() { return std::exchange(unsound_, {}); }

  /// No sign of life came over the unsound route, or over the one in doubt: it counts as lost, and
  /// so does all that is sent of the host until `until` unless it is newer.
  /// @param since it has been silent
  [[nodiscard]] routing_changes unanswered(peer_id host, instant since, instant until);

  /// A package of the host has come: what is sent of it is in doubt no more.
  [[nodiscard]] routing_changes on_sign_of_life(peer_id host);

  /// The links over which a host is offered, in doubt or not, the best first.
  [[nodiscard]] std::vector<link_id> offers_of(peer_id host) const;

  /// One period has passed. @returns unmarked hosts lost for too long, which the owner then erases
  [[nodiscard]] std::vector<peer_id> age(instant now);

  /// @returns marked hosts that have been lost for as long as this
  [[nodiscard]] std::vector<peer_id> lost_since(instant then) const;

  /// When the first of the marked hosts that are lost now was lost.
  [[nodiscard]] std::optional<instant> first_loss() const;

  /// Removes every trace of a host.
  void erase(peer_id host);

  /// Ignores what neighbours still send of this incarnation for a while: they may not have learned
  /// yet that it is gone (RTE-09).
  void bury(peer_id host, std::int32_t magic, instant until);

  /// Ignores what is no news of this incarnation: another one is said to have taken its place. Only
  /// who lives counts on, so that it is believed again if the word was an old one (KH-02).
  void distrust(peer_id host, std::int32_t magic, instant until);

  [[nodiscard]] const route* find(peer_id host) const;
  [[nodiscard]] std::optional<link_id> way_to(peer_id host) const;
  [[nodiscard]] const small_map<peer_id, route>& routes() const { return routes_; }

  /// The largest growth of the metric to any host if the link is closed: V(c) of D1.1 3.1.6.4 in
  /// metric. Unset if a host can be reached over this link alone.
  [[nodiscard]] std::optional<unsigned> loss_without(link_id link) const;

  /// Our own sequence number, one larger than at the last call (RTE-03).
  std::int32_t next_seqno() { return ++seqno_; }

  /// True, once, after neighbours have shown a higher number of an earlier incarnation of ours:
  /// ours has been raised and should be sent (docs/peis-wire.md 9.6).
  [[nodiscard]] bool take_overtaken();

  /// What to send over `link`: routes that lead over it are left out (split horizon; a real kernel
  /// handles an absent entry as it handles hops 255).
  [[nodiscard]] std::vector<routing_entry> table_for(link_id link, std::uint8_t connections) const;

private:
  struct burial {
    std::int32_t magic;
    std::int32_t seqno; ///< newer news are believed,
    instant until;
    bool proof = false; ///< but only with a sign of life
  };
  using link_table = std::vector<std::pair<peer_id, route>>; ///< ascending by host

  [[nodiscard]] static const route* offer_in(const link_table& table, peer_id host);
  static void erase_from(link_table& table, peer_id host);
  static void keep_age(link_table& fresh, const link_table& last);

  void note_own(const routing_entry& entry);
  [[nodiscard]] bool buried(const routing_entry& entry, instant now);
  void merge(link_id link, peer_id host, route& known, const route& offered,
             routing_changes& changes);
  void lose(peer_id host, route& lost, instant now, routing_changes& changes);
  void let_go(peer_id host, route& lost, instant now, routing_changes& changes);
  [[nodiscard]] std::size_t room_for(link_id link);
  void dig(peer_id host, const burial& grave);
  [[nodiscard]] bool is_in_doubt(peer_id host, const route& offered) const;
  /// Whether this incarnation was lost, and has yet to give a sign of life.
  [[nodiscard]] bool needs_proof(peer_id host, const route& offered) const;
  void end_doubt(peer_id host, const route& offered);
  [[nodiscard]] const route* best_offer(peer_id host, std::optional<link_id> but) const;
  void note_loss(peer_id host, instant now);
  void forget_loss(peer_id host);
  void take(peer_id host, route& known, const route& offered);

  peer_id self_;
  std::int32_t magic_ = 0;
  std::uint8_t metric_limit_ = 0;
  std::size_t routes_max_ = 0;
  std::size_t refused_ = 0;
  std::vector<peer_id> evicted_;
  std::int32_t seqno_ = 0;
  bool overtaken_ = false;
  small_map<peer_id, route> routes_; ///< walked for each table that comes or leaves
  std::map<link_id, link_table> by_link_;
  std::map<peer_id, burial> graves_;
  std::set<peer_id> marked_;
  std::set<peer_id> unsound_;
  std::map<peer_id, instant> lost_at_;           ///< marked ones
  std::set<std::pair<instant, peer_id>> losses_; ///< the same, by time
};

} // namespace rubicon::peis
