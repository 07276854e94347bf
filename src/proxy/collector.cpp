#include "proxy/collector.hpp"

#include "core/tuples/device_keys.hpp"

namespace rubicon::proxy {

namespace {

constexpr std::uint64_t watch_of_keys = 0;
constexpr std::uint64_t watch_listed = 1;

} // namespace

components::outputs collector::start(instant) {
  components::outputs out;
  for (const auto& key : keys_)
    out.emplace_back(components::watch{watch_of_keys, any_peer, key});
  if (every_ > duration{})
    out.emplace_back(
        components::watch{watch_listed, any_peer, std::string(all_device_statuses_key)});
  return out;
}

components::outputs collector::on_tuple(const components::news& x, instant) {
  if (x.watch == watch_listed)
    return x.deleted ? components::outputs{} : ask_for_period(x);
  ++updates_;
  const auto name = to_string(x.owner) + ':' + std::string(x.key);
  if (x.deleted)
    collected_.erase(name);
  else if (collected_.size() < collected_max)
    collected_.insert(name);
  return {};
}

/// A gateway that was started again knows of no periods, but says anew who is listed.
components::outputs collector::ask_for_period(const components::news& x) const {
  components::outputs out;
  const auto status = parse_device_status(x.text);
  const auto about = parse_device_key(x.key);
  if (!status || !about || status->presence != device_presence::listed)
    return out;
  const auto period = std::chrono::duration_cast<std::chrono::milliseconds>(every_);
  for (const auto& key : keys_) {
    const auto pattern = parse_output_pattern(key);
    if (pattern && pattern->channel && pattern->mote.value_or(about->mote) == about->mote)
      out.emplace_back(components::write{x.owner,
                                         device_output_period_key(about->mote, *pattern->channel),
                                         std::to_string(period.count())});
  }
  return out;
}

components::figures collector::figures() const {
  return {{"updates", static_cast<double>(updates_)},
          {"tuples", static_cast<double>(collected_.size())}};
}

} // namespace rubicon::proxy
