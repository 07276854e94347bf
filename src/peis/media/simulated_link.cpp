#include "peis/media/simulated_link.hpp"

#include <algorithm>
#include <utility>

#include "peis/link/link.hpp"
#include "peis/wire/package_walk.hpp"

namespace rubicon::peis {

namespace {

duration sending_time(std::uint64_t rate_bps, std::size_t octets) {
  if (rate_bps == 0)
    return 0s;
  return duration(
      static_cast<std::int64_t>(8e9 * static_cast<double>(octets) / static_cast<double>(rate_bps)));
}

} // namespace

simulated_link::outputs simulated_link::send(payload octets, instant now, random_stream& rng) {
  outputs out;
  free_at_ = std::max(free_at_, now) + sending_time(rate_bps_, octets.size());
  out.emplace_back(octets_leave{free_at_, octets.size()});
  const auto request = std::exchange(request_is_next_, false) ? connect_request_size : 0;
  if (condition_.cut) {
    out.emplace_back(octets_cut{std::move(octets)});
    return out;
  }
  if (condition_.loss > 0) {
    auto rest =
        without_lost_packages(octets.view(), request, [&] { return rng.chance(condition_.loss); });
    if (rest.lost > 0)
      out.emplace_back(packages_lost{std::move(rest.lost_octets), rest.lost});
    octets = payload(std::move(rest.octets));
  }
  if (!octets.empty())
    out.emplace_back(octets_arrive{free_at_ + delay_, std::move(octets)});
  return out;
}

std::optional<instant> simulated_link::close(instant now) const {
  if (condition_.cut)
    return std::nullopt;
  return std::max(free_at_, now) + delay_;
}

} // namespace rubicon::peis
