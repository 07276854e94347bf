// Messages about own tuples that must reach a subscriber in order: appends (TUP-07).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "peis/space/tuple_events.hpp"

namespace rubicon::peis {

/// One message in flight per subscriber and tuple, the next leaves when it is acknowledged: a real
/// kernel applies append notices in the order in which they arrive, and repeats of lost packages
/// change that order (peis-wire.md 15.5). A tuple is followed from a whole value on which later
/// notices build until something else happens to it.
class tuple_channels {
public:
  /// @param waiting_max messages per subscriber and tuple that have not left yet
  /// @param octets_max of all messages that have not left yet
  explicit tuple_channels(std::size_t waiting_max = 0, std::size_t octets_max = 0)
      : waiting_max_(waiting_max), octets_max_(octets_max) {}

  void follow(const key& name) { followed_.try_emplace(name.folded()); }
  [[nodiscard]] bool follows(const key& name) const { return followed_.contains(name.folded()); }

  /// Forgets the tuple. @returns the subscribers that something was still to leave for
  std::vector<peer_id> abandon(const key& name);

  /// Is a message to that subscriber in flight?
  [[nodiscard]] bool busy(const key& name, peer_id subscriber) const;
  /// Would a message of this size have to wait without there being room?
  [[nodiscard]] bool full(const key& name, peer_id subscriber, std::size_t octets) const;

  /// What is to be sent now: the message, with a request of its own, unless it has to wait.
  /// @pre follows(name), !full(name, message.destination, message.content.size())
  [[nodiscard]] std::optional<transmit> send(const key& name, transmit message);

  /// A message has been acknowledged. @returns the one that may leave now
  [[nodiscard]] std::optional<transmit> on_delivered(request_id request);

  /// Is this the request of a message that is still of interest?
  [[nodiscard]] bool knows(request_id request) const { return requests_.contains(request); }

  void drop_subscriber(peer_id host);

private:
  struct channel {
    request_id in_flight;
    std::deque<transmit> waiting;
  };
  using channels = std::map<peer_id, channel>; ///< only busy ones

  [[nodiscard]] const channel* find(const key& name, peer_id subscriber) const;
  [[nodiscard]] transmit dispatch(const std::string& folded, channel& through, transmit message);

  void forget(const channel& x);

  std::size_t waiting_max_;
  std::size_t octets_max_;
  std::size_t octets_ = 0;                   ///< of all that wait
  std::map<std::string, channels> followed_; ///< by folded key
  std::map<request_id, std::pair<std::string, peer_id>> requests_;
  std::uint64_t requests_made_ = 0;
};

} // namespace rubicon::peis
