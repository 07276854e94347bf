// SMEPP Light of one mote: its peer, and the programs that use it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "smepp/member_config.hpp"
#include "smepp/member_program.hpp"
#include "smepp/smepp.hpp"

namespace rubicon::smepp {

/// What a transducer of that kind is among transducer_names; 0: none of them.
[[nodiscard]] transducer_mask mask_of(device::quantity x);

/// Configuration of SMEPP Light on a mote. Holds keys: neither logged nor sent.
struct node_config {
  mote_id self;
  transducer_mask transducers = 0;
  bool is_real = false;    ///< in wall time: its secrets are not drawn from the seed
  group_settings settings; ///< with keys
  std::vector<std::pair<member_config, group_description>> members; ///< of groups that differ
  std::vector<mote_id> others; ///< with whom it has pairwise keys, if those are asked for
};

/// An event's value is to go to the gateway.
struct forward_event {
  std::uint8_t channel = 0;
  bytes value;
};

/// The mote's processor computes for so long.
struct computes {
  duration length{};
};

/// A line for the event log of the run.
struct notable {
  std::string what;
};

using node_output =
    std::variant<store_state, send_frame, set_radio, forward_event, computes, notable>;
using node_outputs = std::vector<node_output>;

/// The programs of a mote and their peer. Times are by the mote's own clock, which never goes back.
class node {
public:
  using reader = std::function<std::optional<std::int16_t>(device::quantity)>;

  /// @param begin of the run, by the same clock
  /// @param before what store_state gave last, in a former life
  node(node_config config, random_stream rng, instant begin, instant now,
       persistent_state before = {});
  ~node(); // these are large: compiled once
  node(node&&) noexcept;
  node& operator=(node&&) noexcept;

  /// Transducers are read through this; without it there are none.
  void set_reader(reader x) { reader_ = std::move(x); }

  [[nodiscard]] node_outputs start(instant now);
  /// @param at when its start-of-frame delimiter was received
  [[nodiscard]] node_outputs on_frame(mote_id from, mote_id to, byte_view octets, instant at,
                                      instant now);
  /// @param at when the start-of-frame delimiter of a send_frame was on the air
  [[nodiscard]] node_outputs on_sent(std::uint64_t id, bool acked, instant at, instant now);
  /// Frames under the keys before are still taken for a while (SMP-02).
  [[nodiscard]] node_outputs set_network_keys(const key_pair& x, instant now);
  [[nodiscard]] node_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] const peer& own() const { return peer_; }
  [[nodiscard]] const std::vector<member_program>& members() const { return members_; }

private:
  class host;

  node_outputs dispatch(outputs from_peer, instant now);
  /// Gives each member its turn, after what the peer wants.
  template <class Turn>
  node_outputs give_turns(outputs from_peer, instant now, Turn turn);

  peer peer_;
  key_pair network_;
  std::vector<member_program> members_;
  reader reader_;
  std::uint64_t agreements_ = 0; ///< that the battery has been charged for
};

} // namespace rubicon::smepp
