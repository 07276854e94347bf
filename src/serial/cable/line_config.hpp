// What a file may say about the cable between a sink and its basestation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <ratio>
#include <string>
#include <vector>

#include "core/text/ipv4_network.hpp"
#include "core/time.hpp"

namespace rubicon::serial {

/// A serial cable with 10 bit times an octet (tinyos.md 1.1).
struct line_config {
  std::uint32_t baud = 57600;
  duration latency = 1ms; ///< of the PC's USB adapter and driver, in each direction
  double octet_error = 0; ///< chance that one octet is corrupted, 0..1
  std::size_t buffer =
      4096; ///< octets waiting to be sent in one direction; more are lost and counted
};

struct recorded_frame;

/// AM payload that TinyOS's programs are compiled for unless somebody says otherwise. A longer one
/// blocks a BaseStation's path to the radio for good (tinyos.md 3).
inline constexpr std::size_t base_station_payload = 28;

/// What is at one end of an island's cable in place of what the ecology has there itself. At most
/// one of the names is given; none: the ecology has both ends.
struct outside_config {
  std::string device;    ///< serial port with a real sink
  std::string forwarder; ///< HOST:PORT of a TinyOS serial forwarder that has one
  std::string replay;    ///< file with what a sink has once said
  double speed = 1;      ///< of the replay: how often the recorded time passes in one
  std::string pty;       ///< pseudo-terminal on which others find the sink that the ecology has

  /// AM payload that the real sink's program was compiled for; 0: base_station_payload, until it
  /// has said that it is the island's own.
  std::size_t payload = 0;

  /// Of this island, in order of time; not nullptr if it is to be replayed.
  std::shared_ptr<const std::vector<recorded_frame>> recorded;

  /// Nothing of the island is simulated but its gateway.
  [[nodiscard]] bool has_sink() const {
    return !device.empty() || !forwarder.empty() || !replay.empty();
  }

  /// The gateway is another program's.
  [[nodiscard]] bool has_gateway() const { return !pty.empty(); }
};

/// Where TinyOS's programs find an island's sink, as a serial forwarder has it.
struct export_config {
  std::string forwarder;              ///< ADDRESS:PORT to listen at; empty: nowhere
  std::vector<ipv4_network> networks; ///< clients from elsewhere are closed at once; empty: none
};

/// How long `octets` occupy one direction of a line. @pre baud > 0
[[nodiscard]] constexpr duration transmission_time(std::size_t octets, std::uint32_t baud) {
  return duration(static_cast<std::int64_t>(octets) * 10 * std::nano::den / baud);
}

/// How many times longer than usual to wait for what the other end says now and then, and as much
/// longer to wait before saying it: what a mote's queue holds comes first, twelve packets of 40
/// octets. That is a second at 4800 baud, which is what usual waits allow for. @pre baud > 0
[[nodiscard]] constexpr std::int64_t slowness(std::uint32_t baud) {
  constexpr std::size_t queued = std::size_t{12} * 40;
  return (transmission_time(queued, baud) + 1s - 1ns) / 1s;
}

/// How many packets of 40 octets, and their answers, a line carries in four seconds; four at least.
/// A queue that holds more would only make what waits in it older than anybody waits for it.
/// @pre baud > 0
[[nodiscard]] constexpr std::size_t queue_room(std::uint32_t baud) {
  constexpr std::size_t packet = 40 + 9;
  const auto packets = 4s / transmission_time(packet, baud);
  return packets > 4 ? static_cast<std::size_t>(packets) : 4;
}

} // namespace rubicon::serial
