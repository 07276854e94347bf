#include "config/run/change_text.hpp"

#include "apps/app_keys.hpp"
#include "config/summary_parts.hpp"
#include "config/toml/document.hpp"

namespace rubicon::config {

namespace {

/// Calls use(app) with the sampler or messenger that the change is about, if it is among them.
template <class Apps, class Use>
void with_program(Apps& apps, const program_change& x, Use use) {
  for (auto& each : apps) {
    if (auto* sampler = std::get_if<sampler_app>(&each);
        sampler != nullptr && x.sampler == sampler->channel)
      use(*sampler);
    if (auto* messenger = std::get_if<messenger_app>(&each);
        messenger != nullptr && x.messenger == messenger->am_type)
      use(*messenger);
  }
}

} // namespace

std::string program_text(const program_change& x) {
  return x.messenger ? "messenger " + std::to_string(*x.messenger)
                     : "sampler " + std::to_string(x.sampler.value_or(0));
}

std::string settings_text(const program_change& x) {
  std::string out;
  for (const auto& each : x.settings)
    out += (out.empty() ? "" : ", ") + keys::to_text(each);
  return out;
}

std::string link_text(const link_change& x) {
  const auto loss = x.loss ? "loss " + percent(*x.loss) : std::string();
  return x.gain_db ? loss + (loss.empty() ? "" : ", ") + "gain " + shown(*x.gain_db) + " dB" : loss;
}

std::optional<keys::key_changes> settings_before(const std::vector<mote_app>& apps,
                                                 const program_change& x) {
  std::optional<keys::key_changes> out;
  with_program(apps, x,
               [&](const auto& program) { out = keys::values_before(x.settings, program); });
  return out;
}

void apply(std::vector<mote_app>& apps, const program_change& x) {
  with_program(apps, x, [&x](auto& program) { keys::apply(x.settings, program); });
}

} // namespace rubicon::config
