// Reads what a mote is made of: transducers, actuators, apps, and the mote types that bundle them.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "config/claims.hpp"
#include "config/directory.hpp"
#include "config/ecology.hpp"
#include "config/table_reader.hpp"

namespace rubicon::config {

/// An app, and the places that later checks complain about.
struct placed_app {
  mote_app app;
  mark channel_at;
  std::vector<mark> needs_at; ///< of each transducer, or of the actuator
};

/// What a mote type and a mote have in common. A mote starts with its type's and changes it.
struct mote_profile {
  std::uint32_t type = 0;
  const radio::platform* platform = nullptr;
  std::optional<double> battery_mah;
  std::vector<mote::transducer_config> transducers; ///< ascending by kind
  std::vector<mote::actuator_config> actuators;
  std::vector<placed_app> apps;
};

using mote_types = std::map<std::string, mote_profile, std::less<>>;

/// The keys of both [mote_type.NAME] and [[island.mote]], except `type`. Transducers replace those
/// of the same quantity, actuators those of the same name; an app replaces one of the same kind on
/// the same channel or AM type, and is added otherwise.
void read_profile(table_reader& in, const directory& names, mote_profile& out);

/// Complains about apps that name an absent transducer or actuator, and about two apps with one
/// channel.
void check_profile(const mote_profile& x, reading& shared);

/// [mote_type.NAME]
[[nodiscard]] mote_types read_mote_types(table_reader& root, const directory& names);

/// transducers.QUANTITY, into `out`.
void read_transducers(table_reader& in, std::vector<mote::transducer_config>& out);

/// actuators = [{ ... }], into `out`.
void read_actuators(table_reader& in, std::vector<mote::actuator_config>& out);

/// apps = [{ app = ... }] of a mote.
[[nodiscard]] std::vector<placed_app> read_mote_apps(table_reader& in, const directory& names);

/// The word for a quantity in a file.
[[nodiscard]] std::string_view word_of(mote::quantity x);

} // namespace rubicon::config
