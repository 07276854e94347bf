#include "explain/tuples.hpp"

#include "peis/tuples/key.hpp"

namespace rubicon::explain {

namespace {

/// As components see it: text without its trailing NUL.
bytes shown(const peis::tuple& x) {
  return x.form == peis::encoding::text ? to_bytes(x.text()) : to_bytes(x.value.view());
}

} // namespace

std::uint32_t tuple_follower::begin(tuple_value x, step how, std::uint64_t number,
                                    const record& r) {
  const auto index = static_cast<std::uint32_t>(all_.all.tuples.size());
  node root;
  root.what = how;
  root.about = {true, index};
  root.from = x.writer;
  root.to = r.to;
  root.begin = r.time;
  root.arrived = r.time;
  if (how == step::sets)
    x.set = r.time;
  const auto parent = all_.step_of(number);
  all_.all.tuples.push_back(std::move(x));
  const auto n = all_.add(std::move(root), parent);
  all_.stands_for(number, n);
  all_.all.tuples[index].root = n;
  if (how == step::sets)
    all_.all.tuples[index].at_owner = n;
  return index;
}

void tuple_follower::on_set(const record& r, bool deleted) {
  const auto owner = all_.all.known.peer_of(r.to);
  if (!owner)
    return;
  tuple_value x;
  x.owner = *owner;
  x.key = r.text;
  x.value = r.octets;
  x.is_text = r.yes;
  x.is_deletion = deleted;
  x.writer = r.from;
  static_cast<void>(begin(std::move(x), step::sets, r.number, r));
}

std::optional<sighting> tuple_follower::on_set_remote(const record& r) {
  const auto here = all_.all.known.peer_of(r.to);
  if (!here)
    return std::nullopt;
  tuple_value x;
  x.owner = peer_id(r.peer);
  x.key = r.text;
  x.value = r.octets;
  x.is_text = r.yes;
  x.writer = r.from;
  const auto index = begin(std::move(x), step::asks, r.number, r);
  if (all_.all.tuples[index].owner == *here)
    all_.stands_for(r.number, reach_owner(index, r.to, all_.all.tuples[index].root, r.time));
  return sighting{{true, index}};
}

node_index tuple_follower::reach_owner(std::uint32_t index, const std::string& actor,
                                       node_index parent, instant when) {
  if (all_.all.tuples[index].set)
    return all_.all.tuples[index].at_owner;
  node x;
  x.what = step::sets;
  x.about = {true, index};
  x.from = actor;
  x.to = actor;
  x.begin = when;
  x.arrived = when;
  const auto n = all_.add(std::move(x), parent);
  all_.all.tuples[index].set = when;
  all_.all.tuples[index].at_owner = n;
  return n;
}

void tuple_follower::on_event(const record& r) {
  all_.all.last_notified[r.to] = r.time;
  const auto parent = all_.step_of(r.cause);
  if (parent == no_node || !all_.at(parent).about.is_tuple)
    return;
  node x;
  x.what = step::notified;
  x.about = all_.at(parent).about;
  x.from = r.to;
  x.begin = r.time;
  x.arrived = r.time;
  all_.stands_for(r.number, all_.add(std::move(x), parent));
}

std::optional<sighting> tuple_follower::recognise(const std::optional<peis::tuple>& x,
                                                  std::uint64_t cause, const record& r) {
  const auto begun = all_.begun(cause, "value");
  const auto n = all_.step_of(cause);
  if (begun == 0 && n != no_node && all_.at(n).about.is_tuple)
    return sighting{all_.at(n).about};
  if (begun == 0 || !x)
    return std::nullopt;
  tuple_value y; // a kernel's own
  y.owner = x->owner;
  y.key = x->name.text();
  y.value = shown(*x);
  y.is_text = x->form == peis::encoding::text;
  y.is_deletion = x->expiry == peis::deleted;
  y.writer = r.from;
  return sighting{{true, begin(std::move(y), step::sets, begun, r)}};
}

} // namespace rubicon::explain
