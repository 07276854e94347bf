#include "synaptic/parameters.hpp"

#include <algorithm>
#include <cassert>

#include "core/codec.hpp"

namespace rubicon::synaptic {

std::array<std::uint8_t, parameters_size> encode(const parameters& x) {
  assert(x.island.value <= 0xffff);
  const auto island = x.island == own_island ? 0U : x.island.value;
  byte_writer to;
  to.big(static_cast<std::uint16_t>(island)).octet(x.divisor).octet(x.qos);
  std::array<std::uint8_t, parameters_size> octets{};
  std::copy(to.view().begin(), to.view().end(), octets.begin());
  return octets;
}

parameters parse_parameters(std::span<const std::uint8_t, parameters_size> octets) {
  byte_reader from(octets);
  const auto island = from.big<std::uint16_t>();
  const auto divisor = from.octet();
  const auto qos = from.octet();
  return {island == 0 ? own_island : island_id{island}, std::max<std::uint8_t>(divisor, 1), qos};
}

} // namespace rubicon::synaptic
