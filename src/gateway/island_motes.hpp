// The motes of an island as its sink reports them, and their tuples below `devices`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "gateway/occasion.hpp"
#include "network/sink_event.hpp"

namespace rubicon::gateway {

struct island_motes_config {
  std::size_t motes_max = 1000; ///< further ones are refused
  duration rejoin_wait = 60s;   ///< gateway_config's
  bool has_real_line = false;   ///< motes with plain programs are behind a line of their own
};

/// A copy of the sink's list of members, repaired by its rosters: the sink is asked about each mote
/// of which the two differ.
class island_motes {
public:
  /// How a join has changed the list.
  struct join {
    bool is_new = false;
    bool restarted = false;   ///< its incarnation is another one
    bool contradicts = false; ///< the same life, with another type or descriptor
  };

  island_motes() = default;
  explicit island_motes(island_motes_config config) : config_(config) {}

  /// @returns nothing if there is no room for another mote
  [[nodiscard]] std::optional<join> on_joined(const network::mote_joined& x, const occasion& at);
  /// @returns whether it was listed
  bool on_left(const network::mote_left& x, const occasion& at);
  void on_roster(const network::roster& x, const occasion& at);
  /// The motes of a sink that was started again are there as before; it lists each of them when it
  /// has joined again.
  void on_sink_started(const occasion& at);

  void refresh(mote_id mote, const occasion& at); ///< it has sent: it is not stale
  void make_stale(const occasion& at);            ///< all that are behind the sink's line
  void make_plain_stale(const occasion& at);

  void note_output(mote_id mote, std::uint16_t channel); ///< @pre listed; it has a tuple
  void note_input(mote_id mote, std::uint16_t channel);  ///< @pre as above
  /// Erases the tuples of outputs: the newest ones are another gateway's.
  void erase_outputs(const occasion& at);

  [[nodiscard]] bool is_listed(mote_id x) const { return listed_.contains(x); }
  [[nodiscard]] bool is_plain(mote_id x) const;   ///< listed, with a plain program
  [[nodiscard]] std::vector<mote_id> all() const; ///< ascending
  [[nodiscard]] publish list_tuple() const;

private:
  struct listed_mote {
    std::uint32_t incarnation = 0;
    std::uint64_t described = 0; ///< hash of its type and descriptor
    bool stale = false; ///< nothing received since the line was lost, or the sink started again
    bool plain = false; ///< it understands no message of a gateway
    std::set<std::uint16_t> output_channels; ///< those with a tuple, erased when the mote leaves
    std::set<std::uint16_t> input_channels;
  };

  static void make_stale(listed_mote& x, mote_id id, const occasion& at);
  void end_roster(const occasion& at);

  island_motes_config config_;
  std::map<mote_id, listed_mote> listed_;
  instant rejoin_until_; ///< before this the sink, started again, may not list all its motes
  std::optional<std::uint16_t> roster_number_; ///< of the roster being received
  std::set<mote_id> roster_motes_;
  std::uint8_t roster_pages_ = 0;
};

} // namespace rubicon::gateway
