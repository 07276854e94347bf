// Motes that know nothing of islands: what their programs send becomes what a sink would say of
// members (docs/tinyos.md 3).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "gateway/plain/plain_rule.hpp"

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

/// Something for a plain mote.
struct plain_packet {
  std::uint8_t am_type = 0;
  bytes payload;
};

/// Each address that a rule knows is a device from its first packet on, until it is silent.
class plain_motes {
public:
  static constexpr std::size_t motes_max = 1000; ///< packets of more are dropped

  plain_motes() = default;
  explicit plain_motes(plain_config config) : config_(std::move(config)) {}

  /// Whose packet it is.
  struct sender {
    mote_id mote; ///< without a rule, who it would be by the first that has its AM type
    const plain_rule* rule = nullptr; ///< valid as long as this; nullptr: no rule knows the packet
  };
  /// @param am_type nothing: it is a frame of another layout
  [[nodiscard]] sender sender_of(mote_id source, std::optional<std::uint8_t> am_type,
                                 byte_view payload) const;

  /// @returns what a sink would have said, empty if there is no room for another mote; nothing: no
  /// rule knows the packet
  [[nodiscard]] std::optional<std::vector<sink_packet>>
  on_packet(mote_id source, std::optional<std::uint8_t> am_type, byte_view payload, instant now);

  /// The packet for a mote when this is written to that input of it. @returns nothing if no
  /// rule of its has the input, or the octets are not what the rule's form takes
  [[nodiscard]] std::optional<plain_packet> on_input(mote_id mote, std::uint16_t channel,
                                                     byte_view octets);

  /// Whether the line to them is there. While it is not, no mote leaves because of silence.
  void on_line(bool there, instant now);

  [[nodiscard]] std::size_t size() const { return members_.size(); } ///< at most motes_max
  [[nodiscard]] bool knows(mote_id mote) const { return members_.contains(mote); }

  [[nodiscard]] std::vector<sink_packet> on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  struct member {
    instant last_received;
    bool listed = false;
    std::uint32_t lives = 0;
    std::uint16_t version = 0; ///< of Oscilloscope's settings: the newest received, or sent
  };

  [[nodiscard]] const plain_rule* input_rule_for(mote_id mote, std::uint16_t channel) const;

  plain_config config_;
  bool there_ = true;                 ///< the line
  std::map<mote_id, member> members_; ///< those that have left, too
};

} // namespace rubicon::gateway
