// Motes that know nothing of islands: what their programs send becomes what a sink would say of
// members (tinyos.md 3).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "gateway/plain_rule.hpp"

namespace rubicon::gateway {

/// A packet as the gateway's core takes it from a sink.
struct sink_packet {
  mote_id source;
  std::uint8_t am_type = 0;
  bytes payload;
};

struct plain_config {
  std::vector<plain_rule> rules; ///< the first that fits decides
  duration keep_alive = 10s;     ///< one that is silent for so long has left
};

/// Each address that a rule knows is a device from its first packet on, until it is silent.
class plain_motes {
public:
  static constexpr std::size_t motes_max = 1000; ///< more are not heard

  plain_motes() = default;
  explicit plain_motes(plain_config config) : config_(std::move(config)) {}

  /// @returns what a sink would have said; nothing: no rule knows the packet
  [[nodiscard]] std::optional<std::vector<sink_packet>>
  on_packet(mote_id source, std::uint8_t am_type, byte_view payload, instant now);

  /// Whether this is one of them: it understands nothing that a gateway says.
  [[nodiscard]] bool knows(mote_id mote) const { return members_.contains(mote); }

  [[nodiscard]] std::vector<sink_packet> on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  struct member {
    instant heard;
    bool listed = false;
    std::uint32_t lives = 0;
  };

  [[nodiscard]] const plain_rule* rule_for(mote_id source, std::uint8_t am_type) const;

  plain_config config_;
  std::map<mote_id, member> members_; ///< those that have left, too
};

} // namespace rubicon::gateway
