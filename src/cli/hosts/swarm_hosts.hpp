// The runs of a swarm on several computers, each of which runs `rubicon host`.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "cli/hosts/deployed.hpp"
#include "cli/print/swarm_output.hpp"
#include "cli/swarm.hpp"
#include "control/client.hpp"
#include "control/system.hpp"
#include "deploy/messages.hpp"
#include "io/loop.hpp"

namespace rubicon::cli {

/// Distributes seeds over hosts and reclaims those of lost hosts. The outcome of a seed counts
/// once, whichever host has run it.
class swarm_hosts {
public:
  /// @param where, out outlive it
  /// @param what the file, without a seed of its own
  swarm_hosts(io::loop& where, control::system& actors, const std::vector<deployed_host>& hosts,
              deploy::bundle what, duration timeout, swarm& seeds, swarm_output& out);

  /// To be called again and again. @returns false once all is over
  [[nodiscard]] bool step();

  /// Whether nobody of the hosts could begin.
  [[nodiscard]] bool refused() const;

  /// Lets hosts end what runs; waits for those that answer.
  void end();

private:
  using steady = std::chrono::steady_clock;

  enum class phase : std::uint8_t { greeting, offer, running, unfit };

  struct seed_host {
    std::string name;
    std::unique_ptr<control::client> client;
    phase at = phase::greeting;
    steady::time_point asks_at;
    std::string trouble;
    std::set<std::uint64_t> given; ///< and not come back
    std::uint64_t after = 0;
    std::uint32_t jobs = 0;
    std::size_t finished = 0; ///< of the last answer
  };

  void ask(seed_host& x);
  void on_answer(seed_host& x, deploy::answer& found);
  void on_news(seed_host& x, deploy::seeds_news& news);
  void take_back(seed_host& x, const std::string& why, phase next);
  [[nodiscard]] std::vector<std::uint64_t> seeds_for(seed_host& x);
  void say(const seed_host& x, const std::string& text);

  io::loop& loop_;
  const std::string experiment_;
  const deploy::bundle what_;
  const duration timeout_;
  swarm& seeds_;
  swarm_output& out_;
  std::deque<std::uint64_t> returned_; ///< ascending
  bool is_ending_ = false;
  std::list<seed_host> hosts_;
};

} // namespace rubicon::cli
