// For files of this room only: how ways grow, record by record.
#pragma once

#include <deque>
#include <map>
#include <set>
#include <tuple>

#include "explain/content.hpp"
#include "explain/journeys.hpp"
#include "transport/segment.hpp"

namespace rubicon::explain {

class builder {
public:
  explicit builder(const recording& x);

  void take(const record& r);
  [[nodiscard]] journeys finish();

private:
  /// What has been recognised in some octets.
  struct sighting {
    subject about;
    cargo of = cargo::content;
    std::string kind = {}; ///< of an answer
  };

  /// One hop of one subject.
  struct crossing {
    sighting what;
    medium over = medium::none;
    std::string from;
    std::string to;
    peer_id towards = any_peer;
  };

  // the tree
  node_index add(node x, node_index parent);
  [[nodiscard]] std::vector<node_index>& nodes_of(subject x);
  [[nodiscard]] node_index caused(std::uint64_t cause) const;
  [[nodiscard]] node_index last_at(subject x, const std::string& actor, cargo of,
                                   peer_id towards = any_peer) const;
  [[nodiscard]] node_index last_hop(const crossing& x) const;
  node_index begin_hop(const crossing& x, const record& r);
  void arrive(node_index n, const std::string& actor, const record& r);
  void arrive_piece(node_index n, std::uint32_t index, const std::string& actor, const record& r);
  node& at(node_index n) { return all_.nodes[n]; }

  // messages.cpp: which message is it?
  /// Of a packet in an island: medium, direction, origin, and the tag of its pieces; or medium,
  /// direction, origin and sequence of one of them.
  using packet_key = std::tuple<island_id, medium, bool, mote_id, std::uint32_t>;
  [[nodiscard]] std::optional<sighting> recognise(const carried_piece& x, medium over,
                                                  island_id here, const record& r);
  [[nodiscard]] std::optional<sighting> recognise_packet(const carried_piece& x, medium over,
                                                         island_id here, const record& r);
  void complete(const sighting& what, byte_view packet);
  [[nodiscard]] std::optional<sighting> recognise(const envelope& x, const record& r);
  [[nodiscard]] std::optional<sighting> recognise_plain(message x, const record& r);
  [[nodiscard]] std::optional<sighting>
  recognise_segment(message x, const transport::segment& segment, const record& r);
  [[nodiscard]] std::optional<std::uint32_t> take_waiting(const message& x, const record& r);
  void turn_away(std::uint32_t index, bool for_good);
  [[nodiscard]] std::optional<sighting> recognise_channel(const channel_content& x, island_id here,
                                                          const record& r);
  [[nodiscard]] std::optional<sighting> recognise_flow(byte_view octets, island_id here,
                                                       const record& r);
  std::uint32_t begin_message(message x, const record& r);
  void on_send(const record& r);
  void on_message(const record& r);
  void on_send_ended(const record& r);
  void deliver(const node& x, const std::string& actor, instant when);

  // radio.cpp
  void on_radio_send(const record& r);
  void on_radio_done(const record& r);
  void on_frame(const record& r);
  void on_frame_received(const record& r);

  // serial.cpp
  void on_serial_write(const record& r);
  void on_serial_octets(const record& r);
  void on_plug(const record& r);

  // peis.cpp
  void on_packages(const record& r);
  void on_package(const carried_package& x, const std::string& to, const record& r);
  [[nodiscard]] std::optional<sighting> recognise(const carried_package& x, const record& r);
  [[nodiscard]] std::optional<sighting> recognise(const peis::tuple& x, bool is_set, bool is_whole,
                                                  const record& r);
  [[nodiscard]] bool was_at(const tuple_value& x, const std::string& peer) const;
  void on_set(const record& r, bool deleted);
  void on_set_remote(const record& r);
  void on_event(const record& r);
  void on_send_peis(const record& r);
  void on_outcome(const record& r);
  void on_story(const record& r);
  std::uint32_t begin_tuple(tuple_value x, step how, const record& r);
  void reach_owner(std::uint32_t index, const std::string& actor, node_index parent,
                   const record& r);

  journeys all_;
  instant now_;
  std::map<std::uint64_t, std::uint64_t> causes_;
  std::map<std::uint64_t, std::vector<node_index>> arrivals_; ///< by record

  // messages
  using session_key = std::tuple<mote_address, mote_address, transport::incarnation, std::uint16_t>;
  struct session_entry {
    std::uint32_t message = 0;
    instant seen;
  };
  std::map<session_key, session_entry> sessions_;
  std::map<session_key, session_entry> greetings_;
  /// Given to a mote and not yet seen on their way, oldest first.
  std::map<std::pair<mote_address, mote_address>, std::deque<std::uint32_t>> waiting_;
  std::map<std::uint64_t, std::vector<std::uint32_t>> sent_by_; ///< in the course of a delivery
  std::map<std::pair<std::string, std::uint64_t>, std::deque<std::uint32_t>> unended_;
  std::map<mote_address, std::uint32_t> numbers_; ///< of the last message by source
  struct partial_packet {
    std::optional<sighting> what; ///< once the first piece has been seen
    std::vector<std::optional<bytes>> pieces;
    instant seen;
  };
  std::map<packet_key, partial_packet> packets_;
  std::map<std::tuple<mote_address, mote_address, std::uint16_t, bytes>,
           std::vector<std::uint32_t>>
      plain_; ///< unreliable ones by content
  struct channel_entry {
    std::uint32_t message = 0;
    instant seen;
  };
  std::map<std::tuple<island_id, std::uint32_t, std::uint8_t, bytes>, channel_entry> on_channels_;
  std::map<std::tuple<island_id, mote_id, std::uint64_t>, std::uint32_t> measuring_; ///< by number

  // radio
  struct request {
    std::string from;
    std::uint64_t token = 0;
    mote_id destination;
    std::uint8_t am_type = 0;
    bytes octets;
    node_index hop = no_node;
    std::uint32_t piece = 0;
  };
  std::map<mote_address, std::deque<request>> requests_;
  struct piece_state {
    std::uint32_t sequence = 0;
    bool arrived = false;
  };
  std::map<node_index, std::map<std::uint32_t, piece_state>> pieces_; ///< of hops, by index
  [[nodiscard]] request* request_of(island_id island, const bytes& psdu);

  // serial
  struct line_write {
    bytes octets;
    node_index hop = no_node;
    std::size_t attempt = 0;
    std::uint32_t piece = 0;
  };
  struct line_state {
    bool unplugged = false;
    std::deque<line_write> under_way[2]; ///< by direction
  };
  std::map<std::string, line_state> lines_;

  // peis
  std::map<std::string, std::vector<std::uint32_t>> by_key_; ///< folded key, newest last
  std::map<std::tuple<std::int32_t, std::uint16_t, std::uint16_t>, sighting> fragments_;
  std::map<std::tuple<std::int32_t, std::string, std::int32_t, std::int32_t, std::int32_t>,
           std::uint32_t>
      stamped_; ///< owner, key, seqno and time of writing
  std::map<std::uint64_t, std::vector<std::string>> link_ends_;
  /// What a component waits for, oldest first.
  struct asked_entry {
    std::uint64_t number = 0; ///< of the record
    subject about;
    peer_id to;
    cargo of = cargo::content;
  };
  std::map<std::pair<std::string, std::uint64_t>, std::deque<asked_entry>> asked_;
};

} // namespace rubicon::explain
