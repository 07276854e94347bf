#include "peis/p2p/introductions.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

namespace rubicon::peis {

void introductions::on_record(link_id from, const package_header& header, byte_view data,
                              const occasion& x) {
  const auto message = decode_host_record_message(data);
  if (!message || (!message->cached && message->record.id != header.source)) {
    ++on_.own.counters.malformed;
    return;
  }
  const auto& record = message->record;
  const bool is_own_word = header.hops == 1 && !message->cached;
  auto& link = on_.links.at(from);
  if (link.tried_here && link.tried_for && is_own_word && record.id != *link.tried_for)
    on_.presence.note_elsewhere(*link.tried_for, x);
  if (record.id != on_.own.self.id) {
    introduce(from, header, *message, x);
  } else if (record.magic != on_.own.self.magic) {
    link.rivals = true;
    on_.duplicates.note_duplicate(record, x);
  }
}

/// What a record leads to may close the link that it came over.
void introductions::introduce(link_id from, const package_header& header,
                              const host_record_message& message, const occasion& x) {
  const auto& record = message.record;
  const bool is_own_word = header.hops == 1 && !message.cached;
  auto& link = on_.links.at(from);
  if (!message.cached && header.type != package_type::broadcast)
    on_.guard.notify_rivals(from, record);
  if (is_own_word && on_.guard.refuse_rival(link, record, x))
    return;
  on_.dials.on_record(link, record, is_own_word, message.cached, x.now);
  const bool is_neighbour = is_own_word && link.neighbour.value_or(record.id) == record.id;
  if (on_.own.config.connections.leaf && is_neighbour && !on_.hosts.is_here(record) &&
      !on_.dials.standing_of(from)) {
    on_.records.on_record(message, x);
    ++on_.own.counters.links_refused;
    on_.closer.close(from, close_cause::leaf, x);
    return;
  }
  const bool meets_original =
      is_neighbour && !record.marked && !on_.links.has_named_link(record.id);
  if (is_neighbour)
    name(link, record, x);
  on_.records.on_record(message, x);
  if (!on_.links.contains(from))
    return;
  if (meets_original)
    show_ourselves(link, x);
  else if (!message.cached)
    note_beyond(from, header, record, x);
}

void introductions::name(connection& x, const host_record& record, const occasion& at) {
  const auto& config = on_.own.config;
  x.cost = on_.hosts.is_here(record) ? config.cost_same_host : config.cost_other_host;
  x.magic = record.magic;
  x.named = true;
  if (!record.marked)
    on_.writer.pace(x, at.out);
  on_.greeting.bind(x, record.id, at);
}

/// A real kernel that we were away from announces us to its other neighbours within 10 s. What we
/// broadcast over it, they receive at once.
void introductions::show_ourselves(connection& to, const occasion& x) {
  auto content = std::make_shared<const message_octets>(
      message_octets{encode(host_record_message{on_.own.self, false}), {}});
  on_.sender.send(
      to, lane::high,
      {on_.own.fresh_header(package_type::broadcast, port::host_record), std::move(content), 0},
      x.origin);
}

/// The same, seen from there: a host of our kind speaks over a real kernel, whose routes do not
/// have it yet.
void introductions::note_beyond(link_id from, const package_header& header,
                                const host_record& record, const occasion& x) {
  if (header.type != package_type::broadcast || !record.marked || on_.routes.reachable(record.id) ||
      !on_.health.can_be_suspected(on_.links.at(from)))
    return;
  const auto& config = on_.own.config;
  const auto hops = std::min(header.hops, config.metric_limit) * config.cost_other_host;
  on_.presence.apply(on_.routes.routes().on_heard(from, record.id, record.magic,
                                                  static_cast<std::uint8_t>(hops), x.now),
                     x);
}

} // namespace rubicon::peis
