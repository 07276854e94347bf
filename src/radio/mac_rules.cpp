#include "radio/mac_rules.hpp"

#include <algorithm>
#include <cassert>

namespace rubicon::radio {

namespace {

constexpr backoff_window standard_window(unsigned exponent) {
  return {.first = 0s, .step = timing::unit_backoff, .count = 1U << exponent};
}

using windows = std::array<backoff_window, windows_max>;

/// The exponent grows by one after each busy assessment (IEEE 802.15.4-2006 7.5.1.4).
constexpr windows standard_windows(unsigned min, unsigned max) {
  windows all{};
  for (unsigned busy = 0; busy < windows_max; ++busy)
    all[busy] = standard_window(std::min(min + busy, max));
  return all;
}

/// TinyOS's: one window at first, and another one from then on.
constexpr windows initial_and_congestion(backoff_window initial, backoff_window congestion) {
  windows all{};
  all.fill(congestion);
  all.front() = initial;
  return all;
}

// IEEE 802.15.4-2006 7.5.1.4, unslotted.
constexpr mac_rules standard{
    .name = "standard",
    .backoffs = standard_windows(timing::be_min, timing::be_max),
    .assessments_max = timing::backoffs_max + 1,
    .rounds_max = 1,
    .assessment = timing::cca,
    .second_look = 0s,
    .turnaround = timing::turnaround,
    .ack_delay = timing::turnaround,
    .ack_wait = timing::ack_wait,
    .guard = 0s,
    .spaces = true,
    .dsn_from_address = false,
    .weak_source_key = false,
    .sources_max = 0,
    .retries_max = timing::retries_max,
};

// docs/tinyos.md 5.1, 4.2. The chip's assessment is that of the 128 us before the sample. Acks are
// made in software, about a millisecond after the frame [estimate there].
constexpr mac_rules cc2420(duration tick) {
  return {
      .name = "cc2420",
      .backoffs = initial_and_congestion({.first = 11 * tick, .step = tick, .count = 310},
                                         {.first = 11 * tick, .step = tick, .count = 70}),
      .assessments_max = 0,
      .rounds_max = 1,
      .assessment = 0s,
      .second_look = 7 * tick,
      .turnaround = timing::turnaround,
      .ack_delay = 1ms,
      .ack_wait = 256 * tick,
      .guard = 0s,
      .spaces = false,
      .dsn_from_address = false,
      .weak_source_key = true,
      .sources_max = 4,
      .retries_max = 0,
  };
}

constexpr mac_rules cc2420_micaz = cc2420(34722ns); // 28 800 Hz, docs/tinyos.md 5.1
constexpr mac_rules cc2420_32khz = cc2420(30518ns); // 32 768 Hz

// docs/tinyos.md 5.2, 4.2. Turnaround and the delay of the software ack are estimates: the
// standard's, and what leaves the 352 us of an ack well within the sender's 1000 us.
constexpr mac_rules rf230{
    .name = "rf230",
    .backoffs = initial_and_congestion({.first = 320us, .step = 1us, .count = 4960},
                                       {.first = 320us, .step = 1us, .count = 2240}),
    .assessments_max = 2,
    .rounds_max = 5,
    .assessment = 0s,
    .second_look = 0s,
    .turnaround = timing::turnaround,
    .ack_delay = 300us,
    .ack_wait = 1ms,
    .guard = 864us,
    .spaces = false,
    .dsn_from_address = true,
    .weak_source_key = false,
    .sources_max = 5,
    .retries_max = 0,
};

constexpr duration for_ever = 24h * 36500;

} // namespace

duration mac_rules::repeats_for(unsigned retries) const {
  if (assessments_max == 0)
    return for_ever;
  duration round{};
  for (unsigned busy = 0; busy < assessments_max; ++busy)
    round += backoffs[std::min<std::size_t>(busy, backoffs.size() - 1)].longest() + assessment;
  const auto attempt =
      round * static_cast<duration::rep>(rounds_max) + turnaround + air_time(psdu_max) + ack_wait;
  return attempt * (static_cast<duration::rep>(retries) + 1);
}

duration mac_rules::longest_gap() const {
  const auto quiet = std::max(ack_wait, spaces ? timing::lifs : duration{});
  return quiet + copy_backoff.longest() + assessment + second_look + turnaround;
}

bool has_exponents(const mac_rules& rules) {
  return rules.name == standard.name;
}

mac_rules adjusted(const mac_rules& rules, const access_parameters& own) {
  auto out = rules;
  out.retries_max = own.retries_max.value_or(rules.retries_max);
  if (!has_exponents(rules))
    return out;
  const auto min = own.min_be.value_or(timing::be_min);
  const auto max = own.max_be.value_or(timing::be_max);
  assert(min <= max);
  out.backoffs = standard_windows(min, max);
  out.assessments_max = own.backoffs_max.value_or(timing::backoffs_max) + 1;
  assert(out.assessments_max <= windows_max);
  return out;
}

const mac_rules* find_mac(std::string_view name, const platform& kind) {
  if (name == standard.name)
    return &standard;
  if (name == rf230.name)
    return &rf230;
  if (name == cc2420_32khz.name)
    return kind.name == "micaz" ? &cc2420_micaz : &cc2420_32khz;
  return nullptr;
}

const mac_rules* mac_of(const channel_config& config, const platform& kind) {
  const auto named =
      std::ranges::find(config.macs, kind.name, &std::pair<std::string, std::string>::first);
  return find_mac(named == config.macs.end() ? standard.name : named->second, kind);
}

const std::vector<std::string>& mac_names() {
  static const std::vector<std::string> names{
      std::string(standard.name), std::string(cc2420_32khz.name), std::string(rf230.name)};
  return names;
}

} // namespace rubicon::radio
