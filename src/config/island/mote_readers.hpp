// Reads what a mote is made of: transducers, actuators, apps, and the mote types that bundle them.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "config/plan/ecology.hpp"
#include "config/plan/references.hpp"
#include "config/plan/uniqueness.hpp"
#include "config/toml/table_reader.hpp"
#include "core/shared_list.hpp"

namespace rubicon::config {

/// An app, and the places that later checks complain about.
struct placed_app {
  mote_app app;
  mark channel_at;            ///< of the app itself if it has no channel of its own
  std::vector<mark> needs_at; ///< of each transducer, or of the actuator
  /// `to` and `via` of a sender, `next` of a relay; unset: not in the file, or wrong.
  std::vector<located<std::optional<flow_end>>> ends;
  std::vector<std::optional<double>> dead_band = {}; ///< of each transducer, in its unit
};

/// What a mote type and a mote have in common. A mote starts with its type's and changes it.
struct mote_profile {
  mote_description like; ///< without id, name, place and apps; a micaz; transducers ascend by kind
  mark transmit_at;
  mark access_at; ///< of the last `csma`
  std::vector<placed_app> apps;

  mote_profile() { like.platform = radio::find_platform("micaz"); }

  /// The same with its apps.
  [[nodiscard]] mote_description mote() const;
};

using mote_types = std::map<std::string, mote_profile, std::less<>>;

/// The keys of both [mote_type.NAME] and [[island.mote]], except `type`. Transducers replace those
/// of the same quantity, actuators those of the same name; an app replaces one of the same kind on
/// the same channel or AM type, and is added otherwise.
void read_profile(table_reader& in, mote_profile& out);

/// Complains about apps that name an absent transducer or actuator, about two apps with one channel
/// and two relays or receivers, and about a power that the platform does not have.
void check_profile(const mote_profile& x, reading& shared);

/// Complains about a power that the platform does not have.
void check_power(const radio::platform& platform, const std::optional<double>& dbm, mark at,
                 complaints& problems);

/// What a radio's channel may be.
inline constexpr whole<std::uint8_t> radio_channel{radio::channel_min, radio::channel_max};

/// `csma`. @param at of what check_access() and check_rules() complain
void read_access(table_reader& in, radio::access_parameters& out, mark& at);

/// Complains if macMinBE is above macMaxBE.
void check_access(const radio::access_parameters& x, mark at, complaints& problems);

/// Complains about parameters that the platform's medium access does not have.
void check_rules(const radio::channel_config& radio, const radio::platform& platform,
                 const radio::access_parameters& x, mark at, complaints& problems);

/// Turns the ends of flows into motes of `island`; complains about those of other islands.
void settle_flows(std::vector<placed_app>& apps, island_id island, mote_id sink,
                  complaints& problems);

/// Whether the app only measures the medium access: sender, relay or receiver.
[[nodiscard]] bool is_flow_app(const mote_app& x);

/// Whether the app is a plain program of TinyOS.
[[nodiscard]] bool is_plain_app(const mote_app& x);

/// Whether it is the firmware of the mote.
[[nodiscard]] bool is_firmware(const mote_app& x);

/// Whether the app needs nothing of a mote but its radio: a flow app, a member, or firmware.
[[nodiscard]] bool uses_radio_alone(const mote_app& x);

/// [mote_type.NAME]
[[nodiscard]] mote_types read_mote_types(table_reader& root);

/// transducers.QUANTITY, into `out`.
void read_transducers(table_reader& in, std::vector<device::transducer_config>& out);

/// Lets traces without a `mote` of their own replay what they have of `mote`; complains at `at` if
/// they have nothing.
/// @returns whether they have it
[[nodiscard]] bool settle_traces(shared_list<device::transducer_config>& transducers, mote_id mote,
                                 mark at, reading& shared);

/// actuators = [{ ... }], into `out`.
void read_actuators(table_reader& in, std::vector<device::actuator_config>& out);

/// app = "member" of a mote.
[[nodiscard]] placed_app read_member(table_reader& in);

/// firmware = "./blink.so" of a mote: one app, or none.
[[nodiscard]] std::vector<placed_app> read_firmware(table_reader& in);

/// apps = [{ app = ... }] of a mote.
[[nodiscard]] std::vector<placed_app> read_mote_apps(table_reader& in);

} // namespace rubicon::config
