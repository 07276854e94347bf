#include "actors/island/program.hpp"

#include <utility>

#include "actors/base/statuses.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/programs.hpp"

namespace rubicon {

namespace {

using program_pointer = scheduler::actor_pointer<program_state, program_actor>;

instant own_time(program_pointer self) {
  return self->state.arguments->crystal.own(now(self));
}

void perform(program_pointer self, std::optional<communication::remote::commands_batch> commands) {
  auto& state = self->state;
  const auto& arguments = *state.arguments;
  if (commands)
    self->send(state.mote, program_commands{static_cast<std::uint32_t>(arguments.number),
                                            *std::move(commands)});
  state.programs.send_notices(self, arguments.ecology);
  if (const auto due = state.programs.deadline())
    state.wake.follow(self, arguments.crystal.real(*due));
}

/// Whether the program runs: between program_attached and the end of its mote.
bool runs(program_pointer self) {
  return self->state.process != nullptr && !self->state.is_over;
}

/// @param ended its life is
void send_status(program_pointer self, bool ended) {
  const auto& arguments = *self->state.arguments;
  self->state.programs.report(self, arguments.ecology, arguments.mote, own_time(self), ended);
  report::cause_counts modules;
  if (self->state.process != nullptr)
    report::add_counters<communication::remote_counters>(modules, "programs",
                                                         self->state.process->counters());
  send_modules(self, arguments.ecology, arguments.mote, std::move(modules));
}

/// What this life has counted must not go with it.
void forget(program_pointer self) {
  auto& state = self->state;
  if (state.process != nullptr)
    send_status(self, true);
  state.programs = {};
  state.process = nullptr;
  state.is_over = false;
  state.wake.stop();
}

void on_mote_started(program_pointer self, const mote_started& x) {
  forget(self);
  auto& state = self->state;
  state.mote = x.mote;
  self->monitor(state.mote);
  self->send(state.mote, attach_program{static_cast<std::uint32_t>(state.arguments->number),
                                        {handle_of<program_client_actor>(self)}});
}

void on_attached(program_pointer self, const program_attached& x) {
  auto& state = self->state;
  const auto& arguments = *state.arguments;
  auto life = "mote/" + arguments.mote + '#' + std::to_string(x.incarnation);
  if (state.incarnation > 0)
    life += '/' + std::to_string(state.incarnation);
  state.process = std::make_unique<communication::remote_process>(x.limits);
  state.process->begin(own_time(self));
  state.programs.start_one(*state.process, arguments.config, arguments.number, life, arguments.seed,
                           x.incarnation > 0 || state.incarnation > 0, own_time(self));
  perform(self, state.process->flush());
}

void on_events(program_pointer self, const program_events& x) {
  auto& process = *self->state.process;
  process.on_events(x.batch, own_time(self));
  perform(self, process.flush());
}

} // namespace

program_actor::behavior_type program_behavior(program_pointer self,
                                              std::shared_ptr<const program_arguments> arguments,
                                              std::uint32_t incarnation) {
  self->set_exception_handler([self](std::exception_ptr& x) {
    send_status(self, true);
    return scheduler::failure_of(x);
  });
  self->state.arguments = std::move(arguments);
  self->state.incarnation = incarnation;
  self->set_down_handler([self](const caf::down_msg& x) {
    if (!self->state.mote || x.source != self->state.mote.address())
      return;
    forget(self);
    self->state.mote = nullptr;
  });
  return {
      [self](const program_attached& x) { on_attached(self, x); },
      [self](program_detached) {
        self->state.is_over = true;
        self->state.wake.stop();
      },
      [self](const program_events& x) {
        if (runs(self))
          on_events(self, x);
      },
      [self](const mote_started& x) { on_mote_started(self, x); },
      [self](const timer_expired& x) {
        auto& state = self->state;
        if (state.wake.accepts(x) && runs(self))
          perform(self, state.programs.on_time(*state.process, own_time(self)));
      },
      [self](const status_request& x) {
        const auto& given = *self->state.arguments;
        if (x.sample > 0)
          self->send(given.ecology, self->state.programs.sample(x.sample, given.mote));
        else
          send_status(self, self->state.is_over);
      },
  };
}

} // namespace rubicon
