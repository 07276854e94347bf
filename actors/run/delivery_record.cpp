#include "actors/run/delivery_record.hpp"

#include <string_view>

#include "actors/messages/air.hpp"
#include "actors/messages/backbone.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/links.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/serial.hpp"
#include "network/am.hpp"
#include "radio/raw_frame.hpp"

namespace rubicon {

bool is_beacon(std::uint8_t am_type) {
  return am_type == network::am::beacon;
}

namespace {

using explain::kind;
using explain::record;

// What each message adds to its record. @returns whether it is worth one

bool fill(record& r, const radio_send& x) {
  r.what = kind::radio_send;
  r.id = x.token;
  r.mote.mote = x.destination;
  r.channel = x.am_type;
  r.octets = to_bytes(x.octets.view());
  r.yes = x.ack;
  return !is_beacon(x.am_type);
}

/// What firmware sends is like any other frame, if it has the layout.
bool fill(record& r, const radio_send_raw& x) {
  const auto psdu = radio::with_fcs(x.octets.view());
  const auto frame = radio::decode(psdu);
  if (!frame)
    return false;
  r.what = kind::radio_send;
  r.id = x.token;
  r.mote.mote = frame->destination;
  r.channel = frame->am_type;
  r.octets = to_bytes(frame->payload);
  r.yes = frame->ack_request;
  return !is_beacon(frame->am_type);
}

bool fill(record& r, const radio_done& x) {
  r.what = kind::radio_done;
  r.id = x.token;
  r.text = radio::to_string(x.status);
  r.count = x.transmissions;
  r.yes = x.arrived;
  return true;
}

bool fill(record& r, const frame_received& x) {
  r.what = kind::frame_received;
  r.octets = to_bytes(x.psdu.view());
  const auto frame = radio::decode(x.psdu.view());
  return frame && !is_beacon(frame->am_type);
}

bool fill(record& r, const serial_write& x) {
  r.what = kind::serial_write;
  r.count = x.towards == serial::direction::to_mote ? 1 : 0;
  r.octets = to_bytes(x.octets.view());
  return true;
}

bool fill(record& r, const serial_octets& x) {
  r.what = kind::serial_octets;
  r.octets = to_bytes(x.octets.view());
  return true;
}

bool fill(record& r, const plug_serial& x) {
  r.what = kind::plug_serial;
  r.yes = x.plugged;
  return true;
}

bool fill(record& r, const backbone_write& x) {
  r.what = kind::backbone_write;
  r.count = x.down ? 1 : 0;
  r.channel = x.am_type;
  r.octets = to_bytes(x.octets.view());
  return !is_beacon(x.am_type);
}

bool fill(record& r, const backbone_received& x) {
  r.what = kind::backbone_received;
  r.mote.mote = x.source;
  r.channel = x.am_type;
  r.octets = to_bytes(x.octets.view());
  return !is_beacon(x.am_type);
}

bool fill(record& r, const link_opened& x) {
  r.what = kind::link_opened;
  r.id = x.link;
  return true;
}

bool fill(record& r, const set_tuple& x) {
  r.what = kind::set_tuple;
  r.text = x.key;
  r.octets = to_bytes(x.value.view());
  r.yes = x.text;
  return true;
}

bool fill(record& r, const delete_tuple& x) {
  r.what = kind::delete_tuple;
  r.text = x.key;
  return true;
}

bool fill(record& r, const set_remote_tuple& x) {
  r.what = kind::set_remote_tuple;
  r.id = x.token;
  r.peer = x.owner.value;
  r.text = x.key;
  r.octets = to_bytes(x.value.view());
  r.yes = x.text;
  return true;
}

bool fill(record& r, const set_meta_tuple& x) {
  r.what = kind::set_remote_tuple;
  r.id = x.token;
  r.peer = x.owner.value;
  r.text = x.key;
  r.octets = to_bytes(std::string_view(x.reference));
  r.yes = true;
  return true;
}

bool fill(record& r, const tuple_event& x) {
  r.what = kind::tuple_event;
  r.id = x.watch;
  r.peer = x.owner.value;
  r.text = x.key;
  r.octets = to_bytes(x.value.view());
  r.yes = x.deleted;
  return true;
}

bool fill(record& r, const watch_tuples& x) {
  r.what = kind::watch_tuples;
  r.id = x.watch;
  r.peer = x.owner.value;
  r.text = x.key;
  return true;
}

bool fill(record& r, const send_peis_message& x) {
  r.what = kind::send_peis_message;
  r.id = x.token;
  r.peer = x.destination.value;
  r.channel = x.port;
  r.octets = to_bytes(x.octets.view());
  r.yes = x.reliable;
  return true;
}

bool fill(record& r, const peis_outcome& x) {
  r.what = kind::peis_outcome;
  r.id = x.token;
  r.text = x.cause;
  r.yes = x.success;
  return true;
}

bool fill(record& r, const notable_event& x) {
  r.what = kind::event;
  r.from = x.who;
  r.text = x.what;
  return true;
}

/// @returns whether it is a message of this kind
/// @param worth set if so: whether it is worth a record
template <class Message>
bool take(const scheduler::delivery& x, record& r, bool& worth) {
  const auto* found = x.as<Message>();
  if (found == nullptr)
    return false;
  worth = fill(r, *found);
  return true;
}

template <class... Messages>
bool take_any(const scheduler::delivery& x, record& r) {
  bool worth = false;
  static_cast<void>((take<Messages>(x, r, worth) || ...));
  return worth;
}

} // namespace

bool fill_record(record& r, const scheduler::delivery& x) {
  return take_any<radio_send, radio_done, frame_received, set_tuple, tuple_event, serial_write,
                  serial_octets, watch_tuples, set_remote_tuple, set_meta_tuple, send_peis_message,
                  delete_tuple, peis_outcome, link_opened, plug_serial, backbone_write,
                  backbone_received, notable_event, radio_send_raw>(x, r);
}

} // namespace rubicon
