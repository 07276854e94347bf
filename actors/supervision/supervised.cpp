#include "actors/supervision/supervised.hpp"

#include <algorithm>
#include <utility>

#include "actors/base/log.hpp"
#include "actors/island/mote.hpp"
#include "report/event_log.hpp"

namespace rubicon {

void note_event(ecology_pointer self, const std::string& who, std::string what) {
  auto& report = self->state.report;
  log(self, spdlog::level::info, "event=noted who={} what=\"{}\"", who, what);
  self->remark("event", 0, [&] { return to_bytes(who + '\t' + what); });
  report::logged_event event{now(self), who.substr(who.find('/') + 1), std::move(what)};
  if (self->state.process.on_event)
    self->state.process.on_event(event);
  if (self->state.process.judge != nullptr)
    self->state.process.judge->on_event(event);
  report::add_event(report.event_log, report.event_log_left_out, std::move(event));
}

supervised_mote& mote_now(ecology_pointer self, mote_address x) {
  const auto& all = self->state.moved;
  for (auto moved = all.find(x); moved != all.end(); moved = all.find(x))
    x = moved->second.to;
  return self->state.motes.at(x);
}

void add_violation(ecology_pointer self, const char* invariant, std::string detail) {
  auto& state = self->state;
  report::violation x{now(self), invariant, std::move(detail)};
  constexpr std::size_t violations_max = 1000;
  if (state.delivered && state.process.on_late_violation)
    state.process.on_late_violation(std::move(x));
  else if (state.report.violations.size() < violations_max)
    state.report.violations.push_back(std::move(x));
}

void record_failure(ecology_pointer self, const std::string& path, const std::string& text) {
  log(self, spdlog::level::err, "event=failed actor={} reason=\"{}\"", path, text);
  add_violation(self, report::no_actor_fails, path + ": " + text);
  auto& failures = self->state.report.actors.failures;
  constexpr std::size_t failures_max = 100;
  if (failures.size() < failures_max)
    failures.push_back(path + ": " + text);
}

std::string event_source(const supervised_sink& x) {
  return x.path + "/sink";
}

report::island_report& island_of(ecology_pointer self, island_id id) {
  return *std::ranges::find(self->state.report.islands, id, &report::island_report::id);
}

bool has_several_gateways(ecology_pointer self, island_id id) {
  return !std::ranges::find(self->state.description.islands, id, &config::island_description::id)
              ->aliases.empty();
}

void on_flat(ecology_pointer self, supervised_mote& mote) {
  mote.flat = true;
  mote.changed = now(self);
  if (self->state.process.on_flat)
    self->state.process.on_flat(mote.arguments->name);
}

} // namespace rubicon
