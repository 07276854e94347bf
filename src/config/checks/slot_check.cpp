#include "config/checks/slot_check.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "apps/traffic.hpp"
#include "config/checks/connectivity.hpp"
#include "network/clock/tick_plan.hpp"

namespace rubicon::config {

namespace {

constexpr std::size_t packet_max = synaptic::channels_config{}.packet_max;

/// Motes of an island and how many hops lie between them.
class island_hops {
public:
  island_hops(const island_description& island, std::optional<double> range_m) : range_m_(range_m) {
    places_.push_back(island.sink.place);
    for (const auto& mote : island.motes) {
      index_[mote.id] = places_.size();
      places_.push_back(mote.place);
    }
  }

  /// 1: unknown.
  std::size_t between(mote_id from, mote_id to) {
    const auto a = index_.find(from);
    const auto b = index_.find(to);
    if (!range_m_ || a == index_.end() || b == index_.end())
      return 1;
    if (from_ != from) {
      from_ = from;
      hops_ = hops_from(places_, a->second, *range_m_);
    }
    return std::max<std::size_t>(hops_[b->second], 1);
  }

private:
  std::optional<double> range_m_;
  std::vector<position> places_; ///< the sink's first: it may hand vectors on
  std::map<mote_id, std::size_t> index_;
  mote_id from_;
  std::vector<unsigned> hops_;
};

const std::vector<apps::synapse>* outs_of(const mote_app& app) {
  const auto* separate = std::get_if<separate_app>(&app);
  const auto* program =
      separate != nullptr ? &separate->program : std::get_if<apps::app_config>(&app);
  const auto* units = program != nullptr ? std::get_if<apps::reservoir_config>(program) : nullptr;
  return units != nullptr ? &units->to : nullptr;
}

std::string milliseconds(std::size_t units) {
  return std::to_string(static_cast<duration::rep>(units) * network::tick_plan::unit / 1ms) + " ms";
}

std::string text_of(const mote::vector_flow& x) {
  const auto packets = apps::vector_load(x.elements).packets;
  return std::to_string(x.elements) + " elements in " + std::to_string(packets) +
         (packets == 1 ? " packet" : " packets") +
         (x.hops == 0   ? " to the sink"
          : x.hops == 1 ? " over 1 hop"
                        : " over " + std::to_string(x.hops) + " hops");
}

} // namespace

network::access_times access_of(const radio::channel_config& radio,
                                const island_description& island) {
  network::access_times slowest{0ns, 0ns, 0ns};
  slowest.wake = island.listening.train();
  each_medium_access(radio, island, [&slowest](const auto& rules, const auto& own) {
    const auto x = mote::access_of(radio::adjusted(rules, own));
    slowest.back_off = std::max(slowest.back_off, x.back_off);
    slowest.exchange = std::max(slowest.exchange, x.exchange);
    slowest.space = std::max(slowest.space, x.space);
  });
  return slowest;
}

std::vector<slot_need> slot_needs(const island_description& island, std::optional<double> range_m,
                                  const network::access_times& access,
                                  const std::map<mote_id, mark>& programs_at) {
  std::vector<slot_need> found;
  island_hops hops(island, range_m);
  for (const auto& mote : island.motes) {
    slot_need need{mote.name, 0, {}, {}};
    for (const auto& app : mote.apps) {
      const auto* outs = outs_of(app);
      if (outs == nullptr)
        continue;
      for (const auto& to : *outs) {
        const bool is_own = to.other.island == island.id || to.other.island == own_island;
        if (is_own && to.other.mote == mote.id)
          continue; // never leaves the mote
        const bool is_near = is_own && to.other.mote != no_mote;
        need.flows.push_back({to.size, is_near ? hops.between(mote.id, to.other.mote) : 0});
      }
    }
    if (need.flows.empty())
      continue;
    need.units = units_of(need.flows, packet_max, access);
    if (const auto at = programs_at.find(mote.id); at != programs_at.end())
      need.at = at->second;
    found.push_back(std::move(need));
  }
  return found;
}

void check_slots(const std::vector<slot_need>& needs, duration tick, complaints& problems) {
  std::size_t sum = 0;
  for (const auto& x : needs)
    sum += x.units;
  const auto room = network::tick_plan(tick).units();
  if (sum <= room)
    return;
  const auto& most = *std::ranges::max_element(needs, {}, &slot_need::units);
  const auto& flow = *std::ranges::max_element(
      most.flows, {}, [](const auto& x) { return x.elements * std::max<std::size_t>(x.hops, 1); });
  problems.add(most.at,
               "synaptic vectors of " + std::to_string(needs.size()) +
                   (needs.size() == 1 ? " mote need " : " motes need ") + milliseconds(sum) +
                   " of slots at each tick, " + milliseconds(most.units) + " of them `" +
                   most.mote + "` (" + text_of(flow) +
                   (most.flows.size() > 1
                        ? ", and " + std::to_string(most.flows.size() - 1) + " more vectors"
                        : "") +
                   "), but a tick of " + std::to_string(tick / 1ms) + " ms has " +
                   milliseconds(room) + " for them");
}

} // namespace rubicon::config
