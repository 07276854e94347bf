// An honest peer from outside, for whom an ecology is there: what it writes goes over the attacked
// peer to a translation and comes back, twenty milliseconds apart, and how long each takes is
// measured.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "hostile/link.hpp"
#include "peer/standalone.hpp"

namespace rubicon::hostile {

/// Of the values written in a while. One that has not come back counts with its age.
struct loop_figures {
  std::size_t values = 0;
  std::size_t missing = 0; ///< have not come back
  double p50_ms = 0;
  double p99_ms = 0;
  double longest_ms = 0;
};

/// Of the requests that must have an outcome.
struct request_figures {
  std::uint64_t made = 0;
  std::uint64_t done = 0;
  std::uint64_t failed = 0;
  std::map<std::string, std::uint64_t> causes;

  [[nodiscard]] std::uint64_t open() const { return made - done - failed; }
};

class control_loop {
public:
  explicit control_loop(const target& whom);
  ~control_loop();
  control_loop(const control_loop&) = delete;
  control_loop& operator=(const control_loop&) = delete;

  /// Does a value come back within that time?
  [[nodiscard]] bool await_value(duration patience);

  /// Values written from now on count as those of a new while.
  void begin();
  [[nodiscard]] loop_figures figures() const;
  [[nodiscard]] request_figures requests() const;

  /// No more requests; the values go on.
  void stop_requests() { requesting_ = false; }

private:
  using clock = std::chrono::steady_clock;

  struct written {
    std::uint64_t number = 0;
    clock::time_point when;
  };

  void run();
  void write(peer::standalone& peer);
  void ask(peer::standalone& peer);
  void on_echo(std::string_view text);

  target whom_;
  std::atomic<bool> over_ = false;
  std::atomic<bool> requesting_ = true;
  std::atomic<std::uint64_t> echoes_ = 0;
  std::uint64_t number_ = 0;
  mutable std::mutex mutex_; // of all below
  std::deque<written> open_;
  std::vector<double> done_ms_;
  clock::time_point begun_;
  request_figures requests_;
  std::thread thread_;
};

/// Does somebody who comes now get into the network, and how long does it take?
/// @returns seconds until it reaches the keeper; unset: not within `patience`
[[nodiscard]] std::optional<double> newcomer_s(const target& whom, duration patience);

} // namespace rubicon::hostile
