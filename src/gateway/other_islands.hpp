// Messages between islands (WIR-02): to and from their gateways, in the form of each.
#pragma once

#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "gateway/occasion.hpp"
#include "gateway/others/alias_talks.hpp"
#include "gateway/others/directory.hpp"
#include "network/island_packet.hpp"

namespace rubicon::gateway {

class other_islands {
public:
  /// A message from another island.
  struct message {
    island_id source;
    network::gateway_packet packet;
  };

  other_islands() = default;
  other_islands(const gateway_config& config, random_stream rng)
      : form_(config.form), gateways_(config.others, rng) {}

  void start(instant now) { gateways_.start(now); }

  /// To the gateway that serves an island.
  /// @param reliable as its sender asked (ACK-09)
  void send(island_id island, network::gateway_packet x, bool reliable, const occasion& at);

  /// @returns nothing, counted: no message of this form
  [[nodiscard]] std::optional<message> on_message(peer_id source, byte_view octets,
                                                  const occasion& at);

  [[nodiscard]] directory& gateways() { return gateways_; }
  [[nodiscard]] const directory& gateways() const { return gateways_; }

private:
  [[nodiscard]] wire_form form_with(peer_id peer) const;

  wire_form form_ = wire_form::segment; ///< ours
  directory gateways_;
  alias_talks talks_;
  std::uint16_t strict_counter_ = 0; ///< of what was received in the strict form
};

} // namespace rubicon::gateway
