#include "peis/p2p/incarnations.hpp"

#include "peis/link/link.hpp"
#include "peis/wire/dead_host.hpp"

namespace rubicon::peis {

namespace {

constexpr work_units rebirth_work = 500;

} // namespace

/// Does this show which incarnation is there now?
bool incarnations::believes(const host_record_message& message, instant now) const {
  const auto& record = message.record;
  const auto* way = on_.routes.routes().find(record.id);
  const bool routed = way != nullptr && !way->lost();
  const bool fits = routed && way->magic == record.magic;
  const auto* known = on_.hosts.find(record.id);
  if (known == nullptr)
    return !message.cached || fits || !routed;
  if (known->record.magic == record.magic)
    return true;
  if (on_.guard.living_link(record.id, std::nullopt, now))
    return false; // hearsay; who comes over a link of its own has been judged by refuse_rival()
  if (message.cached)
    return fits && way->news > known->own_word;
  // Its own word, but perhaps one that was long in flight.
  return record.magic != known->before || !routed || way->magic != known->record.magic;
}

void incarnations::on_record(const host_record_message& message, const occasion& x) {
  const auto& record = message.record;
  if (!believes(message, x.now)) {
    on_.inquiry.mislead(record.id, x.now);
    return;
  }
  const auto* known = on_.hosts.find(record.id);
  std::int32_t before = 0;
  if (known != nullptr && known->record.magic != record.magic) {
    before = known->record.magic;
    const auto from = known->from; // the place in the table stays its own
    on_.own.work.add(rebirth_work);
    on_.removal.supersede(record.id, before, x);
    on_.hosts.replace(record.id, from);
  }
  if (auto* place = on_.hosts.admit(record.id, x))
    store(message, *place, before, x);
}

/// @param before magic of the incarnation that this one has followed; 0: none
void incarnations::store(const host_record_message& message, host_entry& stored,
                         std::int32_t before, const occasion& x) {
  const auto id = message.record.id;
  stored.record = message.record;
  stored.last_record = x.now;
  if (!message.cached) {
    stored.own_word = x.now;
    stored.announcer.reset(); // it was met
  }
  if (before != 0)
    stored.before = before;
  on_.hosts.recall(stored);
  if (on_.hosts.knows_present(id))
    on_.inquiry.forget(id);
  else if (on_.routes.reachable(id))
    on_.inquiry.note_stranger(id, x.now);
  if (const auto direct = on_.links.link_to(id))
    on_.beats.expect(on_.links.at(*direct));
  on_.presence.welcome(id, x);
  if (!on_.routes.reachable(id))
    on_.matches.hasten_merge(x.now);
}

void incarnations::on_dead_host(const package_header& header, byte_view data, const occasion& x) {
  const auto message = decode_dead_host(data);
  if (!message || message->host != header.source) {
    ++on_.own.counters.malformed;
    return;
  }
  switch (message->why) {
  case dead_host_message::reason::message:
    break;
  case dead_host_message::reason::route:
    if (header.type == package_type::broadcast) {
      on_.removal.remove(message->host, dead_host_message::reason::message, x);
    } else { // it has given us up, but it is there: both begin anew (peis-wire.md 11)
      on_.presence.forget(message->host, x);
      if (on_.routes.reachable(message->host))
        on_.inquiry.note_stranger(message->host, x.now);
    }
    break;
  case dead_host_message::reason::reborn:
    x.out.push_back(forgotten_by{message->host});
    on_.exchange.trigger(x.now); // if it took another one for us, this shows who lives
    break;
  }
}

void incarnations::on_announcement(byte_view octets, std::optional<ipv4_address> from,
                                   const occasion& x) {
  const auto news = decode_announcement(octets);
  if (!news) {
    ++on_.own.counters.malformed;
    return;
  }
  const auto& own = on_.own;
  if (news->version != protocol_version || news->network != own.config.network || own.left)
    return;
  if (news->sender.id != own.self.id)
    note_sender(news->sender, from, x);
  else if (news->sender.magic != own.self.magic)
    on_.duplicates.note_duplicate(news->sender, x);
}

void incarnations::note_sender(const host_record& sender, std::optional<ipv4_address> from,
                               const occasion& x) {
  if (on_.duplicates.is_away())
    return;
  ++on_.own.counters.announcements_received;
  if (on_.hosts.is_here(sender) && sender.id < on_.own.self.id)
    on_.announcements.on_better_announcer();
  const auto* last = on_.hosts.find(sender.id);
  const bool is_new = last == nullptr;
  const bool is_back = !is_new && last->record.magic != sender.magic;
  const bool has_moved = !is_new && last->record.addresses != sender.addresses;
  if (is_back) {
    if (on_.routes.reachable(sender.id))
      return; // a route, or its own word, shows which of the two is there
    on_.removal.supersede(sender.id, last->record.magic, x);
  }
  auto* known = on_.hosts.admit(sender.id, x);
  if (known == nullptr)
    return;
  const bool is_news = (is_new || is_back || has_moved) && !on_.routes.reachable(sender.id);
  if (is_news)
    known->announcer = from;
  if (is_back)
    // As one that was lost, it is not left to others to connect to, and at once.
    known->lost = x.now - host_entry::reroute_time;
  if (has_moved && is_news)
    on_.contacts.forget(sender.id); // tried in vain where it was
  if (on_.dials.may_dial_none(sender))
    ++on_.own.counters.announcements_foreign;
  known->last_record = known->own_word = x.now;
  known->record = sender;
  on_.hosts.recall(*known);
  if (is_news)
    on_.matches.hasten_merge(x.now);
}

} // namespace rubicon::peis
