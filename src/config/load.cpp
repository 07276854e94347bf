#include "config/load.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <system_error>
#include <variant>

#include "config/file_readers.hpp"
#include "config/toml/schema.hpp"
#include "config/toml/written.hpp"
#include "config/trace_files.hpp"
#include "core/text/spelling.hpp"

namespace rubicon::config {

namespace {

/// The names of the file, read before any reader knows them; problems are reported by the second
/// pass.
directory names_in(const node& root) {
  reading quiet;
  table_reader in(root, "the file", quiet);
  ecology_description all;
  surroundings with(quiet, all.radio, all.seed);
  with.radio_is_known = false;
  read_quantities(in);
  with.types = read_mote_types(in);
  all.hosts = read_hosts(in);
  all.smepp = read_smepp(in, all.seed);
  all.islands = read_islands(in, with);
  all.peers = read_peers(in, with, all.islands);
  directory out(all);
  for (const auto& [name, profile] : with.types)
    out.mote_types.insert(name);
  return out;
}

/// put_parameters() has checked and used it.
struct parameter_value {
  using type = json_text;
  [[nodiscard]] static std::optional<json_text> read(const node& /*x*/, const asker& /*who*/) {
    return json_text();
  }
  [[nodiscard]] static form takes() {
    return types_form("text, number, flag or `{ from = ..., to = ... }`",
                      {"string", "number", "boolean", "object"});
  }
};

/// Its values stand where the file names them.
struct parameter_table {
  std::optional<named_values<json_text>> values;
};

auto parameter_keys() {
  return keys::of(
      keys::optional(parameters_key, &parameter_table::values, pairs_of<parameter_value>{},
                     {"values that texts of the file name, as in `\"${loss}\"`", "none"}));
}

ecology_description read_file_tables(table_reader& in, const named_files& files) {
  auto& shared = in.shared();
  if (!in.walks())
    shared.names = std::make_shared<const directory>(names_in(in.content()));
  ecology_description out;
  read_ecology(in, out);
  if (in.sound())
    shared.end = out.length;
  const auto links = read_radio(in, files, out.radio);
  out.hosts = read_hosts(in);
  surroundings with(shared, out.radio, files.instead.seed.value_or(out.seed));
  with.mode = files.instead.mode.value_or(out.mode);
  with.tick = out.tick;
  with.day_begins = out.day_begins;
  read_quantities(in);
  out.smepp = read_smepp(in, with.seed);
  with.radio_is_known = links.sound;
  with.types = read_mote_types(in);
  out.islands = read_islands(in, with);
  out.airs = read_airs(in, out.islands);
  check_links(links, out.radio, out.airs, shared.problems);
  out.peis = read_peis(in);
  out.peers = read_peers(in, with, out.islands);
  out.proxies = read_proxies(in, files.known.programs, out.islands, out.peers, with.labels);
  out.labels = std::move(with.labels);
  read_mqtt(in, out);
  read_ros2(in, out);
  out.tags = read_tags(in);
  check_object_manager(in, out.peers, out.proxies);
  out.faults = read_faults(in, with, out.islands);
  std::ranges::move(read_changes(in, with, out), std::back_inserter(out.faults));
  out.expectations = read_expectations(in);
  out.bluetooth_devices = read_bluetooth_devices(in);
  parameter_table ignored;
  in.all(ignored, parameter_keys());
  in.finish();
  check_end(in, out);
  if (!in.has("island") && !in.has("peer"))
    in.problems().add(in.at(), "the file has neither an [[island]] nor a [[peer]]");
  return out;
}

std::string reason(int error) {
  return std::generic_category().message(error);
}

/// Of a file that is not there: the one that is meant, or those of its kind beside it.
std::string files_beside(const std::string& path) {
  constexpr std::size_t listed_max = 5;
  const std::filesystem::path wanted(path);
  const auto folder = wanted.has_parent_path() ? wanted.parent_path().string() : std::string(".");
  const auto all = read_folder(folder);
  if (!all.names)
    return {};
  std::vector<std::string> alike;
  for (const auto& each : *all.names)
    if (std::filesystem::path(each).extension() == wanted.extension())
      alike.push_back(each);
  if (const auto meant = nearest(wanted.filename().string(), alike); !meant.empty())
    return "; did you mean `" + meant + "`?";
  std::string text;
  for (std::size_t i = 0; i < std::min(alike.size(), listed_max); ++i)
    text += (i == 0 ? "; there is " : ", ") + alike[i];
  return alike.size() > listed_max ? text + ", ..." : text;
}

std::string why_unopened(const std::string& path, int error) {
  return "cannot be opened: " + reason(error) + (error == ENOENT ? files_beside(path) : "");
}

file_text no_file(const std::string& /*path*/, std::size_t /*octets_max*/) {
  return {std::nullopt, "cannot be opened here"};
}

folder_names no_folder(const std::string& /*path*/) {
  return {std::nullopt, "cannot be opened here"};
}

/// Of a file that has not been read.
std::uint64_t seed_of(const node& root) {
  const auto* run = root.find("ecology");
  const auto* given = run == nullptr ? nullptr : run->find("seed");
  const auto* seed = given == nullptr ? nullptr : given->as<std::int64_t>();
  return seed == nullptr ? ecology_description().seed : static_cast<std::uint64_t>(*seed);
}

resolved resolve(std::string_view toml, const std::string& file_name, const settings& all,
                 std::optional<std::uint64_t> seed, complaints& problems) {
  auto parsed = parse(toml, file_name);
  if (auto* wrong = std::get_if<problem>(&parsed))
    return std::vector{std::move(*wrong)};
  auto& root = std::get<node>(parsed);
  apply(all, root, problems);
  put_parameters(root, seed.value_or(seed_of(root)), problems);
  if (!problems.empty())
    return with_settings(problems.of_file(file_name), all);
  return std::move(root);
}

} // namespace

resolved resolve(std::string_view toml, const std::string& file_name, const settings& all,
                 std::optional<std::uint64_t> seed) {
  complaints problems;
  return resolve(toml, file_name, all, seed, problems);
}

std::string resolved_text(std::string_view toml, const settings& all) {
  auto parsed = parse(all.empty() ? std::string_view() : toml, {});
  auto* root = std::get_if<node>(&parsed);
  complaints problems;
  if (root != nullptr)
    apply(all, *root, problems);
  return all.empty() || root == nullptr || !problems.empty() ? std::string(toml) : written(*root);
}

file_text read_file(const std::string& path, std::size_t octets_max) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return {std::nullopt, "is a directory, not a file"};
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (file == nullptr)
    return {std::nullopt, why_unopened(path, errno)};
  return read_stream(*file, octets_max);
}

file_text read_stream(std::FILE& file, std::size_t octets_max) {
  std::string text;
  std::array<char, 65536> part{};
  for (std::size_t got = 1; got > 0 && text.size() <= octets_max;) {
    got = std::fread(part.data(), 1, part.size(), &file);
    text.append(part.data(), got);
  }
  if (std::ferror(&file) != 0)
    return {std::nullopt, "cannot be read: " + reason(errno)};
  if (text.size() > octets_max)
    return {std::nullopt, "is larger than " + std::to_string(octets_max) + " octets"};
  return {std::move(text), {}};
}

folder_names read_folder(const std::string& path) {
  constexpr std::size_t files_max = 1000;
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator at(path, error), end; !error && at != end;
       at.increment(error)) {
    names.push_back(at->path().filename().string());
    if (names.size() > files_max)
      return {std::nullopt, "has more than " + std::to_string(files_max) + " files"};
  }
  if (error)
    return {std::nullopt, "cannot be opened: " + error.message()};
  std::sort(names.begin(), names.end());
  return {std::move(names), {}};
}

loaded load_text(std::string_view toml, const std::string& file_name, const overrides& instead,
                 const file_reader& read, const folder_reader& list, const extensions& known) {
  reading shared;
  auto root = resolve(toml, file_name, instead.settings, instead.seed, shared.problems);
  if (auto* wrong = std::get_if<std::vector<problem>>(&root))
    return {std::nullopt, std::move(*wrong)};
  const named_files files{file_name, instead, read ? read : no_file, list ? list : no_folder,
                          known};
  trace_files traces(files);
  shared.traces = &traces;
  shared.files = &files;
  table_reader in(std::get<node>(root), "the file", shared);
  auto ecology = read_file_tables(in, files);
  if (!shared.problems.empty())
    return {std::nullopt, with_settings(shared.problems.of_file(file_name), instead.settings),
            shared.problems.skipped()};
  return {std::move(ecology),
          {},
          shared.problems.skipped(),
          with_settings(shared.problems.warnings_of(file_name), instead.settings),
          std::move(shared.seen),
          instead.settings};
}

loaded load_file(const std::string& path, const overrides& instead, const extensions& known) {
  auto file = read_file(path, file_octets_max);
  if (!file.text)
    return {std::nullopt, {problem{path, 0, 0, std::move(file.reason)}}};
  return load_with_files(*file.text, path, instead, known);
}

loaded load_with_files(std::string_view toml, const std::string& file_name,
                       const overrides& instead, const extensions& known) {
  return load_text(toml, file_name, instead, read_file, read_folder, known);
}

table_description describe_file() {
  reading walk;
  walk.walks = true;
  const node nothing{{1, 1}, node_table{}};
  table_reader in(nothing, "the file", walk);
  static_cast<void>(read_file_tables(in, {"", {}, no_file}));
  return in.found();
}

} // namespace rubicon::config
