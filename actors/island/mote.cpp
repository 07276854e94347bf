#include "actors/island/mote.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "actors/base/failure.hpp"
#include "actors/base/log.hpp"
#include "actors/island/mote_firmware.hpp"
#include "actors/island/mote_groups.hpp"
#include "actors/island/mote_report.hpp"
#include "actors/island/mote_shell.hpp"
#include "actors/island/network_radio.hpp"
#include "actors/island/program_note.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/supervision.hpp"
#include "apps/actuator.hpp"
#include "apps/listener.hpp"
#include "apps/requested_messages.hpp"
#include "network/am.hpp"
#include "scheduler/messages/spawn.hpp"

namespace rubicon {

namespace {

void die(mote_pointer self);

void perform(mote_pointer self, mote::node_outputs todo) {
  mote_shell{self}.perform(std::move(todo));
}

instant own_time(mote_pointer self) {
  return mote_shell{self}.own_time();
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

  void operator()(const mote::actuator_arrived& x) const {
    const auto how = x.state == 0   ? " off"
                     : x.state == 1 ? " on"
                                    : " at " + std::to_string(x.state);
    mote_shell{self}.notify_ecology(x.name + how);
  }

  void operator()(const mote::radio_switch& x) const {
    auto demand = self->state.radio;
    demand.stack = x.on;
    demand.silenced = false;
    mote_shell{self}.set_radio(demand);
  }

  void operator()(const mote::store_nonvolatile& x) const {
    self->send(self->state.arguments->ecology,
               store_written{self->state.arguments->address, x.content});
  }

  void operator()(mote::address_taken) const {
    log(self, spdlog::level::warn, "event=address_taken");
    auto demand = self->state.radio;
    demand.silenced = true;
    mote_shell{self}.set_radio(demand);
    mote_shell{self}.notify_ecology("is silent: another mote has its id");
  }

  void operator()(const mote::membership& x) const {
    log(self, spdlog::level::info, "event={}", x.joined ? "joined" : "lost_island");
  }
};

/// Why a mote that is away is not back yet: searches become rare, which nothing else shows.
void report_search(mote_pointer self) {
  auto& since = self->state.rests_since;
  const auto& search = self->state.node->packets().router().search();
  const mote_shell mote{self};
  if (!since && search.rests()) {
    since = now(self);
    mote.notify_ecology(
        "finds no neighbour that knows the time: sleeps, and searches less and less often");
  } else if (since && !search.is_lost()) {
    mote.notify_ecology("knows the time again, after resting for " +
                        to_text(now(self) - *std::exchange(since, {})));
  }
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
  mote_firmware(self).on_frame(psdu, rssi_dbm);
  const auto frame = radio::decode(psdu);
  if (!frame || !is_for(*frame, self->state.arguments->address))
    return;
  if (self->state.plain && !self->state.flat)
    self->state.plain->take(self, *frame);
  if (self->state.flows.take(self, *frame) || mote_groups(self).accept_frame(*frame, psdu))
    return;
  if (auto& node = self->state.node; node && !self->state.flat) {
    const auto time = own_time(self);
    auto todo = node->on_frame(frame->source, frame->am_type, frame->payload,
                               self->state.crystal.own(sfd_of(psdu, now(self))), time);
    std::ranges::move(node->on_signal(frame->source, rssi_dbm, time), std::back_inserter(todo));
    perform(self, std::move(todo));
  }
}

void on_done(mote_pointer self, const radio_done& x) {
  if (self->state.plain && self->state.plain->on_done(x))
    return;
  if (mote_firmware(self).on_done(x))
    return;
  if (const auto id = smepp_id_of(x)) {
    mote_groups(self).on_sent(*id, x);
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
    state.node->devices().move(place);
  if (state.plain)
    state.plain->move(place);
  mote_firmware(self).move(place);
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
  mote_firmware(self).on_timer(x);
  if (state.wake.accepts(x) && !state.flat) {
    perform(self, state.node->on_time(own_time(self)));
    perform(self, state.programs.on_time(*state.node, own_time(self)));
  }
  if (state.reports_wake.accepts(x) && !state.flat)
    perform(self, state.reports.on_time(*state.node, own_time(self), now(self)));
  if (state.groups_wake.accepts(x) && !state.flat)
    mote_groups(self).on_time();
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
  mote_shell{self}.notify_ecology("battery flat");
  self->send(self->state.arguments->ecology, mote_flat{self->state.arguments->address});
  self->state.flows.stop(self);
  if (self->state.plain)
    self->state.plain->stop();
  mote_firmware(self).stop();
}

void on_battery_low(mote_pointer self) {
  log(self, spdlog::level::info, "event=battery_low");
  if (self->state.node && !self->state.flat)
    perform(self, self->state.node->on_battery_low(own_time(self)));
}

void on_clock_step(mote_pointer self, duration by) {
  auto& state = self->state;
  if (!state.node || state.flat)
    return;
  state.node->on_clock_leapt(by);
  perform(self, state.node->on_time(own_time(self)));
}

/// The programs' turn follows at once: a period may have begun.
void on_program_change(mote_pointer self, const change_program& x) {
  auto& state = self->state;
  if (!state.node || state.flat)
    return;
  if (const auto found = state.samplers.find(x.number);
      !x.messenger && found != state.samplers.end())
    found->second->change(x.settings);
  if (const auto found = state.messengers.find(x.number);
      x.messenger && found != state.messengers.end())
    found->second->change(x.settings);
  perform(self, state.reports.on_time(*state.node, own_time(self), now(self)));
}

/// A program of its own sends, which begins with the first message of a life.
void on_request(mote_pointer self, const send_as_program& x) {
  auto& state = self->state;
  if (!state.node || state.flat) {
    mote_shell{self}.notify_ecology("message " + std::to_string(x.number) + " refused");
    return;
  }
  auto* program = state.reports.find<apps::requested_messages>();
  if (program == nullptr) {
    auto made = std::make_unique<apps::requested_messages>();
    program = made.get();
    state.reports.start_as(*state.node, "mote_app/" + state.arguments->name + "/requested",
                           std::move(made), now(self));
  }
  state.node->begin(own_time(self));
  program->send(x.number, x.to, x.octets.view(), x.reliable, x.am_type);
  perform(self, state.node->settle(own_time(self)));
}

/// An exception ends the mote. What this life has counted must not go with it. Reliable messages
/// that were still open have failed; the outcome of flows' requests is not known, so they stay
/// open.
void report_failures(mote_pointer self) {
  self->set_exception_handler([self](std::exception_ptr& x) {
    mote_report(self).send(life_state::replaced);
    return scheduler::failure_of(x);
  });
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
    const auto state = self->state.node->devices().state(x.actuator, {}).value_or(0);
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
  mote_groups(self).start(life);
  mote_firmware(self).start(life);
  // Who has groups and no other use for its radio leaves it to them.
  if (state.groups && !state.node && !state.flows.is_used()) {
    auto demand = state.radio;
    demand.stack = false;
    mote_shell{self}.set_radio(demand);
  }
}

} // namespace

instant mote_shell::own_time() const {
  return self->state.crystal.own(now(self));
}

void mote_shell::set_radio(const radio_demand& x) const {
  const bool was_on = std::exchange(self->state.radio, x).is_on();
  if (x.is_on() != was_on)
    self->send(self->state.arguments->air,
               radio_power{self->state.arguments->radio,
                           x.is_on() ? radio::power::on : radio::power::off});
}

void mote_shell::notify_ecology(std::string what) const {
  self->send(self->state.arguments->ecology, notable_event{self->path(), std::move(what)});
}

void mote_shell::perform(mote::node_outputs todo) const {
  auto& mote = self->state;
  // Programs that have had no turn have nothing to report: most frames are not for them.
  const bool had_turns = mote.program_turns != mote.node->program_turns();
  mote.program_turns = mote.node->program_turns();
  if (had_turns) {
    mote.reports.send_notices(self, mote.arguments->ecology);
    mote.programs.send_notices(self, mote.arguments->ecology);
    mote.programs_due = mote.programs.deadline();
  }
  for (auto& output : todo)
    std::visit(mote_performer{self}, output);
  mote.separate.send_events(self);
  report_search(self);
  const auto due = *earliest(mote.node->deadline(), mote.programs_due);
  if (std::exchange(mote.due, due) != due)
    mote.due_real = mote.crystal.real(due);
  mote.wake.follow(self, mote.due_real);
  if (!had_turns)
    return;
  if (const auto report = mote.reports.deadline())
    mote.reports_wake.follow(self, std::max(*report, now(self)));
  else
    mote.reports_wake.stop();
}

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
      [self](const change_program& x) { on_program_change(self, x); },
      [self](const set_network_keys& x) { mote_groups(self).set_keys(x); },
      [self](const send_as_program& x) { on_request(self, x); },
      [self](end_battery) {
        on_battery_low(self);
        const auto left = self->state.node ? last_words_time : duration{};
        self->state.last_words.follow(self, now(self) + left);
      },
      [self](const status_request& x) {
        if (x.sample > 0)
          mote_report(self).send_sample(x.sample);
        else
          mote_report(self).send(self->state.flat ? life_state::ended : life_state::goes_on);
      },
  };
}

} // namespace rubicon
