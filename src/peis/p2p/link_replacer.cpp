#include "peis/p2p/link_replacer.hpp"

#include <algorithm>
#include <vector>

#include "peis/wire/trace.hpp"

namespace rubicon::peis {

void link_replacer::on_time(const occasion& x) {
  const auto due = health_.take_suspects(x.now);
  for (const auto link : due.ask)
    sender_.send_to_host(*links_.at(link).neighbour, link, lane::high, port::trace,
                         encode(trace_message{{own_.self.id}}), x.origin);
  for (const auto link : due.beside)
    try_beside(links_.at(link), x);
}

/// Is another link to that host there that may be alive, or asked for?
bool link_replacer::has_other_hope(const connection& x, instant now) const {
  const auto host = *x.neighbour;
  return dials_.is_seeking(host) || std::ranges::any_of(links_.all(), [&](const auto& entry) {
           const auto& y = entry.second;
           return y.id != x.id && (y.neighbour == host || y.tried_for == host) &&
                  !health_.is_suspect(y, now);
         });
}

void link_replacer::try_beside(const connection& x, const occasion& at) {
  const auto* known = hosts_.find(*x.neighbour);
  if (known != nullptr && !has_other_hope(x, at.now))
    dials_.connect_beside(x, known->record, at);
}

void link_replacer::end_suspects_beside(link_id link, const occasion& x) {
  const auto neighbour = links_.at(link).neighbour;
  if (!neighbour)
    return;
  auto dead = links_.links_to(*neighbour);
  std::erase_if(dead, [&](link_id other) {
    return other == link || !health_.is_suspect(links_.at(other), x.now);
  });
  closer_.close_broken(dead, close_cause::replaced, x);
}

} // namespace rubicon::peis
