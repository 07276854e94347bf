// The backbones between an island's sink and its further ones.
#pragma once

#include <cstdint>

#include "actors/messages/common.hpp"
#include "actors/messages/serial.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"

namespace rubicon {

/// A packet of the Network module that a backbone has carried.
struct backbone_received {
  mote_id source;
  std::uint8_t am_type = 0;
  payload octets;
  duration age{}; ///< as in serial::backbone_arrived
};
RUBICON_FIELDS(backbone_received, source, am_type, octets, age);

/// A packet with this token has been acknowledged, or has not.
struct backbone_sent {
  std::uint64_t token = 0;
  bool acked = false;
};
RUBICON_FIELDS(backbone_sent, token, acked);

/// Whoever is at an end of a backbone: a sink, or a mote that is a further one.
struct backbone_end_interface : takes<backbone_received, backbone_sent> {};
using backbone_end_actor = ref<backbone_end_interface>;

/// From now on what goes in that direction is for `user`; empty: it is out of order.
struct attach_backbone {
  bool down = false; ///< the further sink; else the island's
  backbone_end_actor user;
};
RUBICON_FIELDS(attach_backbone, down, user);

struct backbone_write {
  bool down = false;       ///< to the further sink; else to the island's
  std::uint64_t token = 0; ///< network::no_token: no backbone_sent follows
  std::uint8_t am_type = 0;
  payload octets;
};
RUBICON_FIELDS(backbone_write, down, token, am_type, octets);

struct backbone_interface
    : takes<attach_backbone, backbone_write, plug_serial, timer_expired, status_request> {};
using backbone_actor = ref<backbone_interface>;

} // namespace rubicon
