// Reads ways of what moves, and the larger models of transducers.
#pragma once

#include "config/toml/table_reader.hpp"
#include "device/transducer_config.hpp"
#include "device/waypoint.hpp"

namespace rubicon::config {

/// path = [["0s", [0, 2]], ["1min", [30, 2]]] of what may move. It begins at 0 s, with its first
/// point or with the table's position_m.
/// @param has_place position_m is read, into `place`; if not, the path sets it
void read_path(table_reader& in, bool has_place, position& place,
               std::vector<device::waypoint>& out);

/// model = "field"
[[nodiscard]] device::field_model read_field(table_reader& in);

/// model = "trace", with the file that it names.
/// @param kind its word is the default of `column`
[[nodiscard]] device::trace_model read_trace(table_reader& in, device::quantity kind);

} // namespace rubicon::config
