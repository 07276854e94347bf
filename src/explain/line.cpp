#include <algorithm>

#include "explain/media.hpp"

namespace rubicon::explain {

namespace {

/// Writes of which nothing has been heard for so many others are lost.
constexpr std::size_t under_way_max = 64;

} // namespace

void line_follower::on_write(const record& r) {
  const auto who = all_.all.known.address_of(r.from);
  if (!who)
    return;
  const bool to_mote = r.count == 1;
  auto& line = lines_[r.to];
  written write{r.number, r.octets};
  const auto part = serial_part_of(r.octets, to_mote);
  const auto what = part ? messages_.recognise(*part, r.cause, who->island, r) : std::nullopt;
  if (what) {
    const auto& known = all_.all.known;
    write.piece = part->part.index;
    write.hop = all_.hop_for({*what, medium::serial, r.from,
                              to_mote ? known.path_of({who->island, known.sink_of(who->island)})
                                      : known.gateway_at(r.to, who->island),
                              any_peer, part->part.last + 1U},
                             r.cause, r);
    auto& attempts = all_.at(write.hop).attempts;
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

void line_follower::tell(const written& x, const char* outcome) {
  if (x.hop != no_node)
    all_.at(x.hop).attempts[x.attempt].outcome = outcome;
}

void line_follower::on_octets(const record& r) {
  const auto who = all_.all.known.address_of(r.to);
  if (!who)
    return;
  auto& under_way = lines_[r.from].under_way[who->mote == no_mote ? 0 : 1];
  const auto found = std::ranges::find(under_way, r.cause, &written::number);
  if (found == under_way.end())
    return;
  std::for_each(under_way.begin(), found,
                [this](const written& x) { tell(x, "lost on the line"); });
  if (found->octets != r.octets) {
    tell(*found, found->octets.size() == r.octets.size() ? "octets corrupted" : "octets lost");
  } else if (r.unheard) {
    tell(*found, "the receiver had ended");
  } else if (found->hop != no_node) {
    tell(*found, "delivered");
    all_.at(found->hop).attempts[found->attempt].arrived = true;
    all_.arrive(found->hop, found->piece, r.to, r);
  }
  under_way.erase(under_way.begin(), found + 1);
}

void line_follower::on_plug(const record& r) {
  auto& line = lines_[r.to];
  line.unplugged = !r.yes;
  if (r.yes)
    return;
  for (auto& under_way : line.under_way) {
    for (const auto& x : under_way)
      tell(x, "cable unplugged");
    under_way.clear();
  }
}

} // namespace rubicon::explain
