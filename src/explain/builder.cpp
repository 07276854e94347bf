#include "explain/builder.hpp"

#include <algorithm>

namespace rubicon::explain {

instant node::time() const {
  if (arrived)
    return *arrived;
  return attempts.empty() ? begin : std::max(begin, attempts.back().begin);
}

builder::builder(const recording& x) {
  all_.about = x.about;
  all_.known = names(x.about);
  all_.cut_off = x.cut_off;
}

void builder::take(const record& r) {
  now_ = std::max(now_, r.time);
  if (r.number != 0)
    causes_[r.number] = r.cause;
  const bool is_hop = r.what == kind::serial_octets || r.what == kind::link_octets;
  if (r.unheard && !is_hop) // nobody makes anything of it
    return;
  switch (r.what) {
  case kind::radio_send:
    return on_radio_send(r);
  case kind::radio_done:
    return on_radio_done(r);
  case kind::frame:
    return on_frame(r);
  case kind::frame_received:
    return on_frame_received(r);
  case kind::serial_write:
    return on_serial_write(r);
  case kind::serial_octets:
    return on_serial_octets(r);
  case kind::plug_serial:
    return on_plug(r);
  case kind::link_opened:
    link_ends_[r.id].push_back(r.to);
    return;
  case kind::link_octets:
  case kind::link_lost:
    return on_packages(r);
  case kind::set_tuple:
    return on_set(r, false);
  case kind::delete_tuple:
    return on_set(r, true);
  case kind::set_remote_tuple:
    return on_set_remote(r);
  case kind::tuple_event:
    return on_event(r);
  case kind::watch_tuples:
    all_.watchers.push_back({r.from, r.peer, r.text, r.time});
    return;
  case kind::send_peis_message:
    return on_send_peis(r);
  case kind::peis_outcome:
    return on_outcome(r);
  case kind::send_message:
    return on_send(r);
  case kind::message_received:
    return on_message(r);
  case kind::send_ended:
    return on_send_ended(r);
  case kind::actuator_changed:
    return; // its story tells more
  case kind::story:
    return on_story(r);
  }
}

journeys builder::finish() {
  all_.end = now_;
  return std::move(all_);
}

std::vector<node_index>& builder::nodes_of(subject x) {
  return x.is_tuple ? all_.tuples[x.index].nodes : all_.messages[x.index].nodes;
}

/// What arrived with the record that led to another one: with it, or with what led to it.
node_index builder::caused(std::uint64_t cause) const {
  while (cause != 0) {
    const auto arrived = arrivals_.find(cause);
    if (arrived != arrivals_.end())
      return arrived->second.back();
    const auto before = causes_.find(cause);
    if (before == causes_.end() || before->second >= cause)
      break;
    cause = before->second;
  }
  return no_node;
}

node_index builder::add(node x, node_index parent) {
  const auto n = static_cast<node_index>(all_.nodes.size());
  x.parent = parent;
  nodes_of(x.about).push_back(n);
  if (parent != no_node)
    at(parent).children.push_back(n);
  all_.nodes.push_back(std::move(x));
  return n;
}

/// @param towards of packages: those for another peer do not count; any_peer: all do
node_index builder::last_at(subject x, const std::string& actor, cargo of, peer_id towards) const {
  const auto place = all_.known.place_of(actor);
  const auto& nodes = x.is_tuple ? all_.tuples[x.index].nodes : all_.messages[x.index].nodes;
  const auto is_there = [&](node_index n) {
    const auto& y = all_.nodes[n];
    if (y.what != step::hop || y.of != of || !y.arrived ||
        (towards != any_peer && y.towards != towards))
      return false;
    return all_.known.place_of(y.to) == place || std::ranges::find(y.heard, actor) != y.heard.end();
  };
  const auto found = std::ranges::find_if(nodes.rbegin(), nodes.rend(), is_there);
  return found == nodes.rend() ? no_node : *found;
}

node_index builder::last_hop(const crossing& x) const {
  const auto& all = x.what.about.is_tuple ? all_.tuples[x.what.about.index].nodes
                                          : all_.messages[x.what.about.index].nodes;
  const auto is_it = [&](node_index n) {
    const auto& y = all_.nodes[n];
    return y.what == step::hop && y.over == x.over && y.of == x.what.of && y.from == x.from &&
           y.to == x.to && y.towards == x.towards && y.text == x.what.kind;
  };
  const auto found = std::ranges::find_if(all.rbegin(), all.rend(), is_it);
  return found == all.rend() ? no_node : *found;
}

/// It goes on from where it has come, or back from where what it answers has come.
node_index builder::begin_hop(const crossing& x, const record& r) {
  const auto about = x.what.about;
  auto parent = last_at(about, x.from, x.what.of, x.towards);
  if (parent == no_node)
    parent = last_at(about, x.from, x.what.of);
  if (about.is_tuple && all_.tuples[about.index].at_owner != no_node &&
      all_.known.peer_of(x.from) == all_.tuples[about.index].owner)
    parent = all_.tuples[about.index].at_owner;
  if (parent == no_node && x.what.of == cargo::answer)
    parent = last_at(about, x.from, cargo::content);
  if (parent == no_node && x.what.of == cargo::greeting_answer)
    parent = last_at(about, x.from, cargo::greeting);
  if (parent == no_node)
    parent = about.is_tuple ? all_.tuples[about.index].root : all_.messages[about.index].root;
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
  if (!about.is_tuple && x.what.of == cargo::content) {
    auto& m = all_.messages[about.index];
    if (parent == m.root)
      ++m.sends;
    if (m.is_on_channel) // not there yet: it goes on
      m.delivered.reset();
  }
  return add(std::move(hop), parent);
}

void builder::arrive(node_index n, const std::string& actor, const record& r) {
  auto& x = at(n);
  if (x.to.empty() && std::ranges::find(x.heard, actor) == x.heard.end())
    x.heard.push_back(actor);
  if (!x.arrived)
    x.arrived = r.time;
  deliver(x, actor, r.time);
}

/// One of the pieces of a hop is there.
void builder::arrive_piece(node_index n, std::uint32_t index, const std::string& actor,
                           const record& r) {
  arrivals_[r.number].push_back(n);
  auto& pieces = pieces_[n];
  pieces[index].arrived = true;
  const auto there = std::ranges::count_if(pieces, [](const auto& x) { return x.second.arrived; });
  if (static_cast<std::size_t>(there) >= at(n).pieces)
    arrive(n, actor, r);
}

journeys follow(const recording& x) {
  builder all(x);
  for (const auto& r : x.records)
    all.take(r);
  return all.finish();
}

} // namespace rubicon::explain
