// Hands out what links have queued, as far as their windows allow.
#pragma once

#include <cstddef>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/links/link_health.hpp"
#include "peis/links/message_delivery.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/overlay/p2p_events.hpp"

namespace rubicon::peis {

class link_writer {
public:
  /// All outlive this.
  link_writer(own_peer& own, link_health& health, message_delivery& messages)
      : own_(own), health_(health), messages_(messages) {}

  /// Over a paced link package by package. @returns whether anything has left
  bool write(connection& to, instant now, events& out);
  /// The owner has got rid of so many octets.
  void on_sent(connection& x, std::size_t octets, instant now);
  /// Its neighbour is of another kind, which may take the first part of a package and wait for the
  /// rest.
  void pace(connection& x, events& out) const;

private:
  [[nodiscard]] bool has_window(const connection& to, std::size_t more) const;
  [[nodiscard]] bool encode_next(connection& to, bytes& octets, instant now);
  void hand_out(connection& to, bytes octets, instant now, events& out);

  own_peer& own_;
  link_health& health_;
  message_delivery& messages_;
};

} // namespace rubicon::peis
