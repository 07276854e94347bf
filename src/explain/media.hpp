// For files of this room only: what crosses the air, the serial lines, the backbones, and the links
// between peers.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "explain/messages.hpp"
#include "explain/tuples.hpp"

namespace rubicon::explain {

/// Frames. All that becomes of a request is caused by it.
class air_follower {
public:
  air_follower(growth& all, message_follower& messages) : all_(all), messages_(messages) {}

  void on_send(const record& r);
  void on_frame(const record& r);
  void on_received(const record& r);
  void on_done(const record& r);

  /// What a packet of the Network module carries that `who` sends over any medium.
  /// @param fragment @param fragments which part of it
  [[nodiscard]] std::optional<sighting>
  recognise(const record& r, mote_address who, std::uint32_t& fragment, std::uint32_t& fragments);

private:
  struct request {
    node_index hop = no_node;
    std::uint32_t fragment = 0;
    bool to_all = false;
  };

  growth& all_;
  message_follower& messages_;
  std::map<std::uint64_t, request> requests_; ///< that are open, by number
};

/// Octets that come out of a line are caused by the write that gave them to it. What a line carries
/// stays in order: what was written before and has not come is lost.
class line_follower {
public:
  line_follower(growth& all, message_follower& messages) : all_(all), messages_(messages) {}

  void on_write(const record& r);
  void on_octets(const record& r);
  void on_plug(const record& r);

private:
  struct written {
    std::uint64_t number = 0;
    bytes octets;
    node_index hop = no_node;
    std::size_t attempt = 0;
    std::uint32_t fragment = 0;
  };
  struct cable {
    bool unplugged = false;
    std::array<std::deque<written>, 2> in_flight; ///< by direction
  };

  void set_outcome(const written& x, const char* outcome);

  growth& all_;
  message_follower& messages_;
  std::map<std::string, cable> lines_;
};

/// Packets between an island's sink and its further ones. A backbone keeps them in order: what was
/// given to it before one that has come, and has not come itself, is lost.
class backbone_follower {
public:
  backbone_follower(growth& all, air_follower& air) : all_(all), air_(air) {}

  void on_write(const record& r);
  void on_received(const record& r);
  void on_plug(const record& r);

private:
  struct written {
    std::uint64_t number = 0;
    node_index hop = no_node;
    std::size_t attempt = 0;
    std::uint32_t fragment = 0;
  };
  struct connection {
    bool is_cut = false;
    std::array<std::deque<written>, 2> in_flight; ///< by direction
  };

  void lose(const written& x, const char* why);

  growth& all_;
  air_follower& air_;
  std::map<std::string, connection> links_;
};

/// Packages, each in a record of its own, and what components ask their kernels to send.
class link_follower {
public:
  link_follower(growth& all, message_follower& messages, tuple_follower& tuples)
      : all_(all), messages_(messages), tuples_(tuples) {}

  void on_opened(const record& r) { ends_[r.id].push_back(r.to); }
  void on_package(const record& r); ///< that has come, or is lost

  // a component's request to its kernel
  void on_asked(const record& r, const sighting& what);
  void on_send(const record& r);
  void on_outcome(const record& r);

private:
  [[nodiscard]] std::optional<sighting> recognise(const carried_package& x, const record& r);

  struct request {
    sighting what;
    peer_id to;
  };

  growth& all_;
  message_follower& messages_;
  tuple_follower& tuples_;
  std::map<std::uint64_t, std::vector<std::string>> ends_; ///< of links
  std::map<std::uint64_t, request> requests_;              ///< without an outcome, by number
};

} // namespace rubicon::explain
