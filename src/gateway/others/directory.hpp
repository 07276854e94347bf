// The other gateways, as far as they have announced themselves (GW-13, GW-14).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "gateway/others/announcement.hpp"

namespace rubicon::gateway {

struct directory_config {
  duration first_gap = 1s; ///< between our first announcements; each further gap is twice as long,
  duration period = 10s;   ///< up to this
  duration answer_max = 500ms;     ///< a new gateway gets an answer within this
  unsigned missed_max = 3;         ///< a gateway silent for so many periods is gone
  std::size_t gateways_max = 4096; ///< further ones are not noted
};

struct directory_counters {
  std::uint64_t heard = 0;
  std::uint64_t foreign = 0; ///< broadcasts on the port that are no announcement of our kind
  std::uint64_t refused = 0; ///< no room for another gateway
};
RUBICON_FIELDS(directory_counters, heard, foreign, refused);

struct known_gateway {
  peer_id peer;
  announcement said;
  instant last_received;
  instant claimed = {}; ///< when it first said that it leads, if it does
};

/// Says when to announce ourselves, and knows who else serves which island.
class directory {
public:
  directory() = default;
  directory(directory_config config, random_stream rng) : config_(config), rng_(rng) {}

  void start(instant now);

  /// A broadcast on the port. What is no announcement makes its sender a gateway of another make,
  /// which serves the island of its own PEIS id in the strict form.
  void on_announcement(peer_id source, byte_view octets, instant now);

  /// A message could not be delivered: another gateway of its island is tried from now on.
  void on_unreachable(peer_id peer) { known_.erase(peer); }

  /// @returns whether we are to announce ourselves now
  [[nodiscard]] bool on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Our role has changed: it is announced soon.
  void announce_soon(instant now) {
    gap_ = config_.first_gap;
    due_ = now;
  }

  /// The gateway that messages for an island go to: the one that leads it; without such, that with
  /// the island's id while it announces itself, or if it never has; else the last received one of
  /// those that serve it too. An island may be called by the id of any gateway that was ever
  /// announced for it.
  [[nodiscard]] peer_id gateway_for(island_id island) const;

  /// The one that says it leads, the last to say so; nothing: none does.
  [[nodiscard]] std::optional<peer_id> leader_of(island_id island) const;

  /// The island that is meant by an id of it, or by the id of one of its gateways.
  [[nodiscard]] island_id meant_by(island_id x) const;

  /// Which island a gateway speaks for: that of its own id unless it says otherwise.
  [[nodiscard]] island_id island_of(peer_id peer) const;

  /// Form in which a peer speaks; ours unless it says otherwise.
  [[nodiscard]] wire_form form_of(peer_id peer) const;

  [[nodiscard]] std::vector<known_gateway> known() const; ///< ascending by PEIS id
  [[nodiscard]] const directory_counters& counters() const { return counters_; }

private:
  directory_config config_;
  random_stream rng_;
  std::map<peer_id, known_gateway> known_;
  std::map<peer_id, island_id> aliases_; ///< ever announced, also of gateways that have gone
  duration gap_{};
  std::optional<instant> due_; ///< our next announcement
  directory_counters counters_;
};

} // namespace rubicon::gateway
