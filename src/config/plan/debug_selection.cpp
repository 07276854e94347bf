#include "config/plan/debug_selection.hpp"

#include <algorithm>
#include <array>

#include "core/text/spelling.hpp"

namespace rubicon::config {

namespace {

/// Modules whose actors come and go, under names that tuples give them.
constexpr std::array<std::string_view, 1> open_modules{"proxy"};

/// Modules whose actors have further parts behind what the description names.
constexpr std::array<std::string_view, 4> deep_modules{"mote_app", "program", "peer_app", "proxy"};

template <class List>
bool among(const List& all, std::string_view x) {
  return std::ranges::find(all, x) != all.end();
}

std::string_view module_of(std::string_view path) {
  return path.substr(0, path.find('/'));
}

std::string ticked(std::string_view x) {
  return '`' + std::string(x) + '`';
}

} // namespace

bool debug_selection::has(std::string_view path) const {
  return std::ranges::any_of(patterns_, [path](std::string_view x) {
    return x == "*" || (path.starts_with(x) && (path.size() == x.size() || path[x.size()] == '/'));
  });
}

std::string debug_selection::text() const {
  if (patterns_.empty())
    return "no actors";
  if (among(patterns_, "*"))
    return "all actors";
  std::string text;
  for (const auto& x : patterns_)
    text += (text.empty() ? "" : ", ") + x;
  return text;
}

std::vector<std::string> debug_patterns(std::string_view text) {
  constexpr std::string_view between = ", \t\r\n";
  std::vector<std::string> found;
  for (auto at = text.find_first_not_of(between); at != std::string_view::npos;) {
    const auto end = std::min(text.find_first_of(between, at), text.size());
    found.emplace_back(text.substr(at, end - at));
    at = text.find_first_not_of(between, end);
  }
  return found;
}

debug_names::debug_names(const ecology_description& x) {
  add("ecology/" + x.name);
  for (const auto* module : {"peis_lan", "peis_bluetooth", "mote", "mote_app", "program", "proxy",
                             "peer_app", "proxy_manager", "object_manager", "init", "pc"})
    add(module); // also if none is there, or not yet
  for (const auto& air : x.airs)
    add("air/" + air.name);
  const auto add_kernel = [this](const std::string& name) { add("peis_peer/" + name); };
  for_each_island(x, [&](const island_description& island) {
    for (const auto* module : {"mote/", "mote_app/", "program/", "sink/", "serial_line/",
                               "gateway/", "pty_end/", "forwarder_server/"})
      add(module + island.name);
    add("real_line/" + island.name + "/real");
    add_kernel(island.gateway_name);
    for (const auto& alias : island.aliases) {
      add("serial_line/" + island.name + '/' + alias.name);
      add("gateway/" + island.name + '/' + alias.name);
      add_kernel(alias.name);
    }
    for (const auto& mote : island.motes)
      add_mote(island.name + '/' + mote.name);
  });
  for (const auto& peer : x.peers) {
    add_kernel(peer.name);
    for (const auto* module : {"pc/", "proxy_manager/", "object_manager/", "peer_app/", "init/"})
      add(module + peer.name);
  }
}

void debug_names::add_mote(const std::string& name) {
  for (const auto* module : {"mote/", "mote_app/", "program/"})
    add(module + name);
}

void debug_names::add(std::string path) {
  while (paths_.insert(path).second && path.find('/') != std::string::npos)
    path.resize(path.rfind('/'));
}

std::vector<std::string> debug_names::modules() const {
  std::vector<std::string> found;
  for (const auto& x : paths_)
    if (x.find('/') == std::string::npos)
      found.push_back(x);
  return found;
}

std::string debug_names::problem(std::string_view pattern) const {
  constexpr std::size_t pattern_octets_max = 200; // it may come from anybody
  if (pattern.size() > pattern_octets_max)
    return "a pattern has at most " + std::to_string(pattern_octets_max) + " characters";
  const auto module = module_of(pattern);
  if (pattern == "*" || paths_.contains(pattern))
    return {};
  if (!paths_.contains(module))
    return "there is no module " + ticked(module) + suggestion(module, modules());
  if (pattern.ends_with('/') || pattern.find("//") != std::string_view::npos)
    return ticked(pattern) + " has an empty part";
  if (among(open_modules, module))
    return {};
  for (auto end = pattern.rfind('/'); end > module.size() && among(deep_modules, module);
       end = pattern.rfind('/', end - 1))
    if (paths_.contains(pattern.substr(0, end)))
      return {};
  std::vector<std::string> known;
  for (auto at = paths_.lower_bound(module); at != paths_.end() && at->starts_with(module); ++at)
    if (module_of(*at) == module && at->size() > module.size())
      known.push_back(*at);
  return "no actor is named " + ticked(pattern) + suggestion(pattern, known);
}

std::string debug_names::problem(const std::vector<std::string>& patterns) const {
  if (patterns.size() > debug_patterns_max)
    return "there are more than " + std::to_string(debug_patterns_max) + " patterns";
  for (const auto& x : patterns)
    if (auto why = problem(x); !why.empty())
      return why;
  return {};
}

} // namespace rubicon::config
