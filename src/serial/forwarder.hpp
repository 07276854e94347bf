// The serial forwarder's protocol (docs/tinyos.md 2): packets of a mote over TCP, without the
// serial line's types, sequence numbers and acks. Both sides speak it alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/bytes.hpp"
#include "serial/frame.hpp"

namespace rubicon::serial {

inline constexpr std::uint16_t forwarder_port = 9002;

/// What either side sends first, without waiting for the other's.
[[nodiscard]] bytes forwarder_greeting();

/// A packet as it travels. @pre 1..255 octets, dispatch first
[[nodiscard]] bytes encode_forwarded(byte_view packet);

enum class refusal : std::uint8_t {
  none,
  other_protocol, ///< the first octet is no `U`
  old_version,
  empty_packet, ///< a length of 0: where the next packet begins is not to be believed
};

[[nodiscard]] std::string_view to_string(refusal x);

/// What comes from the other side of a connection, in whatever pieces.
///
///   greeting --55, version of 20 or above--> length --1..255--> packet --all of it--> length
///      `-- anything else --> refused <-- 0 -----'
class forwarder_decoder {
public:
  /// @returns the packets that these octets complete, dispatch octet first
  [[nodiscard]] std::vector<bytes> on_octets(byte_view octets);

  /// Anything but none: the connection is to be closed, and nothing more is taken.
  [[nodiscard]] refusal refused() const { return refused_; }

  /// Whether the other side has greeted as a serial forwarder does.
  [[nodiscard]] bool greeted() const { return state_ == state::length || state_ == state::packet; }

private:
  enum class state : std::uint8_t { first, version, length, packet };

  void on_octet(std::uint8_t octet, std::vector<bytes>& out);

  state state_ = state::first;
  refusal refused_ = refusal::none;
  std::size_t wanted_ = 0;
  bytes packet_;
};

/// What stands in a cable's place when the sink is behind a forwarder: the frames of the PC's end
/// become packets for it, its packets become frames. An ack does not
/// say, as at a cable, that the packet has come to the mote: the PC's end is given one for what the
/// forwarder gets.
class forwarder_line {
public:
  struct todo {
    bytes to_forwarder;
    bytes to_pc;
  };

  /// The PC's end has written these. @pre the connection stands
  [[nodiscard]] todo on_pc(byte_view octets);

  /// These have come from the forwarder.
  [[nodiscard]] todo on_forwarder(byte_view octets);

  /// Another connection is begun; whatever the last one has left is forgotten.
  [[nodiscard]] bytes on_connected();

  [[nodiscard]] refusal refused() const { return decoder_.refused(); }
  [[nodiscard]] bool greeted() const { return decoder_.greeted(); }

private:
  forwarder_decoder decoder_;
  frame_decoder frames_; ///< of the PC's end
};

} // namespace rubicon::serial
