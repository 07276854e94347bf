#include "config/plan/references.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "config/plan/uniqueness.hpp"
#include "core/text/spelling.hpp"
#include "peis/tuples/meta_tuple.hpp"

namespace rubicon::config {

namespace {

/// As many as a suggestion can make use of.
template <class Names>
std::vector<std::string> keys_of(const Names& names) {
  constexpr std::size_t keys_max = 2001;
  std::vector<std::string> out;
  for (const auto& each : names) {
    if (out.size() == keys_max)
      break;
    if constexpr (requires { each.first; })
      out.push_back(each.first);
    else
      out.push_back(each);
  }
  return out;
}

/// @param header of the table that describes one; empty: none does alone
std::nullopt_t unknown(const node& x, const asker& who, const std::string& what,
                       std::string_view name, const std::vector<std::string>& known,
                       const std::string& header = {}) {
  who.complain(x, "no " + what + " is named `" + std::string(name) + '`' + suggestion(name, known) +
                      (known.empty() && !header.empty() ? "; describe it under " + header : ""));
  return std::nullopt;
}

/// "island/mote", and "island/sink" if `sink_too`.
std::optional<mote_address> address_of(const node& x, const asker& who, const std::string& text,
                                       bool sink_too) {
  const auto slash = text.find('/');
  const auto island_part = text.substr(0, slash);
  const auto mote_part = text.substr(slash + 1);
  const auto island = who.in.names->islands.find(island_part);
  if (island == who.in.names->islands.end())
    return unknown(x, who, "island", island_part, keys_of(who.in.names->islands));
  if (sink_too && mote_part == sink_name)
    return mote_address{island->second.id, island->second.sink};
  const auto mote = island->second.motes.find(mote_part);
  if (mote == island->second.motes.end())
    return unknown(x, who, "mote of island `" + island_part + '`', mote_part,
                   keys_of(island->second.motes));
  return mote_address{island->second.id, mote->second};
}

/// A peer or gateway of that name.
std::optional<peer_id> end_of(const node& x, const asker& who, const std::string& name) {
  const auto& ends = who.in.names->ends;
  const auto found = ends.find(name);
  if (found == ends.end())
    return unknown(x, who, "peer or gateway", name, keys_of(ends));
  return found->second;
}

/// The text in `x` if it has a slash.
const std::string* text_with_slash(const node& x) {
  const auto* found = x.as<std::string>();
  return found != nullptr && found->find('/') != std::string::npos ? found : nullptr;
}

bool is_star(const node& x) {
  const auto* found = x.as<std::string>();
  return found != nullptr && *found == "*";
}

/// A PEIS id as a file may write it.
std::optional<peer_id> peer_id_of(std::string_view digits) {
  std::int32_t id = 0;
  const auto* const end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, id);
  if (error != std::errc{} || stop != end || id < 1 || id > peer_id_max)
    return std::nullopt;
  return peer_id(id);
}

word<device::quantity> words_of(const quantity_name& kind, const quantities& known) {
  word<device::quantity> out;
  for (std::size_t i = 0; i < known.all().size(); ++i)
    if (const auto x = static_cast<device::quantity>(i); x != device::quantity::signal)
      out.choices.emplace_back(known.all()[i].name, x);
  if (kind.signal)
    out.choices.emplace_back(known.word_of(device::quantity::signal), device::quantity::signal);
  return out;
}

} // namespace

std::optional<island_id> island_name::read(const node& x, const asker& who) const {
  const auto* name = x.as<std::string>();
  if (name == nullptr)
    return who.refuse(x, "the name of an island");
  if (any && is_star(x))
    return any_island;
  const auto found = who.in.names->islands.find(*name);
  if (found == who.in.names->islands.end())
    return unknown(x, who, "island", *name, keys_of(who.in.names->islands));
  return found->second.id;
}

std::optional<peer_id> peer_name::read(const node& x, const asker& who) const {
  const auto* name = x.as<std::string>();
  if (name == nullptr)
    return who.refuse(x, "the name of a peer or gateway, or \"*\"");
  if (is_star(x))
    return any_peer;
  return end_of(x, who, *name);
}

std::optional<peer_group_name::type> peer_group_name::read(const node& x, const asker& who) const {
  const auto* name = x.as<std::string>();
  if (name == nullptr)
    return who.refuse(x, "the name of a peer or gateway");
  if (const auto group = who.in.names->peer_groups.find(*name);
      group != who.in.names->peer_groups.end())
    return group->second;
  const auto found = end_of(x, who, *name);
  return found ? std::optional(std::vector{*found}) : std::nullopt;
}

std::optional<peer_id> gateway_name::read(const node& x, const asker& who) {
  const auto found = peer_name{}.read(x, who);
  if (!found || (*found != any_peer && who.in.names->island_of_gateway(*found) != nullptr))
    return found;
  who.complain(x, "that is not the name of a gateway");
  return std::nullopt;
}

std::optional<island_id> joined_sink_name::read(const node& x, const asker& who) {
  const auto found = island_name{true}.read(x, who);
  const auto& islands = who.in.names->islands;
  if (const auto* of = found ? who.in.names->find(*found) : nullptr;
      of != nullptr && !of->has_gateway)
    who.complain(x, "the sink of an island with stack = \"mac\" only measures; name another");
  if (found == any_island &&
      std::ranges::none_of(islands, [](const auto& each) { return each.second.has_gateway; }))
    who.complain(x, "no island has a gateway, so there is no sink to choose from");
  return found;
}

std::optional<linked_peers::type> linked_peers::read(const node& x, const asker& who) {
  const auto found = config::read(list_of<peer_group_name>{{}, 1}, x, who);
  if (!found)
    return std::nullopt;
  type out;
  for (const auto& each : *found)
    out.insert(out.end(), each.value.begin(), each.value.end());
  if (out.size() < 2)
    who.complain(x, "a link has two ends: name another peer");
  return out;
}

form linked_peers::takes() {
  return {"array of names of peers and gateways, at least 2",
          form_of(list_of<peer_group_name>{{}, 1}).schema};
}

std::optional<peer_groups::type> peer_groups::read(const node& x, const asker& who) {
  const auto found = config::read(list_of<list_of<peer_group_name>>{{{}, 1}, 1}, x, who);
  if (!found)
    return std::nullopt;
  type out;
  uniqueness<peer_id> placed;
  for (const auto& group : *found) {
    auto& peers = out.emplace_back();
    for (const auto& each : group.value)
      for (const auto id : each.value) {
        placed.add(id, "the peer with the id " + to_string(id), each.at, who.in.problems,
                   "is already in a group");
        peers.push_back(id);
      }
  }
  return out;
}

form peer_groups::takes() {
  return {"array of arrays of names of peers and gateways, at least 1 of each",
          form_of(list_of<list_of<peer_group_name>>{{{}, 1}, 1}).schema};
}

std::optional<std::string> mote_type_name::read(const node& x, const asker& who) {
  const auto* name = x.as<std::string>();
  if (name == nullptr)
    return who.refuse(x, "the name of a mote type");
  if (!who.in.names->mote_types.contains(*name))
    return unknown(x, who, "mote type", *name, keys_of(who.in.names->mote_types),
                   "[mote_type." + *name + ']');
  return *name;
}

std::optional<mote_address> read(const mote_name& kind, const node& x, const asker& who) {
  if (kind.any && is_star(x))
    return any_mote;
  const auto* text = text_with_slash(x);
  if (text == nullptr)
    return who.refuse(x, "the island and the name of a mote, as in \"kitchen/climate-7\"");
  return address_of(x, who, *text, false);
}

std::optional<mote_scope> scope_name::read(const node& x, const asker& who) {
  const auto* text = x.as<std::string>();
  if (text == nullptr)
    return who.refuse(x, "an island, a mote as in \"kitchen/fan\", or \"*\"");
  if (is_star(x))
    return mote_scope{};
  if (text_with_slash(x) != nullptr) {
    const auto mote = config::read(mote_name{}, x, who);
    return mote ? std::optional(mote_scope{*text, mote->island, mote->mote}) : std::nullopt;
  }
  const auto island = island_name{}.read(x, who);
  return island ? std::optional(mote_scope{*text, *island, {}}) : std::nullopt;
}

std::optional<std::string> any_node_name::read(const node& x, const asker& who) {
  const bool good = is_star(x) || config::read(node_name{}, x, who);
  return good ? std::optional(*x.as<std::string>()) : std::nullopt;
}

std::optional<std::string> proxy_name::read(const node& x, const asker& who) {
  return is_star(x) ? std::optional<std::string>("*") : config::read(tuple_key{}, x, who);
}

std::optional<mote_address> radio_name::read(const node& x, const asker& who) const {
  const auto* text = text_with_slash(x);
  if (text == nullptr)
    return who.refuse(x, "the island and the name of a mote, as in \"kitchen/climate-7\" or "
                         "\"kitchen/sink\"");
  return address_of(x, who, *text, true);
}

std::optional<flow_end> flow_end_name::read(const node& x, const asker& who) const {
  const auto* text = x.as<std::string>();
  if (text != nullptr && *text == sink_name)
    return flow_end{};
  if (broadcast && is_star(x))
    return flow_end{std::nullopt, broadcast_mote};
  if (text_with_slash(x) == nullptr)
    return who.refuse(x, "the island and the name of a mote, as in \"lab/node-7\", or \"sink\"" +
                             std::string(broadcast ? " or \"*\"" : ""));
  const auto address = address_of(x, who, *text, true);
  if (!address)
    return std::nullopt;
  return flow_end{address->island, address->mote};
}

std::optional<std::string> host_name::read(const node& x, const asker& who) const {
  const auto* name = x.as<std::string>();
  if (name == nullptr)
    return who.refuse(x, "the name of a host");
  if (!who.in.names->hosts.contains(*name))
    return unknown(x, who, "host", *name, keys_of(who.in.names->hosts), "[[host]]");
  return *name;
}

std::optional<std::string> link_end::read(const node& x, const asker& who) const {
  constexpr std::string_view scheme = "inproc://";
  const auto* url = x.as<std::string>();
  if (url == nullptr || !url->starts_with(scheme))
    return who.refuse(x, "a link to a peer or gateway, as in \"inproc://kitchen-gateway\"");
  const auto name = url->substr(scheme.size());
  return end_of(x, who, name) ? std::optional(name) : std::nullopt;
}

std::optional<std::string> tuple_reference::read(const node& x, const asker& who) const {
  const auto* text = x.as<std::string>();
  const auto colon = text == nullptr ? std::string::npos : text->find(':');
  if (text != nullptr && *text == "nowhere")
    return peis::format_meta({});
  if (colon == std::string::npos)
    return who.refuse(x,
                      "a tuple of a peer or gateway, as in \"robot:robot.state\", or \"nowhere\"");
  const auto name = text->substr(0, colon);
  const auto id = peer_id_of(name); // unless it is a name
  const auto owner = id && !who.in.names->ends.contains(name) ? id : end_of(x, who, name);
  if (!owner)
    return std::nullopt;
  const auto key = config::read(tuple_key{}, {x.at, text->substr(colon + 1)}, who);
  if (!key)
    return std::nullopt;
  return peis::format_meta(peis::meta_target{*owner, *peis::key::parse(*key)});
}

form form_of(const mote_name& kind) {
  return string_form(kind.any ? "mote, or `\"*\"`" : "mote");
}

std::optional<mote_address> read(const node_name& /*kind*/, const node& x, const asker& who) {
  const auto* text = x.as<std::string>();
  if (text != nullptr && text->find('/') != std::string::npos)
    return read(mote_name{}, x, who);
  const auto peer = peer_name{}.read(x, who);
  if (!peer)
    return std::nullopt;
  if (peer->value > static_cast<std::int32_t>(island_id_max)) {
    who.complain(x, "peer `" + *text + "` has the id " + to_string(*peer) +
                        ", but motes and programs address peers up to 254");
    return std::nullopt;
  }
  return mote_address{island_id(static_cast<std::uint32_t>(peer->value)), no_mote};
}

form form_of(const node_name& /*kind*/) {
  return string_form("mote, peer or gateway");
}

std::optional<device::quantity> read(const quantity_name& kind, const node& x, const asker& who) {
  return read(words_of(kind, who.in.quantities), x, who);
}

form form_of(const quantity_name& kind) {
  auto out = form_of(words_of(kind, {}));
  out.wanted += ", or a [quantity](#quantity) of the file";
  out.schema = either_schema(out.schema, form_of(name_text{}).schema);
  return out;
}

} // namespace rubicon::config
