// The mote's side of joining an island and staying in it (DIS-08).
#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "mote/join/management.hpp"

namespace rubicon::mote {

/// Send this component management message to the sink.
struct to_registrar {
  management message;
};

/// The mote is in (D1.1 5.3.4, event `joined`).
struct island_joined {
  island_id island;
  mote_id sink;
  std::vector<island_id> aliases = {}; ///< as in join_reply
};

/// The sink has forgotten us; joining starts again.
struct island_lost {};

/// The sink has another mote with our address: we are to be silent (ADR-04).
struct join_refused {};

/// The silence is over; joining starts again.
struct join_resumed {};

using join_output =
    std::variant<to_registrar, island_joined, island_lost, join_refused, join_resumed>;
using join_outputs = std::vector<join_output>;

struct join_config {
  duration start_jitter = 250ms; ///< the first request leaves uniformly within this, and
  static constexpr duration start_jitter_hop = 1s; ///< this for each hop of the route but the first
  static constexpr duration reply_wait = 500ms;    ///< for each hop of the route
  static constexpr unsigned attempts_max = 5;      ///< before a pause

  /// After attempts_max requests without a reply; doubles each time up to pause_max, +-50 %.
  duration pause = 2s;
  static constexpr duration pause_max = 30s;

  /// After a refusal, since another mote has its address: doubles each time, +-50 %.
  static constexpr duration refused_pause = 30s;
  static constexpr duration refused_pause_max = 10min;

  duration keep_alive = 3s; ///< a keep-alive is sent when nothing else was sent for so long
  /// One is sent so long after the join, too, and at twice the time after each: a sink that never
  /// received a confirm has given the mote up.
  static constexpr duration first_keep_alive = 4s;
};

/// off --start--> requesting --reply--> joined --rejoin_prompt--> requesting
///                 |   ^
///                 +---+ no reply: again, after attempts_max with a growing pause
///                 requesting --refusal--> refused --silence over--> requesting
class join_client {
public:
  enum class state : std::uint8_t { off, requesting, joined, refused };

  join_client() = default;
  /// @param device as in descriptor
  join_client(join_config config, bytes descriptor, std::uint32_t incarnation, random_stream rng,
              std::uint32_t device = 0);

  /// @param hops of the route to the sink
  [[nodiscard]] join_outputs start(unsigned hops, instant now);
  [[nodiscard]] join_outputs leave(); ///< notifies the sink, then off

  /// A component management message from `source`.
  /// @param root of the tree: its prompts count too, or a false reply would make a mote ignore them
  [[nodiscard]] join_outputs on_message(mote_id source, const management& message, instant now,
                                        mote_id root = no_mote);

  /// Frames may wait so long for their turn: answers take longer, and motes that have joined
  /// together do not go on sending together.
  void set_turn_wait(duration x) { turn_wait_ = x; }

  /// What the mote's sink is to know in case it falls silent.
  [[nodiscard]] join_outputs report(const mote_condition& x, instant now);

  void on_sent(instant now); ///< the mote has sent its sink something: no keep-alive needed yet

  [[nodiscard]] join_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const { return deadline_; }

  [[nodiscard]] state current() const { return state_; }

private:
  [[nodiscard]] join_outputs request(instant now);
  [[nodiscard]] instant next_keep_alive(instant now);

  join_config config_;
  bytes descriptor_;
  std::uint32_t incarnation_ = 0;
  std::uint32_t device_ = 0;
  mote_condition condition_;
  random_stream rng_;
  state state_ = state::off;
  mote_id sink_;
  unsigned hops_ = 1;
  duration turn_wait_{};
  std::uint16_t sequence_ = 0;
  unsigned attempts_ = 0;
  duration pause_{};
  duration refused_pause_{};
  duration gap_{}; ///< to the next keep-alive at most
  std::optional<instant> deadline_;
};

} // namespace rubicon::mote
