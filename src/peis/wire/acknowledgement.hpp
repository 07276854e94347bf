// The message of port 14: which packages have arrived (peis-wire.md 8.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::peis {

inline constexpr std::size_t acknowledgements_max = 200; ///< ids in one message

/// @pre at most 200 ids
[[nodiscard]] bytes encode_acknowledgement(std::span<const std::int32_t> ack_ids);

/// truncated if the ids announced are not all there, too_long for more than 200.
[[nodiscard]] result<std::vector<std::int32_t>> decode_acknowledgement(byte_view octets);

} // namespace rubicon::peis
