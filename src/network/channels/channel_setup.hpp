// How channels are set up: from the source's connect message to the destination's answer.
#pragma once

#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "network/channels/channel_message.hpp"
#include "network/channels/channel_table.hpp"
#include "network/channels/dead_ends.hpp"
#include "network/channels/flood_offers.hpp"

namespace rubicon::network {

/// The connect message goes greedily towards the destination's coordinates. At a dead end it goes
/// back one mote, which sends it to another neighbour, and after `tries_max` of them back in turn;
/// the source then waits once for a neighbour that has just started and tries again, and at last
/// floods. Each mote on the path keeps previous and next hop, and refuses for a while what
/// it has sent back.
///
/// The table is that of the mote, the same in all calls.
class channel_setup {
public:
  channel_setup() = default;
  explicit channel_setup(const channels_config& config) : offers_(config.offers_max) {}

  /// As source. @param request of which destination, place, schedule and expiry are given
  void begin(channel_table& table, channel_id id, const connect_message& request,
             const channel_occasion& at);

  void on_connect(channel_table& table, mote_id from, channel_id id, const connect_message& x,
                  const channel_occasion& at, random_stream& rng);
  void on_ack(channel_table& table, mote_id from, channel_id id, const connect_ack_message& ack,
              const channel_occasion& at);
  void on_dead_end(channel_table& table, mote_id from, channel_id id, const channel_occasion& at);

  /// The next mote has not answered. @pre the channel is not open
  void on_no_answer(channel_table& table, channel_id id, channel_entry& x,
                    const channel_occasion& at);

  /// The next mote has forgotten the channel: it is asked once more, or another.
  void go_on(channel_table& table, channel_id id, channel_entry& x, const channel_occasion& at);

  /// As channels::look().
  void look(channel_table& table, std::optional<mote_id> heard, const channel_occasion& at);

  /// How often a flood's message is to be said.
  [[nodiscard]] unsigned rounds_of_flood(const channel_table& table, channel_id id) const;

  void on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  void on_flooded(channel_table& table, mote_id from, channel_id id, const connect_message& x,
                  const channel_occasion& at, random_stream& rng);
  void accept(channel_table& table, mote_id from, channel_id id, const connect_message& x,
              const channel_occasion& at);

  flood_offers offers_;
  dead_ends dead_ends_;
};

} // namespace rubicon::network
