// The communication layer of one mote: join, Network and Transport over whatever carries frames.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/random.hpp"
#include "core/time.hpp"
#include "mote/descriptor.hpp"
#include "mote/join_client.hpp"
#include "mote/transducer_config.hpp"
#include "network/star.hpp"
#include "transport/endpoint.hpp"

namespace rubicon::mote {

struct node_config {
  mote_id id;
  std::uint32_t type = 0;
  duration keep_alive = 3s; ///< promised in the descriptor: heard at least this often
  std::vector<transducer_config> transducers;
  std::vector<actuator_config> actuators;
};

/// The mote is a member of its island, or is one no longer.
struct membership {
  bool joined = false;
  island_id island;
};

using node_output =
    std::variant<network::transmit, membership, transport::received, transport::outcome>;
using node_outputs = std::vector<node_output>;

struct node_counters {
  std::uint64_t malformed = 0;    ///< frames of a known AM type that could not be decoded
  std::uint64_t unknown_type = 0; ///< frames of an AM type nobody owns here (AM-01)
};

/// Everything a mote does that needs no radio chip and no application. Send and read need no
/// completion to be waited for: results come as outputs.
class node {
public:
  node() = default;

  /// @param incarnation how often this mote has been started before (DIS-07)
  node(node_config config, std::uint32_t incarnation, random_stream dice);

  /// Starts to join (D1.1 5.3.4 joinIsland).
  [[nodiscard]] node_outputs start(instant now);

  /// Says goodbye and ends every outstanding send as failed.
  [[nodiscard]] node_outputs leave();

  /// D1.1 5.3.3 send. Nothing: refused (FAIL), because not joined (MCK-16), because of the
  /// destination or the length, or because too many reliable sends are outstanding.
  [[nodiscard]] std::optional<node_outputs> send(transport::ticket id, mote_address destination,
                                                 std::uint8_t am_type, bytes payload, bool reliable,
                                                 instant now);

  /// One reading, as a count; nothing if the mote has no such transducer.
  [[nodiscard]] std::optional<std::int16_t> read(quantity kind, instant now);

  /// @returns false if there is no such actuator, or it has no such state
  bool actuate(const std::string& name, std::uint8_t state);

  [[nodiscard]] std::optional<std::uint8_t> actuator_state(const std::string& name) const;

  /// The radio has delivered a frame for this mote.
  [[nodiscard]] node_outputs on_frame(mote_id source, std::uint8_t am_type, byte_view payload,
                                      instant now);

  [[nodiscard]] node_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] bool joined() const { return star_.joined(); }
  [[nodiscard]] const transport::endpoint_counters& messages() const {
    return endpoint_.counters();
  }
  [[nodiscard]] std::size_t outstanding() const { return endpoint_.outstanding(); }
  [[nodiscard]] const node_counters& counters() const { return counters_; }

private:
  [[nodiscard]] node_outputs take(join_outputs from_join);
  [[nodiscard]] node_outputs take(network::outputs from_network, instant now);
  [[nodiscard]] node_outputs take(transport::outputs from_transport, instant now);

  node_config config_;
  random_stream dice_;
  join_client join_;
  network::star star_;
  transport::endpoint endpoint_;
  std::map<std::string, std::uint8_t> actuator_states_;
  node_counters counters_;
};

} // namespace rubicon::mote
