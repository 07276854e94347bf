// What the programs on an island's motes make its motes carry: how many channels, and the synaptic
// vectors of one tick, which all come at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "apps/app_config.hpp"
#include "core/address.hpp"
#include "synaptic/channels.hpp"
#include "synaptic/message.hpp"

namespace rubicon::apps {

/// Packets and their octets, in all.
struct load {
  std::size_t packets = 0;
  std::size_t octets = 0;

  constexpr load& operator+=(const load& x) {
    packets += x.packets;
    octets += x.octets;
    return *this;
  }
  friend constexpr load operator*(std::size_t times, const load& x) {
    return {times * x.packets, times * x.octets};
  }
  friend constexpr bool operator==(const load&, const load&) = default;
};

/// @returns `x` without what is in `y`, at least nothing
[[nodiscard]] constexpr load beyond(const load& x, const load& y) {
  return {x.packets - std::min(x.packets, y.packets), x.octets - std::min(x.octets, y.octets)};
}

[[nodiscard]] constexpr load longer(const load& x, const load& y) {
  return {std::max(x.packets, y.packets), std::max(x.octets, y.octets)};
}

/// A synaptic vector of so many elements as a channel carries it.
[[nodiscard]] constexpr load vector_load(std::size_t elements) {
  constexpr auto packet_max = synaptic::channels_config{}.packet_max;
  constexpr auto in_one = (packet_max - synaptic::vector_header_size) / synaptic::value_size;
  const auto packets = (elements + in_one - 1) / in_one;
  return {packets, elements * synaptic::value_size + packets * synaptic::vector_header_size};
}

/// The same as packets of the island's tree or of a serial line carry it: each packet has headers
/// of 16 octets more (WIR-02, a tunnel's), and goes in two fragments if it is longer than 80
/// octets.
[[nodiscard]] constexpr load tunnel_load(std::size_t elements) {
  constexpr std::size_t headers = 16;
  constexpr std::size_t in_one_piece = 80;
  const auto whole = vector_load(elements);
  const bool is_cut = whole.packets > 1 || whole.octets > in_one_piece;
  return {whole.packets * (is_cut ? 2 : 1), whole.octets + whole.packets * headers};
}

/// Of one mote's programs, or of those of all motes of an island.
struct traffic {
  std::size_t channels = 0;    ///< begun here, to motes of the island: streams and synaptic ones
  load vectors;                ///< of one tick, over these
  load vectors_in;             ///< of one tick, that come over such channels
  load longest;                ///< of the vectors to or from motes of the island
  load up;                     ///< vectors of one tick that leave the island
  load down;                   ///< vectors of one tick that come from elsewhere
  load longest_tunnelled;      ///< of these
  std::size_t streams_in = 0;  ///< read ends
  std::size_t synapses_in = 0; ///< in ends

  constexpr traffic& operator+=(const traffic& x) {
    channels += x.channels;
    vectors += x.vectors;
    vectors_in += x.vectors_in;
    longest = longer(longest, x.longest);
    up += x.up;
    down += x.down;
    longest_tunnelled = longer(longest_tunnelled, x.longest_tunnelled);
    streams_in += x.streams_in;
    synapses_in += x.synapses_in;
    return *this;
  }
};

/// @param island that the motes are in
[[nodiscard]] traffic traffic_of(island_id island, const std::vector<app_config>& programs);

} // namespace rubicon::apps
