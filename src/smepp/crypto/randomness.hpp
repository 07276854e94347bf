// Where secrets come from: keys of sessions, shares of handshakes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/numbers/random.hpp"

namespace rubicon::smepp {

/// The operating system's source in wall time. In virtual time, where the same seed gives the same
/// run, a stream stands for the mote's source: what is drawn from it is as secret as the seed.
class randomness {
public:
  randomness() = default; ///< the operating system's
  explicit randomness(random_stream x) : stream_(x) {}

  void fill(std::span<std::uint8_t> octets);

private:
  std::optional<random_stream> stream_;
};

} // namespace rubicon::smepp
