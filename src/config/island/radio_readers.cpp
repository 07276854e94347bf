#include <algorithm>
#include <filesystem>
#include <utility>

#include "config/file_readers.hpp"
#include "radio/medium/noise.hpp"
#include "radio/medium/tossim_files.hpp"
#include "radio/parameter_keys.hpp"

namespace rubicon::config {

namespace {

constexpr metres range_kind{0.1, 100'000};

/// A file that a TOML file names, and what the command line may say instead.
struct file_choice {
  std::string_view key;
  std::string_view option;
  const std::string& instead;
  const char* meaning;
};

/// Name of another file.
struct other_file {
  std::string name;
};

auto other_file_keys(const file_choice& x) {
  return keys::of(
      keys::optional(x.key, &other_file::name, text{path_octets_max}, {x.meaning, {}, "file"}));
}

auto gain_keys() {
  return keys::of(keys::optional(
      "first_mote", &radio::gain_matrix::first_mote, whole<std::uint16_t>{0, mote_id_max},
      "id of the mote that node 0 is; node 1 is the next one, and so on"));
}

auto range_keys() {
  return keys::of(keys::optional("range", &radio::unit_disk::range_m, range_kind,
                                 "short for `range` of a unit disk"));
}

/// Medium access of a platform.
struct platform_mac {
  std::string name;
};

auto platform_mac_keys(std::string_view platform) {
  return keys::of(keys::optional(platform, &platform_mac::name, mac_name(),
                                 {"of this platform", "`\"standard\"`"}));
}

auto radio_link_keys() {
  using x = radio::link_override;
  return keys::of(
      keys::required("from", &x::from, radio_name{}, "sender"),
      keys::required("to", &x::to, radio_name{}, "receiver"),
      keys::optional("loss", &x::loss, ratio{},
                     {"probability that a copy is lost on this link", "as in `[radio]`"}),
      keys::optional("gain", &x::gain_db, decibels{-200, 20},
                     {"received dBm at 0 dBm sent", "the model's"}));
}

/// The file's path and text; complains if it is not named or cannot be read.
std::optional<std::pair<std::string, std::string>>
named_text(table_reader& in, const file_choice& x, const named_files& files) {
  other_file found_name;
  in.all(found_name, other_file_keys(x));
  const auto& name = found_name.name;
  const bool good = in.is_good(x.key) || !in.has(x.key);
  if (in.walks() || !good)
    return std::nullopt;
  if (name.empty() && x.instead.empty()) {
    in.problems().add(in.at(), '`' + std::string(x.key) + "` is missing in " + in.title() +
                                   ": name the file there or with " + std::string(x.option));
    return std::nullopt;
  }
  const bool replaced = !x.instead.empty();
  const auto path =
      replaced ? x.instead : (std::filesystem::path(files.toml).parent_path() / name).string();
  auto found = files.read(path, radio::tossim_file_octets_max);
  if (found.text)
    return std::pair(path, *std::move(found.text));
  if (replaced)
    in.problems().add(problem{path, 0, 0, std::move(found.reason)});
  else
    in.problems().add(in.at(x.key), in_quotes(path) + ' ' + found.reason);
  return std::nullopt;
}

void add_problem(complaints& problems, const std::string& path, const radio::file_problem& x) {
  problems.add(problem{path, static_cast<unsigned>(x.line), 0, x.message});
}

radio::gain_matrix read_gains(table_reader& in, const named_files& files) {
  radio::gain_matrix out;
  in.all(out, gain_keys());
  const auto file =
      named_text(in,
                 {"topology", "--topology", files.instead.topology,
                  "relative to this file's folder; may be given by `--topology` instead"},
                 files);
  if (!file)
    return out;
  auto read = radio::read_topology(file->second);
  if (const auto* wrong = std::get_if<radio::file_problem>(&read))
    add_problem(in.problems(), file->first, *wrong);
  else
    out.table =
        std::make_shared<const radio::gain_table>(std::move(std::get<radio::gain_table>(read)));
  return out;
}

radio::noise_model read_trace(table_reader& in, const named_files& files) {
  radio::traced_noise out;
  const auto file =
      named_text(in,
                 {"file", "--noise-trace", files.instead.noise_trace,
                  "relative to this file's folder; may be given by `--noise-trace` instead"},
                 files);
  if (!file)
    return out;
  auto read = radio::read_noise_trace(file->second);
  if (const auto* wrong = std::get_if<radio::file_problem>(&read))
    add_problem(in.problems(), file->first, *wrong);
  else
    out.trace = std::get<std::shared_ptr<const radio::noise_trace>>(std::move(read));
  return out;
}

/// A model whose keys are listed beside it.
template <class Model, class Out>
table_reader::part_reader model_of(Out& out) {
  return [&out](table_reader& in) {
    Model found;
    in.all(found);
    out = found;
  };
}

bool is_disk(const radio::channel_config& x) {
  return std::holds_alternative<radio::unit_disk>(x.propagation);
}

bool is_noisy(const radio::channel_config& x) {
  return !std::holds_alternative<radio::no_noise>(x.noise);
}

void read_propagation(table_reader& in, const named_files& files, radio::propagation& out) {
  const std::string within = in.title();
  in.one_of("model", "propagation: signal strength of arriving frames",
            {{"unit_disk", model_of<radio::unit_disk>(out)},
             {"log_distance", model_of<radio::log_distance>(out)},
             {"friis", model_of<radio::friis>(out)},
             {"gains", [&](table_reader& x) { out = read_gains(x, files); }}},
            within);
}

void read_noise(table_reader& in, const named_files& files, radio::noise_model& out) {
  const std::string within = in.title();
  in.one_of("model", "kind of noise",
            {{"none", [&](table_reader&) { out = radio::no_noise{}; }},
             {"constant", model_of<radio::constant_noise>(out)},
             {"table", [&](table_reader&) { out = radio::table_noise{}; }},
             {"trace", [&](table_reader& x) { out = read_trace(x, files); }}},
            within);
}

/// `range` of [radio] is short for the table of a unit disk.
void read_range(table_reader& in, radio::channel_config& out) {
  auto* disk = std::get_if<radio::unit_disk>(&out.propagation);
  radio::unit_disk found;
  in.all(found, range_keys());
  if (!in.is_good("range"))
    return;
  if (disk == nullptr)
    in.problems().add(in.at("range"), "`range` belongs to model = \"unit_disk\": "
                                      "[radio.propagation] has another");
  else if (in.has("propagation") && in.content().find("propagation")->find("range") != nullptr)
    in.problems().add(in.at("range"),
                      "`range` is in [radio.propagation] already " +
                          place_text(in.content().find("propagation")->find("range")->at));
  else
    disk->range_m = found.range_m;
}

void read_reception(table_reader& in, radio::channel_config& out) {
  using radio::collision_rule;
  out.collisions = is_disk(out) ? collision_rule::strict : collision_rule::sinr;
  in.all(out, radio::reception_keys());
}

void read_macs(table_reader& in, radio::channel_config& out) {
  in.table("mac", "[radio.mac]", "rules of medium access", [&out](table_reader& x) {
    for (const auto& platform : radio::platforms()) {
      platform_mac found;
      x.all(found, platform_mac_keys(platform.name));
      if (x.is_good(platform.name))
        out.macs.emplace_back(platform.name, std::move(found.name));
    }
  });
}

void read_radio_links(table_reader& in, radio::channel_config& out, std::vector<mark>& places) {
  uniqueness<std::pair<mote_address, mote_address>> pairs;
  in.tables("link", "[[radio.link]]",
            about("links with their own loss or gain", "none")
                .changeable("loss and gain of a link, and further links"),
            [&](table_reader& x) {
              radio::link_override link;
              x.all(link, radio_link_keys());
              const bool ends = x.is_good("from") && x.is_good("to");
              if (!x.has("loss") && !x.has("gain"))
                x.problems().add(x.at(), "a link needs `loss`, `gain` or both");
              if (ends && link.from == link.to)
                x.problems().add(x.at("to"), "a link leads from one mote to another");
              else if (ends)
                pairs.add({link.from, link.to}, "the link", x.at("to"), x.problems(),
                          "is already listed");
              places.push_back(x.at());
              out.links.push_back(link);
            });
}

/// What a file says and what then has no effect.
struct idle_key {
  std::string_view key;
  bool idle = false;
  std::string_view why;
};

/// Refuses what decides nothing beside the rest. @pre everything could be read
void check_effects(const table_reader& in, const radio::channel_config& x) {
  const bool disk = is_disk(x);
  const bool strict = x.collisions == radio::collision_rule::strict;
  constexpr std::string_view all_hear =
      "with model = \"unit_disk\": all radios within range receive";
  constexpr std::string_view only_overlaps =
      "with model = \"unit_disk\" and collisions = \"strict\": only overlaps lose frames";
  constexpr std::string_view no_capture =
      "with collisions = \"strict\": every frame that overlaps another is lost";
  const idle_key keys[] = {
      {"sensitivity", disk, all_hear},
      {"sensitivity_edge", disk, all_hear},
      {"cutoff", disk, all_hear},
      {"cca_threshold", disk && strict, only_overlaps},
      {"cca_threshold", x.sensing == radio::sensing::carrier, "with sensing = \"carrier\""},
      {"noise", disk && strict && is_noisy(x), only_overlaps},
      {"curve", strict && !is_noisy(x) && x.edge == radio::sensitivity_edge::sharp,
       "with collisions = \"strict\" and without noise"},
      {"capture", strict && x.capture, no_capture},
  };
  for (const auto& each : keys)
    if (each.idle && in.has(each.key))
      in.problems().add(in.at(each.key),
                        '`' + std::string(each.key) + "` has no effect " + std::string(each.why));
}

void check_table_noise(const table_reader& in, const radio::channel_config& x) {
  if (!std::holds_alternative<radio::table_noise>(x.noise))
    return;
  const auto* gains = std::get_if<radio::gain_matrix>(&x.propagation);
  if (gains == nullptr)
    in.problems().add(in.at("noise"), "noise from the topology needs [radio.propagation] with "
                                      "model = \"gains\"");
  else if (gains->table != nullptr && gains->table->floors.empty())
    in.problems().add(in.at("noise"), "the topology has no `noise` lines");
}

/// A file on the command line takes the place of one that the model has; it makes no model.
void check_overrides(const named_files& files, const radio::channel_config& x,
                     complaints& problems) {
  if (!files.instead.topology.empty() && !std::holds_alternative<radio::gain_matrix>(x.propagation))
    problems.add(
        problem{files.toml, 0, 0, "--topology needs [radio.propagation] with model = \"gains\""});
  if (!files.instead.noise_trace.empty() && !std::holds_alternative<radio::traced_noise>(x.noise))
    problems.add(
        problem{files.toml, 0, 0, "--noise-trace needs [radio.noise] with model = \"trace\""});
}

} // namespace

placed_links read_radio(table_reader& root, const named_files& files, radio::channel_config& out) {
  placed_links links;
  const auto before = root.problems().size();
  root.table("radio", "[radio]", "properties of all radios", [&](table_reader& in) {
    in.all(out, radio::medium_keys());
    in.table("propagation", "[radio.propagation]",
             {"propagation: signal strength of arriving frames", "a unit disk"},
             [&](table_reader& x) { read_propagation(x, files, out.propagation); });
    const bool propagation_is_good = in.sound();
    if (propagation_is_good || in.walks())
      read_range(in, out);
    else
      in.expect("range");
    if (!is_disk(out))
      out.noise = radio::constant_noise{};
    in.table("noise", "[radio.noise]", {"noise", "none for a unit disk, else -98 dBm"},
             [&](table_reader& x) { read_noise(x, files, out.noise); });
    read_reception(in, out);
    read_macs(in, out);
    if (in.sound()) {
      check_effects(in, out);
      check_table_noise(in, out);
    }
    read_radio_links(in, out, links.at);
  });
  links.sound = root.problems().size() == before;
  if (links.sound && !root.walks())
    check_overrides(files, out, root.problems());
  return links;
}

void check_links(const placed_links& links, const radio::channel_config& config,
                 const std::vector<air_description>& airs, complaints& problems) {
  const auto air_of = [&airs](island_id island) {
    return std::find_if(airs.begin(), airs.end(), [island](const auto& x) {
      return std::find(x.islands.begin(), x.islands.end(), island) != x.islands.end();
    });
  };
  for (std::size_t i = 0; links.sound && i < config.links.size(); ++i) {
    const auto from = air_of(config.links[i].from.island);
    const auto to = air_of(config.links[i].to.island);
    if (from != airs.end() && to != airs.end() && from != to)
      problems.add(links.at[i], "a link leads from air `" + from->name + "` to air `" + to->name +
                                    "`, which are isolated from each other");
  }
}

} // namespace rubicon::config
