// When one sender wants to send.
#pragma once

#include <cstdint>
#include <optional>

#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "traffic/flow_config.hpp"

namespace rubicon::traffic {

/// Sans-I/O. A periodic sender's k-th request is due at start + k * every + uniform 0..jitter, k
/// counted from 0; one that starts late keeps to the grid of its start. A Poisson sender draws
/// exponential gaps. A saturated sender begins a random part of phase_max after its start, since
/// senders in step would find the channel clear at the same instants for ever, which those with
/// clocks of their own do not. It is due as soon as its last request has ended, but no sooner
/// than retry_min after a request that was answered in the instant it was made: a MAC that refuses
/// on the spot would be asked without end.
class schedule {
public:
  static constexpr duration retry_min = 1ms;
  static constexpr duration phase_max = 10ms;

  /// From the first request to the end of sending.
  struct span {
    instant from;
    instant until;
  };

  schedule() = default;
  /// @pre every > 0 unless saturated; jitter >= 0
  schedule(const sender_config& config, random_stream rng);

  void start(instant now);

  /// Notices that the time to stop has come.
  void on_time(instant now);

  /// A request was made. @pre due()
  void on_request(instant now);

  /// A request that was made at `requested` has ended.
  void on_answer(instant requested, instant now);

  /// Nothing is sent any more.
  void end(instant now);

  /// When to make the next request; nothing while a saturated sender waits for an answer, and after
  /// the last.
  [[nodiscard]] std::optional<instant> due() const { return due_; }

  /// Until `now`, or until the first request that `stop` or `count` did not allow was due; nothing
  /// before the first request.
  [[nodiscard]] std::optional<span> active(instant now) const;

private:
  [[nodiscard]] instant first_of_grid(instant now);
  [[nodiscard]] instant first_of_poisson(instant now);
  [[nodiscard]] duration jitter();
  [[nodiscard]] duration gap();
  void plan(instant at);

  arrivals pattern_ = arrivals::periodic;
  duration every_ = 1s;
  duration jitter_{};
  std::optional<instant> start_;
  std::optional<instant> stop_;
  std::optional<std::uint64_t> count_;
  random_stream rng_;

  std::uint64_t requests_ = 0;
  instant base_; ///< of a periodic request: when it is due but for the jitter
  std::optional<instant> due_;
  std::optional<instant> first_;
  std::optional<instant> ended_;
};

} // namespace rubicon::traffic
