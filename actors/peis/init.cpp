#include "actors/peis/init.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <stdexcept>
#include <utility>

#include "actors/base/log.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "scheduler/messages/spawn.hpp"

namespace rubicon {

namespace {

using init_pointer = scheduler::actor_pointer<init_state, init_actor>;

/// What others may write of each component.
constexpr std::array fields{"reqState", "stdin", "extra-arguments"};

void perform(init_pointer self, peisinit::outputs todo);

/// Once for each component.
void report_unmet(init_pointer self, std::size_t component, const std::string& why) {
  const auto& what = self->state.supervisor.components()[component];
  if (self->state.unmet.insert(component).second)
    self->send(self->state.arguments.ecology,
               request_unmet{self->path(), "component " + what.name + " cannot be started (" + why +
                                               "): correct its command `" + what.command + '`'});
}

/// What a shell says of a command that it does not find, or that is no program (POSIX 2.8.2).
bool is_no_command(const std::string& how) {
  return how == io::to_string(io::process_end{127, 0}) ||
         how == io::to_string(io::process_end{126, 0});
}

void start_process(init_pointer self, const peisinit::start& x) {
  auto& state = self->state;
  const auto& what = state.supervisor.components()[x.component];
  const auto user = handle_of<init_actor>(self);
  io::spawn_request request{"/bin/sh", {"sh", "-c", what.command}};
  request.environment = {"PEISINIT=" + peisinit::options_for(what, x.arguments, *state.host)};
  auto made = io::process::start(
      *state.arguments.loop, std::move(request),
      {[user, at = x.component](io::process::output from, byte_view octets) {
         const auto last = octets.last(std::min(octets.size(), peisinit::tail_octets_max));
         post(user, process_output{at, from == io::process::output::err, to_bytes(last)});
       },
       [user, at = x.component, life = x.life](io::process_end how) {
         post(user, process_ended{at, life, io::to_string(how)});
       }});
  if (const auto* why = std::get_if<std::string>(&made)) {
    report_unmet(self, x.component, *why);
    self->send(user, process_ended{x.component, x.life, *why});
    return;
  }
  auto& process = std::get<io::process>(made);
  const auto number = process.pid();
  state.processes.insert_or_assign(x.component, std::move(process));
  perform(self, state.supervisor.on_started(x.component, x.life, number));
}

struct init_performer {
  init_pointer self;

  void operator()(const peisinit::publish& x) const {
    self->send(self->state.arguments.peer, set_tuple{x.key, payload(to_bytes(x.text)), true});
  }

  void operator()(const peisinit::start& x) const {
    const auto& what = self->state.supervisor.components()[x.component];
    if (what.peer.empty())
      start_process(self, x);
    else
      self->send(self->state.arguments.ecology, start_component{what.peer, x.life});
  }

  void operator()(const peisinit::stop& x) const {
    const auto& what = self->state.supervisor.components()[x.component];
    switch (x.step) {
    case peisinit::stop_step::do_quit:
      write(what.id, "do-quit");
      return;
    case peisinit::stop_step::kernel_quit:
      write(what.id, "kernel.do-quit");
      return;
    case peisinit::stop_step::interrupt:
      signal(x.component, SIGINT);
      return;
    case peisinit::stop_step::terminate:
      signal(x.component, SIGTERM);
      return;
    case peisinit::stop_step::kill:
      signal(x.component, SIGKILL);
      return;
    }
  }

  void operator()(const peisinit::feed& x) const {
    const auto process = self->state.processes.find(x.component);
    if (process == self->state.processes.end() || !process->second.feed(x.text))
      log(self, spdlog::level::warn, "event=input_lost component={} octets={}",
          self->state.supervisor.components()[x.component].name, x.text.size());
  }

  void operator()(peisinit::notice& x) const {
    log(self, spdlog::level::info, "event=component what=\"{}\"", x.what);
    self->send(self->state.arguments.ecology, notable_event{self->path(), std::move(x.what)});
  }

  void operator()(const peisinit::all_off&) const {
    self->send(self->state.arguments.peer, quit_peer{});
  }

  void write(peer_id owner, const char* key) const {
    self->send(self->state.arguments.peer,
               set_remote_tuple{{handle_of<peis_client_actor>(self)},
                                0,
                                owner,
                                key,
                                payload(to_bytes(std::string_view("yes"))),
                                true});
  }

  void signal(std::size_t component, int number) const {
    const auto& what = self->state.supervisor.components()[component];
    if (!what.peer.empty()) {
      self->send(self->state.arguments.ecology, stop_component{what.peer, number == SIGKILL});
      return;
    }
    const auto process = self->state.processes.find(component);
    if (process != self->state.processes.end())
      process->second.signal(number);
  }
};

void perform(init_pointer self, peisinit::outputs todo) {
  for (auto& output : todo)
    std::visit(init_performer{self}, output);
  self->state.wake.follow(self, self->state.supervisor.deadline());
}

/// A host has one init (SVC-06). In virtual time the description has no second one.
void take_host(init_pointer self, const std::string& host) {
  auto& state = self->state;
  if (state.arguments.loop == nullptr)
    return;
  const auto path = state.arguments.lock.empty()
                        ? io::runtime_file("rubicon-init-" + host + ".lock")
                        : state.arguments.lock;
  auto taken = io::file_lock::take(path);
  if (const auto* why = std::get_if<std::string>(&taken))
    throw std::runtime_error("no second init of host " + host + ": " + *why);
  state.lock.emplace(std::get<io::file_lock>(std::move(taken)));
}

/// Watch n is on field n % 3 of component n / 3.
void watch_all(init_pointer self) {
  const auto& state = self->state;
  const auto& components = state.supervisor.components();
  for (std::size_t i = 0; i < components.size() * fields.size(); ++i)
    self->send(state.arguments.peer,
               watch_tuples{{handle_of<peis_client_actor>(self)},
                            i,
                            state.arguments.id,
                            "components." + components[i / fields.size()].name + '.' +
                                fields[i % fields.size()]});
}

void on_guarded(init_pointer self, const kernel_guarded& x) {
  auto& state = self->state;
  if (state.host)
    return;
  take_host(self, x.host_name);
  state.host = peisinit::host_facts{x.host_name, x.network, x.port};
  perform(self, state.supervisor.begin(now(self)));
  watch_all(self);
  if (state.quit_wanted)
    perform(self, state.supervisor.shut_down(now(self)));
}

void on_tuple(init_pointer self, const tuple_event& x) {
  if (x.deleted)
    return;
  auto& supervisor = self->state.supervisor;
  const auto component = static_cast<std::size_t>(x.watch) / fields.size();
  const auto text = to_string(x.value.view());
  switch (x.watch % fields.size()) {
  case 0:
    perform(self, supervisor.on_request(component, text, now(self)));
    return;
  case 1:
    perform(self, supervisor.on_input(component, text));
    return;
  default:
    perform(self, supervisor.on_arguments(component, text));
  }
}

/// The place of the component that is this peer. @pre there is one
std::size_t component_of(init_pointer self, const std::string& peer) {
  const auto& all = self->state.supervisor.components();
  return static_cast<std::size_t>(std::ranges::find(all, peer, &peisinit::component::peer) -
                                  all.begin());
}

void send_status(init_pointer self) {
  const auto& state = self->state;
  const auto& counted = state.supervisor.counted();
  std::size_t on = 0;
  for (std::size_t i = 0; i < state.supervisor.components().size(); ++i)
    on += state.supervisor.phase_of(i) == peisinit::phase::on ? 1 : 0;
  program_status status{{state.arguments.name, "init", {}}, 0, {}, {}};
  status.program.figures = {{"components on", static_cast<double>(on)},
                            {"starts", static_cast<double>(counted.starts)},
                            {"unwanted ends", static_cast<double>(counted.ends)},
                            {"killed", static_cast<double>(counted.kills)},
                            {"refused", static_cast<double>(counted.refused)}};
  self->send(state.arguments.ecology, std::move(status));
}

} // namespace

init_actor::behavior_type init_behavior(init_pointer self, init_arguments arguments) {
  auto& state = self->state;
  state.arguments = std::move(arguments);
  state.supervisor = peisinit::supervisor(std::move(state.arguments.components));
  self->send(state.arguments.peer, guard_kernel{{handle_of<init_actor>(self)}});
  return {
      [self](const tuple_event& x) { on_tuple(self, x); },
      [](const peis_message&) {}, // hooks no port
      [](const peis_outcome&) {}, // the next step of a stop comes all the same
      [self](const component_started& x) {
        perform(self, self->state.supervisor.on_started(component_of(self, x.peer), x.life, 0));
      },
      [self](const component_ended& x) {
        perform(self,
                self->state.supervisor.on_ended(component_of(self, x.peer), x.life, "", now(self)));
      },
      [self](const kernel_guarded& x) { on_guarded(self, x); },
      [self](quit_wanted) {
        if (self->state.host)
          perform(self, self->state.supervisor.shut_down(now(self)));
        else
          self->state.quit_wanted = true;
      },
      [self](const process_output& x) {
        perform(self, self->state.supervisor.on_output(
                          x.component, x.is_error ? peisinit::channel::err : peisinit::channel::out,
                          x.octets.view(), now(self)));
      },
      [self](const process_ended& x) {
        self->state.processes.erase(x.component);
        if (is_no_command(x.how))
          report_unmet(self, x.component, x.how);
        perform(self, self->state.supervisor.on_ended(x.component, x.life, x.how, now(self)));
      },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          perform(self, self->state.supervisor.on_time(now(self)));
      },
      [self](status_request) { send_status(self); },
  };
}

} // namespace rubicon
