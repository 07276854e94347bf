// The sink's half of the bridge between an island and its gateway (GW-01, RTG-02): the root of the
// island's Network on one side, serial packets on the other, the list of members in between.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "mote/duty_cycle.hpp"
#include "mote/gateway_lines.hpp"
#include "mote/join/registrar.hpp"
#include "mote/nonvolatile.hpp"
#include "mote/packet_service.hpp"
#include "network/clock/time_reference.hpp"
#include "transport/fragments.hpp"

namespace rubicon::mote {

/// Send this packet up a serial line.
struct to_gateway {
  mote_id source; ///< where in the island it comes from; the sink itself for its own events
  std::uint8_t am_type = 0;
  bytes payload;                        ///< at most network::frame_payload_max octets
  std::optional<std::size_t> line = {}; ///< nothing: up all of them
  bool urgent = false;                  ///< goes before others
  bool asks_time = false;               ///< on_question_delayed() says how long the line is in use
};

using sink_output = std::variant<network::frame_out, to_gateway, store_nonvolatile, double_refused>;
using sink_outputs = std::vector<sink_output>;

struct sink_counters {
  std::uint64_t malformed = 0;    ///< serial packets that could not be decoded
  std::uint64_t unknown_type = 0; ///< serial packets of a type that has no business here
  std::uint64_t up = 0;           ///< island packets passed to the gateway
  std::uint64_t down = 0;         ///< island packets passed to the island
  std::uint64_t turned = 0;       ///< island packets from a mote of the island to another (RTG-01)
  std::uint64_t for_sink = 0;     ///< island packets for the sink, on which no app runs
};
RUBICON_FIELDS(sink_counters, malformed, unknown_type, up, down, turned, for_sink);

/// Events go to all gateways, so that whoever takes the lead knows the island; packets of motes and
/// questions about the time go to the one that leads (GW-14).
class sink {
public:
  sink() = default;
  /// @param store what it remembers: its incarnation, and the term that its gateways are in
  sink(network::router_config network, registrar_config members, const duty_config& duty,
       random_stream rng, instant now, gateway_lines_config lines = {},
       const nonvolatile& store = {});

  /// Nothing comes before the new content of its store.
  [[nodiscard]] sink_outputs start(instant now);

  /// The radio, or a backbone, has delivered a frame.
  /// @param sfd as in network::router::on_frame()
  [[nodiscard]] sink_outputs on_frame(mote_id source, std::uint8_t am_type, byte_view payload,
                                      instant sfd, instant now,
                                      network::medium over = network::medium::radio);

  /// A network::frame_out has ended.
  [[nodiscard]] sink_outputs on_sent(std::uint64_t token, bool acked, unsigned transmissions,
                                     instant now);

  /// A serial line has delivered a packet from its gateway.
  [[nodiscard]] sink_outputs on_packet(std::uint8_t am_type, byte_view payload, instant now,
                                       std::size_t line = 0);

  /// A question about the time waits so long for its line.
  void on_question_delayed(duration by) { time_.on_delayed(by); }

  /// Its clock has leapt forward by so much, or back; its timers have not.
  void on_clock_leapt(duration by);

  [[nodiscard]] sink_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] instant deadline() const;

  [[nodiscard]] std::uint32_t incarnation() const { return store_.starts - 1; } ///< once started
  [[nodiscard]] std::size_t members() const { return registrar_.members(); }
  [[nodiscard]] const sink_counters& counters() const { return counters_; }
  [[nodiscard]] const registrar_counters& joining() const { return registrar_.counters(); }
  [[nodiscard]] const slot_table& slots() const { return registrar_.slots(); }
  [[nodiscard]] const packet_service& packets() const { return packets_; }
  [[nodiscard]] const network::time_reference& time() const { return time_; }
  [[nodiscard]] const gateway_lines& lines() const { return lines_; }

private:
  [[nodiscard]] sink_outputs finish(sink_outputs out, instant now);
  [[nodiscard]] sink_outputs take(packet_service_outputs from_packets, instant now);
  [[nodiscard]] sink_outputs take(registrar_outputs from_registrar, instant now);
  [[nodiscard]] sink_outputs on_event(const network::sink_event& x, instant now, std::size_t line);
  [[nodiscard]] sink_outputs remember();
  [[nodiscard]] to_gateway event_for(const network::sink_event& x) const;
  [[nodiscard]] to_gateway question(const network::sink_event& x, std::size_t line) const;
  void tell_time(instant now);
  [[nodiscard]] sink_outputs from_island(const packet_in& x, instant now);
  [[nodiscard]] sink_outputs to_island(const network::island_packet& x, instant now);
  [[nodiscard]] sink_outputs to_line(mote_id origin, const network::island_packet& x);

  mote_id self_;
  nonvolatile store_; ///< its content
  island_id island_;
  registrar registrar_;
  packet_service packets_;
  duty_cycle duty_;
  network::time_reference time_;
  gateway_lines lines_;
  std::vector<transport::assembly> fragments_; ///< of packets from the gateway, for each line
  std::uint8_t tag_ = 0;
  sink_counters counters_;
};

} // namespace rubicon::mote
