// Numbers for packages and for groups of fragments (peis-wire.md 1).
#pragma once

#include <cstdint>

#include "core/numbers/random.hpp"

namespace rubicon::peis {

/// Every id of 1..2^31-1 once before any comes again: one that did would be taken for a duplicate
/// and dropped. Start and stride are random, so that two peers do not walk side by side.
class id_source {
public:
  id_source() = default;
  explicit id_source(random_stream& rng)
      : id_(static_cast<std::uint32_t>(rng.next())),
        stride_(static_cast<std::uint32_t>(rng.next()) | 1),
        group_(static_cast<std::uint16_t>(rng.below(groups))) {}

  /// For a package, or for the acknowledgement of one.
  [[nodiscard]] std::int32_t next() {
    do
      id_ = (id_ + stride_) & 0x7fffffff;
    while (id_ == 0);
    return static_cast<std::int32_t>(id_);
  }

  /// For the fragments of one message: 1..32767.
  [[nodiscard]] std::uint16_t next_group() {
    group_ = static_cast<std::uint16_t>(group_ % groups + 1);
    return group_;
  }

private:
  static constexpr unsigned groups = 32767;

  std::uint32_t id_ = 0;
  std::uint32_t stride_ = 1;
  std::uint16_t group_ = 0;
};

} // namespace rubicon::peis
