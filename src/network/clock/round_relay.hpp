// When a mote relays a round of the island's clock to its neighbours (CLK-01).
#pragma once

#include <optional>

#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::network {

struct relay_config {
  duration spread = 150ms;                  ///< the first beacon of a round leaves within this time
  duration pause = 1s;                      ///< before the next one, at most
  unsigned relays_max = 3;                  ///< beacons of a round
  static constexpr unsigned copies_max = 3; ///< of others: then ours are not needed
};

class round_relay {
public:
  round_relay() = default;
  explicit round_relay(relay_config config) : config_(config) {}

  /// A new round has been received.
  void on_round(instant now, random_stream& rng);
  /// This mote has begun a round.
  void on_own_round() { copies_ = relays_ = 0; }
  /// Another's beacon of the same round. @param is_urgent our beacon is needed for another reason
  void on_copy(bool is_urgent);

  /// A beacon is needed as soon as one of a new round.
  void hasten(instant now, random_stream& rng);

  /// One leaves now: what is due is done.
  void clear() { due_.reset(); }
  /// It has the time in it: the next one may be due.
  void on_relayed(instant now, random_stream& rng);

  [[nodiscard]] std::optional<instant> due() const { return due_; }

private:
  relay_config config_;
  std::optional<instant> due_;
  unsigned copies_ = 0; ///< received, of the last round,
  unsigned relays_ = 0; ///< and sent
};

} // namespace rubicon::network
