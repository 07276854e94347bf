// Membership of a mote in its island: when it asks to join, what it has joined, and in which
// condition it says it is.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "mote/join/join_client.hpp"

namespace rubicon::mote {

class island_member {
public:
  /// To join with this client as soon as there is a route to the sink.
  void prepare(join_client x) {
    client_ = std::move(x);
    waits_for_route_ = true;
  }
  /// The client may start; it is not waited for any longer.
  void start_at(instant when) {
    waits_for_route_ = false;
    starts_at_ = when;
  }
  /// @returns once, when the client is to start now
  [[nodiscard]] bool takes_start(instant now);
  [[nodiscard]] join_outputs leave();

  void on_joined(const island_joined& x);

  // What the sink is to know in case the mote falls silent (IF-13).
  [[nodiscard]] join_outputs on_battery_low(instant now);
  /// @param rssi_dbm of the newest frame of its parent @returns nothing: this says nothing new
  [[nodiscard]] std::optional<join_outputs> on_signal(int rssi_dbm, instant now);

  [[nodiscard]] join_client& client() { return client_; }
  [[nodiscard]] bool waits_for_route() const { return waits_for_route_; }
  [[nodiscard]] bool joined() const { return client_.current() == join_client::state::joined; }
  [[nodiscard]] island_id island() const { return island_; } ///< the last one

  /// PEIS ids by which the island is addressed, that of the island first (NFR-05); empty before the
  /// first join.
  [[nodiscard]] const std::vector<peer_id>& gateways() const { return gateways_; }

  [[nodiscard]] std::optional<instant> deadline() const {
    return earliest(client_.deadline(), starts_at_);
  }

private:
  join_client client_;
  mote_condition condition_;
  bool waits_for_route_ = false;
  std::optional<instant> starts_at_;
  island_id island_;
  std::vector<peer_id> gateways_;
};

} // namespace rubicon::mote
