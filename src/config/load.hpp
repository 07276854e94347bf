// From a TOML file to the description of an ecology, or to all that is wrong with it (GEN-04,
// GEN-06).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "apps/registry.hpp"
#include "config/plan/ecology.hpp"
#include "config/plan/places.hpp"
#include "config/toml/document.hpp"
#include "config/toml/problem.hpp"
#include "config/toml/settings.hpp"
#include "proxy/classes/program.hpp"

namespace rubicon::config {

struct loaded {
  std::optional<ecology_description> ecology; ///< only if there are no problems
  std::vector<problem> problems;              ///< in order of place, those of named files last
  std::vector<problem> skipped = {};          ///< of named files that are left out
  std::vector<problem> warnings = {}; ///< what is no mistake, but hardly what is meant, in order,
                                      ///< as far as it is seen while the file is read
  file_places seen = {};              ///< for the rest of these: warnings.hpp
  config::settings settings = {};     ///< that places may be of
};

/// What a command line may say in the place of the TOML file.
struct overrides {
  std::string topology;                        ///< path; empty: [radio.propagation] topology
  std::string noise_trace;                     ///< path; empty: [radio.noise] file
  std::optional<std::uint64_t> seed;           ///< it decides where the motes of a disk are
  std::optional<run_mode> mode = std::nullopt; ///< it decides what may be real
  std::optional<duration> time_of_day{};       ///< that `start = "now"` stands for; unset: midnight
  std::vector<proxy::clock_change> clock_changes{}; ///< of that clock, during the run
  config::settings settings = {};                   ///< written into the file before it is read
};

/// What files may name beside what every binary has.
struct extensions {
  proxy::program_registry programs = proxy::built_in_programs(); ///< `program` of a [[proxy]]
  apps::registry applications = {};                              ///< `app` of motes and peers
};

/// The text of a file, or why there is none: `cannot be opened: No such file or directory`.
struct file_text {
  std::optional<std::string> text;
  std::string reason;
};

/// Reads a file; one of more than `octets_max` octets has no text.
using file_reader = std::function<file_text(const std::string& path, std::size_t octets_max)>;

/// From the disk.
[[nodiscard]] file_text read_file(const std::string& path, std::size_t octets_max);

/// The same of a file that is open, from where it is to its end.
[[nodiscard]] file_text read_stream(std::FILE& file, std::size_t octets_max);

/// The names of the files in a folder, sorted, or why they are not known.
struct folder_names {
  std::optional<std::vector<std::string>> names;
  std::string reason;
};

using folder_reader = std::function<folder_names(const std::string& path)>;

/// From the disk; more than 1000 files are refused.
[[nodiscard]] folder_names read_folder(const std::string& path);

/// A file as its readers see it, with settings and parameters in place; or the reasons why there is
/// none.
/// @param seed decides parameters that are drawn; unset: the file's does
using resolved = std::variant<node, std::vector<problem>>;
[[nodiscard]] resolved resolve(std::string_view toml, const std::string& file_name,
                               const settings& all,
                               std::optional<std::uint64_t> seed = std::nullopt);

/// The text of a file with settings in place, which still names its parameters; the text itself
/// without any setting, or if there is a problem.
[[nodiscard]] std::string resolved_text(std::string_view toml, const settings& all);

/// A syntax error hides everything else, and so does a setting or parameter that cannot be put in
/// place; all other problems are reported together.
/// @param file_name how problems call the text; names in it are relative to this file's folder
/// @param read reads the files that the text names; without it, none can be opened
/// @param known a file that names another program or application has a problem
/// @param list lists the folders that the text names; the same
[[nodiscard]] loaded load_text(std::string_view toml, const std::string& file_name,
                               const overrides& instead = {}, const file_reader& read = {},
                               const folder_reader& list = {}, const extensions& known = {});

/// The same, with what it names read from the disk.
[[nodiscard]] loaded load_with_files(std::string_view toml, const std::string& file_name,
                                     const overrides& instead = {}, const extensions& known = {});

/// The same for a file. One that is missing, unreadable, a directory, binary or empty is one
/// problem.
[[nodiscard]] loaded load_file(const std::string& path, const overrides& instead = {},
                               const extensions& known = {});

} // namespace rubicon::config
