// The Mockup interface: what the Communication Layer offers to a program, on a mote or on a PC
// (D1.1 5.3; MCK-01..18, PAR-05). Commands and events have D1.1's names. Commands return at once;
// an event tells later what has become of them (AM-02). A program is the same wherever it runs and
// wherever the other end is: only addresses differ.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "stream/events.hpp"
#include "synaptic/events.hpp"
#include "synaptic/parameters.hpp"

namespace rubicon::mote {

class layer;

/// What commands return, and events tell.
enum class status : std::uint8_t { FAIL, SUCCESS };
using enum status;

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
  /// Extension: the same from anybody; PCs may have ids beyond one octet. Calls receive().
  virtual void receiveFrom(mote_address source, byte_view buf, std::uint8_t am_type) {
    receive(octet_of(source.island), source.mote.value, buf, am_type, status::SUCCESS);
  }

  // 5.3.4 Component management
  virtual void initCommunicationsDone(status /*success*/) {}
  virtual void joined(island_octet /*island_addr*/, std::uint16_t /*mote_addr*/,
                      status /*success*/) {}
  /// At the sink's PC: a mote has joined.
  virtual void moteJoined(std::uint16_t /*mote_addr*/, byte_view /*description*/) {}
};

/// One program's access to its node's layer. Copies are the same program.
class communication {
public:
  // 5.3.1. Done events follow a SUCCESS. FAIL: no room, already open, size, not joined.
  /// @param dest mote; its island is params[0..1]
  status create_syn_channel_out(std::uint16_t dest, std::uint8_t size, syn_params params);
  status create_syn_channel_in(std::uint16_t src, std::uint8_t size, syn_params params);
  /// Extension: to or from anybody; the descriptor of the Done event, or -1.
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

  // 5.3.2. A descriptor is 1 or more.
  /// The read end passes its own address (STR-11). @param stream_rate ms; 0: at any time
  status open_remote(island_octet island_addr, std::uint16_t mote_addr, std::uint16_t symbolic_name,
                     std::uint32_t stream_rate, std::uint8_t qos,
                     std::size_t buffer_size = stream::buffer_size_default);
  /// Extension: the write end, also of a stream to this node itself, which the call above cannot
  /// ask for. The rest as above.
  status open_write_end(mote_address to, std::uint16_t symbolic_name, std::uint32_t stream_rate,
                        std::uint8_t qos, std::size_t buffer_size = stream::buffer_size_default);
  /// @param sensor_tid a mote::quantity @returns descriptor or -1
  int open_sensor(std::uint8_t sensor_tid, std::uint32_t stream_rate,
                  stream::sampling sampling_type);
  int open_local();
  status close(int desc);
  status read(int desc, std::size_t nbytes);
  /// @returns octets written, or -1
  int write(int desc, byte_view buf);

  // 5.3.3
  /// FAIL: not joined, bad address, more than 256 octets, too many reliable ones under way.
  status send(island_octet island_addr, std::uint16_t mote_addr, byte_view buf, bool reliable,
              std::uint8_t am_type);
  /// Extension: the number that ackOf() tells; nothing: FAIL.
  std::optional<std::uint32_t> send_numbered(mote_address to, byte_view buf, bool reliable,
                                             std::uint8_t am_type);
  /// Messages of this type are for this program. FAIL: it is another's, or the layer's own (AM-05).
  status provide(std::uint8_t am_type);
  /// This program has no room for reliable messages of its types for now: senders wait (MCK-18).
  /// Types that it does not provide are left alone.
  void hold(std::uint8_t am_type);
  void release(std::uint8_t am_type);

  // 5.3.4
  status initCommunications();
  status joinIsland(byte_view description);
  [[nodiscard]] std::optional<mote_address> address() const; ///< nothing before joined()

  [[nodiscard]] instant now() const; ///< by the node's own clock

private:
  friend class layer;
  communication(layer& below, std::size_t process) : below_(&below), process_(process) {}
  status open_end(bool writes_to_self, mote_address other, std::uint16_t name,
                  std::uint32_t rate_ms, std::uint8_t qos, std::size_t buffer_size);

  layer* below_;
  std::size_t process_;
};

} // namespace rubicon::mote
