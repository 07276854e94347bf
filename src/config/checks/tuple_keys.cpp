#include "config/checks/tuple_keys.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "bridge/mqtt/mqtt_settings.hpp"
#include "bridge/ros2/ros2_settings.hpp"
#include "config/plan/uniqueness.hpp"
#include "core/tuples/device_keys.hpp"
#include "proxy/classes/class_table.hpp"
#include "proxy/classes/signature.hpp"
#include "proxy/classes/tuple_key.hpp"

namespace rubicon::config {

namespace {

/// The next part of a key; nothing more once it is empty.
std::string_view take_part(std::string_view& key) {
  const auto dot = std::min(key.find('.'), key.size());
  const auto part = key.substr(0, dot);
  key.remove_prefix(std::min(dot + 1, key.size()));
  return part;
}

} // namespace

std::string without_names(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    auto part = take_part(text);
    out += (out.empty() ? "" : ".") +
           (part.find('{') == std::string_view::npos ? std::string(part) : std::string("*"));
  }
  return out;
}

std::string prefix_of_any(const proxy::proxy_class& what, const island_description& island) {
  constexpr std::string_view place = "{island}";
  auto prefix = what.prefix;
  if (const auto at = prefix.find(place); at != std::string::npos)
    prefix.replace(at, place.size(), island.name);
  return without_names(prefix);
}

namespace {

class key_list {
public:
  void add(std::string pattern, const std::string& owner) {
    all_.push_back({std::move(pattern), owner});
  }

  void add_gateway(const std::string& name) {
    add(std::string(devices_key), name);
    add(std::string(devices_key) + ".**", name);
  }

  void add_proxy(const proxy::proxy_class& what, const std::string& prefix,
                 const std::string& owner) {
    const auto own = [&](const std::string& name) { add(prefix + '.' + name, owner); };
    for (const auto* name : {"status", "status.cause", "status.since", "class", "id", "island"})
      own(name);
    for (const auto& [name, text] : what.properties)
      own(name);
    if (what.indirect || !what.ids.empty())
      for (const auto* name : {"interface", "position", "position.accuracy"})
        own(name);
    for (const auto& field : what.fields) {
      own(field.name);
      if (!field.unit.empty())
        own(field.name + ".unit");
      if (what.settings.stale_after > 0s)
        own(field.name + ".freshness");
      if (field.stream ||
          std::ranges::find(what.stamped_channels, field.channel) != what.stamped_channels.end())
        own(field.name + ".latency");
    }
    for (const auto& input : what.inputs) {
      own(input.name);
      for (const auto* part : {".deadline", ".latency", ".words", ".outcome"})
        own(input.name + part);
      if (input.meta)
        own("mi-" + input.name);
      if (input.numbers)
        own(input.name + ".range");
      if (!input.unit.empty())
        own(input.name + ".unit");
    }
    for (const auto& tuple : what.tuples)
      add(without_names(tuple.key), owner);
    if (!what.program.empty()) // only the program itself knows what it says
      add(prefix + ".**", owner);
  }

  std::vector<known_key> take() { return std::move(all_); }

private:
  std::vector<known_key> all_;
};

struct app_keys {
  const ecology_description& all;
  const peer_description& peer;
  key_list& keys;

  void operator()(const proxy_manager_app& x) const {
    mote_classes classes(all);
    for (const auto& island : all.islands) {
      if (std::ranges::find(x.islands, island.id) == x.islands.end())
        continue;
      for (const auto& mote : island.motes)
        if (const auto* what = classes.of(mote))
          keys.add_proxy(*what, prefix_of(*what, island, mote), peer.name);
      for (const auto& rule : island.plain) { // which of them will appear is not known
        mote_description real;
        real.id = mote_id(rule.first);
        real.type = rule.type;
        if (const auto* what = class_of(all, island.id, real))
          keys.add_proxy(*what, prefix_of_any(*what, island), peer.name);
      }
    }
    for (const auto& what : all.proxies) {
      if (!x.objects || what.ids.empty())
        continue;
      keys.add_proxy(what, without_names(what.prefix), peer.name);
      keys.add(without_names(what.prefix) + ".**", peer.name);
    }
  }
  void operator()(const rfid::reader_config& x) const {
    keys.add("interface." + x.name + ".**", peer.name);
  }
  void operator()(const goal::pursuer_config& x) const {
    for (const auto* name : {"goal", "state", "outcome", "outcome.cause"})
      keys.add(x.name + '.' + name, peer.name);
    for (const auto& input : x.inputs) {
      keys.add(x.name + '.' + input.name, peer.name);
      keys.add(x.name + ".mi-" + input.name, peer.name);
    }
    for (const auto& output : x.outputs)
      keys.add(x.name + '.' + output.name, peer.name);
  }
  void operator()(const translate_app& x) const {
    for (const auto& rule : x.rules) {
      const auto to = rule.to.empty() ? rule.from : without_names(rule.to);
      if (!rule.to.empty())
        keys.add(to, peer.name);
      if (!rule.unit.empty())
        keys.add(to + ".unit", peer.name);
      if (rule.history > 0)
        keys.add(to + ".history", peer.name);
    }
  }
  void operator()(const mqtt_app& x) const {
    for (const auto& rule : x.settings->bridge.topics)
      keys.add(rule.key, peer.name);
  }
  void operator()(const ros2_app& x) const {
    for (const auto& rule : x.settings->bridge.subscriptions)
      keys.add(rule.key, peer.name);
    for (const auto& rule : x.settings->bridge.requests)
      keys.add(rule.key + ".outcome", peer.name);
  }
  template <class Other>
  void operator()(const Other&) const {}
};

} // namespace

bool may_be(std::string_view pattern, std::string_view key) {
  while (!pattern.empty() && !key.empty()) {
    if (pattern == "**")
      return true;
    const auto a = take_part(pattern);
    const auto b = take_part(key);
    if (a != "*" && b != "*" && folded(a) != folded(b))
      return false;
  }
  return pattern.empty() && key.empty();
}

const proxy::proxy_class* class_of(const ecology_description& x, island_id island,
                                   const mote_description& mote) {
  const proxy::class_table table(x.proxies);
  const auto* best = table.find(proxy::signature_of({island, mote.id}, mote.type));
  if (best == nullptr)
    return nullptr;
  const auto found = std::ranges::find(x.proxies, best->name, &proxy::proxy_class::name);
  return found == x.proxies.end() ? nullptr : &*found;
}

mote_classes::mote_classes(const ecology_description& x) : all_(x), table_(x.proxies) {}

const proxy::proxy_class* mote_classes::of(const mote_description& mote) {
  const auto [at, is_new] = known_.emplace(mote.type, nullptr);
  if (!is_new)
    return at->second;
  if (const auto* best = table_.find(proxy::signature_of({{}, mote.id}, mote.type)))
    at->second = &*std::ranges::find(all_.proxies, best->name, &proxy::proxy_class::name);
  return at->second;
}

std::string prefix_of(const proxy::proxy_class& what, const island_description& island,
                      const mote_description& mote) {
  const mote_address address{island.id, mote.id};
  const auto known = std::ranges::find(what.objects, to_string(address), &proxy::known_object::id);
  const auto& name = known != what.objects.end() && !known->name.empty() ? known->name : mote.name;
  return proxy::key_prefix(what.prefix, {address, island.name, name});
}

std::map<std::string, std::string> object_labels(const ecology_description& x) {
  std::map<std::string, std::string> out;
  if (x.labels.empty())
    return out;
  mote_classes classes(x);
  for_each_island(x, [&](const island_description& island) {
    for (const auto& mote : island.motes) {
      auto label = x.labels.of(label_table::kind::mote, island.name + '/' + mote.name);
      const auto* what = label.empty() ? nullptr : classes.of(mote);
      if (what != nullptr)
        out.emplace(folded(prefix_of(*what, island, mote)), std::move(label));
    }
  });
  return out;
}

std::vector<known_key> tuple_keys(const ecology_description& x) {
  key_list keys;
  for (const auto& island : x.islands) {
    if (!has_line(island.stack))
      continue;
    keys.add_gateway(island.gateway_name);
    for (const auto& alias : island.aliases)
      keys.add_gateway(alias.name);
  }
  for (const auto& peer : x.peers)
    for (const auto& app : peer.apps)
      std::visit(app_keys{x, peer, keys}, app);
  return keys.take();
}

} // namespace rubicon::config
