#include "actors/apps/mote_apps.hpp"

#include <algorithm>

#include "actors/log.hpp"
#include "core/codec.hpp"
#include "scheduler/spawn.hpp"
#include "scheduler/supervision.hpp"

namespace rubicon {

namespace {

template <class Self>
carried<mote_app_actor> handle_of(Self* self) {
  return {caf::actor_cast<mote_app_actor>(self)};
}

/// Where readings and states go: the PC of the own island, which is its gateway (RTG-03).
constexpr mote_address gateway_address{own_island, no_mote};

template <class Self>
void claim(Self* self, std::uint8_t am_type) {
  self->send(self->state.mote, claim_am_type{handle_of(self), am_type});
}

using sampler_pointer = scheduler::traced_pointer<sampler_state, mote_app_actor>;

/// Nothing: it is not to send.
std::optional<duration> period_of(const sampler_state& x) {
  const bool asked = x.wanted && x.wanted->period.count() > 0;
  if (!x.in_island || (x.config.only_subscribed && !x.wanted))
    return std::nullopt;
  return asked ? std::max<duration>(x.wanted->period, x.config.every_min) : x.config.every;
}

void begin_periods(sampler_pointer self) {
  auto& state = self->state;
  state.every = period_of(state);
  state.period.stop();
  if (!state.every)
    return;
  state.next_period = now(self) + state.dice.between(0s, *state.every);
  state.period.follow(self, state.next_period);
}

void on_wanted(sampler_pointer self, const outputs_wanted& x) {
  auto& state = self->state;
  state.wanted = mote::wanted_on(x.all, state.config.channel);
  if (period_of(state) != state.every)
    begin_periods(self);
}

void on_period(sampler_pointer self) {
  auto& state = self->state;
  self->send(state.mote, read_transducers{handle_of(self), state.config.transducers});
  state.next_period += *state.every;
  state.period.follow(self, state.next_period + state.dice.between(0s, state.config.jitter));
}

void on_counts(sampler_pointer self, const transducers_read& x) {
  byte_writer out;
  auto& state = self->state;
  for (std::size_t i = 0; i < x.counts.size(); ++i)
    out.big(i < state.means.size() ? static_cast<std::int16_t>(state.means[i].add(x.counts[i]))
                                   : x.counts[i]);
  if (state.config.stamped)
    out.big(x.time_ms);
  self->send(state.mote, send_message{handle_of(self), ++state.sent, gateway_address,
                                      static_cast<std::uint8_t>(state.config.channel),
                                      payload(out.finish()), state.config.reliable});
}

using actuator_pointer = scheduler::traced_pointer<actuator_app_state, mote_app_actor>;

void tell_state(actuator_pointer self) {
  auto& state = self->state;
  self->send(state.mote, send_message{handle_of(self), 0, gateway_address,
                                      static_cast<std::uint8_t>(state.config.channel),
                                      payload(bytes{state.current}), true});
}

using messenger_pointer = scheduler::traced_pointer<messenger_state, mote_app_actor>;

void on_period(messenger_pointer self) {
  auto& state = self->state;
  self->send(state.mote,
             send_message{handle_of(self), ++state.number, state.config.to, state.config.am_type,
                          payload(to_bytes(std::string_view(state.config.text))),
                          state.config.reliable});
  state.next_message += state.config.every;
  state.period.follow(self, state.next_message);
}

using listener_pointer = scheduler::traced_pointer<listener_state, mote_app_actor>;

void on_message(listener_pointer self, const message_received& x) {
  const auto text = to_string(x.octets.view());
  log(self, spdlog::level::debug, "event=received from={} length={}", to_string(x.source),
      x.octets.size());
  if (++self->state.received == 1)
    self->send(self->state.ecology,
               story{self->path(), "heard \"" + text + "\" from mote " + to_string(x.source)});
}

} // namespace

mote_app_actor::behavior_type sampler(sampler_pointer self, config::sampler_app config,
                                      mote_actor mote, std::uint64_t seed) {
  scheduler::tell_monitors_of_exceptions(self);
  self->state.config = std::move(config);
  for (const auto size : self->state.config.mean_of)
    self->state.means.emplace_back(size);
  self->state.mote = std::move(mote);
  self->state.dice = random_stream(seed, self->path());
  return {
      [self](const membership_changed& x) {
        self->state.in_island = x.joined;
        begin_periods(self);
      },
      [](const message_received&) {},
      [self](const send_ended& x) {
        if (x.refused || (self->state.config.reliable && !x.acked))
          ++self->state.unsent;
      },
      [self](const transducers_read& x) { on_counts(self, x); },
      [](const actuator_changed&) {},
      [self](const outputs_wanted& x) { on_wanted(self, x); },
      [self](const timer_expired& x) {
        if (self->state.period.accepts(x))
          on_period(self);
      },
  };
}

mote_app_actor::behavior_type actuator(actuator_pointer self, config::actuator_app config,
                                       mote_actor mote, std::uint8_t initial) {
  scheduler::tell_monitors_of_exceptions(self);
  self->state.config = std::move(config);
  self->state.mote = std::move(mote);
  self->state.current = initial;
  claim(self, static_cast<std::uint8_t>(self->state.config.channel));
  return {
      [self](const membership_changed& x) {
        if (x.joined)
          tell_state(self);
      },
      [self](const message_received& x) {
        if (!x.octets.empty())
          self->send(self->state.mote, set_actuator{handle_of(self), self->state.config.actuator,
                                                    x.octets.view()[0]});
      },
      [](const send_ended&) {},
      [](const transducers_read&) {},
      [self](const actuator_changed& x) {
        self->state.current = x.state;
        tell_state(self);
      },
      [](const outputs_wanted&) {},
      [](const timer_expired&) {},
  };
}

mote_app_actor::behavior_type messenger(messenger_pointer self, config::messenger_app config,
                                        mote_actor mote) {
  scheduler::tell_monitors_of_exceptions(self);
  self->state.config = std::move(config);
  self->state.mote = std::move(mote);
  return {
      [self](const membership_changed& x) {
        auto& state = self->state;
        state.period.stop();
        if (!x.joined)
          return;
        state.next_message = now(self) + state.config.every;
        state.period.follow(self, state.next_message);
      },
      [](const message_received&) {},
      [self](const send_ended& x) {
        if (x.refused || (self->state.config.reliable && !x.acked))
          log(self, spdlog::level::warn, "event=undelivered number={} refused={}", x.token,
              x.refused);
      },
      [](const transducers_read&) {},
      [](const actuator_changed&) {},
      [](const outputs_wanted&) {},
      [self](const timer_expired& x) {
        if (self->state.period.accepts(x))
          on_period(self);
      },
  };
}

mote_app_actor::behavior_type listener(listener_pointer self, config::listener_app config,
                                       mote_actor mote, ecology_actor ecology) {
  scheduler::tell_monitors_of_exceptions(self);
  self->state.config = config;
  self->state.mote = std::move(mote);
  self->state.ecology = std::move(ecology);
  claim(self, config.am_type);
  return {
      [](const membership_changed&) {}, [self](const message_received& x) { on_message(self, x); },
      [](const send_ended&) {},         [](const transducers_read&) {},
      [](const actuator_changed&) {},   [](const outputs_wanted&) {},
      [](const timer_expired&) {},
  };
}

namespace {

/// Spawns one app of a mote, whichever kind it is.
struct spawner {
  scheduler::traced_pointer<mote_state, mote_actor> mote;
  std::string path;

  mote_app_actor operator()(const config::sampler_app& x) const {
    return scheduler::spawn_at<caf::linked>(mote, path + "/sampler-" + std::to_string(x.channel),
                                            sampler, x, handle(), mote->state.arguments->seed);
  }

  mote_app_actor operator()(const config::actuator_app& x) const {
    const auto initial = mote->state.node->actuator_state(x.actuator, {}).value_or(0);
    return scheduler::spawn_at<caf::linked>(mote, path + "/actuator-" + x.actuator, actuator, x,
                                            handle(), initial);
  }

  mote_app_actor operator()(const config::messenger_app& x) const {
    return scheduler::spawn_at<caf::linked>(mote, path + "/messenger-" + std::to_string(x.am_type),
                                            messenger, x, handle());
  }

  mote_app_actor operator()(const config::listener_app& x) const {
    return scheduler::spawn_at<caf::linked>(mote, path + "/listener-" + std::to_string(x.am_type),
                                            listener, x, handle(), mote->state.arguments->ecology);
  }

  // Programs that use the Mockup interface are in the mote itself, or are no children of it.
  mote_app_actor operator()(const apps::app_config&) const { return {}; }
  mote_app_actor operator()(const config::separate_app&) const { return {}; }

  // Flows run in the mote itself: there is no layer between them and the radio.
  mote_app_actor operator()(const flow::sender_config&) const { return {}; }
  mote_app_actor operator()(const flow::relay_config&) const { return {}; }
  mote_app_actor operator()(const flow::receiver_config&) const { return {}; }

  [[nodiscard]] mote_actor handle() const { return caf::actor_cast<mote_actor>(mote); }
};

} // namespace

std::vector<mote_app_actor>
spawn_mote_apps(scheduler::traced_pointer<mote_state, mote_actor> mote) {
  std::vector<mote_app_actor> apps;
  const auto& arguments = *mote->state.arguments;
  for (const auto& app : arguments.apps)
    if (auto actor = std::visit(spawner{mote, "mote_app/" + arguments.name}, app))
      apps.push_back(std::move(actor));
  return apps;
}

} // namespace rubicon
