// Ecologies of motes for the benches that ask what a mote costs.
#pragma once

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "config/load.hpp"

namespace bench {

/// Equal islands: a sink amid a square grid of motes, 10 m apart with a range of 15 m, so that many
/// readings go over several hops. Each mote sends one a minute. Islands stand too far apart to hear
/// each other; their gateways are in one PEIS network.
/// @param islands 1 to 250
/// @param motes of each
/// @param one_air all islands share it; else each has an air of its own
inline rubicon::config::ecology_description mote_islands(unsigned islands, unsigned motes,
                                                         bool one_air) {
  constexpr unsigned in_a_row = 10;
  constexpr unsigned apart_m = 200;
  const auto columns = static_cast<unsigned>(std::ceil(std::sqrt(motes)));
  const auto centre_m = 10 * ((columns - 1) / 2) + 5; // between four motes
  std::ostringstream toml;
  toml << "[ecology]\nname = 'motes'\n[radio]\nrange = '15m'\n"
       << "[mote_type.m]\ntype = 1\n"
       << "transducers = { temperature = { model = 'constant', value = 20 } }\n"
       << "apps = [{ app = 'sampler', transducers = ['temperature'], every = '60s' }]\n";
  if (one_air) {
    toml << "[[air]]\nname = 'field'\nislands = [";
    for (unsigned i = 1; i <= islands; ++i)
      toml << "'island-" << i << "', ";
    toml << "]\n";
  }
  for (unsigned i = 0; i < islands; ++i) {
    const auto x_m = apart_m * (i % in_a_row);
    const auto y_m = apart_m * (i / in_a_row);
    toml << "[[island]]\nid = " << i + 1 << "\nname = 'island-" << i + 1
         << "'\nkeep_alive = '3min'\nsink.position_m = [" << x_m + centre_m << ", "
         << y_m + centre_m << "]\n"
         << "[[island.group]]\ncount = " << motes << "\nfirst = 2\ntype = 'm'\n"
         << "layout = 'grid'\ncolumns = " << columns << "\nspacing = '10m'\norigin = [" << x_m
         << ", " << y_m << "]\n";
  }
  auto loaded = rubicon::config::load_text(toml.str(), "motes.toml", {}, {});
  if (!loaded.ecology)
    throw std::logic_error("the bench's own ecology is refused");
  return *std::move(loaded.ecology);
}

} // namespace bench
