// From a mote's octets to readings, and from words to octets, as a proxy class describes it
// (PXY-04).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "proxy/classes/proxy_class.hpp"

namespace rubicon::proxy {

/// One field of one message, readable.
struct reading {
  std::string name; ///< the field's
  std::string text; ///< a number in plain decimal, `-3.5`, or a word; never with the unit
  std::string unit; ///< empty: none

  friend bool operator==(const reading&, const reading&) = default;
};

/// Octets of one count.
[[nodiscard]] std::size_t octets_of(encoding x);

/// Whether a field of the class is read from there.
[[nodiscard]] bool reads(const proxy_class& what, reading_source from);

/// The streams that fields of the class are read from, each once.
[[nodiscard]] std::vector<stream_input> streams_of(const proxy_class& what);

/// Whether anything that is read for the class holds a time.
[[nodiscard]] bool reads_times(const proxy_class& what);

/// Fields and what was read for them.
using field_counts = std::vector<std::pair<const field*, std::int64_t>>;

/// The counts in one message, with their fields, in the class's order; of a stamp its 32 bits.
/// @returns errc::truncated as decode(); the pointers are valid as long as the class
[[nodiscard]] result<field_counts> counts_in(const proxy_class& what, std::uint16_t channel,
                                             byte_view payload);

/// The time at the end of a message on one of the class's stamped channels, in milliseconds;
/// nothing if it does not go beyond the fields.
[[nodiscard]] std::optional<std::uint32_t> stamp_in(const proxy_class& what, std::uint16_t channel,
                                                    byte_view payload);

/// What a field's count means.
[[nodiscard]] reading reading_of(const field& what, std::int64_t count);

/// All readings in one message, in the class's order: each count times `scale` plus `add` with
/// `decimals` digits, or the count's word; a count for which no word is given stays a plain decimal
/// count. Octets that no field covers are ignored.
/// @returns errc::truncated if one of the channel's fields is not wholly in the payload: a message
/// that does not fit its class has no meaning, so none of its fields is read
[[nodiscard]] result<std::vector<reading>> decode(const proxy_class& what, std::uint16_t channel,
                                                  byte_view payload);

/// Least and greatest count.
[[nodiscard]] std::pair<std::int64_t, std::int64_t> range_of(encoding x);

/// The octets that stand for a word, compared letter by letter, or for a number.
/// @returns errc::bad_value for a word the input does not know, and a number it does not take
[[nodiscard]] result<bytes> encode(const input& what, std::string_view word);

} // namespace rubicon::proxy
