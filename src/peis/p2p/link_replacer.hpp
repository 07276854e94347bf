// Another link beside one that may be dead without either end knowing: it shows at once that the
// route is free again, and then takes the place of the old one.
#pragma once

#include "peis/links/dialler.hpp"
#include "peis/links/link_health.hpp"
#include "peis/links/package_sender.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/p2p/link_closer.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

class link_replacer {
public:
  /// All outlive this.
  link_replacer(const own_peer& own, link_table& links, const host_table& hosts,
                link_health& health, package_sender& sender, dialler& dials, link_closer& closer)
      : own_(own), links_(links), hosts_(hosts), health_(health), sender_(sender), dials_(dials),
        closer_(closer) {}

  /// A neighbour has sent its routes over one link: other suspect ones to it are of no use.
  void end_suspects_beside(link_id link, const occasion& x);
  void on_time(const occasion& x);

private:
  [[nodiscard]] bool has_other_hope(const connection& x, instant now) const;
  void try_beside(const connection& x, const occasion& at);

  const own_peer& own_;
  link_table& links_;
  const host_table& hosts_;
  link_health& health_;
  package_sender& sender_;
  dialler& dials_;
  link_closer& closer_;
};

} // namespace rubicon::peis
