// Hand-made records for tests of explain: what an island with two motes, a gateway and two PCs may
// do, with the octets that the product's own encoders make of it.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "explain/print/text.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "network/router_message.hpp"
#include "network/tree/collection_packet.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "peis/wire/package.hpp"
#include "radio/frame.hpp"
#include "serial/frame.hpp"
#include "serial/packet.hpp"
#include "support/text.hpp"
#include "transport/fragments.hpp"
#include "transport/segment.hpp"

namespace rubicon::test {

inline const bytes reading{0x00, 0xd7};
inline constexpr explain::text_style wide{200, false};

inline const std::string near_mote = "mote/kitchen/near";
inline const std::string far_mote = "mote/kitchen/far";
inline const std::string sink_actor = "sink/kitchen";
inline const std::string gateway_actor = "gateway/kitchen";
inline const std::string gateway_kernel = "peis_peer/kitchen-gateway";
inline const std::string pc_kernel = "peis_peer/pc";
inline const std::string robot_kernel = "peis_peer/robot";
inline const std::string air_actor = "air/kitchen";
inline const std::string line_actor = "serial_line/kitchen";

/// Island 1 `kitchen`: sink 1, motes 7 `near` and 8 `far`; peers 11 `pc` and 30 `robot`.
class explain_fixture {
public:
  explain_fixture() {
    x.about.ecology = "test";
    x.about.islands = {{1, "kitchen", 1, "kitchen-gateway", {{7, "near"}, {8, "far"}}, {}, {}}};
    x.about.peers = {{1, "kitchen-gateway"}, {11, "pc"}, {30, "robot"}};
  }

  explain::recording x;
  instant now;

  /// A message between actors. @returns its number
  std::uint64_t put(explain::kind what, const std::string& from, const std::string& to,
                    std::uint64_t cause, explain::record r = {}) {
    r.what = what;
    r.from = from;
    r.to = to;
    r.cause = cause;
    r.number = ++number_;
    r.time = now;
    x.records.push_back(std::move(r));
    if (what == explain::kind::set_tuple || what == explain::kind::set_remote_tuple)
      value_ = number_;
    if (what == explain::kind::set_tuple || what == explain::kind::link_octets)
      news_ = number_;
    return number_;
  }

  /// Transport tries again.
  std::uint64_t attempt(std::uint64_t message) {
    explain::record r;
    r.text = "attempt";
    return put(explain::kind::begun, "", "", message, std::move(r));
  }

  /// A program on a mote sends to the gateway.
  std::uint64_t program_sends(const std::string& mote, const bytes& content, bool reliable,
                              std::uint64_t token = 1) {
    explain::record r;
    r.id = token;
    r.mote = {own_island, no_mote};
    r.channel = 2;
    r.octets = content;
    r.yes = reliable;
    return put(explain::kind::send_message, "mote_app/" + mote.substr(5) + "/sampler-1", mote, 0,
               std::move(r));
  }

  /// The island packet of a segment to the gateway.
  static bytes packet_up(const transport::segment& x) {
    return network::encode(network::island_packet{own_island, no_mote, x.am_type, encode(x)});
  }
  static bytes packet_down(const transport::segment& x, mote_id to) {
    return network::encode(network::island_packet{island_id{1}, to, x.am_type, encode(x)});
  }

  static transport::segment reliable(std::uint16_t source, std::uint16_t counter, bytes content) {
    transport::segment x;
    x.source = mote_id(source);
    x.counter = counter;
    x.sender = 1;
    x.am_type = 2;
    x.what = transport::segment::kind::reliable;
    x.payload = std::move(content);
    return x;
  }

  static transport::segment answer_to(const transport::segment& asked) {
    transport::segment x;
    x.source = no_mote;
    x.counter = asked.counter;
    x.sender = asked.sender;
    x.am_type = asked.am_type;
    x.what = transport::segment::kind::acknowledgement;
    return x;
  }

  /// A fragment of a packet in a frame's payload.
  static bytes up(std::uint16_t origin, std::uint16_t sequence, byte_view fragment) {
    network::up_packet y{mote_id(origin), mote_id{1}, sequence, 0, 0, carried(fragment)};
    return encode(y);
  }
  static bytes down(std::uint16_t sequence, std::uint16_t to, byte_view fragment) {
    network::down_packet y{sequence, 0, {mote_id(to)}, carried(fragment)};
    return encode(y);
  }
  static bytes whole(const bytes& packet) {
    return transport::cut(packet, packet.size() + 1, 0)->front();
  }

  struct frame_of {
    std::string from;
    std::string to;
    std::uint16_t source = 0;
    std::uint16_t destination = 0;
    std::uint8_t am_type = network::am::up;
    bytes payload;
    std::uint64_t token = 1;
  };

  void asks_radio(const frame_of& f, std::uint64_t cause) {
    explain::record r;
    r.id = f.token;
    r.mote.mote = mote_id(f.destination);
    r.channel = f.am_type;
    r.octets = f.payload;
    asked_[{f.from, f.token}] =
        put(explain::kind::radio_send, f.from, air_actor, cause, std::move(r));
  }

  /// One frame on the air; it is received if its outcome is `delivered`.
  /// @returns the number of its reception
  std::uint64_t on_air(const frame_of& f, const std::string& outcome) {
    radio::frame content;
    content.pan = 1;
    content.source = mote_id(f.source);
    content.destination = mote_id(f.destination);
    content.am_type = f.am_type;
    content.payload = f.payload;
    explain::record r;
    r.octets = radio::encode(content);
    const auto begin = now;
    now += 3ms;
    std::uint64_t received = 0;
    if (outcome == "delivered")
      received = put(explain::kind::frame_received, air_actor, f.to, asked_[{f.from, f.token}], r);
    r.text = outcome;
    r.yes = outcome == "delivered";
    r.mote.island = island_id{1};
    r.time = begin;
    r.what = explain::kind::frame;
    r.number = 0;
    r.cause = asked_[{f.from, f.token}];
    x.records.push_back(std::move(r));
    now += 1ms;
    return received;
  }

  void radio_ends(const frame_of& f, const std::string& status) {
    explain::record r;
    r.id = f.token;
    r.text = status;
    put(explain::kind::radio_done, air_actor, f.from, asked_[{f.from, f.token}], std::move(r));
  }

  /// Asked, on the air once, received, done.
  std::uint64_t crosses_air(const frame_of& f, std::uint64_t cause) {
    asks_radio(f, cause);
    const auto received = on_air(f, "delivered");
    radio_ends(f, "sent");
    return received;
  }

  static bytes serial(const serial::am_packet& packet, bool to_mote, std::uint8_t sequence = 0) {
    return serial::encode(
        serial::frame{to_mote ? serial::frame_type::packet_with_ack : serial::frame_type::packet,
                      sequence, serial::encode(packet)});
  }

  void writes(bool to_mote, const bytes& octets, std::uint64_t cause) {
    explain::record r;
    r.octets = octets;
    r.count = to_mote ? 1 : 0;
    written_[to_mote ? 1 : 0].push_back(put(explain::kind::serial_write,
                                            to_mote ? gateway_actor : sink_actor, line_actor, cause,
                                            std::move(r)));
  }
  std::uint64_t line_gives(bool to_mote, const bytes& octets) {
    explain::record r;
    r.octets = octets;
    now += 2ms;
    auto& written = written_[to_mote ? 1 : 0];
    const auto cause = written.front();
    written.pop_front();
    return put(explain::kind::serial_octets, line_actor, to_mote ? sink_actor : gateway_actor,
               cause, std::move(r));
  }
  void plug(bool plugged) {
    explain::record r;
    r.yes = plugged;
    put(explain::kind::plug_serial, "ecology/test", line_actor, 0, std::move(r));
  }

  std::uint64_t sets(const std::string& component, const std::string& kernel,
                     const std::string& key, const std::string& value, std::uint64_t cause) {
    explain::record r;
    r.text = key;
    r.octets = to_bytes(std::string_view(value));
    r.yes = true;
    return put(explain::kind::set_tuple, component, kernel, cause, std::move(r));
  }

  void watches(const std::string& component, const std::string& kernel,
               const std::string& pattern) {
    explain::record r;
    r.peer = -1;
    r.text = pattern;
    put(explain::kind::watch_tuples, component, kernel, 0, std::move(r));
  }

  std::uint64_t hears(const std::string& kernel, const std::string& component, std::int32_t owner,
                      const std::string& key, const std::string& value) {
    explain::record r;
    r.peer = owner;
    r.text = key;
    r.octets = to_bytes(std::string_view(value));
    return put(explain::kind::tuple_event, kernel, component, news_, std::move(r));
  }

  /// A push or set package with the newest value over one link, which may lose it.
  void package(std::uint16_t port, const std::string& from, const std::string& to,
               std::int32_t owner, std::int32_t destination, const std::string& key,
               const std::string& value, std::int32_t seqno, bool lost = false) {
    peis::tuple t;
    t.owner = peer_id{owner};
    t.creator = peer_id{owner};
    t.name = *peis::key::parse(key);
    t.value = peis::text_content(value).value;
    t.written = {1, 0};
    t.user_time = {1, 0};
    t.seqno = seqno;
    auto data = encode_tuple_head(t, port == peis::port::set ? peis::tuple_message_kind::set
                                                             : peis::tuple_message_kind::push);
    const auto tail = to_bytes(peis::encode_tuple_value(t).view());
    data.insert(data.end(), tail.begin(), tail.end());
    peis::package_header header;
    header.id = ++packages_;
    header.source = peer_id{owner};
    header.destination = peer_id{destination};
    header.port = port;
    header.length = static_cast<std::uint16_t>(data.size());
    explain::record r;
    peis::encode(header, r.octets);
    r.octets.insert(r.octets.end(), data.begin(), data.end());
    r.id = 5;
    now += 1ms;
    if (!lost) {
      put(explain::kind::link_octets, from, to, value_, std::move(r));
      return;
    }
    r.text = "link_lost";
    r.from = from;
    r.what = explain::kind::link_lost;
    r.time = now;
    r.cause = value_;
    x.records.push_back(std::move(r));
  }
  void link(const std::string& a, const std::string& b) {
    explain::record r;
    r.id = 5;
    put(explain::kind::link_opened, "peis_lan", a, 0, r);
    put(explain::kind::link_opened, "peis_lan", b, 0, r);
  }

private:
  static bytes carried(byte_view fragment) {
    bytes content{network::am::packet};
    content.insert(content.end(), fragment.begin(), fragment.end());
    return encode(network::router_message(network::user_content{std::move(content)}));
  }

  std::uint64_t number_ = 0;
  std::uint64_t value_ = 0; ///< number of the newest request for one
  std::uint64_t news_ = 0;  ///< of what components hear of next
  std::map<std::pair<std::string, std::uint64_t>, std::uint64_t> asked_; ///< of the radio
  std::array<std::deque<std::uint64_t>, 2> written_; ///< and not come out of the line, by direction
  std::int32_t packages_ = 0;
};

} // namespace rubicon::test
