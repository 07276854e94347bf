// Serial lines, and who sits at their ends.
#pragma once

#include <cstdint>
#include <string>

#include "actors/messages/common.hpp"
#include "core/bytes.hpp"
#include "serial/cable/line.hpp"

namespace rubicon {

/// Octets that have arrived at one end of a serial line.
struct serial_octets {
  payload octets;
};
RUBICON_FIELDS(serial_octets, octets);

/// Whoever sits at an end of a serial line: a sink or a gateway.
struct serial_end_interface : takes<serial_octets> {};
using serial_end_actor = ref<serial_end_interface>;

/// From now on octets going `towards` that end are for `user`.
struct attach_serial {
  serial::direction towards = serial::direction::to_pc;
  serial_end_actor user;
};
RUBICON_FIELDS(attach_serial, towards, user);

struct serial_write {
  serial::direction towards = serial::direction::to_pc;
  payload octets;
};
RUBICON_FIELDS(serial_write, towards, octets);

struct plug_serial {
  bool plugged = true;
};
RUBICON_FIELDS(plug_serial, plugged);

/// From the thread of the loop: what a line has of the outside is there, or not.
struct serial_presence {
  bool there = false;
  std::string why; ///< it is not, in words; may be empty
};
RUBICON_FIELDS(serial_presence, there, why);

/// Octets of a line to real motes, which is beside the cable of a simulated sink.
struct real_octets {
  payload octets;
};
RUBICON_FIELDS(real_octets, octets);

/// Whoever wants to know whether what is at the far end of a line is there.
struct line_watcher_interface : takes<serial_presence, real_octets> {};
using line_watcher_actor = ref<line_watcher_interface>;

/// From now on `user` hears when the far end comes and goes, and at once if it is there.
struct watch_line {
  line_watcher_actor user;
  bool takes_octets = false; ///< those towards the PC are for it, too, as real_octets
};
RUBICON_FIELDS(watch_line, user, takes_octets);

/// A packet between the gateway and a program of TinyOS.
struct serial_packet {
  std::uint64_t token = 0; ///< the sender's name for it
  payload octets;          ///< dispatch octet first
};
RUBICON_FIELDS(serial_packet, token, octets);

/// To the sender of a serial_packet: the sink has acked it, or it is lost.
struct serial_packet_done {
  std::uint64_t token = 0;
};
RUBICON_FIELDS(serial_packet_done, token);

/// Whoever has a sink to give packets to.
struct packet_end_interface : takes<serial_packet> {};
using packet_end_actor = ref<packet_end_interface>;

struct attach_packets {
  packet_end_actor user;
};
RUBICON_FIELDS(attach_packets, user);

/// The cable between a sink and its gateway.
struct serial_line_interface
    : takes<attach_serial, serial_write, plug_serial, timer_expired, status_request, watch_line> {};
using serial_line_actor = ref<serial_line_interface>;

/// What stands for the cable where the sink is a real one.
struct outside_line_interface : extends<serial_line_interface, serial_octets, serial_presence> {};
using outside_line_actor = ref<outside_line_interface>;

/// The PC's end of a cable that other programs find on a pseudo-terminal.
struct pty_end_interface
    : extends<serial_end_interface, serial_write, serial_presence, status_request> {};
using pty_end_actor = ref<pty_end_interface>;

} // namespace rubicon
