#include "actors/hosts/plain_host.hpp"

#include <algorithm>
#include <string>
#include <variant>

#include "report/report.hpp"

namespace rubicon {

namespace {

constexpr std::uint16_t failed_reading = 0xffff; // as Oscilloscope has it

} // namespace

plain_host::plain_host(plain_host_config config,
                       const std::vector<tinyos::program_config>& programs, random_stream rng,
                       instant now)
    : config_(std::move(config)), rng_(rng) {
  for (const auto& x : programs)
    programs_.push_back(
        {x, tinyos::program(x, config_.self, own(now) + rng_.between(0s, x.every))});
}

bool plain_host::on_done(const radio_done& x) {
  if (x.token >> 61U != 1)
    return false;
  const auto which = static_cast<std::size_t>(x.token & ~plain_token);
  if (!is_stopped_ && which < programs_.size())
    programs_[which].runs.on_sent(x.status == radio::send_status::sent);
  return true;
}

std::uint16_t plain_host::read(const std::optional<device::quantity>& kind, instant now) {
  const auto found = std::ranges::find_if(
      config_.transducers, [&kind](const auto& x) { return kind && x.kind == *kind; });
  if (found == config_.transducers.end())
    return failed_reading;
  return static_cast<std::uint16_t>(
      device::sample(*found, now, rng_, {config_.place, config_.transducer_seed}));
}

report::cause_counts plain_host::counted() const {
  report::cause_counts all;
  for (const auto& each : programs_)
    report::add_counters<tinyos::program_counters>(
        all, std::string(tinyos::to_string(each.config.kind)), each.runs.counters());
  return all;
}

std::vector<tinyos::program_config>
plain_programs_among(const std::vector<config::mote_app>& apps) {
  std::vector<tinyos::program_config> found;
  for (const auto& app : apps)
    if (const auto* x = std::get_if<tinyos::program_config>(&app))
      found.push_back(*x);
  return found;
}

} // namespace rubicon
