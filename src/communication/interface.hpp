// The Mockup interface: what the Communication Layer offers to a program, on a mote or on a PC
// (D1.1 5.3; MCK-01..18, PAR-05). Commands and events have D1.1's names; the class `interface` has
// all commands, those of each group in a class of the group. Commands return at once; an event
// reports the outcome later (AM-02). A program is the same wherever it runs and wherever the other
// end is: only addresses differ.
//
// A program may be in the actor of its node, or in an actor of its own that exchanges messages with
// the node's (communication/remote_process.hpp). There too commands return at once, by what the
// program's side knows; what the node refuses later, because another program was first, because
// what ended there has not been reported, or for want of room, is reported by the event that the
// command has:
//   create_syn_channel_*   createSynChannelOutDone, createSynChannelInDone with FAIL
//   open_*                 openRemoteDone with FAIL; a sensor or local stream, which has no event,
//                          fails at its first read or write
//   read, write            readDone with FAIL, also at a write end: the stream has ended
//   send                   ackOf and ack with FAIL, if reliable
//   provide                receive with FAIL, the AM type, and neither source nor octets
//   read_transducers       transducersRead without counts
//   joinIsland             joined with FAIL
// start, stop, dispose and close are refused late only for what has ended: that was reported
// already.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "communication/outputs_wanted.hpp"
#include "communication/process.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "stream/events.hpp"
#include "synaptic/events.hpp"
#include "synaptic/parameters.hpp"

namespace rubicon::communication {

/// D1.1 5.2: one octet, 1..254, 255: our own (ADR-03).
using island_octet = std::uint8_t;

inline constexpr std::size_t DIM_SYNCHANNEL_PARAM = synaptic::parameters_size;
using syn_params = std::span<const std::uint8_t, DIM_SYNCHANNEL_PARAM>;

/// 0, which is no island, for a PC beyond one octet.
[[nodiscard]] constexpr island_octet octet_of(island_id x) {
  return x.value <= 0xff ? static_cast<island_octet>(x.value) : island_octet{};
}

/// Events. Each has a default that does nothing. Views are valid during the call only.
class communication_events {
public:
  communication_events() = default;
  communication_events(const communication_events&) = delete;
  communication_events& operator=(const communication_events&) = delete;
  virtual ~communication_events() = default;

  // 5.3.1 Synaptic_Channels
  virtual void createSynChannelOutDone(int /*channel*/, status /*success*/) {}
  virtual void createSynChannelInDone(int /*channel*/, status /*success*/) {}
  virtual void syn_input_update(int /*channel*/, std::uint8_t /*index*/,
                                synaptic::input_status /*status*/) {}
  virtual void clock_tick(std::uint32_t /*currentClock*/) {}
  /// Extension: whether it wants clock_tick(), always the same. A mote without open
  /// synaptic channels wakes for ticks only if a program wants them.
  [[nodiscard]] virtual bool wants_ticks() const { return true; }
  /// Extension: the other end is gone (SYN-17).
  virtual void synChannelFailed(int /*channel*/) {}

  // 5.3.2 Streams
  virtual void openRemoteDone(int /*stream_desc*/, std::uint16_t /*symbolic_name*/,
                              status /*success*/) {}
  virtual void readDone(int /*desc*/, byte_view /*buf*/, status /*success*/) {}

  // 5.3.3 Connectionless
  virtual void ack(status /*success*/) {} ///< of reliable sends in the order of their ends
  /// Extension: of the send that returned this number. Comes beside ack().
  virtual void ackOf(std::uint32_t /*number*/, status /*success*/) {}
  virtual void receive(island_octet /*src_island_addr*/, std::uint16_t /*src_mote_addr*/,
                       byte_view /*buf*/, std::uint8_t /*am_type*/, status /*success*/) {}
  /// Extension: the same from any node; PCs may have ids beyond one octet. Calls receive().
  virtual void receiveFrom(mote_address source, byte_view buf, std::uint8_t am_type) {
    receive(octet_of(source.island), source.mote.value, buf, am_type, status::SUCCESS);
  }

  /// Extension: what its gateway wants this mote to send (GW-10); replaces what it wanted before.
  /// A program that comes later gets it when it comes.
  virtual void outputsWanted(std::span<const output_wanted> /*all*/) {}

  // Extensions: what its mote carries.
  /// In the order asked for. @param time_ms when that was, as in stream::sensor_record
  virtual void transducersRead(std::span<const std::int16_t> /*counts*/,
                               std::uint32_t /*time_ms*/) {}
  /// It was asked to change, or has come to where it was sent. @param state what it is now
  virtual void actuatorChanged(std::string_view /*name*/, std::uint8_t /*state*/, bool /*obeyed*/) {
  }

  // 5.3.4 Component management
  virtual void initCommunicationsDone(status /*success*/) {}
  virtual void joined(island_octet /*island_addr*/, std::uint16_t /*mote_addr*/,
                      status /*success*/) {}
  /// At the sink's PC: a mote has joined.
  virtual void moteJoined(std::uint16_t /*mote_addr*/, byte_view /*description*/) {}
};

/// 5.3.1 Synaptic_Channels. Done events follow a SUCCESS. FAIL: no room, already open, size, not
/// joined.
class synaptic_interface {
public:
  explicit synaptic_interface(process& below) : below_(&below) {}

  /// @param dest mote; its island is params[0..1]
  status create_syn_channel_out(std::uint16_t dest, std::uint8_t size, syn_params params);
  status create_syn_channel_in(std::uint16_t src, std::uint8_t size, syn_params params);
  /// Extension: to or from any node; the descriptor of the Done event, or -1.
  int create_syn_channel_out(mote_address dest, std::uint8_t size,
                             const synaptic::parameters& params);
  int create_syn_channel_in(mote_address src, std::uint8_t size,
                            const synaptic::parameters& params);
  status dispose_syn_channel(int channel);
  status start_syn_channel(int channel);
  status stop_syn_channel(int channel);
  status write_output(int channel, std::uint8_t k, float val);
  /// NaN, and counted, for what is no element of an open in channel.
  float read_input(int channel, std::uint8_t index);

private:
  process* below_;
};

/// 5.3.2 Streams. A descriptor is 1 or more.
class stream_interface {
public:
  explicit stream_interface(process& below) : below_(&below) {}

  /// The read end passes its own address (STR-11). @param stream_rate ms; 0: at any time
  status open_remote(island_octet island_addr, std::uint16_t mote_addr, std::uint16_t symbolic_name,
                     std::uint32_t stream_rate, std::uint8_t qos,
                     std::size_t buffer_size = stream::buffer_size_default);
  /// Extension: the write end, also of a stream to this node itself, which the call above cannot
  /// ask for. The rest as above.
  status open_write_end(mote_address to, std::uint16_t symbolic_name, std::uint32_t stream_rate,
                        std::uint8_t qos, std::size_t buffer_size = stream::buffer_size_default);
  /// Extension: either of these; the descriptor of the Done event, or -1.
  int open_end(const stream_end& end);
  /// @param sensor_tid a device::quantity @returns descriptor or -1
  int open_sensor(std::uint8_t sensor_tid, std::uint32_t stream_rate,
                  stream::sampling sampling_type);
  int open_local();
  status close(int desc);
  status read(int desc, std::size_t nbytes);
  /// @returns octets written, or -1
  int write(int desc, byte_view buf);
  /// Extension: the other end is gone, and what came from it has been read: reads and writes fail.
  /// False for what is no stream.
  [[nodiscard]] bool has_ended(int desc) const;
  /// Extension: a record that arrives over this remote stream has been in flight for no longer,
  /// from write() to readDone() of a read that waited for it (IF-05). Nothing before
  /// openRemoteDone(), for other streams, and for one from this node to itself.
  [[nodiscard]] std::optional<duration> latency_bound(int desc) const;

private:
  process* below_;
};

/// 5.3.3 Connectionless.
class message_interface {
public:
  explicit message_interface(process& below) : below_(&below) {}

  /// FAIL: not joined, bad address, more than 256 octets, too many reliable ones in flight.
  status send(island_octet island_addr, std::uint16_t mote_addr, byte_view buf, bool reliable,
              std::uint8_t am_type);
  /// Extension: the number that ackOf() has; nothing: FAIL.
  std::optional<std::uint32_t> send_numbered(mote_address to, byte_view buf, bool reliable,
                                             std::uint8_t am_type);
  /// Messages of this type are for this program. FAIL: it is another's, or the layer's own (AM-05).
  status provide(std::uint8_t am_type);
  /// This program has no room for reliable messages of its types for now: senders wait (MCK-18).
  /// Types that it does not provide are left alone.
  void hold(std::uint8_t am_type);
  void release(std::uint8_t am_type);

private:
  process* below_;
};

/// Extensions: what its mote carries.
class device_interface {
public:
  explicit device_interface(process& below) : below_(&below) {}

  /// transducersRead() follows. FAIL: the node has not all of them, which no PC has.
  status read_transducers(std::span<const device::quantity> kinds);
  /// actuatorChanged() follows, and again when what takes its time has come there. FAIL: a PC.
  status set_actuator(std::string_view name, std::uint8_t state);

private:
  process* below_;
};

/// One program's access to its node's layer: all of these, 5.3.4 Component management, and the
/// time. Copies are the same program.
class interface : public synaptic_interface,
                  public stream_interface,
                  public message_interface,
                  public device_interface {
public:
  /// @param below outlives this and its copies
  explicit interface(process& below)
      : synaptic_interface(below), stream_interface(below), message_interface(below),
        device_interface(below), below_(&below) {}

  status initCommunications();
  status joinIsland(byte_view description);
  [[nodiscard]] std::optional<mote_address> address() const; ///< nothing before joined()

  [[nodiscard]] instant now() const; ///< by the node's own clock
  /// Extension: the time that peers share, since 1970 (CLK-06). Nothing on a mote, in an actor of
  /// its own, and on a PC that does not know it yet.
  [[nodiscard]] std::optional<duration> network_time() const;

  /// Extension: the program is over. What it has open is closed, its AM types are free; it gets
  /// no more events, and must not give commands.
  void leave();

private:
  process* below_;
};

} // namespace rubicon::communication
