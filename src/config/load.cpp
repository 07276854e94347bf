#include "config/load.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <set>
#include <system_error>
#include <variant>

#include "config/document.hpp"
#include "config/file_readers.hpp"

namespace rubicon::config {

namespace {

ecology_description read_file_tables(const node& root, reading& shared) {
  const directory names(root);
  table_reader in(root, "the file", shared);
  ecology_description out;
  read_ecology(in, out);
  const auto end = in.sound() ? out.length : duration::max();
  const auto before_radio = shared.problems.size();
  read_radio(in, out.radio);
  const auto range_m = shared.problems.size() == before_radio
                           ? out.radio.range_m
                           : std::numeric_limits<double>::infinity();
  out.hosts = read_hosts(in);
  surroundings with{shared, names, range_m, read_mote_types(in, names), {}, {}, {}};
  out.islands = read_islands(in, with);
  out.airs = read_airs(in, names, out.islands);
  out.peers = read_peers(in, with, out.islands);
  out.proxies = read_proxies(in);
  out.faults = read_faults(in, names, end);
  in.finish();
  if (!in.has("island") && !in.has("peer"))
    in.problems().add(in.at(), "the file has neither an [[island]] nor a [[peer]]");
  return out;
}

loaded refused(const std::string& path, std::string message) {
  return {std::nullopt, {problem{path, 0, 0, std::move(message)}}};
}

std::string reason(int error) {
  return std::generic_category().message(error);
}

} // namespace

loaded load_text(std::string_view toml, const std::string& file_name) {
  const auto parsed = parse(toml, file_name);
  if (const auto* wrong = std::get_if<problem>(&parsed))
    return {std::nullopt, {*wrong}};
  reading shared;
  auto ecology = read_file_tables(std::get<node>(parsed), shared);
  if (!shared.problems.empty())
    return {std::nullopt, shared.problems.of_file(file_name)};
  return {std::move(ecology), {}};
}

loaded load_file(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return refused(path, "is a directory, not a file");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (file == nullptr)
    return refused(path, "cannot be opened: " + reason(errno));
  std::string text(file_octets_max + 1, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  if (std::ferror(file.get()) != 0)
    return refused(path, "cannot be read: " + reason(errno));
  return load_text(text, path);
}

std::vector<std::pair<std::string, std::string>> accepted_keys() {
  std::set<accepted_key> keys;
  reading walk;
  walk.accepted = &keys;
  static_cast<void>(read_file_tables(node{{1, 1}, node_table{}}, walk));
  return {keys.begin(), keys.end()};
}

} // namespace rubicon::config
