// A serial forwarder's clients: programs of TinyOS that take it for a sink (tinyos.md 2).
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/text/ipv4_network.hpp"
#include "io/tcp/tcp_listener.hpp"
#include "serial/forwarder.hpp"

namespace rubicon {

struct forwarder_counters {
  std::uint64_t slow = 0;      ///< clients closed because they did not read
  std::uint64_t bad_input = 0; ///< clients closed because of what they sent
  std::uint64_t refused = 0;   ///< clients closed because there were enough
  std::uint64_t foreign = 0;   ///< clients closed because they are of none of the networks
};
RUBICON_FIELDS(forwarder_counters, slow, bad_input, refused, foreign);

/// Each client gets each packet of the sink. Of what clients send, one packet of each is handed out
/// at a time, and no more is read of one that waits: so none of them is in the way of others.
class forwarder_clients {
public:
  /// Called on the loop's thread, never from within a call.
  struct callbacks {
    /// A packet for the sink; the next of that client comes after done().
    std::function<void(std::uint64_t client, bytes packet)> on_packet;
    /// Something worth telling, in words.
    std::function<void(std::string)> on_event;
  };

  static constexpr std::size_t clients_max = 64;
  /// Octets that wait for a client beside those that the system holds for it: some minutes of what
  /// a sink says.
  static constexpr std::size_t room = std::size_t{64} * 1024;

  /// @param where must outlive it
  /// @param networks from where clients may come; empty: from anywhere
  /// @returns why it cannot listen there, if it cannot
  [[nodiscard]] static std::variant<std::unique_ptr<forwarder_clients>, std::string>
  open(io::loop& where, const std::string& address, std::uint16_t port, callbacks x,
       std::vector<ipv4_network> networks = {});

  /// To all of them. @param packet dispatch octet first
  void forward(byte_view packet);

  /// The client's packet is delivered, or lost.
  void done(std::uint64_t number);

  [[nodiscard]] const forwarder_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t count() const { return clients_.size(); }

private:
  struct client {
    io::tcp_stream stream;
    std::string name; ///< where it connects from
    serial::forwarder_decoder decoder;
    std::deque<bytes> packets; ///< for the sink
    bool under_way = false;    ///< one is handed out
  };

  forwarder_clients(callbacks x, std::vector<ipv4_network> networks)
      : to_user_(std::move(x)), networks_(std::move(networks)) {}

  void accept(io::tcp_stream stream, const ipv4_address& from);
  void on_octets(std::uint64_t number, byte_view octets);
  void hand_out(std::uint64_t number, client& from);

  callbacks to_user_;
  std::vector<ipv4_network> networks_;
  std::map<std::uint64_t, client> clients_;
  std::uint64_t next_ = 1;
  forwarder_counters counters_;
  std::unique_ptr<io::tcp_listener> listener_;
};

} // namespace rubicon
