#include "actors/services/proxy.hpp"

#include "actors/base/log.hpp"
#include "actors/base/statuses.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "peis/tuples/meta_tuple.hpp"

namespace rubicon {

namespace {

using proxy_pointer = scheduler::actor_pointer<proxy_actor_state, proxy_actor>;

struct proxy_performer {
  proxy_pointer self;

  void operator()(const proxy::publish& x) const {
    self->send(self->state.arguments.peer, set_tuple{x.key, payload(to_bytes(x.text)), true});
  }

  void operator()(const proxy::declare& x) const {
    const auto target = peis::key::parse(x.target);
    if (target) // otherwise nothing is published under it
      self->send(self->state.arguments.peer,
                 declare_meta_tuple{x.key, peis::format_meta(peis::meta_target{
                                               self->state.arguments.peer_number, *target})});
  }

  void operator()(proxy::write_device& x) const {
    self->state.written_to = self->state.arguments.gateway;
    self->send(self->state.arguments.peer,
               set_remote_tuple{{handle_of<peis_client_actor>(self)},
                                0,
                                self->state.arguments.gateway,
                                device_input_key(x.mote.mote, x.channel),
                                payload(std::move(x.octets)),
                                false});
  }

  /// All gateways remember it; the one that leads asks the mote.
  void operator()(const proxy::write_period& x) const {
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(x.period).count();
    for (const auto gateway : self->state.arguments.gateways)
      self->send(self->state.arguments.peer,
                 set_remote_tuple{{handle_of<peis_client_actor>(self)},
                                  0,
                                  gateway,
                                  device_output_period_key(x.mote.mote, x.channel),
                                  payload(to_bytes(std::to_string(ms))),
                                  true});
  }

  void operator()(const proxy::retire&) const;
};

void perform(proxy_pointer self, proxy::proxy::outputs todo) {
  for (auto& output : todo)
    std::visit(proxy_performer{self}, output);
  const auto& state = self->state;
  self->state.wake.follow(
      self, earliest(state.arguments.core.deadline(), state.streams.programs.deadline()));
}

/// Among the programs of its peer; those of the peer's file have small ones.
std::uint32_t number_of_streams(proxy_pointer self) {
  const auto& mote = self->state.arguments.core.who().mote;
  return mote.island.value << 16 | mote.mote.value;
}

/// After anything that the stream program did. @param commands what settling it gave
void perform(proxy_pointer self, std::optional<communication::remote::commands_batch> commands) {
  auto& state = self->state;
  auto& streams = state.streams;
  if (commands)
    self->send(state.arguments.layer,
               program_commands{number_of_streams(self), *std::move(commands)});
  streams.programs.send_notices(self, state.arguments.ecology);
  for (const auto& x : streams.tap->take_values())
    perform(self, state.arguments.core.on_record(x.stream, x.count, x.time_ms, now(self)));
  perform(self, proxy::proxy::outputs{}); // its deadline may be another
}

void on_attached(proxy_pointer self, const program_attached& x) {
  auto& state = self->state;
  auto& streams = state.streams;
  std::vector<apps::stream_tap::read_stream> inputs;
  for (const auto& each : proxy::streams_of(state.arguments.core.what()))
    inputs.push_back({each.number, each.every});
  auto tap = std::make_unique<apps::stream_tap>(inputs);
  streams.tap = tap.get();
  streams.process = std::make_unique<communication::remote_process>(x.limits);
  streams.process->begin(now(self));
  streams.programs.start_made(*streams.process, std::move(tap), "proxy", number_of_streams(self),
                              x.incarnation > 0, now(self));
  perform(self, streams.process->flush());
}

void on_timer(proxy_pointer self) {
  auto& state = self->state;
  auto& streams = state.streams;
  perform(self, state.arguments.core.on_time(now(self)));
  if (streams.process != nullptr)
    perform(self, streams.programs.on_time(*streams.process, now(self)));
}

/// Those of its core that it does not watch yet: all, at first.
void watch_all(proxy_pointer self) {
  using source = proxy::watch::source;
  auto& state = self->state;
  const auto first = state.watches.size();
  state.watches = state.arguments.core.watches();
  const auto own = state.arguments.peer_number;
  const auto client = handle_of<peis_client_actor>(self);
  for (auto i = first; i < state.watches.size(); ++i) {
    const auto& x = state.watches[i];
    if (x.where == source::meta)
      self->send(state.arguments.peer, watch_indirectly{client, i + 1, own, x.key});
    else if (x.where == source::own)
      self->send(state.arguments.peer, watch_tuples{client, i + 1, own, x.key});
    else
      for (const auto gateway : state.arguments.gateways)
        self->send(state.arguments.peer, watch_tuples{client, i + 1, gateway, x.key});
  }
}

bool is_answer(std::string_view key) {
  const auto parsed = parse_device_key(key);
  return parsed && parsed->what == device_tuple::input_status;
}

void on_gateway(proxy_pointer self, const gateway_changed& x) {
  self->state.arguments.gateway = x.gateway;
  log(self, spdlog::level::info, "event=gateway id={}", to_string(x.gateway));
  perform(self, self->state.arguments.core.on_gateway_changed(x.name, now(self)));
}

void on_tuple(proxy_pointer self, const tuple_event& x) {
  if (x.deleted)
    return;
  auto& core = self->state.arguments.core;
  const auto& watched = self->state.watches.at(x.watch - 1);
  if (watched.where != proxy::watch::source::gateway)
    perform(self, core.on_input(watched.input, to_string(x.value.view()), now(self)));
  else if (is_answer(x.key) && x.owner != self->state.written_to)
    return; // to somebody else, before this gateway has led
  else
    perform(self, core.on_gateway_tuple(x.key, x.value.view(), now(self)));
}

/// @param ends its life does: what has no answer has failed
void send_status(proxy_pointer self, bool ends) {
  const auto& core = self->state.arguments.core;
  const auto& counted = core.counters();
  report::proxy_report r;
  r.name = core.prefix();
  r.proxy_class = core.what().name;
  r.status = proxy::to_string(core.status());
  r.values = core.values();
  r.latency = core.reading_latency().value_or(0s);
  r.late = counted.late;
  r.actuations.requested = counted.requested;
  r.actuations.acknowledged = counted.acknowledged;
  r.actuations.sent = counted.sent;
  r.actuations.slowest = counted.slowest;
  r.actuations.latency = counted.latency;
  r.actuations.failed = counted.failed;
  const auto ended = counted.acknowledged + counted.sent + report::total(r.actuations.failed);
  if (ends) {
    r.status = "ended";
    if (ended < counted.requested)
      r.actuations.failed["proxy_ended"] = counted.requested - ended;
  }
  const auto& given = self->state.arguments;
  self->send(given.ecology, proxy_status{std::move(r), ends});
  report::cause_counts modules;
  report::add_counters<proxy::proxy_counters>(modules, "proxy", counted);
  if (self->state.streams.process)
    report::add_counters<communication::remote_counters>(modules, "programs",
                                                         self->state.streams.process->counters());
  send_modules(self, given.ecology, given.peer_name, std::move(modules));
  self->state.streams.programs.report(self, given.ecology, given.peer_name, now(self), ends);
}

void proxy_performer::operator()(const proxy::retire&) const {
  send_status(self, true);
  self->quit();
}

} // namespace

proxy_actor::behavior_type proxy_behavior(proxy_pointer self, proxy_arguments arguments) {
  self->set_exit_handler([self](const caf::exit_msg& x) {
    send_status(self, true); // a life that a fault has ended counts as well
    self->quit(x.reason);
  });
  self->state.arguments = std::move(arguments);
  auto& given = self->state.arguments;
  if (given.gateways.empty())
    given.gateways = {gateway_of(given.core.who().mote.island)};
  if (given.gateway == any_peer)
    given.gateway = given.gateways.front();
  self->state.written_to = given.gateway;
  perform(self, self->state.arguments.core.start(now(self)));
  if (proxy::reads_times(given.core.what()))
    self->send(given.peer, watch_clock{{handle_of<clock_watcher_actor>(self)}});
  watch_all(self);
  if (given.layer)
    self->send(given.layer,
               attach_program{number_of_streams(self), {handle_of<program_client_actor>(self)}});
  return {
      [self](const tuple_event& x) { on_tuple(self, x); },
      [](const peis_message&) {}, // hooks no port
      [self](const peis_outcome& x) {
        if (!x.success) {
          ++self->state.failed_writes;
          log(self, spdlog::level::warn, "event=write_failed cause={}", x.cause);
        }
      },
      [self](const clock_changed& x) { self->state.arguments.core.on_clock(x.offset); },
      [self](const mote_presence& x) {
        perform(self, self->state.arguments.core.on_presence(x.presence, x.cause, now(self)));
        log(self, spdlog::level::info, "event={} cause={}",
            proxy::to_string(self->state.arguments.core.status()), x.cause);
      },
      [self](const gateway_changed& x) { on_gateway(self, x); },
      [self](const change_class& x) {
        perform(self, self->state.arguments.core.on_class_changed(x.what));
        watch_all(self);
      },
      [self](const program_attached& x) { on_attached(self, x); },
      [](program_detached) {}, // a PC ends with its kernel, and so does this
      [self](const program_events& x) {
        auto& process = *self->state.streams.process;
        process.on_events(x.batch, now(self));
        perform(self, process.flush());
      },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          on_timer(self);
      },
      [self](status_request) { send_status(self, false); },
  };
}

} // namespace rubicon
