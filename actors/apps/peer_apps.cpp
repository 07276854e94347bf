#include "actors/apps/peer_apps.hpp"

#include <algorithm>

#include "actors/log.hpp"
#include "scheduler/supervision.hpp"

namespace rubicon {

namespace {

using rules_pointer = scheduler::traced_pointer<rules_state, timed_peer_app_actor>;
using collector_pointer = scheduler::traced_pointer<collector_state, peer_app_actor>;

/// Name of the watch on what is read. Watch n + 1 is on the n-th tuple that rules write.
constexpr std::uint64_t watch_read = 0;
/// A collector's other watch, on who is listed.
constexpr std::uint64_t watch_listed = 1;

template <class Self>
carried<peis_client_actor> handle_of(Self* self) {
  return {caf::actor_cast<peis_client_actor>(self)};
}

void write_all(rules_pointer self, const std::vector<proxy::write_tuple>& writes) {
  auto& state = self->state;
  for (const auto& x : writes) {
    const auto owner = state.owners.find(x.key);
    if (owner == state.owners.end())
      continue; // said again when the owner is found: rules::on_owner
    self->send(state.ecology,
               story{self->path(), "writes " + x.key + " = " + x.word + (x.again ? " again" : "")});
    if (x.meta)
      self->send(state.peer, set_meta_tuple{handle_of(self), 0, owner->second, x.key, x.word});
    else
      self->send(state.peer, set_remote_tuple{handle_of(self), 0, owner->second, x.key,
                                              payload(to_bytes(std::string_view(x.word))), true});
  }
  state.wake.follow(self, state.rules.deadline());
}

/// The owner of a tuple to write has gone. If it comes back its inputs are where they are by
/// default, so a reference is written again then; a word may be a command, and is not.
void forget_reference(rules_pointer self, const std::string& key, peer_id owner) {
  auto& owners = self->state.owners;
  const auto known = owners.find(key);
  if (self->state.rules.is_meta(key) && known != owners.end() && known->second == owner)
    owners.erase(known);
}

void on_tuple(rules_pointer self, const tuple_event& x) {
  auto& state = self->state;
  if (x.deleted) {
    if (x.watch == watch_read)
      state.rules.on_gone(x.key);
    else
      forget_reference(self, state.rules.written().at(x.watch - 1), x.owner);
    return;
  }
  if (x.watch == watch_read) {
    write_all(self, state.rules.on_value(x.key, to_string(x.value.view()), now(self)));
    return;
  }
  const auto& key = state.rules.written().at(x.watch - 1);
  const auto [owner, is_new] = state.owners.try_emplace(key, x.owner);
  if (!is_new && owner->second == x.owner)
    return;
  owner->second = x.owner;
  write_all(self, state.rules.on_owner(key, now(self)));
}

/// A gateway that was started again knows of no periods, but says anew who is listed.
void ask_for_period(collector_pointer self, const tuple_event& x) {
  const auto status = parse_device_status(to_string(x.value.view()));
  const auto about = parse_device_key(x.key);
  if (!status || !about || status->presence != device_presence::listed)
    return;
  const auto& config = self->state.config;
  const auto period = std::chrono::duration_cast<std::chrono::milliseconds>(config.every);
  for (const auto& key : config.keys) {
    const auto pattern = parse_output_pattern(key);
    if (pattern && pattern->channel && pattern->mote.value_or(about->mote) == about->mote)
      self->send(self->state.peer,
                 set_remote_tuple{handle_of(self), 0, x.owner,
                                  device_output_period_key(about->mote, *pattern->channel),
                                  payload(to_bytes(std::to_string(period.count()))), true});
  }
}

void on_tuple(collector_pointer self, const tuple_event& x) {
  auto& state = self->state;
  if (x.watch == watch_listed) {
    if (!x.deleted)
      ask_for_period(self, x);
    return;
  }
  ++state.updates;
  const auto name = to_string(x.owner) + ':' + x.key;
  if (x.deleted)
    state.collected.erase(name);
  else if (state.collected.size() < collected_max)
    state.collected.insert(name);
}

} // namespace

timed_peer_app_actor::behavior_type rules_program(rules_pointer self, proxy::rules rules,
                                                  peis_peer_actor peer, ecology_actor ecology) {
  scheduler::tell_monitors_of_exceptions(self);
  auto& state = self->state;
  state.rules = std::move(rules);
  state.peer = std::move(peer);
  state.ecology = std::move(ecology);
  for (const auto& key : state.rules.watched())
    self->send(state.peer, watch_tuples{handle_of(self), watch_read, any_peer, key});
  std::uint64_t watch = watch_read;
  for (const auto& key : state.rules.written())
    self->send(state.peer, watch_tuples{handle_of(self), ++watch, any_peer, key});
  return {
      [self](const tuple_event& x) { on_tuple(self, x); },
      [](const peis_message&) {},
      [self](const peis_outcome& x) {
        if (x.success)
          return;
        ++self->state.failed_writes;
        log(self, spdlog::level::warn, "event=write_failed cause={}", x.cause);
      },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          write_all(self, self->state.rules.on_time(now(self)));
      },
      [](status_request) {},
  };
}

peer_app_actor::behavior_type collector(collector_pointer self, config::collector_app config,
                                        std::string who, peis_peer_actor peer,
                                        ecology_actor ecology) {
  scheduler::tell_monitors_of_exceptions(self);
  self->state.config = std::move(config);
  self->state.peer = std::move(peer);
  self->state.ecology = std::move(ecology);
  const auto& state = self->state;
  for (const auto& key : state.config.keys)
    self->send(state.peer, watch_tuples{handle_of(self), watch_read, any_peer, key});
  if (state.config.every > duration{})
    self->send(state.peer, watch_tuples{handle_of(self), watch_listed, any_peer,
                                        std::string(all_device_statuses_key)});
  return {
      [self](const tuple_event& x) { on_tuple(self, x); },
      [](const peis_message&) {},
      [](const peis_outcome&) {},
      [self, who = std::move(who)](status_request) {
        const auto& counted = self->state;
        self->send(counted.ecology,
                   program_status{{who,
                                   "collector",
                                   {{"updates", static_cast<double>(counted.updates)},
                                    {"tuples", static_cast<double>(counted.collected.size())}}},
                                  0,
                                  {},
                                  {}});
      },
  };
}

proxy::rule rule_of(const config::rule& x) {
  proxy::rule y{x.when, x.above, x.below, x.equals, x.lasting, x.otherwise_lasting, {}};
  for (const auto& each : x.writes)
    y.writes.push_back({each.key, each.then, each.otherwise, each.meta});
  return y;
}

} // namespace rubicon
