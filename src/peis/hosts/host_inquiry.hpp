// Questions about hosts: ours, and those of others (peis-wire.md 10, KH-01, KH-02).
#pragma once

#include <cstdint>
#include <optional>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/link/stranger_table.hpp"
#include "peis/links/message_delivery.hpp"
#include "peis/links/package_sender.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Every host whose record does not fit its route is a stranger, and asked about until one does.
class host_inquiry {
public:
  /// All outlive this.
  host_inquiry(own_peer& own, link_table& links, const overlay& routes, const host_table& hosts,
               package_sender& sender, message_delivery& messages);

  void note_stranger(peer_id id, instant now);
  void forget(peer_id id) { strangers_.forget(id); }
  /// A host remembers another incarnation of it.
  void mislead(peer_id id, instant now) { strangers_.mislead(id, now); }
  void review(instant now); ///< finds what was missed at a change
  void ask_due(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Answers for ourselves or, if we know who is there now, for the destination of a passing
  /// question. @returns false if we have no answer
  [[nodiscard]] bool answer(link_id from, const package_header& header, byte_view data,
                            events& out);

private:
  void ask_about(const stranger_table::question& x);
  void ask(peer_id id, std::int32_t magic, bool sealed);

  own_peer& own_;
  link_table& links_;
  const overlay& overlay_;
  const host_table& hosts_;
  package_sender& sender_;
  message_delivery& messages_;
  stranger_table strangers_;
  rate_limit rate_; ///< of questions
};

} // namespace rubicon::peis
