// What one mote knows about a flow of packets; the parts of all motes add up to the flow.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::flow {

/// Lengths of time by logarithmic buckets of at most 1.6 % width; few and sparse, so that ten
/// thousand flows fit in memory. Mean exact, quantiles (nearest rank) at the middle of their
/// bucket: off by at most 0.8 %.
class delay_histogram {
public:
  void add(duration x); ///< negative counts as 0
  delay_histogram& operator+=(const delay_histogram& x);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] double mean_ms() const;             ///< 0 if empty
  [[nodiscard]] double quantile_ms(double q) const; ///< 0 if empty; q in 0..1

  friend bool operator==(const delay_histogram&, const delay_histogram&) = default;

  /// For messages.
  template <class F>
  friend auto inspect(F& f, delay_histogram& x) {
    return f(x.count_, x.sum_ns_, x.buckets_);
  }

private:
  std::uint64_t count_ = 0;
  double sum_ns_ = 0;
  std::vector<std::pair<std::uint16_t, std::uint32_t>> buckets_; ///< ascending by number
};

struct part {
  mote_address from;
  mote_address to;
  std::uint64_t sent = 0;                    ///< the origin's: packets for which it asked its MAC
  std::uint64_t delivered = 0;               ///< the target's, each once
  std::uint64_t octets = 0;                  ///< MAC payload delivered
  std::uint64_t transmissions = 0;           ///< of this mote, for this flow, repeats included
  std::map<std::string, std::uint64_t> lost; ///< on the hop out of this mote, by cause
  duration active{};     ///< the origin's: from its first request to the end of the run or
                         ///< to when it stops sending
  delay_histogram delay; ///< the target's: from the origin's request to delivery

  /// A part without addresses takes those of `x`. @pre otherwise the same flow
  part& operator+=(const part& x);
};

} // namespace rubicon::flow
