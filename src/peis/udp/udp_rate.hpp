// How much of a UDP session may be under way, and for how long it is waited for (UDP-02).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/numbers/latency_estimate.hpp"
#include "core/time.hpp"

namespace rubicon::peis {

struct udp_rate_config {
  double window_first = 16; ///< datagrams
  double window_min = 8;
  double window_max = 1024;
  double growth = 1.1; ///< an interval, as UDP-02 has it
  /// Up to this share lost the window grows: radio loses so much without being full.
  double loss_borne = 0.2;
  double loss_much = 0.25;   ///< beyond it the window shrinks by what was lost, to a half at most
  double loss_weight = 0.25; ///< of the newest interval in the share that is looked at
  /// Loss while the round trip takes longer than the least by a quarter and this comes of a full
  /// queue.
  duration queue_delay = 10ms;
  double loss_of_queue = 0.02;
  double shrink_of_queue = 0.85;
};

/// The window follows the delivery that the other side reports: an interval is a round trip, of
/// interval_min and 16 datagrams at least; at its end the window grows by a tenth if it was used up
/// and little was lost, and shrinks if much was. Retries wait as RFC 6298 has it.
///
/// Deviation: the least wait is retry_min, not 1 s, and a session without a measured round trip
/// waits 300 ms: what is lost is noticed by what overtakes it, and a retry is one or two datagrams.
class udp_rate {
public:
  static constexpr duration retry_min = 20ms;
  static constexpr duration retry_max = 2s;
  static constexpr duration retry_first = 300ms;
  static constexpr duration interval_min = 1ms;
  static constexpr std::uint64_t interval_datagrams = 16;

  udp_rate() = default;
  explicit udp_rate(udp_rate_config config) : config_(config), window_(config.window_first) {}

  void on_round_trip(duration taken, instant now);

  /// The other side has got `count` of the transmissions up to `newest`; `sent` have left.
  /// @param newest, count of all since the session began; never smaller than before
  void on_report(std::uint64_t newest, std::uint64_t count, std::uint64_t sent, instant now);

  /// More would have left if the window had allowed it.
  void note_limited() { limited_ = true; }

  /// Nothing that was sent has been acknowledged for several retries.
  void on_stall() { window_ = config_.window_min; }

  [[nodiscard]] std::size_t window() const { return static_cast<std::size_t>(window_); }
  [[nodiscard]] duration retry_after(unsigned retries) const;

  /// What was overtaken is lost when it is out for so long: reordering costs less.
  [[nodiscard]] duration lost_after() const;

  [[nodiscard]] std::optional<duration> round_trip() const { return estimate_.mean(); }

private:
  [[nodiscard]] bool queues() const;
  void adapt(double lost);

  udp_rate_config config_;
  double window_ = udp_rate_config{}.window_first;
  latency_estimate estimate_;
  duration latest_{};
  // The least round trip of the last 10 to 20 s.
  std::optional<duration> least_;
  std::optional<duration> least_before_;
  instant least_since_{};
  // The interval.
  std::uint64_t first_newest_ = 0;
  std::uint64_t first_count_ = 0;
  std::uint64_t end_ = 0; ///< it is over when this transmission has come, or a later one
  instant begun_{};
  double lost_ = 0; ///< share, smoothed
  bool limited_ = false;
};

} // namespace rubicon::peis
