#include "actors/supervision/changes.hpp"

#include <algorithm>
#include <any>
#include <memory>
#include <utility>

#include "actors/base/debug_log.hpp"
#include "actors/base/log.hpp"
#include "actors/island/mote.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/services.hpp"
#include "actors/supervision/supervised.hpp"
#include "config/plan/debug_selection.hpp"
#include "config/run/change_text.hpp"
#include "report/figures.hpp"

namespace rubicon {

namespace {

/// A change that is asked for and cannot be had. Of what anybody can ask for the log tells the
/// first, the report all.
void refuse(ecology_pointer self, const std::string& who, const std::string& why) {
  constexpr std::uint64_t logged_max = 100;
  if (++self->state.report.actors.changes_refused <= logged_max)
    log(self, spdlog::level::warn, "event=change_refused who={} why=\"{}\"", who, why);
  note_event(self, who, why);
}

std::shared_ptr<const mote_arguments> with_settings(mote_arguments of,
                                                    const config::program_change& x) {
  config::apply(of.apps.edit(), x);
  return std::make_shared<const mote_arguments>(std::move(of));
}

std::shared_ptr<const mote_arguments> with_keys(mote_arguments of,
                                                const config::network_keys_change& x) {
  auto groups = *of.smepp;
  groups.settings.network_key = x.network_key;
  if (x.network_mac)
    groups.settings.network_mac = x.network_mac;
  of.smepp = std::make_shared<const smepp::node_config>(std::move(groups));
  return std::make_shared<const mote_arguments>(std::move(of));
}

/// `kitchen/stove`, `kitchen/sink`
std::string radio_name(ecology_pointer self, const mote_address& x) {
  const auto mote = self->state.motes.find(x);
  if (mote != self->state.motes.end())
    return mote->second.arguments->name;
  const auto& islands = self->state.description.islands;
  return std::ranges::find(islands, x.island, &config::island_description::id)->name + "/sink";
}

} // namespace

/// The writer of the debug log is notified by a remark: that is no part of the run.
void select_debug(ecology_pointer self, const std::string& who, std::vector<std::string> patterns) {
  const auto& state = self->state;
  config::debug_names names(state.description);
  for (const auto& [address, mote] : state.motes)
    names.add_mote(mote.arguments->name);
  const auto why = names.problem(patterns);
  const bool is_whole = !state.description.part; // else others know more names
  if (is_whole && !why.empty()) {
    refuse(self, who, "debug log stays as it is: " + why);
    return;
  }
  const config::debug_selection selected(std::move(patterns));
  self->remark_any(debug_log::selected, [&] { return std::any(selected); });
  note_event(self, who,
             "debug log of " + selected.text() +
                 (state.process.writes_debug_log ? "" : ", but --debug-dir does not say where"));
}

void change_applier::operator()(const config::debug_change& x) const {
  select_debug(self, self->path(), x.of);
}

/// The mote's next lives have the settings too, here and where it is carried to.
void change_applier::operator()(const config::program_change& x) const {
  auto& mote = mote_now(self, x.mote);
  const auto program = config::program_text(x);
  const auto path = "mote/" + mote.arguments->name;
  const auto before = config::settings_before(mote.arguments->apps, x);
  if (!before) {
    refuse(self, path, "has no " + program + " now, which could change");
    return;
  }
  mote.arguments = with_settings(*mote.arguments, x);
  const auto& faults = self->state.description.faults;
  for (auto& [fault, next] : self->state.successors) {
    const auto* move = std::get_if<config::move_island_fault>(&faults.at(fault).what);
    if (move != nullptr && move->mote == x.mote)
      next = with_settings(*next, x);
  }
  if (mote.handle)
    self->send(mote.handle, change_program{x.messenger.has_value(),
                                           x.messenger ? *x.messenger : *x.sampler, x.settings});
  std::string text;
  for (std::size_t i = 0; i < x.settings.size(); ++i)
    text += (i == 0 ? ": " : ", ") + keys::to_text(x.settings[i]) + " instead of " +
            keys::to_text((*before)[i].value);
  note_event(self, path, program + text);
}

void change_applier::operator()(const config::link_change& x) const {
  const auto air = self->state.airs.find(x.from.island);
  if (air == self->state.airs.end())
    return; // real: nothing of it is simulated
  self->send(air->second, change_link{x.from, x.to, x.loss, x.gain_db});
  note_event(self, "mote/" + radio_name(self, x.from),
             "link to " + radio_name(self, x.to) + ": " + config::link_text(x));
}

/// Managers that start later read the description.
void change_applier::operator()(const proxy::class_change& x) const {
  for (auto& each : self->state.description.proxies)
    if (each.name == x.class_name)
      proxy::apply(x, each);
  for (const auto& [name, peer] : self->state.peers)
    for (const auto& manager : peer.managers)
      self->send(manager, change_class{x});
  note_event(self, self->path(), "proxy class " + x.class_name + ": " + proxy::to_text(x));
}

/// A mote that is off now has them when it starts.
void change_applier::operator()(const config::network_keys_change& x) const {
  const auto gets = [&x](const mote_arguments& mote) {
    return mote.smepp &&
           (x.motes.empty() || std::ranges::find(x.motes, mote.address) != x.motes.end());
  };
  std::size_t count = 0;
  for (auto& [address, mote] : self->state.motes) {
    if (!gets(*mote.arguments))
      continue;
    ++count;
    mote.arguments = with_keys(*mote.arguments, x);
    const auto& settings = mote.arguments->smepp->settings;
    if (mote.handle)
      self->send(mote.handle, set_network_keys{std::make_shared<const smepp::key_pair>(
                                  smepp::key_pair{*settings.network_key, *settings.network_mac})});
  }
  for (auto& [fault, next] : self->state.successors)
    if (gets(*next))
      next = with_keys(*next, x);
  note_event(self, self->path(), "network keys changed on " + report::counted(count, "mote"));
}

} // namespace rubicon
