#include "peis/kernel/kernel.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr std::string_view version_text = "v0.6.0.7 (proto 500)"; // what real kernels show
/// An init lets its components end first.
constexpr duration quit_patience = 6s;
constexpr std::string_view id_taken_key = "kernel.id-taken"; ///< who else uses our id

/// Any value but these asks to quit (docs/peis-wire.md 18).
bool asks_to_quit(const tuple& x) {
  const auto text = key::from_wire(x.text().substr(0, key_characters_max));
  return text && !text->folded().empty() && text->folded() != "no" && text->folded() != "nil";
}

} // namespace

kernel::kernel() = default;
kernel::~kernel() = default;
kernel::kernel(kernel&&) noexcept = default;
kernel& kernel::operator=(kernel&&) noexcept = default;

kernel::kernel(kernel_config config, random_stream rng, instant now)
    : config_(std::move(config)), network_(config_.network, rng, now),
      tuples_(config_.tuples, config_.network.id, config_.network.clock_offset), statistics_(now) {
  assert(config_.network.id.value >= 1 && config_.network.id.value <= peer_id_max);
  network_.share_memory(tuples_.memory());
  const std::pair<std::string_view, std::string> published[] = {
      {"kernel.hostname", config_.network.host_name}, {"kernel.version", std::string(version_text)},
      {"kernel.name", config_.network.name},          {"kernel.user", config_.user},
      {"kernel.id", to_string(config_.network.id)},   {quit_key, ""}};
  const auto statistics = [&] { return statistics_.initial(network_, tuples_, now); };
  publish(statistics(), now); // nobody listens yet
  for (const auto& [name, text] : published)
    publish({{*key::parse(name), text}}, now);
  publish(statistics(), now); // once more, all keys being there
}

outputs kernel::on_link_open(link_id link, link_role role, instant now,
                             std::optional<attempt_id> attempt) {
  network_.on_link_open(link, role, now, attempt);
  return finish(now);
}

outputs kernel::on_attempt_failed(attempt_id attempt, instant now) {
  network_.on_attempt_failed(attempt, now);
  return finish(now);
}

outputs kernel::set_addresses(std::vector<low_level_address> all, instant now) {
  network_.set_addresses(std::move(all), now);
  return finish(now);
}

outputs kernel::on_announcement(byte_view octets, instant now, std::optional<ipv4_address> from) {
  network_.on_announcement(octets, now, from);
  return finish(now);
}

outputs kernel::on_bluetooth_scan(std::string_view adapter, std::span<const seen_device> seen,
                                  instant now) {
  network_.on_bluetooth_scan(adapter, seen, now);
  return finish(now);
}

outputs kernel::on_hello_answer(std::string_view adapter, const bluetooth_address& address,
                                byte_view octets, instant now) {
  network_.on_hello_answer(adapter, address, octets, now);
  return finish(now);
}

outputs kernel::on_link_octets(link_id link, byte_view octets, instant now) {
  const bool idle = !network_.has_input();
  network_.on_link_octets(link, octets, now);
  return finish(now, idle);
}

outputs kernel::on_link_sent(link_id link, std::size_t octets, instant now) {
  network_.on_link_sent(link, octets, now);
  return finish(now);
}

outputs kernel::on_link_closed(link_id link, instant now) {
  network_.on_link_closed(link, now);
  return finish(now);
}

outputs kernel::on_time(instant now) {
  network_.on_time(now);
  perform(tuples_.on_time(now), now);
  give_up_quits(now);
  return finish(now, true);
}

std::optional<instant> kernel::deadline() const {
  auto due = earliest(network_.deadline(), tuples_.deadline());
  for (const auto& [request, quit] : quits_)
    due = earliest(due, quit.until);
  return earliest(due, statistics_.deadline(tuples_));
}

/// Handles a turn's input, and all that comes of it.
outputs kernel::finish(instant now, bool turn) {
  tuples_.set_clock_offset(network_.view().clock.offset());
  publish(statistics_.due(network_, tuples_, now), now);
  while (turn && network_.serve_next(now)) {
    for (auto news = network_.take_events(); !news.empty(); news = network_.take_events()) {
      for (auto& x : news)
        std::visit([&](auto& what) { handle(what, now); }, x);
    }
  }
  network_.end_turn(now);
  settle(now);
  statistics_.follow(tuples_);
  return std::exchange(out_, {});
}

/// Works off what the layers tell each other until both are quiet, then writes to the links.
void kernel::settle(instant now) {
  for (auto again = true; again;) {
    auto news = network_.take_events();
    if (news.empty()) {
      network_.flush(now);
      news = network_.take_events();
    }
    again = !news.empty();
    for (auto& x : news)
      std::visit([&](auto& what) { handle(what, now); }, x);
  }
}

void kernel::handle(host_appeared& x, instant now) {
  const auto* record = network_.view().hosts.record_of(x.host);
  out_.emplace_back(x);
  perform(tuples_.on_host_appeared(x.host, record != nullptr && record->marked, now, x.incarnation),
          now);
}

/// Whoever looks after the network sees it there.
void kernel::handle(id_taken& x, instant now) {
  publish({{*key::parse(id_taken_key), x.by}}, now);
  out_.emplace_back(std::move(x));
}

void kernel::handle(host_vanished& x, instant now) {
  for (auto quit = quits_.begin(); quit != quits_.end();) {
    const bool has_gone = quit->second.owner == x.host && quit->second.until;
    if (has_gone)
      report(quit->first, cause::none);
    quit = has_gone ? quits_.erase(quit) : std::next(quit);
  }
  perform(tuples_.on_host_vanished(x.host, now), now);
  out_.emplace_back(x);
}

/// @param asked is sent next
void kernel::expect_quit(const tuple& asked, request_id request) {
  const auto* record = network_.view().hosts.record_of(asked.owner);
  if (request != no_request && asked.name.folded() == quit_key && asks_to_quit(asked) &&
      record != nullptr && record->marked && !network_.view().hosts.shares_host(asked.owner))
    quits_[request] = {asked.owner, std::nullopt};
}

/// Who has been asked to quit and is still there does not want to.
void kernel::give_up_quits(instant now) {
  for (auto quit = quits_.begin(); quit != quits_.end();) {
    const bool is_due = quit->second.until && *quit->second.until <= now;
    if (is_due)
      report(quit->first, cause::refused);
    quit = is_due ? quits_.erase(quit) : std::next(quit);
  }
}

void kernel::handle(forgotten_by& x, instant now) {
  perform(tuples_.renew(x.host, now), now);
}

void kernel::handle(device_noted& x, instant now) {
  const auto name = key::parse(x.key);
  if (name && x.value)
    publish({{*name, *x.value}}, now);
  else if (name)
    perform(tuples_.remove(*name, now), now);
}

void kernel::handle(delivered& x, instant now) {
  if (const auto quit = quits_.find(x.request); quit != quits_.end())
    quit->second.until = now + quit_patience;
  else if (x.request.value >= own_ids_first)
    perform(tuples_.on_delivered(x.request, now), now);
  else
    report(x.request, cause::none);
}

void kernel::handle(undelivered& x, instant now) {
  quits_.erase(x.request);
  if (x.request.value < own_ids_first)
    report(x.request, x.why);
  tuples_.on_undelivered(x.destination, x.port, x.head.view(), x.request, now);
}

/// Whoever sent a message over a link pays there for all that it brings about.
void kernel::handle(arrived& x, instant now) {
  const acting_on its(x.origin);
  static_cast<void>(tuples_.take_work());
  events_made_ = 0;
  const auto link = x.from;
  dispatch(x, now);
  network_.charge(link, tuples_.take_work() + events_made_, now);
}

void kernel::dispatch(arrived& x, instant now) {
  const bool for_us_only = !x.broadcast;
  switch (x.port) {
  case port::set:
    if (for_us_only)
      on_set(x.source, std::move(x.octets), now);
    return;
  case port::push:
  case port::append_request:
  case port::append_notice:
    if (for_us_only)
      perform(tuples_.on_message(x.port, x.source, std::move(x.octets), now), now);
    return;
  case port::subscribe:
    if (const auto message = decode_subscribe(x.octets, network_time(now)))
      refresh_statistics(message->wanted.name, now);
    perform(tuples_.on_message(x.port, x.source, std::move(x.octets), now), now);
    return;
  case port::unsubscribe:
    perform(tuples_.on_message(x.port, x.source, std::move(x.octets), now), now);
    return;
  }
  if (hooked_.test(x.port))
    out_.emplace_back(message{x.port, x.source, x.broadcast, std::move(x.octets)});
  else
    ++unhooked_;
}

void kernel::on_set(peer_id source, const payload& octets, instant now) {
  const auto x = tuples_.decode_set(octets, now);
  if (!x)
    return;
  const bool quit = x->name.folded() == quit_key;
  const bool allowed = !is_reserved(x->name) || (quit && may_stop_us(source));
  perform(tuples_.on_set(source, *x, allowed, now), now);
  if (allowed && quit && asks_to_quit(*x))
    out_.emplace_back(quit_requested{source});
  if (allowed && x->name.folded() == debug_key)
    out_.emplace_back(debug_requested{std::string(x->text())});
}

/// Peers of our own host and the managers of the configuration (TUP-22).
bool kernel::may_stop_us(peer_id source) const {
  const auto& managers = config_.managers;
  return network_.view().hosts.shares_host(source) ||
         std::find(managers.begin(), managers.end(), source) != managers.end();
}

void kernel::perform(tuple_events todo, instant now) {
  events_made_ += todo.size();
  for (auto& x : todo) {
    if (auto* sent = std::get_if<transmit>(&x)) {
      const acting_on its(sent->from);
      network_.send({sent->destination, sent->port, std::move(sent->content), true,
                     priority::normal, sent->request});
    } else if (auto* flooded = std::get_if<transmit_all>(&x)) {
      static_cast<void>(network_.broadcast(flooded->port, std::move(flooded->octets)));
    } else if (auto* changed = std::get_if<tuple_changed>(&x)) {
      if (changed->subscription.value >= own_ids_first)
        on_meta_tuple(changed->subscription, changed->content.get(), now);
      else
        out_.emplace_back(std::move(*changed));
    } else if (auto& gone = std::get<tuple_deleted>(x); gone.subscription.value >= own_ids_first) {
      on_meta_tuple(gone.subscription, nullptr, now);
    } else {
      out_.emplace_back(std::move(gone));
    }
  }
}

void kernel::report(request_id request, cause why) {
  if (request != no_request)
    out_.emplace_back(outcome{request, why == cause::none, why});
}

outputs kernel::send_message(peer_id destination, std::uint16_t port, payload octets, bool reliable,
                             priority class_of_service, request_id request, instant now) {
  if (!is_user_port(port)) {
    report(request, cause::bad_port);
  } else if (destination == id()) {
    if (hooked_.test(port))
      out_.emplace_back(message{port, id(), false, std::move(octets)});
    else
      ++unhooked_;
    report(request, cause::none);
  } else {
    network_.send(
        {destination, port, {{}, std::move(octets)}, reliable, class_of_service, request});
  }
  return finish(now);
}

outputs kernel::broadcast(std::uint16_t port, payload octets, request_id request, instant now) {
  report(request,
         is_user_port(port) ? network_.broadcast(port, std::move(octets)) : cause::bad_port);
  return finish(now);
}

bool kernel::is_user_port(std::uint16_t port) {
  return port >= port::user_first && port < port::count;
}

bool kernel::hook_port(std::uint16_t port) {
  if (!is_user_port(port))
    return false;
  hooked_.set(port);
  return true;
}

bool kernel::hook_transit(std::uint16_t port, transit_hook hook) {
  if (!is_user_port(port))
    return false;
  network_.set_transit_hook(port, std::move(hook));
  return true;
}

outputs kernel::trace(peer_id destination, request_id request, instant now) {
  network_.trace(destination, request, now);
  return finish(now);
}

outputs kernel::step_clock(duration by, instant now) {
  network_.step_clock(by, now);
  return finish(now);
}

outputs kernel::leave(instant now) {
  network_.leave();
  return finish(now);
}

cause kernel::refusal(const result<key>& name) {
  if (network_.view().own.left)
    return cause::left;
  if (name)
    return cause::none;
  ++refused_;
  return cause::bad_key;
}

peer_id kernel::id() const {
  return config_.network.id;
}

std::vector<const host_record*> kernel::hosts() const {
  return network_.view().hosts.records();
}

bool kernel::reachable(peer_id host) const {
  return host == id() || network_.view().routes.reachable(host);
}

bool kernel::knows_present(peer_id host) const {
  return host == id() || network_.view().hosts.knows_present(host);
}

timestamp kernel::network_time(instant now) const {
  return tuples_.drafts().clock().network_time(now);
}

kernel_counters kernel::counters() const {
  kernel_counters all{network_.view().own.counters, tuples_.counters(), unhooked_};
  all.tuples.refused += refused_;
  all.tuples.bad_meta_tuples = bad_meta_tuples_;
  return all;
}

} // namespace rubicon::peis
