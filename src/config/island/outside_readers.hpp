// What an island has of the real world: a sink, a gateway of others, programs of TinyOS.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "config/file_readers.hpp"
#include "config/toml/table_reader.hpp"
#include "serial/cable/line_config.hpp"

namespace rubicon::config {

/// At which end of the cable something is that the ecology has not made. @param island its name
void read_outside(table_reader& in, const surroundings& with, const std::string& island,
                  serial::outside_config& out);

/// [island.export]
void read_export(table_reader& island, const surroundings& with, island_description& out);

/// Names of real motes, and where the file gives them.
using real_names = std::vector<std::pair<mark, std::string>>;

/// [island.real]. @pre the island's sink and cable are read
[[nodiscard]] real_names read_real(table_reader& island, surroundings& with,
                                   island_description& out);

/// [[island.plain]]. @pre [island.real] is read
void read_plain(table_reader& island, island_description& out);

/// Complains about what needs a gateway of the ecology, in an island that leaves it to others.
void refuse_gateway(table_reader& in);

/// Complains about what needs a simulated sink: a real one has one cable, and others set its radio.
void refuse_simulated(table_reader& in);

} // namespace rubicon::config
