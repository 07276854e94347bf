// Two others that use one id (RTE-08): who of them a neighbour is.
#pragma once

#include <optional>

#include "core/time.hpp"
#include "peis/links/link_writer.hpp"
#include "peis/links/package_sender.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/p2p/link_closer.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/package.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// What a neighbour that is alive says of itself comes over its own link; a newcomer with its id is
/// refused, and both are notified of the other.
class id_guard {
public:
  /// All outlive this.
  id_guard(own_peer& own, link_table& links, host_table& hosts, package_sender& sender,
           link_writer& writer, link_closer& closer)
      : own_(own), links_(links), hosts_(hosts), sender_(sender), writer_(writer), closer_(closer) {
  }

  /// A link whose other end is a host of our kind, as we know it, that has sent something just now;
  /// what waits to be handled counts.
  [[nodiscard]] std::optional<link_id> living_link(peer_id id, std::optional<link_id> except,
                                                   instant now) const;
  [[nodiscard]] bool is_impersonation(link_id from, const package_header& header,
                                      instant now) const;
  /// @returns true if the link was closed, because its other end has the id of a neighbour
  [[nodiscard]] bool refuse_rival(connection& from, const host_record& record, const occasion& x);
  void notify_rivals(link_id from, const host_record& record);

private:
  void notify_taken(connection& to, const host_record& by, link_id origin);

  own_peer& own_;
  link_table& links_;
  host_table& hosts_;
  package_sender& sender_;
  link_writer& writer_;
  link_closer& closer_;
};

} // namespace rubicon::peis
