// The datagram by which peers find each other (peis-wire.md 4, TCP-03).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "peis/wire/host_record.hpp"

namespace rubicon::peis {

inline constexpr std::size_t announcement_size = 616;

struct announcement {
  std::int32_t version = 500;
  std::string network; ///< up to 62 characters
  host_record sender;
};

[[nodiscard]] bytes encode(const announcement& x);

/// Does what hide_inproc() does to a record.
void hide_inproc_of_announcement(std::span<std::uint8_t> octets);

/// truncated, too_long: any size but 616 is ignored; bad_value as for host records, or a network
/// string without NUL.
[[nodiscard]] result<announcement> decode_announcement(byte_view octets);

} // namespace rubicon::peis
