#include "config/checks/listening_check.hpp"

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "config/checks/slot_check.hpp"
#include "config/checks/window_room.hpp"
#include "core/text/decimal.hpp"

namespace rubicon::config {

namespace {

/// From here on motes wait for each other longer than they send. The runs of docs/radio.md stay
/// below.
constexpr double share_max = 0.5;

/// Each mote forwards each round of the clock: once a minute, or more rarely.
double rounds_per_second(const radio::listening_config& x) {
  return 1 / std::max(60.0, network::round_lengths * seconds(x.train()));
}

/// Who sends more rarely says that it is there: mote/join/join_client.hpp.
double signs_per_second(const island_description& x) {
  return 1 / (seconds(silence_max(x)) / 5 * 1.5);
}

/// The gap between two copies, of the slowest medium access in the island.
duration longest_gap(const island_description& x, const radio::channel_config& radio) {
  duration longest{};
  each_medium_access(radio, x, [&longest](const auto& rules, const auto&) {
    longest = std::max(longest, rules.longest_gap());
  });
  return longest;
}

std::string rounded(double x) {
  return decimal_text(x, 2);
}

} // namespace

air_need air_need_of(const island_description& x, std::optional<double> range_m, duration tick) {
  const auto hops = hops_to_sink(x, range_m);
  air_need sum;
  for (std::size_t i = 0; i < x.motes.size(); ++i) {
    const auto sleeping = hops[i] - 1; // the sink's radio is always on
    const auto rate = std::max(messages_per_second(x.motes[i]), signs_per_second(x));
    sum.hops_per_second += rate * sleeping;
  }
  for (const auto& need : slot_needs(x, range_m, {}, {}))
    for (const auto& flow : need.flows) // those to the sink have a hop to a mote, perhaps
      sum.hops_per_second +=
          static_cast<double>(std::max<std::size_t>(flow.hops, 1)) / seconds(tick);
  if (x.stack == stack::full)
    sum.broadcasts_per_second =
        static_cast<double>(x.motes.size() + 1) * rounds_per_second(x.listening);
  sum.share = sum.hops_per_second * seconds(x.listening.interval) / 2 +
              sum.broadcasts_per_second * seconds(x.listening.train());
  return sum;
}

std::string warning_of_interval(const island_description& x, const radio::channel_config& radio,
                                duration tick) {
  const auto need = air_need_of(x, range_of(radio), tick);
  if (need.share <= share_max)
    return {};
  const auto least_ms = std::ceil(seconds(x.listening.interval) * 1000 * share_max / need.share);
  return "an interval of " + to_text(x.listening.interval) +
         " is too long for its motes: " + rounded(need.hops_per_second) +
         " hops of messages and vectors per second to motes whose radios sleep take half of it "
         "each, and " +
         rounded(need.broadcasts_per_second) + " broadcasts per second take a whole one: " +
         std::to_string(std::lround(need.share * 100)) + " % of the channel's time; with about " +
         std::to_string(std::lround(least_ms)) + " ms it is half";
}

void check_listening(const island_description& x, const radio::channel_config& radio, duration tick,
                     const mark& at, complaints& problems) {
  const auto gap = longest_gap(x, radio);
  if (x.listening.check <= gap)
    problems.add(at, "`check` must be longer than the gap between two copies of a frame, which is "
                     "up to " +
                         to_text(gap) + " by the medium access of its motes");
  if (x.listening.interval <= x.listening.awake)
    problems.warn(at, "motes stay awake for " + to_text(x.listening.awake) +
                          " after each frame, but check the channel every " +
                          to_text(x.listening.interval) + ": a shorter `awake` saves more");
  for (const auto& mote : x.motes)
    if (std::ranges::any_of(
            mote.apps, [](const auto& app) { return std::holds_alternative<member_app>(app); })) {
      problems.add(at, "mote `" + mote.name +
                           "` is a member of a group, which controls its radio: it cannot use "
                           "low-power listening");
      break;
    }
  if (const auto text = warning_of_interval(x, radio, tick); !text.empty())
    problems.warn(at, text);
}

} // namespace rubicon::config
