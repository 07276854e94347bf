#include "config/directory.hpp"

#include <algorithm>
#include <charconv>
#include <functional>
#include <utility>
#include <vector>

#include "config/ecology.hpp"
#include "config/near.hpp"
#include "peis/meta_tuple.hpp"

namespace rubicon::config {

namespace {

/// Calls `use` with each table in the array `key` of `x`.
void each_table(const node& x, std::string_view key, const std::function<void(const node&)>& use) {
  const auto* found = x.find(key);
  const auto* elements = found == nullptr ? nullptr : found->as<node_array>();
  if (elements == nullptr)
    return;
  for (const auto& element : *elements)
    use(element);
}

std::optional<std::string> text_at(const node& x, std::string_view key) {
  const auto* found = x.find(key);
  const auto* content = found == nullptr ? nullptr : found->as<std::string>();
  return content == nullptr ? std::nullopt : std::optional(*content);
}

/// The id of a table; 0 if it has none in range.
template <class Id>
Id id_at(const node& x, typename Id::rep max) {
  const auto* found = x.find("id");
  const auto* content = found == nullptr ? nullptr : found->as<std::int64_t>();
  if (content == nullptr || !std::in_range<typename Id::rep>(*content) ||
      static_cast<typename Id::rep>(*content) > max)
    return Id{};
  return Id(static_cast<typename Id::rep>(*content));
}

/// A whole number of a table; nothing if it has none from 1 to `max`.
std::optional<std::uint32_t> number_at(const node& x, std::string_view key, std::uint32_t max) {
  const auto* found = x.find(key);
  const auto* content = found == nullptr ? nullptr : found->as<std::int64_t>();
  if (content == nullptr || *content < 1 || *content > max)
    return std::nullopt;
  return static_cast<std::uint32_t>(*content);
}

/// The first of the lowest `count` ids in a row from 1 on that nobody has.
std::uint32_t lowest_free(const std::set<std::uint32_t>& taken, std::uint32_t count) {
  std::uint32_t first = 1;
  for (const auto id : taken) {
    if (id >= first + count)
      break;
    first = std::max(first, id + 1);
  }
  return first;
}

/// Fills the directory's islands; what all groups have together is limited.
struct island_walk {
  std::map<mark, directory::group>& groups;
  std::uint32_t group_motes = 0;

  directory::island island_at(const node& x) {
    directory::island out;
    out.id = id_at<island_id>(x, island_id_max);
    out.has_gateway = text_at(x, "stack") != "mac";
    const auto* sink = x.find("sink");
    if (sink != nullptr && sink->find("id") != nullptr)
      out.sink = id_at<mote_id>(*sink, mote_id_max);
    std::set<std::uint32_t> taken{out.sink.value};
    each_table(x, "mote", [&](const node& mote) {
      const auto id = id_at<mote_id>(mote, mote_id_max);
      taken.insert(id.value);
      auto name = text_at(mote, "name");
      if (!name)
        name = default_mote_name(text_at(mote, "type").value_or(""), id);
      out.motes.emplace(*std::move(name), id);
    });
    each_table(x, "group", [&](const node& group) { add_group(group, taken, out); });
    return out;
  }

  void add_group(const node& x, std::set<std::uint32_t>& taken, directory::island& out) {
    const auto count = number_at(x, "count", mote_id_max).value_or(0);
    const auto given = number_at(x, "first", mote_id_max);
    const auto first = given ? *given : lowest_free(taken, count);
    const bool fits = count <= group_motes_max - group_motes;
    groups.emplace(x.at, directory::group{first, fits});
    if (count == 0 || first + count - 1 > mote_id_max || !fits)
      return;
    group_motes += count;
    const auto prefix = text_at(x, "prefix");
    const auto type_name = text_at(x, "type").value_or("");
    for (auto i = first; i < first + count; ++i) {
      const mote_id id(static_cast<std::uint16_t>(i));
      taken.insert(i);
      out.motes.emplace(default_mote_name(prefix.value_or(type_name), id), id);
    }
  }
};

/// Fills the directory's ends with the peers.
struct peer_walk {
  directory& out;

  void add(const node& x) const {
    auto name = text_at(x, "name");
    if (!name)
      return;
    const auto first = id_at<peer_id>(x, peer_id_max);
    if (x.find("count") == nullptr) {
      out.ends.emplace(*std::move(name), first);
      return;
    }
    const auto count = number_at(x, "count", peer_count_max).value_or(0);
    if (out.ends.size() > static_cast<std::size_t>(peer_id_max))
      return; // more than there are ids: the reader complains
    auto& group = out.peer_groups[*name];
    for (std::uint32_t i = 0; i < count; ++i) {
      const peer_id id(first.value + static_cast<std::int32_t>(i));
      out.ends.emplace(counted_peer_name(*name, i + 1), id);
      group.push_back(id);
    }
  }
};

std::string gateway_at(const node& island, std::string_view island_name) {
  const auto* gateway = island.find("gateway");
  const auto given = gateway == nullptr ? std::nullopt : text_at(*gateway, "name");
  return given.value_or(default_gateway_name(island_name));
}

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

std::nullopt_t unknown(const node& x, const asker& who, const std::string& what,
                       std::string_view name, const std::vector<std::string>& known) {
  who.complain(x,
               "no " + what + " is called `" + std::string(name) + '`' + suggestion(name, known));
  return std::nullopt;
}

/// "island/mote", and "island/sink" if `sink_too`.
std::optional<mote_address> address_of(const node& x, const asker& who, const directory& names,
                                       const std::string& text, bool sink_too) {
  const auto slash = text.find('/');
  const auto island_part = text.substr(0, slash);
  const auto mote_part = text.substr(slash + 1);
  const auto island = names.islands.find(island_part);
  if (island == names.islands.end())
    return unknown(x, who, "island", island_part, keys_of(names.islands));
  if (sink_too && mote_part == sink_name)
    return mote_address{island->second.id, island->second.sink};
  const auto mote = island->second.motes.find(mote_part);
  if (mote == island->second.motes.end())
    return unknown(x, who, "mote of island `" + island_part + '`', mote_part,
                   keys_of(island->second.motes));
  return mote_address{island->second.id, mote->second};
}

/// The text in `x` if it has a slash.
const std::string* text_with_slash(const node& x) {
  const auto* found = x.as<std::string>();
  return found != nullptr && found->find('/') != std::string::npos ? found : nullptr;
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

} // namespace

std::string default_mote_name(std::string_view type_name, mote_id id) {
  return (type_name.empty() ? "mote" : std::string(type_name)) + '-' + to_string(id);
}

std::string default_gateway_name(std::string_view island) {
  return std::string(island) + "-gateway";
}

std::string default_alias_name(std::string_view island, std::size_t number) {
  return default_gateway_name(island) + '-' + std::to_string(number);
}

std::string counted_peer_name(std::string_view name, std::uint32_t number) {
  return std::string(name) + '-' + std::to_string(number);
}

directory::directory(const node& root) {
  island_walk walk{groups};
  each_table(root, "island", [&](const node& x) {
    auto found = walk.island_at(x);
    if (const auto name = text_at(x, "name")) {
      auto& added = islands.emplace(*name, std::move(found)).first->second;
      if (added.has_gateway)
        add_gateways(x, *name, added);
    }
  });
  each_table(root, "peer", [this](const node& x) { peer_walk{*this}.add(x); });
  each_table(root, "host", [this](const node& x) {
    if (auto name = text_at(x, "name"))
      hosts.insert(*std::move(name));
  });
  const auto* types = root.find("mote_type");
  if (const auto* members = types == nullptr ? nullptr : types->as<node_table>()) {
    for (const auto& each : *members)
      mote_types.insert(each.key);
  }
}

void directory::add_gateways(const node& x, const std::string& name, island& of) {
  ends.emplace(gateway_at(x, name), gateway_of(of.id));
  of.gateways.push_back(gateway_of(of.id));
  each_table(x, "alias", [&](const node& alias) {
    const auto id = id_at<peer_id>(alias, peer_id_max);
    of.gateways.push_back(id);
    ends.emplace(text_at(alias, "name").value_or(default_alias_name(name, of.gateways.size())), id);
  });
}

directory::group directory::group_at(mark at) const {
  const auto found = groups.find(at);
  return found == groups.end() ? group{} : found->second;
}

const directory::island* directory::island_of_gateway(peer_id id) const {
  const auto found = std::find_if(islands.begin(), islands.end(), [id](const auto& x) {
    const auto& gateways = x.second.gateways;
    return std::find(gateways.begin(), gateways.end(), id) != gateways.end();
  });
  return found == islands.end() ? nullptr : &found->second;
}

const directory::island* directory::find(island_id id) const {
  const auto found = std::find_if(islands.begin(), islands.end(),
                                  [id](const auto& x) { return x.second.id == id; });
  return found == islands.end() ? nullptr : &found->second;
}

std::optional<island_id> island_name::read(const node& x, const asker& who) const {
  const auto* name = x.as<std::string>();
  if (name == nullptr)
    return who.refuse(x, "the name of an island");
  if (any && *name == "*")
    return any_island;
  const auto found = names.islands.find(*name);
  if (found == names.islands.end())
    return unknown(x, who, "island", *name, keys_of(names.islands));
  return found->second.id;
}

std::optional<peer_id> peer_name::read(const node& x, const asker& who) const {
  const auto* name = x.as<std::string>();
  if (name == nullptr)
    return who.refuse(x, "the name of a peer or gateway, or \"*\"");
  if (*name == "*")
    return any_peer;
  const auto found = names.ends.find(*name);
  if (found == names.ends.end())
    return unknown(x, who, "peer or gateway", *name, keys_of(names.ends));
  return found->second;
}

std::optional<peer_group_name::type> peer_group_name::read(const node& x, const asker& who) const {
  const auto* name = x.as<std::string>();
  if (name == nullptr)
    return who.refuse(x, "the name of a peer or gateway");
  if (const auto group = names.peer_groups.find(*name); group != names.peer_groups.end())
    return group->second;
  const auto found = names.ends.find(*name);
  if (found == names.ends.end())
    return unknown(x, who, "peer or gateway", *name, keys_of(names.ends));
  return std::vector{found->second};
}

std::optional<mote_address> mote_name::read(const node& x, const asker& who) const {
  if (const auto* star = x.as<std::string>(); any && star != nullptr && *star == "*")
    return any_mote;
  const auto* text = text_with_slash(x);
  if (text == nullptr)
    return who.refuse(x, "the island and the name of a mote, as in \"kitchen/climate-7\"");
  return address_of(x, who, names, *text, false);
}

std::optional<mote_address> radio_name::read(const node& x, const asker& who) const {
  const auto* text = text_with_slash(x);
  if (text == nullptr)
    return who.refuse(x, "the island and the name of a mote, as in \"kitchen/climate-7\" or "
                         "\"kitchen/sink\"");
  return address_of(x, who, names, *text, true);
}

std::optional<flow_end> flow_end_name::read(const node& x, const asker& who) const {
  const auto* text = x.as<std::string>();
  if (text != nullptr && *text == sink_name)
    return flow_end{};
  if (broadcast && text != nullptr && *text == "*")
    return flow_end{std::nullopt, broadcast_mote};
  if (text_with_slash(x) == nullptr)
    return who.refuse(x, "the island and the name of a mote, as in \"lab/node-7\", or \"sink\"" +
                             std::string(broadcast ? " or \"*\"" : ""));
  const auto address = address_of(x, who, names, *text, true);
  if (!address)
    return std::nullopt;
  return flow_end{address->island, address->mote};
}

std::optional<std::string> host_name::read(const node& x, const asker& who) const {
  const auto* name = x.as<std::string>();
  if (name == nullptr)
    return who.refuse(x, "the name of a host");
  if (!names.hosts.contains(*name))
    return unknown(x, who, "host", *name, keys_of(names.hosts));
  return *name;
}

std::optional<std::string> link_end::read(const node& x, const asker& who) const {
  constexpr std::string_view scheme = "inproc://";
  const auto* url = x.as<std::string>();
  if (url == nullptr || !url->starts_with(scheme))
    return who.refuse(x, "a link to a peer or gateway, as in \"inproc://kitchen-gateway\"");
  const auto name = url->substr(scheme.size());
  if (!names.ends.contains(name))
    return unknown(x, who, "peer or gateway", name, keys_of(names.ends));
  return name;
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
  const auto found = names.ends.find(name);
  const auto owner = found == names.ends.end() ? peer_id_of(name) : found->second;
  if (!owner)
    return unknown(x, who, "peer or gateway", name, keys_of(names.ends));
  const auto key = config::read(tuple_key{}, {x.at, text->substr(colon + 1)}, who);
  if (!key)
    return std::nullopt;
  return peis::format_meta(peis::meta_target{*owner, *peis::key::parse(*key)});
}

} // namespace rubicon::config
