#include <string>
#include <utility>

#include "actors/base/log.hpp"
#include "actors/messages/links.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/peis/peis_peer.hpp"
#include "peis/media/simulated_bluetooth.hpp"
#include "peis/wire/announcement.hpp"

namespace rubicon {

namespace {

/// A value as components see it: text without its trailing NUL. It is not copied.
payload shown(const peis::tuple& x) {
  return x.form == peis::encoding::text ? x.value.part(0, x.text().size()) : x.value;
}

/// Whether links are closed so while all is well.
bool is_everyday(peis::close_cause x) {
  using peis::close_cause;
  return x == close_cause::double_link || x == close_cause::unneeded ||
         x == close_cause::host_left || x == close_cause::leaf;
}

/// The log has a few of the events that any peer can cause, the report counts all.
bool may_log(peer_pointer self, line_allowance& of, std::string_view events) {
  const auto left_out = of.ask(now(self));
  if (left_out && *left_out > 0)
    log(self, spdlog::level::warn, "event={} left_out={}", events, *left_out);
  return left_out.has_value();
}

void log_closing(peer_pointer self, const peis::close_link& x) {
  if (is_everyday(x.why)) {
    log(self, spdlog::level::info, "event=link_closed link={} cause={}", x.link.value,
        peis::to_string(x.why));
    return;
  }
  if (!may_log(self, self->state.closings, "links_closed"))
    return;
  log(self, spdlog::level::warn, "event=link_closed link={} cause={}", x.link.value,
      peis::to_string(x.why));
}

/// Sends components what is for them.
struct component_notifier {
  peer_pointer self;

  void operator()(const peis::tuple_notice& x) const {
    const acting_on its(x.from);
    const auto& content = *x.content;
    send<peis_client_actor>(x.client, tuple_event{x.watch, content.owner, content.name.text(),
                                                  shown(content), x.deleted});
  }
  void operator()(peis::message_notice& x) const {
    const acting_on its(x.from);
    send<peis_client_actor>(x.client, peis_message{x.source, x.port, std::move(x.octets)});
  }
  void operator()(const peis::outcome_notice& x) const {
    const acting_on its(x.from);
    send<peis_client_actor>(
        x.client, peis_outcome{x.token, x.success,
                               x.success ? std::string() : std::string(to_string(x.why))});
  }
  void operator()(peis::subscribers_notice& x) const {
    send<subscribers_watcher_actor>(x.client, subscribers_changed{std::move(x.keys)});
  }
  void operator()(const peis::clock_notice& x) const {
    send<clock_watcher_actor>(x.client, clock_changed{x.offset});
  }
  void operator()(const peis::withdraw& x) const {
    perform_outputs(self,
                    self->state.kernel.subscriptions().unsubscribe(x.subscription, now(self)));
  }

  template <class Handle, class Message>
  void send(peis::client_id to, Message x) const {
    self->send(Handle(self->state.components.at(to)), std::move(x));
  }
};

struct peis_peer_performer {
  peer_pointer self;

  void operator()(peis::to_link& x) const {
    if (x.link.value < first_real_link)
      transmit(self, x.link, std::move(x.octets));
    else if (self->state.real != nullptr)
      self->state.real->carry_out(std::move(x));
  }

  void operator()(const peis::close_link& x) const {
    auto& state = self->state;
    log_closing(self, x);
    ++state.links_closed[std::string(peis::to_string(x.why))];
    if (state.tcp_links.erase(x.link) > 0 && state.real != nullptr) {
      state.real->carry_out(x);
      state.real->hold(x.link, false);
      self->send(state.arguments.ecology, outside_link_changed{});
    }
    const auto found = state.links.find(x.link);
    if (found == state.links.end())
      return;
    notify_closed(self, x.link, found->second);
    state.links.erase(found);
    if (x.link.value >= peis::first_bluetooth_link)
      self->send(state.arguments.bluetooth, lan_link_ended{x.link.value});
    else if (state.arguments.lan)
      self->send(state.arguments.lan, lan_link_ended{x.link.value});
  }

  /// Simulated links have no other end that could wait.
  void operator()(const peis::read_link& x) const {
    if (x.link.value < first_real_link || self->state.real == nullptr)
      return;
    self->state.real->hold(x.link, !x.wanted);
  }

  /// Simulated links take packages as a whole.
  void operator()(const peis::pace_link& x) const {
    if (x.link.value >= first_real_link && self->state.real != nullptr)
      self->state.real->carry_out(x);
  }

  void operator()(const peis::connect_to& x) const { ask_for_link(self, x); }

  void operator()(const peis::announce& x) const {
    const auto& arguments = self->state.arguments;
    if (arguments.discovery && arguments.lan)
      self->send(arguments.lan, lan_announce{arguments.station, x.octets});
    if (self->state.real != nullptr) {
      auto octets = to_bytes(x.octets.view());
      peis::hide_inproc_of_announcement(octets);
      self->state.real->carry_out(peis::announce{std::move(octets)});
    }
  }

  void operator()(peis::scan_adapter& x) const {
    const auto& arguments = self->state.arguments;
    if (arguments.bluetooth)
      self->send(arguments.bluetooth, scan_bluetooth{arguments.station, std::move(x.adapter)});
    else if (self->state.real != nullptr)
      self->state.real->carry_out(x);
  }

  void operator()(peis::say_hello& x) const {
    const auto& arguments = self->state.arguments;
    if (arguments.bluetooth)
      self->send(arguments.bluetooth,
                 send_hello{arguments.station, {std::move(x.adapter), x.to, std::move(x.octets)}});
    else if (self->state.real != nullptr)
      self->state.real->carry_out(std::move(x));
  }

  void operator()(const peis::traced&) const {} // not requested here

  void operator()(const peis::tuple_changed& x) const {
    notify_components(self, self->state.clients.on(x));
  }
  void operator()(const peis::tuple_deleted& x) const {
    notify_components(self, self->state.clients.on(x));
  }
  void operator()(peis::message& x) const {
    notify_components(self, self->state.clients.on(std::move(x)));
  }
  void operator()(const peis::outcome& x) const {
    notify_components(self, self->state.clients.on(x));
  }

  void operator()(const peis::host_appeared& x) const {
    log(self, spdlog::level::info, "event=host_appeared host={}", x.host.value);
  }
  void operator()(const peis::host_vanished& x) const {
    log(self, spdlog::level::info, "event=host_vanished host={}", x.host.value);
  }
  void operator()(const peis::quit_requested& x) const {
    log(self, spdlog::level::info, "event=quit_requested by={}", x.by.value);
    if (!ask_init(self))
      quit_process(self);
  }
  void operator()(peis::debug_requested& x) const {
    if (may_log(self, self->state.debugs, "debug_requests"))
      self->send(self->state.arguments.ecology, debug_wanted{self->path(), std::move(x.text)});
  }
  void operator()(const peis::intercepted& x) const {
    log(self, spdlog::level::info, "event=intercepted port={} source={} destination={}", x.port,
        x.source.value, x.destination.value);
  }
  void operator()(const peis::namesake_found& x) const {
    log(self, spdlog::level::warn, "event=namesake host={} is={}", x.host.value, x.full_name);
    self->send(self->state.arguments.ecology,
               notable_event{self->path(), "the computer of " + x.full_name +
                                               " has the same name as this one: give one of them "
                                               "another name"});
  }
  void operator()(const peis::id_taken& x) const {
    const auto& ecology = self->state.arguments.ecology;
    if (x.stays_away > duration(0)) {
      log(self, spdlog::level::err, "event=id_left_to by={} away_s={}", x.by,
          seconds(x.stays_away));
      self->send(ecology, notable_event{self->path(), "leaves its id to " + x.by});
    } else if (may_log(self, self->state.claims, "ids_taken")) {
      log(self, spdlog::level::err, "event=id_taken by={}", x.by);
      self->send(ecology, notable_event{self->path(), "its id is used by " + x.by});
    }
  }
};

} // namespace

void leave_and_close(peer_pointer self) {
  auto& state = self->state;
  if (std::exchange(state.left, true))
    return;
  perform_outputs(self, state.kernel.leave(now(self)));
  for (const auto& [id, link] : state.links)
    notify_closed(self, id, link);
  state.links.clear();
  state.tcp_links.clear();
  if (state.real != nullptr)
    state.real->close_all();
}

void quit_process(peer_pointer self) {
  leave_and_close(self);
  self->quit(caf::exit_reason::user_shutdown);
}

bool ask_init(peer_pointer self) {
  if (!self->state.init || self->state.left)
    return false;
  self->send(self->state.init, quit_wanted{});
  return true;
}

void notify_components(peer_pointer self, peis::kernel_clients::outputs todo) {
  for (auto& output : todo)
    std::visit(component_notifier{self}, output);
}

void perform_outputs(peer_pointer self, peis::outputs todo) {
  auto& state = self->state;
  for (auto& output : todo)
    std::visit(peis_peer_performer{self}, output);
  notify_components(self, state.clients.review(state.kernel, now(self)));
  state.wake.follow(self, earliest(state.kernel.deadline(), state.clients.deadline()));
}

} // namespace rubicon
