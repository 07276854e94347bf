// Plays one attack over a number of links for a length of time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "hostile/attack.hpp"

namespace rubicon::hostile {

using steady = std::chrono::steady_clock;

struct play_config {
  target whom;
  std::size_t links = 1;
  duration length = 1s;
  std::uint64_t seed = 1;
  double rate = -1; ///< of say() over all links a second; below 0: that of the attack, 0: no limit
};

/// The sum over all links.
struct play_result {
  link_counts counts;
  duration took{};
};

class player {
public:
  player(const attack_kind& kind, const play_config& config);

  /// To the end; then all links are gone, without a goodbye.
  [[nodiscard]] play_result play();

private:
  struct seat {
    std::unique_ptr<link> its;
    steady::time_point reopen;
  };

  void open_closed();
  void poll_links();
  void talk();
  [[nodiscard]] double allowed() const;
  bool talk(link& x);

  play_config config_;
  double rate_;
  std::unique_ptr<attack> attack_;
  std::vector<seat> seats_;
  steady::time_point start_;
  double said_ = 0;
  bool eager_ = false; ///< there is more to say at once
  std::size_t next_ = 0;
};

} // namespace rubicon::hostile
