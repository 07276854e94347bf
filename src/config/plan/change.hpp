// What may change while an ecology runs (ACT-10): a planned change is no fault, but happens as one
// does.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/describe/changes.hpp"
#include "core/time.hpp"
#include "proxy/classes/class_change.hpp"
#include "smepp/member_config.hpp"

namespace rubicon::config {

/// From now on the debug log has messages of these only (NFR-02).
struct debug_change {
  std::vector<std::string> of; ///< patterns of debug_selection; empty: no actor's
};

/// A sampler or a messenger of a mote has other settings, in all lives that the mote has as a mote
/// of its present type.
struct program_change {
  mote_address mote;
  std::optional<std::uint16_t> sampler = {};   ///< its channel; one of the two is set
  std::optional<std::uint16_t> messenger = {}; ///< its AM type
  keys::key_changes settings = {}; ///< of the keys that apps/app_keys.hpp calls changeable
};

/// One direction between two radios of an air, as a link of [radio] says it. One of both is set.
struct link_change {
  mote_address from;
  mote_address to;
  std::optional<double> loss = {}; ///< 0..1
  std::optional<double> gain_db = {};
};

/// Motes with the program `member` have other network keys, in this life and in later ones
/// (SMP-02).
struct network_keys_change {
  smepp::key network_key;
  std::optional<smepp::key> network_mac = {}; ///< nothing: as before
  std::vector<mote_address> motes = {};       ///< empty: all that have the program
};

/// What a `kind` of a change may be.
inline constexpr std::array<std::string_view, 6> change_kinds{
    "debug", "rate", "program", "link", "proxy_class", "network_keys"};

/// Why there is no such kind, if it is something that does not change while an ecology runs; else
/// empty.
[[nodiscard]] std::string_view why_fixed(std::string_view kind);

using change = std::variant<debug_change, program_change, link_change, proxy::class_change,
                            network_keys_change>;

} // namespace rubicon::config
