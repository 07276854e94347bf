// Events of an island for a gateway, and what it publishes then.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "gateway/gateway.hpp"
#include "network/am.hpp"
#include "network/sink_event.hpp"
#include "support/mote_ids.hpp"
#include "support/pick.hpp"

namespace rubicon::test {

inline constexpr island_id kitchen{1};
inline constexpr mote_id fan{7};

inline gateway::outputs deliver(gateway::gateway& x, const network::sink_event& event,
                                instant now = {}) {
  return x.on_packet(the_sink, network::am::sink_event, encode(event), now);
}

inline void join(gateway::gateway& x, mote_id mote, std::uint32_t incarnation = 0) {
  static_cast<void>(deliver(x, network::mote_joined{mote, incarnation, 301, bytes{0xaa}}));
}

/// The value last published under a key among the outputs.
[[nodiscard]] inline std::string published(const gateway::outputs& out, std::string_view key) {
  std::string value = "nothing";
  for (const auto& x : pick<gateway::publish>(out)) {
    if (x.key == key)
      value = x.text ? to_string(x.value) : to_hex(x.value);
  }
  return value;
}

} // namespace rubicon::test
