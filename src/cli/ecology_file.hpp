// A file that describes an ecology, or everything that is wrong with it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/load.hpp"
#include "config/plan/ecology.hpp"
#include "config/run/variation.hpp"

namespace rubicon::cli {

/// What FILE is called that is read from standard input.
inline constexpr const char* standard_input = "-";

/// What messages call FILE: `<stdin>` for standard input.
[[nodiscard]] std::string name_of_file(const std::string& file);

struct ecology_file {
  config::ecology_description ecology;
  std::uint64_t text_hash = 0;                ///< fold64 of the file's octets, settings in place
  std::vector<config::problem> warnings = {}; ///< valid, but probably not what is meant
  std::string text = {};                      ///< the file's octets as they were read
  config::variation varied = {};              ///< what the seed decides of it
};

/// Prints problems and warnings on standard error, one a line, at most 50 and then their count.
void complain(const config::loaded& x, const std::string& name);

/// Prints its warnings on standard error, one a line.
void warn(const ecology_file& x);

/// Complains of what is wrong.
/// @param file `-`: standard input
/// @param is_bundled it is a deploy::bundle
/// @returns nothing if there was a problem (GEN-06)
[[nodiscard]] std::optional<ecology_file> load_or_complain(const std::string& file,
                                                           const config::overrides& instead,
                                                           const config::extensions& known,
                                                           bool is_bundled = false);

} // namespace rubicon::cli
