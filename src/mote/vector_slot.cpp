#include "mote/vector_slot.hpp"

#include "radio/frame.hpp"
#include "synaptic/message.hpp"

namespace rubicon::mote {

network::access_times access_of(const radio::mac_rules& x) {
  return {x.backoffs.front().longest(),
          x.assessment + x.second_look + x.turnaround + x.ack_delay +
              radio::air_time(radio::ack_size),
          x.spaces ? radio::timing::lifs : 0ns};
}

duration passage(const vector_flow& x, std::size_t packet_max,
                 const network::access_times& access) {
  duration sum{};
  for (const auto octets : synaptic::vector_packets(x.elements, packet_max))
    sum +=
        x.hops > 0 ? network::passage(octets, x.hops, access) : network::passage_up(octets, access);
  return sum;
}

std::uint16_t units_of(std::span<const vector_flow> flows, std::size_t packet_max,
                       const network::access_times& access) {
  duration sum{};
  for (const auto& x : flows)
    sum += passage(x, packet_max, access);
  return network::units_for(sum, access);
}

} // namespace rubicon::mote
