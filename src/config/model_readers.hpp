// Reads the larger models of transducers.
#pragma once

#include "config/table_reader.hpp"
#include "mote/transducer_config.hpp"

namespace rubicon::config {

/// model = "field"
[[nodiscard]] mote::field_model read_field(table_reader& in);

/// model = "trace", with the file that it names.
/// @param kind its word is the default of `column`
[[nodiscard]] mote::trace_model read_trace(table_reader& in, mote::quantity kind);

} // namespace rubicon::config
