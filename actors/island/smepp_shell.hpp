// SMEPP Light inside a mote's actor: its clock, its store, its radio, and the route to its gateway.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "actors/messages/air.hpp"
#include "actors/messages/supervision.hpp"
#include "apps/application.hpp"
#include "mote/crystal.hpp"
#include "network/wire.hpp"
#include "smepp/node.hpp"

namespace rubicon {

/// Set in the token of what SMEPP Light sends; Network's (network_radio.hpp) do not have it.
inline constexpr std::uint64_t smepp_token = 1ULL << 62U;

/// A radio with several users is on while any of them wants it.
struct radio_demand {
  bool stack = true;     ///< Network and measuring flows
  bool groups = false;   ///< SMEPP Light
  bool silenced = false; ///< another mote has this one's address

  [[nodiscard]] bool is_on() const { return !silenced && (stack || groups); }
};

/// A program that hands values of events to the layer of its mote.
class event_relay final : public apps::application {
public:
  void forward(std::uint8_t channel, const bytes& value) {
    static_cast<void>(layer().send_numbered(apps::own_gateway, value, true, channel));
  }

private:
  void on_start(instant) override {}
};

struct smepp_shell {
  smepp::node node;
  /// Runs on while the mote's other clock is set: it counts, and no other clock follows it.
  mote::crystal crystal;
  event_relay* relay = nullptr; ///< with the full stack
  std::size_t psdu_size = 0;    ///< of the frame at the radio

  [[nodiscard]] instant own(instant real) const { return crystal.own(real); }
};

/// One frame of SMEPP is at the radio at a time.
[[nodiscard]] radio_send request_of(radio::radio_index radio, smepp::send_frame x);

/// SMEPP's own id of a request that has ended; nothing if it was not SMEPP's.
[[nodiscard]] std::optional<std::uint64_t> smepp_id_of(const radio_done& x);

/// What becomes of a life at its report.
enum class life_state : std::uint8_t {
  goes_on,
  ended,    ///< the mote has none after it: what was open is lost
  replaced, ///< nor are its programs those of the mote any more
};

/// What one life has counted.
[[nodiscard]] smepp_status status_of(island_id island, const smepp::node& x, life_state state);

} // namespace rubicon
