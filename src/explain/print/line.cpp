#include <algorithm>

#include "explain/media.hpp"

namespace rubicon::explain {

namespace {

/// A write that has not arrived when so many others have followed is lost.
constexpr std::size_t in_flight_max = 64;

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
    write.fragment = part->part.index;
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
  auto& in_flight = line.in_flight[to_mote ? 1 : 0];
  if (in_flight.size() >= in_flight_max)
    in_flight.pop_front();
  in_flight.push_back(std::move(write));
}

void line_follower::set_outcome(const written& x, const char* outcome) {
  if (x.hop != no_node)
    all_.at(x.hop).attempts[x.attempt].outcome = outcome;
}

void line_follower::on_octets(const record& r) {
  const auto who = all_.all.known.address_of(r.to);
  if (!who)
    return;
  auto& in_flight = lines_[r.from].in_flight[who->mote == no_mote ? 0 : 1];
  const auto found = std::ranges::find(in_flight, r.cause, &written::number);
  if (found == in_flight.end())
    return;
  std::for_each(in_flight.begin(), found,
                [this](const written& x) { set_outcome(x, "lost on the line"); });
  if (found->octets != r.octets) {
    set_outcome(*found,
                found->octets.size() == r.octets.size() ? "octets corrupted" : "octets lost");
  } else if (r.unheard) {
    set_outcome(*found, "the receiver had ended");
  } else if (found->hop != no_node) {
    set_outcome(*found, "delivered");
    all_.at(found->hop).attempts[found->attempt].arrived = true;
    all_.arrive(found->hop, found->fragment, r.to, r);
  }
  in_flight.erase(in_flight.begin(), found + 1);
}

void line_follower::on_plug(const record& r) {
  auto& line = lines_[r.to];
  line.unplugged = !r.yes;
  if (r.yes)
    return;
  for (auto& in_flight : line.in_flight) {
    for (const auto& x : in_flight)
      set_outcome(x, "cable unplugged");
    in_flight.clear();
  }
}

} // namespace rubicon::explain
