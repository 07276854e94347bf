// The tuples between a gateway and its users: keys and values of D1.1 5.4, and nothing about motes.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"
#include "core/time.hpp"

namespace rubicon {

/// Key of the list of motes (GW-03).
inline constexpr std::string_view devices_key = "devices";
/// Prototype key of the type tuples of all motes of a gateway (GW-04, TUP-03).
inline constexpr std::string_view all_device_types_key = "devices.*.type";

/// What a tuple under `devices` says.
enum class device_tuple : std::uint8_t {
  list,          ///< `devices`
  line,          ///< `devices.line`
  role,          ///< `devices.role`
  gateways,      ///< `devices.gateways`
  status,        ///< `devices.$ID.status`
  type,          ///< `devices.$ID.type`
  descriptor,    ///< `devices.$ID.descriptor`
  output,        ///< `devices.$ID.output.$CH`
  output_period, ///< `devices.$ID.output.$CH.period`
  input,         ///< `devices.$ID.input.$CH`
  input_status,  ///< `devices.$ID.input.$CH.status`
};

/// A key under `devices`, taken apart.
struct device_key {
  device_tuple what = device_tuple::list;
  mote_id mote;              ///< 1..mote_id_max; 0 for the first four kinds
  std::uint16_t channel = 0; ///< 0 where the key has none

  friend bool operator==(const device_key&, const device_key&) = default;
};

/// The key as D1.1 5.4 writes it, numbers in decimal (GW-07). @pre mote in 1..mote_id_max except
/// for the first four kinds
[[nodiscard]] std::string to_string(const device_key& x);

/// Key of the state of the serial line to the sink: `up 12.345000`, since when in seconds of
/// ecology time; `silent 337.000000`: nothing has come for a while (GW-15).
inline constexpr std::string_view device_line_key = "devices.line";

/// Of a gateway that is not its island's only one (GW-14): `leads 12.345000` or `stands_by
/// 12.345000`, since when.
inline constexpr std::string_view device_role_key = "devices.role";
/// Of the same: PEIS ids of all of them, `{20,21}`, in the order in which they take over.
inline constexpr std::string_view device_gateways_key = "devices.gateways";

[[nodiscard]] std::string device_role_text(bool leads, instant since);

/// Whether it leads. @returns errc::bad_value for anything that device_role_text() does not make
[[nodiscard]] result<bool> parse_device_role(std::string_view text);

/// Prototype key of the status tuples of all motes of a gateway.
inline constexpr std::string_view all_device_statuses_key = "devices.*.status";

[[nodiscard]] std::string device_type_key(mote_id mote);
[[nodiscard]] std::string device_descriptor_key(mote_id mote);
[[nodiscard]] std::string device_status_key(mote_id mote);
[[nodiscard]] std::string device_output_key(mote_id mote, std::uint16_t channel);
[[nodiscard]] std::string device_output_period_key(mote_id mote, std::uint16_t channel);
[[nodiscard]] std::string device_input_key(mote_id mote, std::uint16_t channel);
[[nodiscard]] std::string device_input_status_key(mote_id mote, std::uint16_t channel);

/// Inverse of to_string(). Numbers are decimal without leading zeros or signs, a
/// mote 1..mote_id_max, a channel 0..65535; words may have any letter case, because keys are
/// compared without it (TUP-03). Anything else, wildcards included, is errc::bad_value.
[[nodiscard]] result<device_key> parse_device_key(std::string_view key);

/// Output tuples that a key, or a pattern of keys, names.
struct output_pattern {
  std::optional<mote_id> mote;          ///< nothing: `*`, every one
  std::optional<std::uint16_t> channel; ///< nothing: `*`

  friend bool operator==(const output_pattern&, const output_pattern&) = default;
};

/// `devices.$ID.output.$CH` whose parts but the first may be `*`. @returns errc::bad_value
/// otherwise
[[nodiscard]] result<output_pattern> parse_output_pattern(std::string_view key);

/// Value of `devices`: `{1,7,11}`, ascending and each once whatever the order of `motes`; `{}` for
/// none (GW-03).
[[nodiscard]] std::string device_list_text(std::vector<mote_id> motes);

/// Inverse of device_list_text(): no blanks, no leading zeros, ids 1..mote_id_max, strictly
/// ascending. @returns errc::bad_value otherwise
[[nodiscard]] result<std::vector<mote_id>> parse_device_list(std::string_view text);

/// Value of `devices.$ID.type`: 4 octets in network byte order (GW-04).
[[nodiscard]] bytes device_type_octets(std::uint32_t type);

/// @returns errc::truncated or errc::too_long unless there are exactly 4 octets
[[nodiscard]] result<std::uint32_t> parse_device_type(byte_view octets);

/// What a gateway knows of a mote.
enum class device_presence : std::uint8_t {
  listed, ///< in the island, as far as anybody can know
  stale,  ///< it was, but its sink is silent or has been started again
  left,
};

/// Value of `devices.$ID.status`: `listed 12.345000`, since when in seconds of ecology time;
/// `left silence 345.100000` with the cause. It outlives the mote's other tuples (IF-13).
struct device_status {
  device_presence presence = device_presence::listed;
  std::string cause; ///< one word; empty unless it has left
  instant since;

  friend bool operator==(const device_status&, const device_status&) = default;
};

[[nodiscard]] std::string to_string(const device_status& x);

/// What a gateway's watchers need: the presence and the cause; the time is for people.
/// @returns errc::bad_value for anything that to_string() does not make
[[nodiscard]] result<device_status> parse_device_status(std::string_view text);

/// Value of `devices.$ID.output.$CH.period`: how far apart the mote's messages on the channel are
/// to be, in decimal milliseconds; 0: the period of the mote (IF-04). @returns errc::bad_value
/// otherwise
[[nodiscard]] result<std::chrono::milliseconds> parse_output_period(std::string_view text);

/// What became of a message written to `devices.$ID.input.$CH` (GW-12, IF-07).
enum class input_outcome : std::uint8_t {
  pending,      ///< on its way to the mote
  acknowledged, ///< the mote has it
  failed,       ///< sent and never acknowledged
  unreachable,  ///< the gateway does not list the mote
  sent,         ///< a base station has it, for a mote whose program sends no reply
};

/// The word in the status tuple.
[[nodiscard]] std::string_view to_string(input_outcome x);

/// Value of `devices.$ID.input.$CH.status`: `3 acknowledged`.
struct input_status {
  std::uint64_t sequence =
      0; ///< counts the writes the gateway saw on this mote and channel, from 1
  input_outcome outcome = input_outcome::pending;

  friend bool operator==(const input_status&, const input_status&) = default;
};

[[nodiscard]] std::string to_string(const input_status& x);

/// Inverse of to_string(): a decimal number from 1 without leading zeros, one blank, one of the
/// five words. @returns errc::bad_value otherwise
[[nodiscard]] result<input_status> parse_input_status(std::string_view text);

/// The text in a tuple's value: text travels with a trailing NUL (TUP-02), so what stands before
/// the first NUL; everything if there is none. The view points into `value`.
[[nodiscard]] std::string_view tuple_text(byte_view value);

} // namespace rubicon
