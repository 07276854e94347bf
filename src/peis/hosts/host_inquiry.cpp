#include "peis/hosts/host_inquiry.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>

#include "peis/wire/host_query.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t questions_at_once = 64; ///< of one occasion

} // namespace

host_inquiry::host_inquiry(own_peer& own, link_table& links, const overlay& routes,
                           const host_table& hosts, package_sender& sender,
                           message_delivery& messages)
    : own_(own), links_(links), overlay_(routes), hosts_(hosts), sender_(sender),
      messages_(messages), strangers_(own.config.routing_period),
      rate_(own.config.tables.questions_per_second, 1s, 1s) {}

void host_inquiry::note_stranger(peer_id id, instant now) {
  strangers_.note(id, hosts_.find(id) != nullptr, now);
}

void host_inquiry::review(instant now) {
  for (const auto& [id, way] : overlay_.routes().routes()) {
    if (way.lost())
      continue;
    if (!hosts_.knows_present(id))
      note_stranger(id, now);
    else
      strangers_.forget(id);
  }
}

void host_inquiry::ask_due(instant now) {
  for (std::size_t i = 0; i < questions_at_once; ++i) {
    const auto next = strangers_.next();
    if (!next || next->first > now || rate_.free_at() > now || own_.left)
      return;
    const auto id = next->second;
    if (hosts_.knows_present(id) || !overlay_.reachable(id)) {
      strangers_.forget(id);
      continue;
    }
    ask_about(strangers_.ask(id, now));
    rate_.take(1, now);
  }
}

/// The first question is for all hosts on the route. Where caches mislead, the incarnation itself
/// is asked for: by its magic number, which a real kernel on the route passes on (but does not
/// answer either), and in a message of one fragment, which no host on the route looks into.
void host_inquiry::ask_about(const stranger_table::question& x) {
  if (!x.misled || x.before % 2 == 1)
    ask(x.host, any_magic, false);
  if (!x.misled && x.before == 0)
    return;
  if (const auto* way = overlay_.routes().find(x.host))
    ask(x.host, way->magic, false);
  ask(x.host, any_magic, true);
}

/// A link to an earlier incarnation may still seem to be there: the route is tried beside it.
void host_inquiry::ask(peer_id id, std::int32_t magic, bool sealed) {
  const auto content = std::make_shared<const message_octets>(
      message_octets{encode(host_query{own_.self.id, magic}), {}});
  const auto direct = overlay_.next_hop(id);
  const auto routed = overlay_.routes().way_to(id);
  for (const auto& hop : {direct, routed == direct ? std::nullopt : routed}) {
    if (!hop)
      continue;
    auto header = own_.fresh_header(package_type::direct, port::host_query);
    header.destination = id;
    if (sealed) {
      header.flags = package_flag::bulk;
      header.seqlen = 1;
      header.seqid = own_.ids.next_group();
    }
    sender_.send(links_.at(*hop), lane::high, {header, content, 0}, own_origin);
  }
}

bool host_inquiry::answer(link_id from, const package_header& header, byte_view data, events& out) {
  const auto query = decode_host_query(data);
  if (!query) {
    ++own_.counters.malformed;
    return false;
  }
  const bool about_me = header.destination == own_.self.id;
  if (!about_me && !hosts_.knows_present(header.destination))
    return false;
  const auto& record = *hosts_.record_of(header.destination);
  if (!about_me && query->magic != any_magic && query->magic != record.magic)
    return false;
  if (!messages_.may_answer(from)) {
    ++own_.counters.questions_refused;
    return about_me;
  }
  messages_.send({header.source,
                  port::host_record,
                  {encode(host_record_message{record, !about_me}), {}},
                  true,
                  priority::high,
                  no_request,
                  from},
                 from, out);
  return true;
}

std::optional<instant> host_inquiry::deadline() const {
  const auto question = strangers_.next();
  return question ? std::optional(std::max(question->first, rate_.free_at())) : std::nullopt;
}

} // namespace rubicon::peis
