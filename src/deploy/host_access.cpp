#include "deploy/host_access.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "bridge/mqtt/mqtt_settings.hpp"
#include "bridge/ros2/ros2_settings.hpp"

namespace rubicon::deploy {

namespace {

/// Whether some part of the path is one of these.
template <class F>
bool has_part(std::string_view path, F is_so) {
  for (;;) {
    const auto slash = path.find('/');
    if (is_so(path.substr(0, slash)))
      return true;
    if (slash == std::string_view::npos)
      return false;
    path.remove_prefix(slash + 1);
  }
}

/// `*` is any text, `?` any character.
bool matches(std::string_view text, std::string_view pattern) {
  std::size_t at = 0;
  std::size_t in_pattern = 0;
  std::size_t star = std::string_view::npos;
  std::size_t after_star = 0; // where the text of the star ends, so far
  while (at < text.size()) {
    if (in_pattern < pattern.size() && pattern[in_pattern] == '*') {
      star = in_pattern++;
      after_star = at;
    } else if (in_pattern < pattern.size() &&
               (pattern[in_pattern] == '?' || pattern[in_pattern] == text[at])) {
      ++in_pattern;
      ++at;
    } else if (star != std::string_view::npos) {
      in_pattern = star + 1;
      at = ++after_star;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', in_pattern) == std::string_view::npos;
}

void add_files(std::vector<std::string>& to, const apps::app_config& x) {
  if (const auto* recorder = std::get_if<apps::recorder_config>(&x))
    to.push_back(recorder->file);
}

bool starts_commands(const config::init_app& x) {
  return std::ranges::any_of(x.components, [](const auto& each) { return !each.command.empty(); });
}

std::string how_to_allow(const std::string& device) {
  return device +
         " is not among the devices that this host allows: start `rubicon host` with "
         "--allow-devices '" +
         device + "' if you trust the coordinators";
}

void judge_island(const config::island_description& x, const host_access& access,
                  std::vector<std::string>& to) {
  for (const auto* device : {&x.outside.device, &x.real.outside.device})
    if (!device->empty() && !is_allowed(*device, access.devices))
      to.push_back("island `" + x.name + "`: " + how_to_allow(*device));
  const auto& pty = x.outside.pty;
  if (!pty.empty() && !is_inside(pty) && !is_allowed(pty, access.devices))
    to.push_back("island `" + x.name + "`: " + how_to_allow(pty));
}

/// Passwords, keys and certificates, which are shown to a server that the file names.
std::vector<std::string> files_of_bridges(const config::ecology_description& part) {
  std::vector<std::string> out;
  for (const auto& peer : part.peers)
    for (const auto& app : peer.apps) {
      if (const auto* ros2 = std::get_if<config::ros2_app>(&app))
        if (!ros2->settings->ca_file.empty())
          out.push_back(ros2->settings->ca_file);
      if (const auto* found = std::get_if<config::mqtt_app>(&app)) {
        const auto& broker = found->settings->broker;
        for (const auto* path :
             {&broker.password_file, &broker.authority, &broker.certificate, &broker.key})
          if (!path->empty())
            out.push_back(*path);
      }
    }
  return out;
}

bool has_firmware(const config::mote_description& x) {
  return std::ranges::any_of(x.apps, [](const auto& app) {
    return std::holds_alternative<firmware::program_config>(app);
  });
}

} // namespace

bool is_inside(std::string_view path) {
  return path.find('\0') == std::string_view::npos && !has_part(path, [](std::string_view part) {
           return part.empty() || part == "." || part == "..";
         });
}

bool is_allowed(std::string_view device, const std::vector<std::string>& patterns) {
  return !has_part(device, [](std::string_view part) { return part == ".."; }) &&
         std::ranges::any_of(patterns, [&](const auto& each) { return matches(device, each); });
}

std::vector<std::string> files_written(const config::ecology_description& part) {
  std::vector<std::string> out;
  for (const auto& island : part.islands) {
    for (const auto& app : island.gateway_apps)
      add_files(out, app);
    if (is_inside(island.outside.pty))
      out.push_back(island.outside.pty);
  }
  for (const auto& peer : part.peers)
    for (const auto& app : peer.apps) {
      if (const auto* program = std::get_if<apps::app_config>(&app))
        add_files(out, *program);
      if (const auto* init = std::get_if<config::init_app>(&app); init != nullptr)
        if (!init->lock.empty())
          out.push_back(init->lock);
    }
  return out;
}

std::vector<std::string> refusals(const config::ecology_description& part,
                                  const host_access& access) {
  std::vector<std::string> out;
  for (const auto& path : files_written(part))
    if (!is_inside(path))
      out.push_back('`' + path +
                    "` would be written outside the part's folder: give a path within it");
  for (const auto& island : part.islands)
    judge_island(island, access, out);
  for (const auto& peer : part.peers)
    if (!peer.adapter.empty() && !is_allowed(peer.adapter, access.devices))
      out.push_back("peer `" + peer.name + "`: " + how_to_allow(peer.adapter));
  const bool has_commands = std::ranges::any_of(part.peers, [](const auto& peer) {
    return std::ranges::any_of(peer.apps, [](const auto& app) {
      const auto* init = std::get_if<config::init_app>(&app);
      return init != nullptr && starts_commands(*init);
    });
  });
  if (has_commands && !access.commands)
    out.emplace_back("the file starts commands here, which this host does not allow: start "
                     "`rubicon host` with --allow-commands if you trust the coordinators");
  for (const auto& path : files_of_bridges(part))
    if (!is_inside(path))
      out.push_back('`' + path +
                    "` of a bridge would be read outside the part's folder: give a path within it");
  if (auto why = firmware_refusal(part, access); !why.empty())
    out.push_back(std::move(why));
  return out;
}

std::string firmware_refusal(const config::ecology_description& part, const host_access& access) {
  const bool has_some = std::ranges::any_of(part.islands, [](const auto& island) {
    return std::ranges::any_of(island.motes, [](const auto& mote) { return has_firmware(mote); });
  });
  if (access.firmware || !has_some)
    return {};
  return "motes of the file have firmware, which would run here as you and which this host does "
         "not allow: start `rubicon host` with --allow-firmware if you trust the coordinators";
}

} // namespace rubicon::deploy
