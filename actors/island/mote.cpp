#include "actors/island/mote.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "actors/base/failure.hpp"
#include "actors/base/log.hpp"
#include "actors/base/statuses.hpp"
#include "actors/island/network_radio.hpp"
#include "actors/island/program_note.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/supervision.hpp"
#include "apps/actuator.hpp"
#include "apps/listener.hpp"
#include "network/am.hpp"
#include "scheduler/messages/spawn.hpp"

namespace rubicon {

namespace {

using mote_pointer = scheduler::actor_pointer<mote_state, mote_actor>;

void perform(mote_pointer self, mote::node_outputs todo);
void perform(mote_pointer self, smepp::node_outputs todo);
void die(mote_pointer self);

void tell_state(mote_pointer self, const std::string& actuator, std::uint8_t state) {
  const auto how = state == 0 ? " off" : state == 1 ? " on" : " at " + std::to_string(state);
  self->send(self->state.arguments->ecology, notable_event{self->path(), actuator + how});
}

void change_radio(mote_pointer self, const radio_wish& wish) {
  const bool was_on = std::exchange(self->state.radio, wish).is_on();
  if (wish.is_on() != was_on)
    self->send(self->state.arguments->air,
               radio_power{self->state.arguments->radio,
                           wish.is_on() ? radio::power::on : radio::power::off});
}

instant own_time(mote_pointer self) {
  return self->state.crystal.own(now(self));
}

struct mote_performer {
  mote_pointer self;

  void operator()(network::frame_out& x) const {
    const acting_on its(x.from);
    const auto& arguments = *self->state.arguments;
    if (x.over == network::medium::backbone)
      self->send(arguments.backbone,
                 backbone_write{false, x.token, x.am_type, payload(std::move(x.payload))});
    else
      self->send(arguments.air, request_of(arguments.radio, std::move(x)));
  }

  void operator()(const mote::actuator_arrived& x) const { tell_state(self, x.name, x.state); }

  void operator()(const mote::radio_switch& x) const {
    auto wish = self->state.radio;
    wish.stack = x.on;
    wish.silenced = false;
    change_radio(self, wish);
  }

  void operator()(const mote::store_nonvolatile& x) const {
    self->send(self->state.arguments->ecology,
               store_written{self->state.arguments->address, x.content});
  }

  void operator()(mote::address_taken) const {
    log(self, spdlog::level::warn, "event=address_taken");
    auto wish = self->state.radio;
    wish.silenced = true;
    change_radio(self, wish);
    self->send(self->state.arguments->ecology,
               notable_event{self->path(), "is silent: another mote has its id"});
  }

  void operator()(const mote::membership& x) const {
    log(self, spdlog::level::info, "event={}", x.joined ? "joined" : "lost_island");
  }
};

/// Why a mote that is away is not back yet: searches become rare, which nothing else shows.
void tell_search(mote_pointer self) {
  auto& since = self->state.rests_since;
  const auto& search = self->state.node->search();
  const auto tell = [self](std::string what) {
    self->send(self->state.arguments->ecology, notable_event{self->path(), std::move(what)});
  };
  if (!since && search.rests()) {
    since = now(self);
    tell("finds no neighbour that knows the time: sleeps, and searches less and less often");
  } else if (since && !search.is_lost()) {
    tell("knows the time again, after resting for " +
         to_text(now(self) - *std::exchange(since, {})));
  }
}

void perform(mote_pointer self, mote::node_outputs todo) {
  auto& state = self->state;
  // Programs that have had no turn have nothing to tell: most frames are none of theirs.
  const bool had_turns = state.program_turns != state.node->program_turns();
  state.program_turns = state.node->program_turns();
  if (had_turns) {
    state.reports.tell(self, state.arguments->ecology);
    state.programs.tell(self, state.arguments->ecology);
    state.programs_due = state.programs.deadline();
  }
  for (auto& output : todo)
    std::visit(mote_performer{self}, output);
  state.separate.send_events(self);
  tell_search(self);
  const auto due = *earliest(state.node->deadline(), state.programs_due);
  if (std::exchange(state.due, due) != due)
    state.due_real = state.crystal.real(due);
  state.wake.follow(self, state.due_real);
  if (!had_turns)
    return;
  if (const auto report = state.reports.deadline())
    state.reports_wake.follow(self, std::max(*report, now(self)));
  else
    state.reports_wake.stop();
}

/// What SMEPP Light of the mote wants done.
struct group_performer {
  mote_pointer self;

  void operator()(smepp::send_frame& x) const {
    const acting_on its(x.from);
    self->state.groups->psdu_size = x.octets.size() + radio::overhead;
    self->send(self->state.arguments->air, request_of(self->state.arguments->radio, std::move(x)));
  }
  void operator()(smepp::store_state& x) const {
    *self->state.arguments->smepp_state = std::move(x.content);
  }
  void operator()(const smepp::set_radio& x) const {
    auto wish = self->state.radio;
    wish.groups = x.on;
    change_radio(self, wish);
  }
  void operator()(const smepp::forward_event& x) const {
    auto& node = *self->state.node;
    node.begin(own_time(self));
    self->state.groups->relay->forward(x.channel, x.value);
    perform(self, node.settle(own_time(self)));
  }
  void operator()(const smepp::computes& x) const {
    const auto& arguments = *self->state.arguments;
    self->send(arguments.air, computation{arguments.radio, x.length});
  }
  void operator()(smepp::notable& x) const {
    self->send(self->state.arguments->ecology, notable_event{self->path(), std::move(x.what)});
  }
};

void perform(mote_pointer self, smepp::node_outputs todo) {
  for (auto& x : todo)
    std::visit(group_performer{self}, x);
  auto& state = self->state;
  if (const auto due = state.groups->node.deadline())
    state.groups_wake.follow(self, std::max(now(self), state.groups->crystal.real(*due)));
  else
    state.groups_wake.stop();
}

/// @returns whether the frame was SMEPP's
bool take_group_frame(mote_pointer self, const radio::frame& x, byte_view psdu) {
  if (x.am_type != network::am::smepp)
    return false;
  auto& groups = self->state.groups;
  if (groups && !self->state.flat)
    perform(self,
            groups->node.on_frame(x.source, x.destination, x.payload,
                                  groups->own(sfd_of(psdu, now(self))), groups->own(now(self))));
  return true;
}

/// Where there are many motes, the memory of one has left the processor's cache since its last
/// frame. What each frame needs of it is fetched while the frame is decoded.
void fetch_ahead(const mote::node& x) {
  constexpr std::ptrdiff_t line = 64;
  const auto fetch = [](const void* from, std::size_t size) {
    const auto* const first = static_cast<const char*>(from);
    for (const auto* at = first; at < first + size; at += line)
      __builtin_prefetch(at);
  };
  const auto& router = x.packets().router();
  const auto& links = router.links().all();
  fetch(links.data(), links.size() * sizeof(links[0]));
  fetch(&router.tree(), sizeof(router.tree()));
  fetch(&router.place(), sizeof(router.place()));
  fetch(&router.clock(), sizeof(router.clock()));
}

void on_frame(mote_pointer self, byte_view psdu, int rssi_dbm) {
  if (self->state.node)
    fetch_ahead(*self->state.node);
  const auto frame = radio::decode(psdu);
  if (!frame || !is_for(*frame, self->state.arguments->address))
    return;
  if (self->state.plain && !self->state.flat)
    self->state.plain->take(self, *frame);
  if (self->state.flows.take(self, *frame) || take_group_frame(self, *frame, psdu))
    return;
  if (auto& node = self->state.node; node && !self->state.flat) {
    const auto time = own_time(self);
    auto todo = node->on_frame(frame->source, frame->am_type, frame->payload,
                               self->state.crystal.own(sfd_of(psdu, now(self))), time);
    std::ranges::move(node->on_signal(frame->source, rssi_dbm, time), std::back_inserter(todo));
    perform(self, std::move(todo));
  }
}

void on_group_frame_sent(mote_pointer self, std::uint64_t id, const radio_done& x) {
  auto& state = self->state;
  if (state.flat)
    return;
  auto& groups = *state.groups;
  const auto sfd = sfd_of(groups.psdu_size, now(self)); // of a broadcast, which nobody acknowledges
  perform(self, groups.node.on_sent(id, x.status == radio::send_status::sent, groups.own(sfd),
                                    groups.own(now(self))));
}

void on_done(mote_pointer self, const radio_done& x) {
  if (self->state.plain && self->state.plain->on_done(x))
    return;
  if (const auto id = smepp_id_of(x)) {
    on_group_frame_sent(self, *id, x);
    return;
  }
  const auto token = token_of(x);
  if (!token)
    self->state.flows.on_done(self, x);
  else if (!self->state.flat)
    perform(self, self->state.node->on_sent(*token, x.status == radio::send_status::sent,
                                            x.transmissions, own_time(self)));
}

void move_to(mote_pointer self, position place) {
  auto& state = self->state;
  if (state.node)
    state.node->move(place);
  if (state.plain)
    state.plain->move(place);
  self->send(state.arguments->air, move_radio{state.arguments->radio, place});
}

void go(mote_pointer self) {
  auto& state = self->state;
  if (!state.moves)
    return;
  move_to(self, state.moves->walk.at(now(self)));
  state.moves->wake.follow(self, state.moves->walk.next(now(self)));
}

void on_timer(mote_pointer self, const timer_expired& x) {
  auto& state = self->state;
  if (state.last_words.accepts(x)) {
    self->send(state.arguments->air, radio_power{state.arguments->radio, radio::power::flat});
    die(self);
  }
  state.flows.on_timer(self, x);
  if (state.plain && !state.flat)
    state.plain->on_timer(self, x);
  if (state.wake.accepts(x) && !state.flat) {
    perform(self, state.node->on_time(own_time(self)));
    perform(self, state.programs.on_time(*state.node, own_time(self)));
  }
  if (state.reports_wake.accepts(x) && !state.flat)
    perform(self, state.reports.on_time(*state.node, own_time(self), now(self)));
  if (state.groups_wake.accepts(x) && !state.flat)
    perform(self, state.groups->node.on_time(state.groups->own(now(self))));
  const bool stays = state.flat && state.arguments->stays_when_flat; // else it is carried on
  if (state.moves && state.moves->wake.accepts(x) && !stays)
    go(self);
}

/// @pre the node runs
template <class Change>
void change_programs(mote_pointer self, Change change) {
  auto& state = self->state;
  state.node->begin(own_time(self));
  change(state.separate);
  perform(self, state.node->settle(own_time(self)));
}

void on_attach(mote_pointer self, const attach_program& x) {
  auto& state = self->state;
  if (state.separate.contains(x.number))
    change_programs(self, [&x](auto& programs) { programs.leave(x.number); });
  state.separate.attach(self, *state.node, x, state.store.starts);
  perform(self, mote::node_outputs{});
}

void on_backbone(mote_pointer self, const backbone_received& x) {
  if (self->state.node && !self->state.flat)
    perform(self, self->state.node->on_frame(x.source, x.am_type, x.octets.view(),
                                             self->state.crystal.own(now(self) - x.age),
                                             own_time(self), network::medium::backbone));
}

void attach_to_backbone(mote_pointer self, const backbone_end_actor& user) {
  if (const auto& backbone = self->state.arguments->backbone)
    self->send(backbone, attach_backbone{true, user});
}

/// The MCU has stopped: no programs, no timers, no answers on the radio.
void die(mote_pointer self) {
  if (self->state.flat)
    return;
  self->state.flat = true;
  attach_to_backbone(self, {});
  self->state.separate.send_detached(self);
  log(self, spdlog::level::info, "event=battery_flat");
  self->send(self->state.arguments->ecology, notable_event{self->path(), "battery flat"});
  self->send(self->state.arguments->ecology, mote_flat{self->state.arguments->address});
  self->state.flows.stop(self);
  if (self->state.plain)
    self->state.plain->stop();
}

void on_battery_low(mote_pointer self) {
  log(self, spdlog::level::info, "event=battery_low");
  if (self->state.node && !self->state.flat)
    perform(self, self->state.node->on_battery_low(own_time(self)));
}

void report_messages(mote_pointer self, bool is_alive) {
  const auto& state = self->state;
  auto status = messages_of(state.arguments->address, state.node->above(), !is_alive);
  status.messages.refused["off"] = 0; // its programs stop with it
  self->send(state.arguments->ecology, std::move(status));
}

/// The clock of a life that has ended is compared with nothing, and its place in the tree is
/// nobody's.
void report_network(mote_pointer self, bool is_alive) {
  const auto& arguments = *self->state.arguments;
  auto status = status_of(arguments.address, *self->state.node, own_time(self), now(self));
  if (!is_alive) {
    status.has_clock = false;
    status.network.synchronised = 0;
    status.network.aligned = 0;
    status.network.hops_max = 0;
    status.parent = {};
    status.channels.clear();
  } else if (const auto dbm = self->state.node->read(device::quantity::signal, now(self))) {
    status.has_signal = *dbm != mote::node::signal_unknown;
    status.signal_dbm = *dbm;
  }
  report::add_counters<communication::program_port_counters>(status.network.counters, "programs",
                                                             self->state.separate.counters());
  self->send(arguments.ecology, std::move(status));
}

void report_node(mote_pointer self, bool is_alive) {
  const auto& state = self->state;
  report_messages(self, is_alive);
  report_network(self, is_alive);
  state.programs.report(self, state.arguments->ecology, state.arguments->name, own_time(self),
                        !is_alive);
}

void report_groups(mote_pointer self, life_state life) {
  const auto& state = self->state;
  if (state.groups)
    self->send(state.arguments->ecology,
               status_of(state.arguments->address.island, state.groups->node, life));
}

void on_clock_step(mote_pointer self, duration by) {
  auto& state = self->state;
  if (!state.node || state.flat)
    return;
  state.node->on_clock_leapt(by);
  perform(self, state.node->on_time(own_time(self)));
}

/// The programs' turn follows at once: a period may have begun.
void on_period(mote_pointer self, const set_period& x) {
  auto& state = self->state;
  if (!state.node || state.flat)
    return;
  if (const auto found = state.samplers.find(x.number);
      !x.messenger && found != state.samplers.end())
    found->second->set_period(x.period);
  if (const auto found = state.messengers.find(x.number);
      x.messenger && found != state.messengers.end())
    found->second->set_period(x.period);
  perform(self, state.reports.on_time(*state.node, own_time(self), now(self)));
}

void report_plain(mote_pointer self) {
  if (const auto& plain = self->state.plain)
    send_modules(self, self->state.arguments->ecology, self->state.arguments->name,
                 plain->counted());
}

/// An exception ends the mote. What this life has counted must not go with it. Reliable messages
/// that were still open have failed; nobody will know about flows' requests, so they stay open.
void report_failures(mote_pointer self) {
  self->set_exception_handler([self](std::exception_ptr& x) {
    self->state.flows.report(self, self->state.arguments->ecology);
    report_plain(self);
    report_groups(self, life_state::replaced);
    if (self->state.node)
      report_node(self, false);
    return scheduler::failure_of(x);
  });
}

void tell_sample(mote_pointer self, std::uint64_t number) {
  const auto& state = self->state;
  if (!state.node || state.flat)
    return;
  const auto& arguments = *state.arguments;
  auto x = sample_of(number, status_of(arguments.address, *state.node, own_time(self), now(self)));
  x.who = arguments.name;
  x.missed = state.programs.vectors_missed();
  self->send(arguments.ecology, std::move(x));
}

/// Starts what reports to others and obeys them.
struct report_starter {
  mote_pointer self;

  void operator()(const apps::sampler_config& x) const {
    const auto path = path_of("sampler", x.channel);
    const random_stream rng(self->state.arguments->seed, path);
    auto program = std::make_unique<apps::sampler>(
        std::shared_ptr<const apps::sampler_config>(self->state.arguments, &x), rng);
    self->state.samplers[x.channel] = program.get();
    begin(path, std::move(program));
  }
  void operator()(const apps::actuator_config& x) const {
    const auto state = self->state.node->actuator_state(x.actuator, {}).value_or(0);
    begin(path_of("actuator", x.actuator), std::make_unique<apps::actuator>(x, state));
  }
  void operator()(const apps::messenger_config& x) const {
    auto program = std::make_unique<apps::messenger>(x);
    self->state.messengers[x.am_type] = program.get();
    begin(path_of("messenger", x.am_type), std::move(program));
  }
  void operator()(const apps::listener_config& x) const {
    begin(path_of("listener", x.am_type), std::make_unique<apps::listener>(x));
  }
  template <class Other>
  void operator()(const Other&) const {}

  template <class What>
  [[nodiscard]] std::string path_of(std::string_view kind, const What& what) const {
    return fmt::format("mote_app/{}/{}-{}", self->state.arguments->name, kind, what);
  }
  void begin(std::string path, std::unique_ptr<apps::application> program) const {
    self->state.reports.start_as(*self->state.node, std::move(path), std::move(program), now(self));
  }
};

void start_programs(mote_pointer self, const std::string& life) {
  auto& state = self->state;
  const auto& arguments = *state.arguments;
  observe_programs(self, *state.node);
  for (const auto& app : arguments.apps)
    std::visit(report_starter{self}, app);
  for (const auto& x : programs_among(arguments.apps)) {
    if (!x.is_separate)
      state.programs.start_one(*state.node, x.config, x.number, life, arguments.seed,
                               state.store.starts > 0, own_time(self));
  }
}

void start_plain(mote_pointer self, const std::string& life) {
  auto& state = self->state;
  const auto& of = *state.arguments;
  const auto programs = plain_programs_among(of.apps);
  if (programs.empty() || state.node)
    return;
  state.plain = std::make_unique<plain_host>(
      plain_host_config{of.address.mote, of.radio, of.air, state.crystal, of.node.transducers,
                        of.node.transducer_seed, of.node.place},
      programs, random_stream(of.seed, life + "/plain"), now(self));
  state.plain->start(self);
}

/// SMEPP Light, beside the stack if there is one.
void start_groups(mote_pointer self, const std::string& life, const mote::crystal& crystal) {
  auto& state = self->state;
  const auto& arguments = *state.arguments;
  if (!arguments.smepp)
    return;
  state.groups = std::make_unique<smepp_shell>(smepp_shell{
      smepp::node(*arguments.smepp, random_stream(arguments.seed, life + "/smepp"),
                  crystal.own(instant{}), crystal.own(now(self)), *arguments.smepp_state),
      crystal});
  auto& groups = *state.groups;
  const auto octets = groups.node.own().footprint() + (state.node ? state.node->footprint() : 0);
  if (const auto most = arguments.smepp->settings.memory_max;
      octets > most && state.store.starts == 0)
    self->send(arguments.ecology,
               notable_event{self->path(), fmt::format("needs {} octets of memory with all tables "
                                                       "full, more than {}",
                                                       octets, most)});
  if (state.node) {
    groups.node.set_reader(
        [self](device::quantity x) { return self->state.node->read(x, now(self)); });
    auto relay = std::make_unique<event_relay>();
    groups.relay = relay.get();
    state.reports.start_as(*state.node, "mote_app/" + arguments.name + "/event_relay",
                           std::move(relay), now(self));
  }
  perform(self, groups.node.start(groups.own(now(self))));
}

void start(mote_pointer self) {
  auto& state = self->state;
  const auto& arguments = *state.arguments;
  const auto life = "mote/" + arguments.name + '#' + std::to_string(state.store.starts);
  const auto crystal =
      arguments.crystal.ahead_by(mote::boot_time(random_stream(arguments.seed, life + "/clock")));
  state.crystal = crystal;
  self->send(arguments.air, attach_radio{arguments.radio, {handle_of<radio_user_actor>(self)}});
  attach_to_backbone(self, {handle_of<backbone_end_actor>(self)});
  if (arguments.stack == config::stack::full)
    state.node.emplace(std::shared_ptr<const mote::node_config>(state.arguments, &arguments.node),
                       state.crystal, state.store, random_stream(arguments.seed, life),
                       own_time(self));
  else
    mote_performer{self}(mote::store_nonvolatile{begin_life(state.store)});
  start_plain(self, life);
  if (!arguments.path.empty()) {
    state.moves = std::make_unique<mote_state::moving>();
    state.moves->walk = device::walk(arguments.path, arguments.step);
  }
  go(self);
  if (state.node) {
    start_programs(self, life);
    perform(self, state.node->start(own_time(self)));
  }
  state.flows.start(self, arguments.apps, arguments.address, arguments.radio, arguments.air,
                    random_stream(arguments.seed, life + "/flows"));
  start_groups(self, life, crystal);
  // Who has groups and no other use for its radio leaves it to them.
  if (state.groups && !state.node && !state.flows.is_used()) {
    auto wish = state.radio;
    wish.stack = false;
    change_radio(self, wish);
  }
}

} // namespace

mote_actor::behavior_type mote_behavior(mote_pointer self,
                                        std::shared_ptr<const mote_arguments> arguments,
                                        mote::nonvolatile store) {
  report_failures(self);
  self->set_down_handler([self](const caf::down_msg& x) {
    const auto ended = self->state.separate.number_of(x.source);
    if (ended && !self->state.flat)
      change_programs(self, [&ended](auto& programs) { programs.leave(*ended); });
  });
  self->state.arguments = std::move(arguments);
  self->state.store = store;
  start(self);
  return {
      [self](const frame_received& x) { on_frame(self, x.psdu.view(), x.rssi_dbm); },
      [self](const timer_expired& x) { on_timer(self, x); },
      [self](const radio_done& x) { on_done(self, x); },
      [self](const backbone_received& x) { on_backbone(self, x); },
      [self](const backbone_sent& x) {
        if (self->state.node && !self->state.flat)
          perform(self, self->state.node->on_sent(x.token, x.acked, 1, own_time(self)));
      },
      [self](battery_low) { on_battery_low(self); },
      [self](battery_flat) { die(self); },
      [self](const attach_program& x) {
        if (self->state.node && !self->state.flat)
          on_attach(self, x);
      },
      [self](const program_commands& x) {
        if (!self->state.flat && self->state.separate.contains(x.number))
          change_programs(self, [&x](auto& programs) { programs.on_commands(x); });
      },
      [self](const move_mote& x) {
        self->state.moves.reset();
        move_to(self, x.place);
      },
      [self](crash_now) {
        if (!self->state.flat)
          throw std::runtime_error(std::string(planned_crash));
      },
      [self](const step_clock& x) { on_clock_step(self, x.by); },
      [self](const set_period& x) { on_period(self, x); },
      [self](const set_network_keys& x) {
        if (self->state.groups && !self->state.flat)
          perform(self, self->state.groups->node.set_network_keys(
                            *x.keys, self->state.groups->own(now(self))));
      },
      [self](end_battery) {
        on_battery_low(self);
        const auto left = self->state.node ? last_words_time : duration{};
        self->state.last_words.follow(self, now(self) + left);
      },
      [self](const status_request& x) {
        if (x.sample > 0) {
          tell_sample(self, x.sample);
          return;
        }
        self->state.flows.report(self, self->state.arguments->ecology);
        report_plain(self);
        report_groups(self, self->state.flat ? life_state::ended : life_state::goes_on);
        if (self->state.node)
          report_node(self, !self->state.flat);
      },
  };
}

} // namespace rubicon
