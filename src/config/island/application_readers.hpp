// Reads the programs that use the Mockup interface, on motes and on peers.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/app_config.hpp"
#include "config/plan/references.hpp"
#include "config/plan/uniqueness.hpp"
#include "config/toml/table_reader.hpp"

namespace rubicon::config {

/// A program, and where the file names each transducer that it needs.
struct placed_program {
  apps::app_config app;
  std::vector<mark> needs_at;
};

/// One kind of program: the word for it in a file, and what reads its table.
using program_kind = std::pair<std::string_view, std::function<placed_program(table_reader&)>>;

/// Programs for motes, with those that the binary has brought along.
/// @param in where they are listed, as in the next one
[[nodiscard]] std::vector<program_kind> mote_programs(const table_reader& in);

/// Programs for PCs. @param files those that recorders write so far; outlives what is returned
[[nodiscard]] std::vector<program_kind> pc_programs(const table_reader& in,
                                                    uniqueness<std::string>& files);

/// app = "lua". The script is read and compiled; what is wrong with it has its place in the script.
[[nodiscard]] placed_program read_lua(table_reader& in);

/// All programs of a PC. @param key of their array
[[nodiscard]] std::vector<apps::app_config> read_pc_programs(table_reader& in, std::string_view key,
                                                             const std::string& title,
                                                             uniqueness<std::string>& files);

/// The transducers that a program needs, in the order of needs_at.
[[nodiscard]] std::vector<device::quantity> needs(const apps::app_config& x);

} // namespace rubicon::config
