// When a mote sends its beacons: often while something changes, seldom otherwise (RFC 6206, without
// suppression).
#pragma once

#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::network {

struct trickle_config {
  duration interval_min = 125ms;
  duration interval_max = 8min;
  unsigned shortest = 1;   ///< so many shortest intervals follow each other before they grow
  unsigned redundancy = 6; ///< others that fire in a shorter interval, which make ours needless
};

/// Fires once in each interval, at a random time in its second half; each interval is twice as long
/// as the one before it, up to interval_max. In shorter ones it keeps quiet if enough others fire
/// (Levis et al., RFC 6206): so many that begin at once, or receive one who does, do not choke the
/// air.
class trickle {
public:
  trickle() = default;

  /// The first interval begins `now`. @pre 0 < interval_min <= interval_max
  trickle(trickle_config config, random_stream rng, instant now);

  /// @returns whether it fires; then deadline() is already that of the next firing
  [[nodiscard]] bool on_time(instant now);

  /// Something is inconsistent: a shortest interval begins, unless one is under way.
  void reset(instant now) { shorten(now, config_.interval_min); }

  /// Something has changed: an interval of this length begins, unless one so short is under way.
  void shorten(instant now, duration interval);

  /// Another has fired that did what we would do.
  void hear() { ++heard_; }

  /// We have just done it for another reason: once nothing changes, the next interval begins now.
  void done(instant now) {
    if (interval_ == config_.interval_max)
      begin(interval_, now);
  }

  [[nodiscard]] instant deadline() const { return due_; }

  /// The latest time at which it fires, whoever else does.
  [[nodiscard]] instant certain() const;

  /// Octets of its state on a mote.
  [[nodiscard]] static std::size_t footprint() { return 12; }

private:
  void begin(duration interval, instant at);

  trickle_config config_;
  random_stream rng_;
  duration interval_{};
  instant start_; ///< of the interval in which it fires next
  instant due_;
  unsigned heard_ = 0;    ///< in this interval
  unsigned shortest_ = 0; ///< shortest intervals so far
};

} // namespace rubicon::network
