// How connecting to hosts has gone, and so when each may be tried again (CM-10).
#pragma once

#include <map>
#include <string>

#include "core/text/ipv4_network.hpp"
#include "core/time.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// A host is tried ever more rarely, one that refuses links together with others of its machine.
/// A peer that announces unknown hosts may have us dial any address: of each sender of
/// announcements we follow a few, then one in dial_cost seconds.
class contact_history {
public:
  /// All outlive this.
  contact_history(const own_peer& own, const link_table& links, const host_table& hosts)
      : own_(own), links_(links), hosts_(hosts) {}

  void note_contact(peer_id host, instant now); ///< a try, or the end of a link
  void note_refusal(peer_id host, instant now); ///< it has closed a link at once
  /// A cluster run has seen it in a higher cluster. @returns whether it is to be tried all the same
  [[nodiscard]] bool note_foreign_run(peer_id host);
  void charge_announcer(peer_id host, instant now);
  void forget(peer_id host) { contacts_.erase(host); }

  /// No link, and the time to try again has come. @param wait_max seconds between two tries
  [[nodiscard]] bool may_try(peer_id host, unsigned wait_max, instant now);
  /// @param refusals before that which is waited for
  [[nodiscard]] duration refused_wait(unsigned refusals) const;

private:
  struct contact {
    unsigned tries = 0;
    instant last;              ///< try, or end of a link
    unsigned runs_foreign = 0; ///< cluster runs that saw it in a higher cluster (CLU-02)
    unsigned refusals = 0;     ///< links that it has closed at once, one after the other
  };

  /// Where peers are that refuse us.
  struct refusing_machine {
    unsigned refusals = 0;
    instant until; ///< none of them is tried before
  };

  [[nodiscard]] bool is_refused_at(peer_id host, instant now) const;
  [[nodiscard]] rate_limit& announcer_of(const ipv4_address& from, instant now);
  [[nodiscard]] bool has_credit(peer_id host, instant now);

  const own_peer& own_;
  const link_table& links_;
  const host_table& hosts_;
  std::map<peer_id, contact> contacts_;
  std::map<std::string, refusing_machine> refusing_; ///< by name of machine
  std::map<ipv4_address, rate_limit> announcers_;
};

} // namespace rubicon::peis
