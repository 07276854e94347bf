// Puts packages into the queues of links.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/bytes.hpp"
#include "peis/link/outgoing_queue.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis {

/// Every package that is not part of a reliable message passes here; what a queue does not take is
/// counted. `origin` is the link that shares the queue with others for it.
class package_sender {
public:
  /// Both outlive this.
  package_sender(own_peer& own, link_table& links) : own_(own), links_(links) {}

  /// @returns why it was not taken. Counts nothing
  [[nodiscard]] cause enqueue(connection& to, lane where, outgoing_package x, link_id origin);
  void send(connection& to, lane where, outgoing_package x, link_id origin);

  /// A package of the network's own for the other end of a link.
  void send_to_neighbour(connection& to, std::uint16_t port, bytes data, link_id origin);
  /// A package of the network's own for one host, which no caller waits for.
  void send_to_host(peer_id to, link_id hop, lane where, std::uint16_t port, bytes data,
                    link_id origin);

  /// To every open link but one, or to those that want all and some others at random.
  cause flood(const package_header& header, const std::shared_ptr<const message_octets>& content,
              std::optional<link_id> except, link_id origin);
  /// A broadcast of ours.
  [[nodiscard]] cause broadcast(std::uint16_t port, payload octets, link_id origin);

  void count_drop(cause why);

private:
  own_peer& own_;
  link_table& links_;
};

} // namespace rubicon::peis
