// The tuples of interfaces: components that perceive objects without a stack of their own, and
// relay what these say (D1.1 3.2.2; PXY-02). The same for every kind of interface and object.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/address.hpp"
#include "core/error.hpp"

namespace rubicon {

/// What a tuple under `interface` says.
enum class interface_tuple : std::uint8_t {
  channel,  ///< `interface.$NAME.channel`: kind of interface, `rfid`
  position, ///< `interface.$NAME.position`: where it is
  objects,  ///< `interface.$NAME.objects`: hardware ids of what it perceives
  rssi,     ///< `interface.$NAME.objects.$ID.rssi`: how strongly, dBm
  memory,   ///< `interface.$NAME.objects.$ID.memory`: the octets that the object carries
};

/// A key under `interface`, taken apart. Names and ids are 1 to 32 letters, digits, `-` and `_`.
struct interface_key {
  interface_tuple what = interface_tuple::objects;
  std::string name;
  std::string object; ///< empty where the key has none

  friend bool operator==(const interface_key&, const interface_key&) = default;
};

[[nodiscard]] std::string to_string(const interface_key& x);

/// Inverse of to_string(); words may have any letter case (TUP-03), names and ids come in lower
/// case. Anything else is errc::bad_value.
[[nodiscard]] result<interface_key> parse_interface_key(std::string_view key);

/// Prototype key of all tuples of what interfaces perceive, whoever owns them.
inline constexpr std::string_view all_interface_channels_key = "interface.*.channel";
inline constexpr std::string_view all_interface_objects_key = "interface.*.objects";

/// Value of `objects`: `{e00401,e00402}`, ascending and each once; `{}` for none.
[[nodiscard]] std::string object_list_text(std::vector<std::string> ids);

/// Inverse of object_list_text(): strictly ascending ids in lower case. @returns errc::bad_value
/// otherwise
[[nodiscard]] result<std::vector<std::string>> parse_object_list(std::string_view text);

/// Value of position tuples: `1.50 0.00 2.25`, metres with two decimals.
[[nodiscard]] std::string position_text(const position& x);

} // namespace rubicon
