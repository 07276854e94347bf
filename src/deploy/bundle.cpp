#include "deploy/bundle.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <set>
#include <utility>

#include "config/plan/placement.hpp"
#include "config/plan/secrets.hpp"
#include "config/toml/document.hpp"
#include "core/hash.hpp"

namespace rubicon::deploy {

namespace {

void add_text(fold64& hash, const std::string& x) {
  hash.add(x.size()).add(std::string_view(x));
}

} // namespace

std::string hash_of(const bundle& x) {
  fold64 hash;
  add_text(hash, x.toml);
  for (const auto& [path, content] : x.files) {
    add_text(hash, path);
    add_text(hash, content);
  }
  for (const auto& [path, names] : x.folders) {
    add_text(hash, path);
    for (const auto& name : names)
      add_text(hash, name);
  }
  return to_hex(hash.value());
}

void place(config::ecology_description& out, const std::vector<host_place>& places) {
  for (auto& host : out.hosts) {
    const auto found = std::ranges::find(places, host.name, &host_place::host);
    if (found == places.end())
      continue;
    host.address = found->address;
    host.listen = found->address;
    host.control_port = found->control_port;
    host.peis_port = found->peis_port;
    host.networks.clear();
  }
}

packed pack(const std::string& path, const config::overrides& instead,
            std::optional<duration> length, const config::extensions& known) {
  packed out;
  out.what.name = path;
  auto read = config::read_file(path, config::file_octets_max);
  if (!read.text) {
    out.loaded.problems.push_back({path, 0, 0, read.reason});
    return out;
  }
  out.what.toml = *std::move(read.text);
  std::size_t octets = out.what.toml.size();
  bool is_too_large = false;
  const auto read_file = [&](const std::string& file, std::size_t octets_max) {
    auto found = config::read_file(file, octets_max);
    if (found.text) {
      octets += found.text->size();
      is_too_large = is_too_large || octets > bundle_octets_max;
      if (!is_too_large)
        out.what.files[file] = *found.text;
    }
    return found;
  };
  const auto read_folder = [&](const std::string& folder) {
    auto found = config::read_folder(folder);
    if (found.names)
      out.what.folders[folder] = *found.names;
    return found;
  };
  out.loaded = config::load_text(out.what.toml, path, instead, read_file, read_folder, known);
  if (out.loaded.ecology && !instead.settings.empty()) {
    out.what.toml = config::resolved_text(out.what.toml, instead.settings);
    auto resolved = instead; // places of secrets are those of the text that is sent
    resolved.settings.clear();
    out.loaded = config::load_text(out.what.toml, path, resolved, read_file, read_folder, known);
  }
  if (is_too_large)
    out.loaded.problems.push_back({path, 0, 0,
                                   "it names files of more than " +
                                       std::to_string(bundle_octets_max >> 20) +
                                       " MiB in total, too much to send to hosts"});
  if (out.loaded.ecology && !config::without(out.loaded.seen.secrets, out.what.toml))
    out.loaded.problems.push_back(
        {path, 0, 0, "its keys cannot be separated from the rest: write them as plain texts"});
  if (!out.loaded.problems.empty() || !out.loaded.ecology)
    return out;
  auto& ecology = *out.loaded.ecology;
  ecology.seed = instead.seed.value_or(ecology.seed);
  ecology.length = length.value_or(ecology.length);
  out.what.seed = ecology.seed;
  out.what.length = ecology.length;
  return out;
}

config::loaded load(const bundle& x, config::overrides instead, const config::extensions& known) {
  instead.seed = instead.seed.value_or(x.seed);
  const auto read_file = [&x](const std::string& path, std::size_t octets_max) {
    const auto found = x.files.find(path);
    if (found == x.files.end())
      return config::file_text{std::nullopt, "is not among the files that were sent"};
    if (found->second.size() > octets_max)
      return config::file_text{std::nullopt, "is too long"};
    return config::file_text{found->second, {}};
  };
  const auto read_folder = [&x](const std::string& path) {
    const auto found = x.folders.find(path);
    if (found == x.folders.end())
      return config::folder_names{std::nullopt, "is not among the folders that were sent"};
    return config::folder_names{found->second, {}};
  };
  auto out = config::load_text(x.toml, x.name, instead, read_file, read_folder, known);
  if (out.ecology) {
    out.ecology->seed = *instead.seed;
    out.ecology->length = x.length;
    place(*out.ecology, x.places);
  }
  return out;
}

bundle part_of(const bundle& what, const config::ecology_description& all,
               const std::vector<config::secret_place>& secrets, const std::string& host) {
  const auto needed = config::secrets_of(config::part_of(all, host));
  std::vector<config::secret_place> withheld;
  std::ranges::copy_if(secrets, std::back_inserter(withheld),
                       [&needed](const auto& x) { return !needed.contains(x.name); });
  auto out = what;
  for (const auto& each : withheld)
    out.withheld.push_back(each.name);
  std::ranges::sort(out.withheld);
  auto text = config::without(withheld, what.toml);
  assert(text); // pack() has seen to it
  out.toml = *std::move(text);
  return out;
}

std::string lacks(const bundle& part, const config::ecology_description& all,
                  const config::fault& x) {
  for (const auto& each : config::secrets_of(all, x))
    if (std::ranges::binary_search(part.withheld, each))
      return "it needs `" + each + "`, which was not sent to this host because none of its motes " +
             "needed it; plan the fault in the file";
  return {};
}

std::vector<host_place>
places_on_one_computer(const config::ecology_description& all,
                       const std::function<bool(std::uint16_t port)>& is_free) {
  std::set<std::uint16_t> taken;
  for (const auto& peer : all.peers)
    if (peer.tcp && peer.tcp->port)
      taken.insert(*peer.tcp->port);
  const auto take = [&](std::uint16_t wanted) {
    constexpr std::uint16_t lowest = 1024;
    auto port = wanted;
    while (taken.contains(port) || !is_free(port)) {
      port = port == 65535 ? lowest : static_cast<std::uint16_t>(port + 1);
      if (port == wanted)
        break; // none is left: who listens will say so
    }
    taken.insert(port);
    return port;
  };
  std::vector<host_place> out;
  for (const auto& host : config::used_hosts(all)) {
    const auto control_port = take(host.control_port);
    out.push_back({host.name, loopback, control_port, take(host.peis_port)});
  }
  return out;
}

} // namespace rubicon::deploy
