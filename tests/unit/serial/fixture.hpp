// Helpers of the serial tests, and both ends of a cable joined under virtual time.
#pragma once

#include <deque>
#include <string_view>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "serial/cable/line.hpp"
#include "serial/host_port.hpp"
#include "serial/mote_port.hpp"

namespace rubicon::serial::test {

inline constexpr instant start{5s}; ///< of a test

/// Octets of hexadecimal text; throws std::runtime_error if it is none.
[[nodiscard]] bytes hex(std::string_view text);

/// The parts of a list in a golden vector, ` / ` between them; `none` and `-` are empty lists.
[[nodiscard]] std::vector<bytes> hex_list(std::string_view text);

/// What a PC makes of these octets when they are all it hears.
[[nodiscard]] std::vector<frame> decode_all(byte_view octets);

/// A valid packet whose octets all depend on `number`. @pre payload_octets >= 4
[[nodiscard]] bytes numbered_packet(std::uint32_t number, std::size_t payload_octets);

/// The number of a packet made by numbered_packet; a test fails if it is not one to the octet.
[[nodiscard]] std::uint32_t number_of(byte_view packet);

/// The alternatives of one kind, in order.
template <class T, class Outputs>
[[nodiscard]] std::vector<T> all(const Outputs& outputs) {
  std::vector<T> found;
  for (const auto& x : outputs)
    if (const auto* match = std::get_if<T>(&x))
      found.push_back(*match);
  return found;
}

/// An host_port and a mote's port with a cable between them.
struct fixture {
  fixture(line_config cable, std::uint64_t seed, host_port_config pc_side = {});

  void send_to_mote(packet_id id, bytes packet) { perform(pc.send(id, std::move(packet), now)); }
  void send_to_pc(bytes packet) { perform(mote.send(std::move(packet), now)); }

  void perform(const outputs& x);
  void perform(const mote_port_outputs& x);
  void perform(const line_outputs& x);

  /// Handles everything due at the next deadline, unless that is later than `end`.
  /// @returns false if nothing was due until then; `now` is then `end`
  bool step(instant end);
  void run_until(instant end);
  void run_for(duration x) { run_until(now + x); }

  /// What is in transit in the PC's adapter, which takes its latency in each direction.
  struct in_adapter {
    instant due;
    direction towards = direction::to_pc;
    payload octets;
  };

  void on_adapter_time();

  host_port pc;
  duration latency;
  std::deque<in_adapter> adapter; ///< by time
  line cable;
  mote_port mote;
  instant now{};

  std::vector<packet_id> sent_ids;
  std::vector<lost> losses;
  std::vector<bytes> at_pc;
  std::vector<bytes> at_mote;
};

} // namespace rubicon::serial::test
