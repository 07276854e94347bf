// Channels that streams and synaptic channels use: Network's inside the island, tunnels to
// elsewhere.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "communication/ports/local_node.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"
#include "stream/events.hpp"
#include "transport/messenger.hpp"
#include "transport/tunnels.hpp"

namespace rubicon::communication {

/// Streams, or synaptic channels: what a channel is opened for.
class channel_user {
public:
  channel_user() = default;
  channel_user(const channel_user&) = delete;
  channel_user& operator=(const channel_user&) = delete;
  virtual ~channel_user() = default;

  /// @param descriptor of the request
  virtual void on_connected(std::uint16_t descriptor, stream::channel_handle channel) = 0;
  virtual void on_connect_failed(std::uint16_t descriptor) = 0;
  /// @param far_slack what answers take longer, as radios of the other end's island sleep
  virtual void on_accepted(stream::channel_handle channel, mote_address source,
                           duration far_slack) = 0;
  virtual void on_octets(stream::channel_handle channel, byte_view octets) = 0;
  virtual void on_closed(stream::channel_handle channel) = 0;
};

/// Channels by their handles, wherever their other end is. One that was accepted belongs to the
/// user that its first packet shows.
class channel_port {
public:
  /// @param messages which knows how slow answers of an island are
  channel_port(local_node& node, const transport::messenger& messages,
               const transport::tunnels_config& tunnels);

  /// Before all others. @param streams, synaptic which outlive this
  void set_users(channel_user& streams, channel_user& synaptic);

  // Requests of a user.
  void connect(channel_request who, mote_address destination, std::chrono::milliseconds interval,
               std::size_t size, std::uint8_t qos);
  void send(stream::channel_handle channel, bytes octets, bool in_slot = false);
  void disconnect(stream::channel_handle channel);
  [[nodiscard]] std::optional<duration> latency_bound(stream::channel_handle channel) const;
  [[nodiscard]] static bool is_tunnel(stream::channel_handle x);

  // Channels of Network.
  void on_connected(channel_request who, stream::channel_handle channel, instant now);
  void on_connect_failed(channel_request who, instant now);
  /// Before on_connected() or on_accepted(). @param bound how long a packet is in flight at most
  void set_latency_bound(stream::channel_handle channel, duration bound) {
    latency_bounds_[channel] = bound;
  }
  void on_accepted(stream::channel_handle channel, mote_address source, instant now);
  void on_octets(stream::channel_handle channel, byte_view octets, instant now);
  void on_closed(stream::channel_handle channel, instant now);

  /// The body of a packet of tunnel_channel.
  void on_tunnel_packet(island_id source, byte_view octets);
  void on_joined(island_id island) { tunnels_.join(island); }
  void on_time();
  [[nodiscard]] std::optional<instant> deadline() const { return tunnels_.deadline(); }

  [[nodiscard]] const transport::tunnels& tunnels() const { return tunnels_; }
  [[nodiscard]] std::size_t footprint() const {
    return tunnels_.footprint() + node_.config.unclaimed_max * 8;
  }

private:
  [[nodiscard]] channel_user& user(bool is_synaptic) {
    return *(is_synaptic ? synaptic_ : streams_);
  }
  void apply(transport::tunnels_outputs todo, bool in_slot = false);

  local_node& node_;
  const transport::messenger& messages_;
  channel_user* streams_ = nullptr;
  channel_user* synaptic_ = nullptr;
  transport::tunnels tunnels_;
  small_map<transport::tunnel_id, channel_request> connecting_;
  small_map<channel_request, duration> latencies_asked_; ///< of channels that are being opened
  small_map<stream::channel_handle, bool> is_synaptic_;  ///< of channels in use
  small_map<stream::channel_handle, duration> latency_bounds_; ///< of channels of Network
  std::vector<std::pair<stream::channel_handle, mote_address>> unclaimed_; ///< the oldest first
};

} // namespace rubicon::communication
