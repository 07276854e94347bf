#include "peis/p2p/link_closer.hpp"

namespace rubicon::peis {

namespace {

constexpr duration lasting = 30s; // a link that has been of use
constexpr duration at_once = 1s;  ///< a link that is closed so soon was refused

} // namespace

void link_closer::close(link_id link, close_cause why, const occasion& x) {
  x.out.push_back(close_link{link, why});
  forget(link, x);
}

void link_closer::close_broken(const std::vector<link_id>& links, close_cause why,
                               const occasion& x) {
  on_.own.counters.links_broken += links.size();
  for (const auto link : links)
    close(link, why, x);
}

/// A link that its other end closes at once, without having said who it is, is a refusal; the first
/// may be a mistake, after a restart (25.8). A peer that uses our id, or knows one that does, asks
/// again.
void link_closer::on_closed(connection& gone, const occasion& x) {
  const auto link = gone.id;
  const bool is_refusal = x.now < gone.opened + at_once && !gone.named && !gone.rivals;
  const bool has_lasted = gone.opened + lasting <= x.now;
  const auto sought = gone.tried_for;
  const auto standing = on_.dials.standing_of(link);
  forget(link, x);
  if (is_refusal && sought && !on_.links.is_neighbour(*sought)) // else one of two went
    on_.contacts.note_refusal(*sought, x.now);
  if (standing)
    on_.dials.note_end(*standing, is_refusal, has_lasted, x.now);
}

void link_closer::forget(link_id link, const occasion& x) {
  auto gone = on_.links.take(link);
  if (!gone)
    return;
  on_.seen.on_link_closed(link);
  if (gone->neighbour) {
    if (gone->opened + lasting <= x.now)
      on_.contacts.forget(*gone->neighbour);  // the tries that led to it are forgotten
    if (!on_.health.is_suspect(*gone, x.now)) // long looked for beside
      on_.contacts.note_contact(*gone->neighbour, x.now);
  }
  on_.dials.on_link_closed(link, x.now);
  on_.messages.on_link_closed(*gone, x.now, x.out);
  on_.input.on_link_closed(*gone);
  on_.presence.apply(on_.routes.on_link_closed(link, x.now), x);
}

} // namespace rubicon::peis
