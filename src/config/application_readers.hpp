// Reads the programs that use the Mockup interface, on motes and on peers.
#pragma once

#include <string_view>
#include <vector>

#include "apps/app_config.hpp"
#include "config/directory.hpp"
#include "config/table_reader.hpp"

namespace rubicon::config {

/// A mote as "island/mote", or a peer by its name.
struct node_name {
  using type = mote_address; ///< no_mote in the mote part: a peer
  const directory& names;
  [[nodiscard]] std::optional<mote_address> read(const node& x, const asker& who) const;
};

/// A program, and where the file names each transducer that it needs.
struct placed_program {
  apps::app_config app;
  std::vector<mark> needs_at;
};

[[nodiscard]] placed_program read_stream_writer(table_reader& in, const directory& names);
[[nodiscard]] placed_program read_stream_reader(table_reader& in);
/// @param senses whether its node can have transducers
[[nodiscard]] placed_program read_reservoir(table_reader& in, const directory& names, bool senses);
[[nodiscard]] placed_program read_readout(table_reader& in, const directory& names);

/// The transducers that a program needs, in the order of needs_at.
[[nodiscard]] std::vector<mote::quantity> needs(const apps::app_config& x);

/// The words for quantities in a file.
[[nodiscard]] std::vector<std::pair<std::string_view, mote::quantity>> quantities();

} // namespace rubicon::config
