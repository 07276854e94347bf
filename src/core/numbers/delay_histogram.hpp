// How lengths of time are spread, in little memory.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "core/time.hpp"

namespace rubicon {

/// Lengths of time by logarithmic buckets of at most 1.6 % width; few and sparse, so that ten
/// thousand of these fit in memory. Mean exact, quantiles (nearest rank) at the middle of their
/// bucket: off by at most 0.8 %.
class delay_histogram {
public:
  void add(duration x); ///< negative counts as 0
  delay_histogram& operator+=(const delay_histogram& x);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] double mean_ms() const;             ///< 0 if empty
  [[nodiscard]] double quantile_ms(double q) const; ///< 0 if empty; q in 0..1

  friend bool operator==(const delay_histogram&, const delay_histogram&) = default;

  void fold_into(fold64& x) const;
  void print_to(std::string& out) const; ///< how many, and their mean

  /// For octets (core/describe/field_codec.hpp).
  template <class F>
  friend void with_parts(F& f, delay_histogram& x) {
    f(x.count_, x.sum_ns_, x.buckets_);
  }

private:
  std::uint64_t count_ = 0;
  double sum_ns_ = 0;
  std::vector<std::pair<std::uint16_t, std::uint32_t>> buckets_; ///< ascending by number
};

} // namespace rubicon
