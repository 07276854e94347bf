// What a file asks for that no table or medium can hold: one name for two ends of streams, more
// synaptic vectors than a tick has time for.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "apps/traffic.hpp"
#include "config/island/mote_readers.hpp"
#include "config/plan/uniqueness.hpp"
#include "config/toml/problem.hpp"
#include "serial/cable/line_config.hpp"

namespace rubicon::config {

/// The ends of streams and synaptic channels that a node's programs have: each of them is known to
/// the node by its name alone, so that two of one name would be refused for ever.
class end_uniqueness {
public:
  /// Complains about what an earlier program has.
  void add(const apps::app_config& x, mark at, complaints& problems);

private:
  void add_stream(bool writes, std::uint16_t name, mark at, complaints& problems);
  void add_synapses(bool is_out, const std::vector<apps::synapse>& ends, mark at,
                    complaints& problems);

  uniqueness<std::pair<bool, std::uint16_t>> streams_;
  uniqueness<std::pair<bool, mote_address>> synapses_;
};

/// Streams whose read ends a program has.
[[nodiscard]] std::vector<std::uint16_t> streams_read(const apps::app_config& x);

/// Programs of a mote, wherever they run.
[[nodiscard]] std::vector<apps::app_config> programs_of(const std::vector<placed_app>& all);

/// Complains about vectors that take a mote's radio longer than a tick.
/// @param programs of the mote; `at` is where they are in the file
void check_tick(const std::vector<apps::app_config>& programs, island_id island, duration tick,
                mark at, complaints& problems);

/// The same for the serial line of an island. @param all of its motes
void check_tick(const apps::traffic& all, const serial::line_config& line, duration tick, mark at,
                complaints& problems);

} // namespace rubicon::config
