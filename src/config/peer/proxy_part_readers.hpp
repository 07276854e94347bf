// Reads the parts of a [[proxy]] that not every class has.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "config/plan/ecology.hpp"
#include "config/plan/references.hpp"
#include "config/plan/uniqueness.hpp"
#include "config/toml/table_reader.hpp"
#include "proxy/classes/program.hpp"

namespace rubicon::config {

/// The names below one proxy's prefix.
class tuple_names {
public:
  void add(const std::string& name, mark at, complaints& problems);

private:
  name_uniqueness names_;
};

/// A template whose names are checked when all fields and properties are known.
struct placed_template {
  proxy::tuple_template what;
  mark key_at;
  mark text_at; ///< of `value` or `json`
};

/// [[proxy.tuple]]
[[nodiscard]] placed_template read_tuple_template(table_reader& in);

/// Complains about names that the class does not have, and about fields of several messages.
void check_tuple_template(const placed_template& x, const proxy::proxy_class& of,
                          complaints& problems);

/// program and settings, when all else of the class is read.
void read_program(table_reader& in, const proxy::program_registry& programs, tuple_names& names,
                  proxy::proxy_class& out);

/// Where a field says that its mote computes it.
struct placed_computation {
  std::string proxy;
  std::string field;
  mark at;
};

/// Where a field names its transducer, and what the file says of the field nevertheless.
struct placed_transducer {
  std::string proxy;
  std::string field;
  device::quantity kind;
  mark at;
  bool has_offset = false;
  bool has_scale = false;
  bool has_unit = false;
};

/// Where a field says that it is read from a stream.
struct placed_stream {
  std::string proxy;
  proxy::stream_input what;
  mark at;
};

/// Complains about streams that could not be read: they end at the peer of the proxy manager, where
/// each number has one read end.
void check_streams(const std::vector<placed_stream>& all,
                   const std::vector<proxy::proxy_class>& classes,
                   const std::vector<island_description>& islands,
                   const std::vector<peer_description>& peers, complaints& problems);

/// Channels on which all motes of a class send a sampler's stamp are stamped, and fields of four
/// octets where it stands are stamps.
void place_stamps(std::vector<proxy::proxy_class>& classes,
                  const std::vector<island_description>& islands);

/// Gives fields the offset, scale and unit of their transducers, as samplers of the motes send them
/// that the classes claim.
void place_transducers(const std::vector<placed_transducer>& all,
                       std::vector<proxy::proxy_class>& classes,
                       const std::vector<island_description>& islands, reading& shared);

/// Gives the computations to the samplers of the motes that the classes claim (PXY-17).
void place_computations(const std::vector<placed_computation>& all,
                        const std::vector<proxy::proxy_class>& classes,
                        std::vector<island_description>& islands, complaints& problems);

} // namespace rubicon::config
