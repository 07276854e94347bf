// What differs between two sets of runs, by how much, and how sure that is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/statistics.hpp"

namespace rubicon::study {

/// A figure of two sets of runs that belong together in pairs, such as by their seeds.
struct paired_figure {
  std::string variant; ///< of which it is; empty where there is only one
  std::string name;
  std::vector<double> a;
  std::vector<double> b; ///< as many
};

/// Puts pairs together of what comes in any order.
class figure_pairs {
public:
  enum class side : std::uint8_t { a, b };

  static constexpr std::size_t runs_max = 20'000; ///< of different variant and seed

  /// The figures of one run. A later one of the same variant, seed and side replaces it; beyond
  /// runs_max it is left out.
  void add(side where, const std::string& variant, std::uint64_t seed,
           const std::map<std::string, double>& figures);

  /// By variant and name, in the order of seeds; without figures that no seed has on both sides.
  [[nodiscard]] std::vector<paired_figure> all() const;

  /// Variant and seed of which there are runs on both sides.
  [[nodiscard]] std::size_t pairs() const;
  /// Runs that were left out.
  [[nodiscard]] std::size_t left_out() const { return left_out_; }
  /// Runs on one side only.
  [[nodiscard]] std::size_t single() const { return runs_.size() - pairs(); }

private:
  struct both {
    std::optional<std::map<std::string, double>> a;
    std::optional<std::map<std::string, double>> b;
  };

  std::map<std::pair<std::string, std::uint64_t>, both> runs_;
  std::size_t left_out_ = 0;
};

/// A figure that is not equal in all pairs.
struct difference {
  std::string variant;
  std::string name;
  estimate a;
  estimate b;
  estimate of_pairs; ///< of b - a
  /// The chance of such a difference, or a greater one, in any of the figures where there is none.
  double p = 1;
  bool is_sure = false; ///< p is at most 1 - confidence

  /// Of the greater of both means: -2 to 2.
  [[nodiscard]] double relative() const;
};

struct comparison {
  std::size_t figures = 0; ///< that were compared
  std::size_t sure = 0;
  std::vector<difference> differing; ///< sure ones first, of these the greatest relative ones
};

/// Student's t of the pairs, where p is at least that of the sign test with all signs equal: few
/// runs prove nothing, however close their values. Holm's correction for the number of figures that
/// differ in any pair; one that is equal in all pairs could not be found to differ.
[[nodiscard]] comparison compare(const std::vector<paired_figure>& all,
                                 double confidence = usual_confidence);

} // namespace rubicon::study
