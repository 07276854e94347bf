#include "config/directory.hpp"

#include <functional>
#include <utility>
#include <vector>

#include "config/near.hpp"

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

directory::island island_at(const node& x) {
  directory::island out{id_at<island_id>(x, island_id_max), {}};
  each_table(x, "mote", [&out](const node& mote) {
    const auto id = id_at<mote_id>(mote, mote_id_max);
    auto name = text_at(mote, "name");
    if (!name)
      name = default_mote_name(text_at(mote, "type").value_or(""), id);
    out.motes.emplace(*std::move(name), id);
  });
  return out;
}

std::string gateway_at(const node& island, std::string_view island_name) {
  const auto* gateway = island.find("gateway");
  const auto given = gateway == nullptr ? std::nullopt : text_at(*gateway, "name");
  return given.value_or(default_gateway_name(island_name));
}

template <class Names>
std::vector<std::string> keys_of(const Names& names) {
  std::vector<std::string> out;
  for (const auto& each : names) {
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

} // namespace

std::string default_mote_name(std::string_view type_name, mote_id id) {
  return (type_name.empty() ? "mote" : std::string(type_name)) + '-' + to_string(id);
}

std::string default_gateway_name(std::string_view island) {
  return std::string(island) + "-gateway";
}

directory::directory(const node& root) {
  each_table(root, "island", [this](const node& x) {
    if (const auto name = text_at(x, "name")) {
      islands.emplace(*name, island_at(x));
      ends.insert(gateway_at(x, *name));
    }
  });
  each_table(root, "peer", [this](const node& x) {
    if (auto name = text_at(x, "name"))
      ends.insert(*std::move(name));
  });
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

std::optional<island_id> island_name::read(const node& x, const asker& who) const {
  const auto* name = x.as<std::string>();
  if (name == nullptr)
    return who.refuse(x, "the name of an island");
  const auto found = names.islands.find(*name);
  if (found == names.islands.end())
    return unknown(x, who, "island", *name, keys_of(names.islands));
  return found->second.id;
}

std::optional<mote_address> mote_name::read(const node& x, const asker& who) const {
  const auto* whole_name = x.as<std::string>();
  const auto slash = whole_name == nullptr ? std::string::npos : whole_name->find('/');
  if (slash == std::string::npos)
    return who.refuse(x, "the island and the name of a mote, as in \"kitchen/climate-7\"");
  const auto island_part = whole_name->substr(0, slash);
  const auto mote_part = whole_name->substr(slash + 1);
  const auto island = names.islands.find(island_part);
  if (island == names.islands.end())
    return unknown(x, who, "island", island_part, keys_of(names.islands));
  const auto mote = island->second.motes.find(mote_part);
  if (mote == island->second.motes.end())
    return unknown(x, who, "mote of island `" + island_part + '`', mote_part,
                   keys_of(island->second.motes));
  return mote_address{island->second.id, mote->second};
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

} // namespace rubicon::config
