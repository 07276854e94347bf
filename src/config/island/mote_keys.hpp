// The keys of motes, of mote types and of groups of motes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "config/island/mote_readers.hpp"
#include "config/label_keys.hpp"
#include "config/plan/island.hpp"
#include "config/plan/references.hpp"
#include "config/toml/values.hpp"

namespace rubicon::config {

inline auto profile_keys() {
  using x = mote_description;
  return keys::of(
      keys::optional(
          "platform", &x::platform, platform_name(),
          {"currents, receive slots and speed; a mote's is that of its type, if it has one",
           "`\"micaz\"`"}),
      keys::optional("battery", &x::battery_mah, charge{},
                     {"charge of the battery at the start", "the mote type's, or the platform's"}),
      keys::optional("power", &x::transmit_dbm, power_level{-100, 30},
                     {"transmit power: -25 to 0 dBm on a MicaZ or a TelosB, -17 to 3 dBm on an "
                      "IRIS; in a unit "
                      "disk (`range`) it changes only the charge used",
                      "the mote type's, or the platform's maximum",
                      "power, as the platform has it"}),
      keys::optional(
          "channel", &x::channel, radio_channel,
          {"channel of its radio, which exchanges frames only with radios of the same channel",
           "the mote type's, or the island's"}));
}

inline auto mote_type_keys() {
  return keys::of(
      keys::required("type", &mote_description::type, whole<std::uint32_t>{1},
                     "the signature that the mote reports at join, which selects its proxy"));
}

inline constexpr std::size_t prefix_length_max =
    26; // with a dash and five digits it is still a name

/// The `type` of a mote: a number, or the name of a mote type.
struct mote_kind {
  struct type {
    std::uint32_t number = 0;
    std::string name;
  };

  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who) {
    if (x.as<std::string>() == nullptr) {
      const auto number = config::read(whole<std::uint32_t>{1}, x, who);
      return number ? std::optional(type{*number, {}}) : std::nullopt;
    }
    const auto name = mote_type_name::read(x, who);
    return name ? std::optional(type{0, *name}) : std::nullopt;
  }
  [[nodiscard]] static form takes() {
    return types_form("name of a mote type, or a number", {"integer", "string"});
  }
};

/// How the names of a group's motes begin.
struct prefix_text {
  using type = std::string;

  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who) {
    const auto* found = x.as<std::string>();
    if (found == nullptr || !is_name(*found) || found->size() > prefix_length_max)
      return who.refuse(x, "1 to 26 letters, digits, - and _");
    return *found;
  }
  [[nodiscard]] static form takes() { return string_form("1 to 26 letters, digits, `-` and `_`"); }
};

/// The `type` of a mote, before it is looked up.
struct mote_type_choice {
  mote_kind::type kind;
};

inline auto mote_kind_keys(bool is_required) {
  return keys::of(keys::required_if(
      is_required, "type", &mote_type_choice::kind, mote_kind{},
      {"its mote type, or the number that it reports at join; required except with "
       "`stack = \"mac\"`, a base station or a real sink"}));
}

/// @param least id; plain motes may have 0
inline auto mote_id_keys(std::uint16_t least) {
  return keys::of(keys::required("id", &mote_description::id,
                                 whole<std::uint16_t>{least, mote_id_max},
                                 "TinyOS id, unique within the island"));
}

inline auto mote_name_keys() {
  return keys::of(keys::optional("name", &mote_description::name, labelled_name{},
                                 {"unique within the island",
                                  "the mote type's, or `mote`, followed by the id: `climate-7`",
                                  "name, but not `sink`"}));
}

inline auto mote_place_keys(bool is_required) {
  return keys::of(keys::required_if(
      is_required, "position_m", &mote_description::place, place{},
      "position; required except with `path`, `model = \"gains\"` or a real sink"));
}

inline auto movement_keys() {
  using x = mote_description;
  return keys::of(
      keys::optional("step", &x::step, time_span{10ms, 1h},
                     "how often its position is updated while it moves"),
      keys::optional(
          "stays_when_flat", &x::stays_when_flat, flag{},
          "when its battery is flat, it stays at its current position; else it is carried on"));
}

/// The motes of an [[island.group]].
struct mote_group {
  std::uint32_t count = 0;
  std::uint32_t first = 0;
  std::string prefix;
};

inline auto group_size_keys() {
  return keys::of(keys::required("count", &mote_group::count, whole<std::uint32_t>{1, mote_id_max},
                                 "number of motes"));
}

inline auto group_name_keys() {
  return keys::of(
      keys::optional(
          "first", &mote_group::first, whole<std::uint32_t>{1, mote_id_max},
          {"id of the first; the others follow",
           "the lowest one that begins a sufficiently long row of free ids: not of the sink, "
           "of `real`, of an `[[island.mote]]` or of an earlier group"}),
      keys::optional("prefix", &mote_group::prefix, prefix_text{},
                     {"first part of their names: `node-7`", "the mote type's name, or `mote`"}));
}

} // namespace rubicon::config
