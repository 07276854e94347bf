#include "config/run/change_text.hpp"

#include "config/summary_parts.hpp"
#include "config/toml/document.hpp"

namespace rubicon::config {

namespace {

/// The period of the app, if it is the one; else nullptr.
template <class App>
auto* period_in(App& app, const rate_change& x) {
  using period = decltype(&std::get_if<sampler_app>(&app)->every);
  if (auto* sampler = std::get_if<sampler_app>(&app); sampler != nullptr && x.sampler)
    return sampler->channel == *x.sampler ? &sampler->every : period(nullptr);
  if (auto* messenger = std::get_if<messenger_app>(&app); messenger != nullptr && x.messenger)
    return messenger->am_type == *x.messenger ? &messenger->every : period(nullptr);
  return period(nullptr);
}

} // namespace

std::string program_text(const rate_change& x) {
  return x.messenger ? "messenger " + std::to_string(*x.messenger)
                     : "sampler " + std::to_string(x.sampler.value_or(0));
}

std::string link_text(const link_change& x) {
  const auto loss = x.loss ? "loss " + percent(*x.loss) : std::string();
  return x.gain_db ? loss + (loss.empty() ? "" : ", ") + "gain " + shown(*x.gain_db) + " dB" : loss;
}

std::optional<duration> period_of(const std::vector<mote_app>& apps, const rate_change& x) {
  for (const auto& each : apps)
    if (const auto* period = period_in(each, x))
      return *period;
  return std::nullopt;
}

void set_period(std::vector<mote_app>& apps, const rate_change& x) {
  for (auto& each : apps)
    if (auto* period = period_in(each, x))
      *period = x.period;
}

} // namespace rubicon::config
