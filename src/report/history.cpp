#include "report/history.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace rubicon::report {

namespace {

/// Every second one goes, the first stays.
template <class T>
void halve(std::vector<T>& x) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < x.size(); i += 2)
    x[kept++] = std::move(x[i]);
  x.resize(kept);
}

} // namespace

void thinned_series::add(instant at, double value) {
  least_ = count_ == 0 ? value : std::min(least_, value);
  most_ = count_ == 0 ? value : std::max(most_, value);
  newest_.reset();
  if (count_++ % stride_ != 0) {
    newest_ = point{at, value};
    return;
  }
  points_.push_back({at, value});
  if (points_.size() < points_max)
    return;
  newest_ = points_.back();
  halve(points_);
  stride_ *= 2;
}

std::vector<thinned_series::point> thinned_series::points() const {
  auto all = points_;
  if (newest_)
    all.push_back(*newest_);
  return all;
}

void history::add(const run_sample& x) {
  newest_ = x;
  if (samples_++ % stride_ != 0)
    return;
  times_.push_back(x.at);
  for (const auto& mote : x.motes) {
    auto& all = used_mah_[mote.address];
    all.resize(times_.size(), all.empty() ? 0.0F : all.back());
    all.back() = static_cast<float>(mote.used_mah);
  }
  for (auto& [mote, all] : used_mah_) // those that are gone
    all.resize(times_.size(), all.empty() ? 0.0F : all.back());
  const auto add_losses = [this](const std::string& layer, const cause_counts& causes) {
    for (const auto& [cause, count] : causes) {
      auto& all = lost_[{layer, cause}];
      all.resize(times_.size());
      all.back() += static_cast<double>(count);
    }
  };
  for (const auto& island : x.islands)
    for (const auto& [layer, causes] : island.lost)
      add_losses(layer, causes);
  add_losses("peis", x.peis_lost);
  if (times_.size() < samples_max)
    return;
  halve(times_);
  for (auto& [what, all] : lost_)
    halve(all);
  for (auto& [mote, all] : used_mah_)
    halve(all);
  stride_ *= 2;
}

void history::add(const tuple_write& x) {
  const auto number = x.deleted ? std::nullopt : number_of(x.value);
  if (!number)
    return;
  const tuple_key key(x.owner, x.key);
  const auto found = tuples_.find(key);
  if (found != tuples_.end())
    found->second.add(x.at, *number);
  else if (tuples_.size() < tuples_max)
    tuples_[key].add(x.at, *number);
}

std::optional<double> number_of(std::string_view value) {
  if (value == "on" || value == "off")
    return value == "on" ? 1 : 0;
  double x = 0;
  const auto* const end = value.data() + value.size();
  const auto [stop, error] = std::from_chars(value.data(), end, x);
  const bool ends_well = stop == end || *stop == ' ';
  return error == std::errc{} && ends_well && std::isfinite(x) ? std::optional(x) : std::nullopt;
}

} // namespace rubicon::report
