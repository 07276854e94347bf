#include "study/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace rubicon::study {

namespace {

/// Not corrected.
double chance_of(const estimate& x) {
  if (x.runs < 2)
    return 1;
  const double sign_test =
      std::ldexp(1.0, 1 - static_cast<int>(std::min<std::size_t>(x.runs, 1000)));
  const double half = *x.half_width;
  if (half <= 0)
    return sign_test;
  const double t = std::abs(x.mean) * student_t(usual_confidence, x.runs - 1) / half;
  return std::max(sign_test, student_tail(t, x.runs - 1));
}

/// S. Holm, A simple sequentially rejective multiple test procedure, 1979. @pre ascending p
void correct(std::vector<difference>& ascending) {
  double highest = 0;
  for (std::size_t i = 0; i < ascending.size(); ++i) {
    auto& p = ascending[i].p;
    highest = std::max(highest, std::min(1.0, p * static_cast<double>(ascending.size() - i)));
    p = highest;
  }
}

bool is_more_important(const difference& x, const difference& y) {
  const auto rank = [](const difference& z) {
    return std::tuple(!z.is_sure, z.is_sure ? 0 : z.p, -std::abs(z.relative()));
  };
  return rank(x) < rank(y);
}

} // namespace

void figure_pairs::add(side where, const std::string& variant, std::uint64_t seed,
                       const std::map<std::string, double>& figures) {
  const std::pair which(variant, seed);
  if (runs_.size() >= runs_max && !runs_.contains(which)) {
    ++left_out_;
    return;
  }
  auto& run = runs_[which];
  (where == side::a ? run.a : run.b) = figures;
}

std::vector<paired_figure> figure_pairs::all() const {
  std::map<std::pair<std::string, std::string>, paired_figure> found;
  for (const auto& [which, run] : runs_) {
    if (!run.a || !run.b)
      continue;
    for (const auto& [name, value] : *run.a) {
      const auto other = run.b->find(name);
      if (other == run.b->end())
        continue;
      auto& figure = found[{which.first, name}];
      figure.a.push_back(value);
      figure.b.push_back(other->second);
    }
  }
  std::vector<paired_figure> out;
  out.reserve(found.size());
  for (auto& [which, figure] : found) {
    figure.variant = which.first;
    figure.name = which.second;
    out.push_back(std::move(figure));
  }
  return out;
}

std::size_t figure_pairs::pairs() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(runs_, [](const auto& x) { return x.second.a && x.second.b; }));
}

double difference::relative() const {
  const double greater = std::max(std::abs(a.mean), std::abs(b.mean));
  return greater == 0 ? 0 : of_pairs.mean / greater;
}

comparison compare(const std::vector<paired_figure>& all, double confidence) {
  comparison out;
  out.figures = all.size();
  for (const auto& each : all) {
    if (each.a == each.b)
      continue;
    difference found{each.variant, each.name, mean_of(each.a), mean_of(each.b),
                     paired_difference(each.a, each.b)};
    found.p = chance_of(found.of_pairs);
    out.differing.push_back(std::move(found));
  }
  std::ranges::stable_sort(out.differing, {}, &difference::p);
  correct(out.differing);
  for (auto& each : out.differing) {
    each.is_sure = each.p <= 1 - confidence;
    out.sure += each.is_sure ? 1 : 0;
  }
  std::ranges::stable_sort(out.differing, is_more_important);
  return out;
}

} // namespace rubicon::study
