// What a lossy network makes of a link's octets: whole packages vanish, the stream stays in step.
#pragma once

#include <cstddef>
#include <functional>

#include "core/bytes.hpp"

namespace rubicon::peis {

struct thinned {
  bytes octets;
  bytes lost_octets;
  std::size_t lost = 0; ///< packages
};

/// A copy of `octets` without the packages that are lost.
/// @param kept octets at the beginning that are no package and never lost: connect_request_size for
///             an initiator's first octets, else 0
/// @param is_lost asked once for each package, in their order. What follows an incomplete or broken
///                package is copied as it is.
[[nodiscard]] thinned without_lost_packages(byte_view octets, std::size_t kept,
                                            const std::function<bool()>& is_lost);

} // namespace rubicon::peis
