// The part of the builder that follows tuples, and packages between PEIS kernels.
#include <algorithm>

#include "explain/builder.hpp"
#include "peis/key.hpp"

namespace rubicon::explain {

namespace {

/// Of messages between gateways and PCs (D1.1 5.4).
constexpr std::uint16_t island_message_port = 21;

std::string folded(std::string_view key) {
  std::string x(key);
  for (auto& c : x)
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
  return x;
}

/// As components see it: text without its trailing NUL.
bytes shown(const peis::tuple& x) {
  return x.form == peis::encoding::text ? to_bytes(x.text()) : to_bytes(x.value.view());
}

} // namespace

// ------------------------------------------------------------------------------------- components

std::uint32_t builder::begin_tuple(tuple_value x, step how, const record& r) {
  const auto index = static_cast<std::uint32_t>(all_.tuples.size());
  by_key_[folded(x.key)].push_back(index);
  node root;
  root.what = how;
  root.about = {true, index};
  root.from = x.writer;
  root.to = r.to;
  root.begin = r.time;
  root.arrived = r.time;
  if (how == step::sets)
    x.set = r.time;
  all_.tuples.push_back(std::move(x));
  const auto n = add(std::move(root), caused(r.cause));
  all_.tuples[index].root = n;
  if (how == step::sets)
    all_.tuples[index].at_owner = n;
  return index;
}

void builder::on_set(const record& r, bool deleted) {
  const auto owner = all_.known.peer_of(r.to);
  if (!owner)
    return;
  tuple_value x;
  x.owner = *owner;
  x.key = r.text;
  x.value = r.octets;
  x.is_text = r.yes;
  x.is_deletion = deleted;
  x.writer = r.from;
  static_cast<void>(begin_tuple(std::move(x), step::sets, r));
}

void builder::on_set_remote(const record& r) {
  const auto here = all_.known.peer_of(r.to);
  if (!here)
    return;
  tuple_value x;
  x.owner = peer_id(r.peer);
  x.key = r.text;
  x.value = r.octets;
  x.is_text = r.yes;
  x.writer = r.from;
  const auto index = begin_tuple(std::move(x), step::asks, r);
  asked_[{r.from, r.id}].push_back({r.number, {true, index}, peer_id(r.peer)});
  if (all_.tuples[index].owner == *here)
    reach_owner(index, r.to, all_.tuples[index].root, r);
}

/// A value that somebody else has asked for is now the tuple's.
void builder::reach_owner(std::uint32_t index, const std::string& actor, node_index parent,
                          const record& r) {
  if (all_.tuples[index].set)
    return;
  node x;
  x.what = step::sets;
  x.about = {true, index};
  x.from = actor;
  x.to = actor;
  x.begin = r.time;
  x.arrived = r.time;
  const auto n = add(std::move(x), parent);
  all_.tuples[index].set = r.time;
  all_.tuples[index].at_owner = n;
}

bool builder::was_at(const tuple_value& x, const std::string& peer) const {
  return all_.known.peer_of(peer) == x.owner || std::ranges::any_of(x.nodes, [&](node_index n) {
           const auto& y = all_.nodes[n];
           return y.what == step::hop && y.to == peer && y.arrived;
         });
}

void builder::on_event(const record& r) {
  all_.last_told[r.to] = r.time;
  const auto known = by_key_.find(folded(r.text));
  if (known == by_key_.end())
    return;
  const auto fits = [&](std::uint32_t index) {
    const auto& x = all_.tuples[index];
    return x.set && x.owner.value == r.peer && x.is_deletion == r.yes &&
           (r.yes || x.value == r.octets);
  };
  const auto& all = known->second;
  auto found = std::ranges::find_if(all.rbegin(), all.rend(), [&](std::uint32_t index) {
    return fits(index) && was_at(all_.tuples[index], r.from);
  });
  if (found == all.rend())
    found = std::ranges::find_if(all.rbegin(), all.rend(), fits);
  if (found == all.rend())
    return;
  node x;
  x.what = step::hears;
  x.about = {true, *found};
  x.from = r.to;
  x.begin = r.time;
  x.arrived = r.time;
  auto parent = last_at(x.about, r.from, cargo::content);
  if (parent == no_node || all_.known.peer_of(r.from) == all_.tuples[*found].owner)
    parent = all_.tuples[*found].at_owner;
  arrivals_[r.number].push_back(add(std::move(x), parent));
}

/// A component's message for another peer; a failure is told later.
void builder::on_send_peis(const record& r) {
  const auto here = all_.known.peer_of(r.to);
  const auto packet = here && r.channel == island_message_port
                          ? envelope_of(r.octets, all_.known.speaks_for(*here),
                                        all_.known.speaks_for(peer_id(r.peer)))
                          : std::nullopt;
  const auto what = packet ? recognise(*packet, r) : std::nullopt;
  if (what) { // its package is known by what led to it
    const auto here_now = last_at(what->about, r.from, what->of);
    arrivals_[r.number].push_back(here_now == no_node ? all_.messages[what->about.index].root
                                                      : here_now);
  }
  // what is no message has an outcome all the same
  const subject nothing{false, static_cast<std::uint32_t>(all_.messages.size())};
  asked_[{r.from, r.id}].push_back(
      {r.number, what ? what->about : nothing, peer_id(r.peer), what ? what->of : cargo::content});
}

/// Of several with one token, the one that the kernel was just asked for, or else the oldest.
void builder::on_outcome(const record& r) {
  const auto open = asked_.find({r.to, r.id});
  if (open == asked_.end() || open->second.empty())
    return;
  auto found = std::ranges::find(open->second, r.cause, &asked_entry::number);
  if (found == open->second.end())
    found = open->second.begin();
  const auto asked = *found;
  open->second.erase(found);
  if (r.yes || (!asked.about.is_tuple && asked.about.index >= all_.messages.size()))
    return;
  const auto to = names::kernel_path(all_.known.of(asked.to));
  const crossing way{{asked.about, asked.of}, medium::peis, r.from, to, asked.to};
  const bool got_there = last_at(asked.about, to, asked.of) != no_node;
  if (got_there) // its acknowledgement did not
    return;
  const auto hop = begin_hop(way, r);
  at(hop).from = all_.known.place_of(r.from);
  at(hop).failure = r.text;
}

void builder::on_story(const record& r) {
  all_.stories.push_back(r);
  const auto parent = caused(r.cause);
  const bool is_of_mote = r.from.starts_with("mote/") || r.from.starts_with("mote_app/");
  if (parent == no_node || !is_of_mote) // what components do, their tuples tell
    return;
  node x;
  x.what = step::acts;
  x.about = at(parent).about;
  x.from = r.from;
  x.begin = r.time;
  x.arrived = r.time;
  x.text = r.text;
  add(std::move(x), parent);
  // What is sent at that moment is sent because of it.
  auto& siblings = at(parent).children;
  const auto sent = std::ranges::find_if(siblings, [&](node_index each) {
    return at(each).what == step::sends && at(each).begin == r.time;
  });
  if (sent != siblings.end())
    std::rotate(sent, std::prev(siblings.end()), siblings.end());
}

// --------------------------------------------------------------------------------------- packages

void builder::on_packages(const record& r) {
  auto to = r.to;
  if (to.empty()) // lost: the link's other end
    for (const auto& end : link_ends_[r.id])
      if (end != r.from)
        to = end;
  for (const auto& x : packages_of(r.octets))
    on_package(x, to, r);
}

void builder::on_package(const carried_package& x, const std::string& to, const record& r) {
  const auto what = recognise(x, r);
  if (!what)
    return;
  const bool is_lost = r.what == kind::link_lost || r.unheard;
  const crossing way{*what, medium::peis, r.from, to, x.header.destination};
  auto hop = last_hop(way);
  if (hop == no_node) {
    hop = begin_hop(way, r);
    at(hop).pieces = std::max<std::uint32_t>(1, x.header.seqlen);
  }
  at(hop).attempts.push_back({r.time,
                              !is_lost               ? "delivered"
                              : r.unheard            ? "the peer had ended"
                              : r.text == "link_cut" ? "the link was cut"
                                                     : "lost on the link",
                              !is_lost});
  if (is_lost)
    return;
  const bool was_there = at(hop).arrived.has_value();
  arrive_piece(hop, x.header.seqnum, to, r);
  const auto about = what->about;
  if (!was_there && at(hop).arrived && about.is_tuple && x.header.port == peis::port::set &&
      all_.known.peer_of(to) == all_.tuples[about.index].owner)
    reach_owner(about.index, to, hop, r);
}

std::optional<builder::sighting> builder::recognise(const carried_package& x, const record& r) {
  const auto& header = x.header;
  const auto group = std::tuple(header.source.value, header.seqid, header.port);
  if (header.seqlen > 0 && header.seqnum > 0) {
    const auto known = fragments_.find(group);
    return known == fragments_.end() ? std::nullopt : std::optional(known->second);
  }
  std::optional<sighting> what;
  if (header.port == island_message_port) {
    if (const auto packet = envelope_of(x.data, all_.known.speaks_for(header.source),
                                        all_.known.speaks_for(header.destination)))
      what = recognise(*packet, r);
  } else if (const auto tuple = tuple_of(x)) {
    what = recognise(*tuple, header.port == peis::port::set, header.seqlen == 0, r);
  }
  if (what && header.seqlen > 0)
    fragments_[group] = *what;
  return what;
}

std::optional<builder::sighting> builder::recognise(const peis::tuple& x, bool is_set,
                                                    bool is_whole, const record& r) {
  const auto key = folded(x.name.text());
  const auto stamp =
      std::tuple(x.owner.value, key, x.seqno, x.written.seconds, x.written.microseconds);
  if (const auto known = stamped_.find(stamp); !is_set && known != stamped_.end())
    return sighting{{true, known->second}};
  const auto value = shown(x);
  const bool is_deletion = x.expiry == peis::deleted;
  const auto fits = [&](std::uint32_t index) {
    const auto& y = all_.tuples[index];
    if (y.owner != x.owner || y.is_deletion != is_deletion)
      return false;
    if (is_set ? all_.nodes[y.root].what != step::asks : !y.set)
      return false;
    return is_deletion || (is_whole ? y.value == value
                                    : y.value.size() >= value.size() &&
                                          std::equal(value.begin(), value.end(), y.value.begin()));
  };
  auto& all = by_key_[key];
  const auto newest = std::ranges::find_if(all.rbegin(), all.rend(), fits);
  std::uint32_t index = 0;
  if (newest != all.rend()) {
    index = *newest;
  } else { // a kernel's own, or from before the record
    if (all_.known.peer_of(r.from) != x.owner)
      return std::nullopt;
    tuple_value y;
    y.owner = x.owner;
    y.key = x.name.text();
    y.value = value;
    y.is_text = x.form == peis::encoding::text;
    y.is_deletion = is_deletion;
    y.writer = r.from;
    index = begin_tuple(std::move(y), step::sets, r);
  }
  if (!is_set)
    stamped_[stamp] = index;
  return sighting{{true, index}};
}

} // namespace rubicon::explain
