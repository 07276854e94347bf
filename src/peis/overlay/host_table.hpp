// The hosts of the network that a peer knows of, and those that it has lost.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "core/text/ipv4_network.hpp"
#include "core/time.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// What is known of another host.
struct host_entry {
  /// So soon others mostly have another route to a host whose route was lost, over four hops.
  /// Before, no link to it is opened: one too many is closed again, which costs others their
  /// routes.
  static constexpr duration reroute_time = 2s;
  static constexpr link_id by_announcement{std::numeric_limits<std::uint64_t>::max()};

  host_record record;
  bool announced = false;         ///< host_appeared was an output
  bool forgotten = false;         ///< we had given it up, what it wanted included
  instant last_record;            ///< or announcement, from any sender
  instant own_word;               ///< when it last described itself
  std::int32_t before = 0;        ///< magic of the incarnation that this one has followed; 0: none
  std::optional<instant> lost;    ///< there has been no route to it since
  std::int32_t rival = 0;         ///< magic of a newcomer with its id that was refused; 0: none
  instant rival_first;            ///< when that began
  link_id from = by_announcement; ///< the link that brought it first
  std::optional<ipv4_address> announcer; ///< who sent its first announcement; unset once it was met
};

/// The rule of the table is one: a link may have as many entries as are free beside them, so that
/// there is always room for another (docs/security.md).
class host_table {
public:
  struct former_host {
    host_record record;
    instant lost;
  };

  /// All outlive this.
  host_table(own_peer& own, link_table& links, const overlay& routes);

  [[nodiscard]] host_entry* find(peer_id id);
  [[nodiscard]] const host_entry* find(peer_id id) const;
  [[nodiscard]] const std::map<peer_id, host_entry>& all() const { return hosts_; }
  /// The entry of a host; a new one, if there is room. @returns null if there is none
  [[nodiscard]] host_entry* admit(peer_id id, const occasion& x);
  /// Another incarnation takes the place of one that was erased.
  void replace(peer_id id, link_id from) { hosts_[id].from = from; }
  void erase(peer_id id);
  void expire(instant now); ///< hosts that no peer mentions any more

  void note_announced(host_entry& x);
  void note_lost(peer_id id, instant now); ///< unless there is a route
  /// There is a route. @returns since when there was none
  std::optional<instant> note_found(host_entry& x);

  /// The host cannot be reached any more, but it may be found again where it was.
  void remember(const host_record& x, instant now);
  /// A host that was given up is known again.
  void recall(host_entry& x);
  void expire_former(instant now);
  [[nodiscard]] const std::map<peer_id, former_host>& former() const { return former_; }
  /// Are there hosts without a route?
  [[nodiscard]] bool has_unreachable() const {
    return !former_.empty() || !missing_.empty() || hosts_.size() > announced_;
  }

  [[nodiscard]] const host_record* record_of(peer_id host) const;      ///< ours included
  [[nodiscard]] const host_record* last_record_of(peer_id host) const; ///< of a former one as well
  [[nodiscard]] std::vector<const host_record*> records() const; ///< ourselves included, by id

  /// Is there a record of the incarnation that the route to that host leads to?
  [[nodiscard]] bool knows_present(peer_id id) const;
  [[nodiscard]] bool is_marked(peer_id id) const;         ///< another host, of our kind
  [[nodiscard]] bool is_here(const host_record& x) const; ///< on this computer
  [[nodiscard]] bool shares_host(peer_id host) const;     ///< the same, as far as we know
  /// Who answers at a loopback address of that host is another one. @returns true if that shows
  /// that it is on another computer
  [[nodiscard]] bool note_elsewhere(peer_id host);

private:
  [[nodiscard]] bool has_room_for(link_id from);

  own_peer& own_;
  link_table& links_;
  const overlay& overlay_;
  std::map<peer_id, host_entry> hosts_;
  std::map<peer_id, former_host> former_; ///< lost for want of a route: may be found again
  std::set<peer_id> missing_;             ///< announced ones without a route
  std::size_t announced_ = 0;
  /// By id their magic: on another computer, though that has our host name. Kept when they go.
  std::map<peer_id, std::int32_t> elsewhere_;
};

} // namespace rubicon::peis
