#include <algorithm>

#include "explain/media.hpp"

namespace rubicon::explain {

namespace {

/// The longest queue that a file may give a backbone.
constexpr std::size_t packets_max = 4096;

constexpr std::string_view kind_of_path = "backbone";

} // namespace

void backbone_follower::on_write(const record& r) {
  const auto who = all_.all.known.address_of(r.from);
  if (!who || !r.to.starts_with(kind_of_path))
    return;
  const bool to_further = r.count == 1;
  auto& link = links_[r.to];
  written write;
  write.number = r.number;
  std::uint32_t fragments = 1;
  if (const auto what = air_.recognise(r, *who, write.fragment, fragments)) {
    const auto& known = all_.all.known;
    const auto to = to_further ? "mote" + r.to.substr(kind_of_path.size())
                               : known.path_of({who->island, known.sink_of(who->island)});
    write.hop =
        all_.hop_for({*what, medium::backbone, r.from, to, any_peer, fragments}, r.cause, r);
    auto& attempts = all_.at(write.hop).attempts;
    write.attempt = attempts.size();
    attempts.push_back({r.time, link.is_cut ? "backbone cut" : "", false});
  }
  if (link.is_cut)
    return;
  auto& in_flight = link.in_flight[to_further ? 1 : 0];
  if (in_flight.size() >= packets_max)
    in_flight.pop_front();
  in_flight.push_back(write);
}

void backbone_follower::lose(const written& x, const char* why) {
  if (x.hop == no_node)
    return;
  auto& outcome = all_.at(x.hop).attempts[x.attempt].outcome;
  if (outcome.empty())
    outcome = why;
}

void backbone_follower::on_received(const record& r) {
  const auto who = all_.all.known.address_of(r.to);
  if (!who)
    return;
  const bool to_further = who->mote != all_.all.known.sink_of(who->island);
  auto& in_flight = links_[r.from].in_flight[to_further ? 1 : 0];
  const auto found = std::ranges::find(in_flight, r.cause, &written::number);
  if (found == in_flight.end())
    return;
  std::for_each(in_flight.begin(), found,
                [this](const written& x) { lose(x, "lost on the backbone"); });
  if (r.unheard) {
    lose(*found, "the receiver had ended");
  } else if (found->hop != no_node) {
    auto& attempt = all_.at(found->hop).attempts[found->attempt];
    attempt.outcome = "delivered";
    attempt.arrived = true;
    all_.arrive(found->hop, found->fragment, r.to, r);
  }
  in_flight.erase(in_flight.begin(), found + 1);
}

void backbone_follower::on_plug(const record& r) {
  auto& link = links_[r.to];
  link.is_cut = !r.yes;
  if (r.yes)
    return;
  for (const auto& in_flight : link.in_flight) // what arrives at this moment is yet to be recorded
    for (const auto& x : in_flight)
      lose(x, "backbone cut");
}

} // namespace rubicon::explain
