// The part of the builder that follows octets over serial lines.
#include <algorithm>

#include "explain/builder.hpp"

namespace rubicon::explain {

namespace {

/// Writes of which nothing has been heard for so many others are lost.
constexpr std::size_t under_way_max = 64;

} // namespace

void builder::on_serial_write(const record& r) {
  const auto who = all_.known.address_of(r.from);
  if (!who)
    return;
  const bool to_mote = r.count == 1;
  auto& line = lines_[r.to];
  line_write write{r.octets, no_node, 0, 0};
  const auto content = serial_content_of(r.octets, to_mote);
  const auto what = content && content->part
                        ? recognise(*content->part, medium::serial, who->island, r)
                        : std::nullopt;
  if (what) {
    write.piece = content->part->part.index;
    const auto sequence = content->sequence + 1U; // 0 stands for none
    const crossing way{*what, medium::serial, r.from,
                       to_mote ? all_.known.path_of({who->island, all_.known.sink_of(who->island)})
                               : all_.known.gateway_at(r.to, who->island)};
    write.hop = last_hop(way);
    if (write.hop != no_node) {
      const auto& sent = pieces_[write.hop];
      const auto same = sent.find(write.piece);
      const bool is_repeat = content->type == serial::frame_type::packet_with_ack &&
                             same != sent.end() && same->second.sequence == sequence;
      if (same != sent.end() && !is_repeat)
        write.hop = no_node;
    }
    if (write.hop == no_node) {
      write.hop = begin_hop(way, r);
      at(write.hop).pieces = content->part->part.last + 1U;
    }
    pieces_[write.hop][write.piece].sequence = sequence;
    auto& attempts = at(write.hop).attempts;
    write.attempt = attempts.size();
    attempts.push_back({r.time, line.unplugged ? "cable unplugged" : "", false});
  }
  if (line.unplugged)
    return;
  auto& under_way = line.under_way[to_mote ? 1 : 0];
  if (under_way.size() >= under_way_max)
    under_way.pop_front();
  under_way.push_back(std::move(write));
}

/// What a line carries stays in order; what was written before and has not come is lost.
void builder::on_serial_octets(const record& r) {
  const auto who = all_.known.address_of(r.to);
  if (!who)
    return;
  auto& under_way = lines_[r.from].under_way[who->mote == no_mote ? 0 : 1];
  auto found = std::ranges::find(under_way, r.octets, &line_write::octets);
  const bool is_whole = found != under_way.end();
  if (!is_whole)
    found = std::ranges::find_if(
        under_way, [&](const line_write& x) { return x.octets.size() >= r.octets.size(); });
  if (found == under_way.end())
    return;
  const auto tell = [&](const line_write& x, const char* fate) {
    if (x.hop != no_node)
      at(x.hop).attempts[x.attempt].fate = fate;
  };
  std::for_each(under_way.begin(), found,
                [&](const line_write& x) { tell(x, "lost on the line"); });
  if (!is_whole) {
    tell(*found, found->octets.size() == r.octets.size() ? "octets corrupted" : "octets lost");
  } else if (r.unheard) {
    tell(*found, "the receiver had ended");
  } else if (found->hop != no_node) {
    tell(*found, "delivered");
    at(found->hop).attempts[found->attempt].arrived = true;
    arrive_piece(found->hop, found->piece, r.to, r);
  }
  under_way.erase(under_way.begin(), found + 1);
}

void builder::on_plug(const record& r) {
  auto& line = lines_[r.to];
  line.unplugged = !r.yes;
  if (r.yes)
    return;
  for (auto& under_way : line.under_way) {
    for (const auto& x : under_way)
      if (x.hop != no_node)
        at(x.hop).attempts[x.attempt].fate = "cable unplugged";
    under_way.clear();
  }
}

} // namespace rubicon::explain
