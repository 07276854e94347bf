#include "config/peer/component_readers.hpp"
#include "peisinit/component_keys.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <utility>

namespace rubicon::config {

namespace {

constexpr std::size_t components_max = 64; ///< of an init
constexpr std::size_t component_file_octets_max = 65536;
constexpr text description{1000};

/// 31, or "+1" for the one after that of the init's peer.
struct component_id {
  using type = peer_id;
  peer_id own;

  [[nodiscard]] std::optional<peer_id> read(const node& x, const asker& who) const {
    const auto* plain = x.as<std::int64_t>();
    const auto* relative = x.as<std::string>();
    std::int64_t id = plain == nullptr ? 0 : *plain;
    if (relative != nullptr && relative->size() > 1 && relative->front() == '+') {
      const auto* end = relative->data() + relative->size();
      std::int32_t step = 0;
      const auto [last, error] = std::from_chars(relative->data() + 1, end, step);
      if (error == std::errc() && last == end && step > 0)
        id = std::int64_t{own.value} + step;
    }
    if (id < 1 || id > peer_id_max)
      return who.refuse(x, "a PEIS id from 1 to " + std::to_string(peer_id_max) +
                               ", or relative to the init's own, as in \"+1\"");
    return peer_id(static_cast<std::int32_t>(id));
  }
  [[nodiscard]] static form takes() {
    return types_form("1 to 65535, or `\"+1\"`", {"integer", "string"});
  }
};

/// A peer of the file.
struct component_peer {
  using type = std::string;

  [[nodiscard]] std::optional<std::string> read(const node& x, const asker& who) const {
    const auto* name = x.as<std::string>();
    if (name == nullptr)
      return who.refuse(x, "the name of a peer");
    if (who.in.names->ends.contains(*name))
      return *name;
    std::vector<std::string> known;
    for (const auto& [each, id] : who.in.names->ends)
      known.push_back(each);
    who.complain(x, "no peer is named `" + *name + '`' + suggestion(*name, known));
    return std::nullopt;
  }
  [[nodiscard]] static form takes() { return string_form("name of a peer"); }
};

/// @param own PEIS id of the init's peer
auto component_keys(peer_id own) {
  using peisinit::component;
  return keys::of(
      keys::required("name", &component::name, name_text{},
                     "no other component of the init has it"),
      keys::optional("peer", &component::peer, component_peer{},
                     "the component is this peer, with all its apps; it is on the host of its "
                     "init, and no component of another"),
      keys::optional(
          "command", &component::command, text{4000},
          "the component is a process that `/bin/sh` runs; needs `mode = \"wall\"`. It finds the "
          "options of its kernel, and the extra arguments, in the environment variable "
          "`PEISINIT`"),
      keys::optional("id", &component::id, component_id{own},
                     "PEIS id of a command, or its offset from the init's; it is unique"));
}

auto init_folder_keys() {
  return keys::of(keys::optional(
      "folder", &placed_init::folder, text{path_octets_max},
      {"each of its files `*.toml` describes one component with the keys below; an invalid "
       "one is reported and skipped",
       "none", "folder"}));
}

auto init_keys() {
  return keys::of(keys::optional(
      "lock", &init_app::lock, text{path_octets_max},
      {"in wall time the init locks this file; a second init with the same file does not start",
       "one per host and user, in `$XDG_RUNTIME_DIR` or `/tmp`", "file"}));
}

placed_component read_component(table_reader& in, run_mode mode, peer_id own) {
  placed_component out;
  auto& x = out.what;
  in.all(x, component_keys(own));
  in.all(x);
  if (in.has("peer") == in.has("command"))
    in.problems().add(in.at(), "a component is either a `peer` or a `command`");
  else if (in.has("peer") && in.has("id"))
    in.problems().add(in.at("id"), "a peer of the file has its `id` already");
  else if (in.has("command") && !in.has("id"))
    in.problems().add(in.at(), "`id` is missing: a command has no PEIS id of its own");
  if (in.has("peer") && in.has("arguments"))
    in.problems().add(in.at("arguments"), "`arguments` have no effect on a peer of the file");
  if (in.has("command") && mode == run_mode::virtual_time)
    in.problems().add(in.at("command"), "`command` needs mode = \"wall\": in virtual time no "
                                        "process can be started");
  out.at = in.at();
  out.what_at = in.at(in.has("peer") ? "peer" : "command");
  out.id_at = in.at("id");
  return out;
}

using complain = std::function<void(mark at, std::string message)>;

/// Gives components to inits.
class settlement {
public:
  settlement(std::vector<peer_description>& peers, surroundings& with)
      : peers_(peers), with_(with) {
    for (const auto& [name, id] : with.shared.names->ends)
      ids_.insert(id);
  }

  /// @returns whether this host has no other init
  bool take_host(const placed_init& x) {
    const auto& peer = *peer_at(x.peer);
    const bool here = has_real_links(peer);
    const auto host = !peer.host.empty() ? "host `" + peer.host + '`'
                      : here             ? std::string("this computer")
                                         : "peer `" + peer.name + '`';
    return hosts_.add(host, host, x.at, with_.shared.problems, "already has an init");
  }

  /// @returns whether the component is good
  bool take(const placed_init& init, placed_component x, const complain& wrong) {
    auto& app = app_of(init);
    if (app.components.size() == components_max) {
      wrong(x.at, "an init has at most " + std::to_string(components_max) + " components");
      return false;
    }
    if (names_[init.peer].contains(folded(x.what.name))) {
      wrong(x.at, "component `" + x.what.name + "` is already there");
      return false;
    }
    if (x.what.peer.empty() ? !take_id(x, wrong) : !take_peer(init, x, wrong))
      return false;
    names_[init.peer].insert(folded(x.what.name));
    app.components.push_back(std::move(x.what));
    return true;
  }

private:
  peer_description* peer_at(peer_id id) {
    const auto found =
        std::find_if(peers_.begin(), peers_.end(), [id](const auto& x) { return x.id == id; });
    return found == peers_.end() ? nullptr : &*found;
  }

  static init_app* init_of(peer_description& x) {
    for (auto& app : x.apps) {
      if (auto* found = std::get_if<init_app>(&app))
        return found;
    }
    return nullptr;
  }

  init_app& app_of(const placed_init& x) { return *init_of(*peer_at(x.peer)); }

  bool take_id(const placed_component& x, const complain& wrong) {
    if (ids_.insert(x.what.id).second)
      return true;
    wrong(x.id_at, "PEIS id " + to_string(x.what.id) + " is already taken");
    return false;
  }

  bool take_peer(const placed_init& init, placed_component& x, const complain& wrong) {
    auto* peer = peer_at(with_.shared.names->ends.find(x.what.peer)->second);
    const auto& own = *peer_at(init.peer);
    const auto name = "peer `" + x.what.peer + '`';
    if (peer == nullptr || peer->name != x.what.peer)
      wrong(x.what_at, '`' + x.what.peer + "` is a gateway, not a peer");
    else if (init_of(*peer) != nullptr)
      wrong(x.what_at, name + " has an init: it is the first to start and the last to end");
    else if (peer->init)
      wrong(x.what_at, name + " is already a component");
    else if (!peer->host.empty() && peer->host != own.host)
      wrong(x.what_at, name + " is on host `" + peer->host + "`, and its init is not");
    else {
      peer->init = init.peer;
      peer->host = own.host;
      x.what.id = peer->id;
      return true;
    }
    return false;
  }

  std::vector<peer_description>& peers_;
  surroundings& with_;
  uniqueness<std::string> hosts_;
  std::set<peer_id> ids_;
  std::map<peer_id, std::set<std::string>> names_; ///< of each init's components
};

/// Adds what the files of a folder describe.
void take_folder(const placed_init& init, settlement& all, surroundings& with) {
  const auto& files = *with.shared.files;
  const auto folder = std::filesystem::path(files.toml).parent_path() / init.folder;
  const auto listed = files.list(folder.string());
  if (!listed.names) {
    with.shared.problems.add(init.folder_at, in_quotes(folder.string()) + ' ' + listed.reason);
    return;
  }
  for (const auto& name : *listed.names) {
    if (!name.ends_with(".toml"))
      continue;
    const auto path = (folder / name).string();
    auto& problems = with.shared.problems;
    const auto file = files.read(path, component_file_octets_max);
    if (!file.text) {
      problems.skip({path, 0, 0, file.reason});
      continue;
    }
    const auto parsed = parse(*file.text, path);
    if (const auto* wrong = std::get_if<problem>(&parsed)) {
      problems.skip(*wrong);
      continue;
    }
    reading own;
    own.names = with.shared.names;
    table_reader in(std::get<node>(parsed), "a component", own);
    auto found = read_component(in, with.mode, init.peer);
    in.finish();
    if (own.problems.empty())
      all.take(init, found,
               [&own](mark at, std::string message) { own.problems.add(at, std::move(message)); });
    for (auto& each : own.problems.of_file(path))
      problems.skip(std::move(each));
  }
}

} // namespace

init_app read_init(table_reader& in, surroundings& with, peer_id own,
                   std::vector<placed_init>& placed) {
  init_app out;
  placed_init x{own, in.at("app"), {}, {}, in.at("folder")};
  in.tables(
      "components", "components",
      "at most 64 including those of the folder, see below; also as `[[peer.apps.components]]`",
      [&](table_reader& y) {
        auto found = read_component(y, with.mode, own);
        if (y.sound())
          x.components.push_back(std::move(found));
      });
  in.all(x, init_folder_keys());
  in.all(out, init_keys());
  if (in.is_good("lock") && with.shared.files != nullptr)
    out.lock = (std::filesystem::path(with.shared.files->toml).parent_path() / out.lock).string();
  if (!in.has("components") && !in.has("folder"))
    in.problems().add(in.at(), "an init needs `components`, a `folder` of them, or both");
  placed.push_back(std::move(x));
  return out;
}

void settle_inits(std::vector<placed_init> inits, std::vector<peer_description>& peers,
                  surroundings& with) {
  const auto same_id = [](const auto& a, const auto& b) { return a.id == b.id; };
  if (peers.empty() || peers.front().id.value < 1 ||
      std::adjacent_find(peers.begin(), peers.end(), same_id) != peers.end())
    return; // their ids are not valid, which is reported already
  settlement all(peers, with);
  const complain wrong = [&with](mark at, std::string message) {
    with.shared.problems.add(at, std::move(message));
  };
  std::sort(inits.begin(), inits.end(),
            [](const auto& a, const auto& b) { return a.peer < b.peer; });
  for (auto& x : inits) {
    if (!all.take_host(x))
      continue;
    for (auto& each : x.components)
      static_cast<void>(all.take(x, std::move(each), wrong));
  }
  for (const auto& x : inits) {
    if (!x.folder.empty() && with.shared.files != nullptr)
      take_folder(x, all, with);
  }
}

} // namespace rubicon::config
