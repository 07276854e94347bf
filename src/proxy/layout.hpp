// From a mote's octets to readings, and from words to octets, as a proxy class describes it
// (PXY-04).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "proxy/proxy_class.hpp"

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

/// `value` rounded to `decimals` digits after the point, nearest first, ties of the double itself
/// to even. The same text on every machine and under every locale; no exponent, no `-0`.
/// @pre decimals in 0..6
[[nodiscard]] std::string decimal_text(double value, int decimals);

/// Whether a field of the class is read from the output channel.
[[nodiscard]] bool reads_channel(const proxy_class& what, std::uint16_t channel);

/// All readings in one message, in the class's order: each count times `scale` plus `add` with
/// `decimals` digits, or the count's word; a count for which no word is given stays a plain decimal
/// count. Octets that no field covers are ignored.
/// @returns errc::truncated if one of the channel's fields is not wholly in the payload: a message
/// that does not fit its class has no meaning, so none of its fields is told
[[nodiscard]] result<std::vector<reading>> decode(const proxy_class& what, std::uint16_t channel,
                                                  byte_view payload);

/// The octets that stand for a word, compared letter by letter.
/// @returns errc::bad_value for a word the input does not know
[[nodiscard]] result<bytes> encode(const input& what, std::string_view word);

} // namespace rubicon::proxy
