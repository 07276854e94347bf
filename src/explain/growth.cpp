#include "explain/growth.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::explain {

namespace {

/// Hops with the same step before them, or in the same attempt of Transport, are one.
constexpr std::uint64_t first_attempt = 1ULL << 63U;

} // namespace

instant node::time() const {
  if (arrived)
    return *arrived;
  return attempts.empty() ? begin : std::max(begin, attempts.back().begin);
}

growth::growth(const header& about) {
  all.about = about;
  all.known = names(about);
}

void growth::note(const record& r) {
  all.end = std::max(all.end, r.time);
  if (r.number != 0)
    origins_[r.number] = {r.cause < r.number ? r.cause : 0, r.what == kind::begun ? r.text : ""};
}

node_index growth::step_of(std::uint64_t number) const {
  while (number != 0) {
    if (const auto step = steps_.find(number); step != steps_.end())
      return step->second;
    const auto from = origins_.find(number);
    number = from == origins_.end() ? 0 : from->second.cause;
  }
  return no_node;
}

node_index growth::own_step_of(std::uint64_t number) const {
  const auto step = steps_.find(number);
  return step == steps_.end() ? no_node : step->second;
}

std::uint64_t growth::begun(std::uint64_t number, std::string_view what) const {
  while (number != 0 && !steps_.contains(number)) {
    const auto from = origins_.find(number);
    if (from == origins_.end())
      return 0;
    if (from->second.begun == what)
      return number;
    number = from->second.cause;
  }
  return 0;
}

std::vector<node_index>& growth::nodes_of(subject x) {
  return x.is_tuple ? all.tuples[x.index].nodes : all.messages[x.index].nodes;
}

node_index growth::add(node x, node_index parent) {
  const auto n = static_cast<node_index>(all.nodes.size());
  x.parent = parent;
  nodes_of(x.about).push_back(n);
  if (parent != no_node)
    at(parent).children.push_back(n);
  all.nodes.push_back(std::move(x));
  return n;
}

node_index growth::hop_for(const crossing& x, std::uint64_t cause, const record& r) {
  const auto about = x.what.about;
  const auto attempt = begun(cause, "attempt");
  auto parent = step_of(cause);
  while (parent != no_node && at(parent).what == step::receives) // who has got it does not carry it
    parent = at(parent).parent;
  if (parent == no_node || at(parent).about != about)
    parent = about.is_tuple ? all.tuples[about.index].root : all.messages[about.index].root;
  const hop_key key{
      attempt != 0 ? first_attempt | attempt : parent, x.over, x.what.of, x.from, x.to, x.towards};
  if (const auto known = hops_.find(key); known != hops_.end())
    return known->second;
  node hop;
  hop.what = step::hop;
  hop.about = about;
  hop.over = x.over;
  hop.of = x.what.of;
  hop.from = x.from;
  hop.to = x.to;
  hop.towards = x.towards;
  hop.begin = r.time;
  hop.text = x.what.kind;
  hop.fragments = x.fragments;
  if (!about.is_tuple && x.what.of == cargo::content) {
    auto& m = all.messages[about.index];
    if (parent == m.root)
      ++m.sends;
    if (m.is_on_channel) // not there yet: it goes on
      m.delivered.reset();
  }
  return hops_[key] = add(std::move(hop), parent);
}

void growth::arrive(node_index n, std::uint32_t fragment, const std::string& actor,
                    const record& r) {
  stands_for(r.number, n);
  auto& fragments = fragments_[n];
  fragments[fragment] = true;
  auto& x = at(n);
  if (fragments.size() < x.fragments)
    return;
  if (x.to.empty() && std::ranges::find(x.receivers, actor) == x.receivers.end())
    x.receivers.push_back(actor);
  if (!x.arrived)
    x.arrived = r.time;
  deliver(x, actor, r.time);
}

/// A hop of a message has reached somebody: is it at its end?
void growth::deliver(const node& x, const std::string& actor, instant when) {
  if (x.about.is_tuple)
    return;
  auto& m = all.messages[x.about.index];
  const auto kernel = all.known.peer_of(actor);
  const auto who =
      kernel ? std::optional(mote_address{
                   island_id(static_cast<std::uint32_t>(all.known.speaks_for(*kernel).value)),
                   no_mote})
             : all.known.address_of(actor);
  if (!who)
    return;
  if (x.of == cargo::answer) {
    if (*who == m.source && x.text == "acknowledgement" && !m.acknowledged)
      m.acknowledged = when;
  } else if (x.of == cargo::content) {
    if (m.is_on_channel) // as far as it has come
      m.destination = *who;
    const bool is_there = m.is_on_channel || *who == m.destination ||
                          (m.destination.mote == broadcast_mote &&
                           who->island == m.destination.island && x.receivers.size() == 1);
    if (is_there && !m.delivered)
      m.delivered = when;
  }
}

} // namespace rubicon::explain
