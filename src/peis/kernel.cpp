#include "peis/kernel.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr std::string_view version_text = "v0.6.0.7 (proto 500)"; // what real kernels show
constexpr std::string_view quit_key = "kernel.do-quit";

/// Keys that describe the kernel and that others may not write (TUP-22).
bool is_reserved(const key& name) {
  return name.folded() == "kernel" || name.folded().starts_with("kernel.");
}

/// Any value but these asks to quit (peis-wire.md 18).
bool asks_to_quit(const tuple& x) {
  const auto text = key::from_wire(x.text().substr(0, key_length_max));
  return text && !text->folded().empty() && text->folded() != "no" && text->folded() != "nil";
}

} // namespace

kernel::kernel(kernel_config config, random_stream dice, instant now)
    : config_(std::move(config)), network_(config_.network, dice, now),
      tuples_(config_.tuples, config_.network.id, config_.network.clock_offset) {
  assert(config_.network.id.value >= 1 && config_.network.id.value <= peer_id_max);
  const std::pair<std::string_view, std::string> published[] = {
      {"kernel.hostname", config_.network.host_name}, {"kernel.version", std::string(version_text)},
      {"kernel.name", config_.network.name},          {"kernel.user", config_.user},
      {"kernel.id", to_string(config_.network.id)},   {quit_key, ""}};
  for (const auto& [name, text] : published)
    static_cast<void>(
        tuples_.set(*key::parse(name), text_content(text), now)); // nobody listens yet
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

outputs kernel::on_announcement(byte_view octets, instant now) {
  network_.on_announcement(octets, now);
  return finish(now);
}

outputs kernel::on_link_octets(link_id link, byte_view octets, instant now) {
  network_.on_link_octets(link, octets, now);
  return finish(now);
}

outputs kernel::on_link_sent(link_id link, std::size_t octets, instant now) {
  network_.on_link_sent(link, octets);
  return finish(now);
}

outputs kernel::on_link_closed(link_id link, instant now) {
  network_.on_link_closed(link, now);
  return finish(now);
}

outputs kernel::on_time(instant now) {
  network_.on_time(now);
  perform(tuples_.on_time(now));
  return finish(now);
}

std::optional<instant> kernel::deadline() const {
  return earliest(network_.deadline(), tuples_.deadline());
}

/// Works off what the layers tell each other until both are quiet, then writes to the links.
outputs kernel::finish(instant now) {
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
  return std::exchange(out_, {});
}

void kernel::handle(to_link& x, instant) {
  out_.push_back(std::move(x));
}

void kernel::handle(close_link& x, instant) {
  out_.push_back(x);
}

void kernel::handle(connect_to& x, instant) {
  out_.push_back(std::move(x));
}

void kernel::handle(announce& x, instant) {
  out_.push_back(std::move(x));
}

void kernel::handle(host_appeared& x, instant) {
  const auto* record = network_.find_host(x.host);
  out_.push_back(x);
  perform(tuples_.on_host_appeared(x.host, record != nullptr && record->marked));
}

void kernel::handle(host_vanished& x, instant) {
  perform(tuples_.on_host_vanished(x.host));
  out_.push_back(x);
}

void kernel::handle(forgotten_by& x, instant) {
  perform(tuples_.renew(x.host));
}

void kernel::handle(delivered& x, instant) {
  report(x.request, cause::none);
}

void kernel::handle(undelivered& x, instant now) {
  report(x.request, x.why);
  perform(tuples_.on_undelivered(x.destination, x.port, x.head.view(), now));
}

void kernel::handle(arrived& x, instant now) {
  switch (x.port) {
  case port::push:
    if (!x.broadcast)
      perform(tuples_.on_push(x.source, std::move(x.octets), now));
    return;
  case port::set:
    if (!x.broadcast)
      on_set(x.source, std::move(x.octets), now);
    return;
  case port::subscribe:
    perform(tuples_.on_subscribe(x.source, x.octets, now));
    return;
  case port::unsubscribe:
    perform(tuples_.on_unsubscribe(x.source, x.octets));
    return;
  }
  if (hooked_.test(x.port))
    out_.push_back(message{x.port, x.source, x.broadcast, std::move(x.octets)});
  else
    ++unhooked_;
}

void kernel::on_set(peer_id source, bytes octets, instant now) {
  const auto x = tuples_.decode_set(std::move(octets));
  if (!x)
    return;
  const bool quit = x->name.folded() == quit_key;
  const bool allowed = !is_reserved(x->name) || (quit && may_stop_us(source));
  perform(tuples_.on_set(*x, allowed, now));
  if (allowed && quit && asks_to_quit(*x))
    out_.push_back(quit_requested{source});
}

/// Peers of our own host and the managers of the configuration (TUP-22).
bool kernel::may_stop_us(peer_id source) const {
  const auto* record = network_.find_host(source);
  const auto& managers = config_.managers;
  return (record != nullptr && record->host_name == config_.network.host_name) ||
         std::find(managers.begin(), managers.end(), source) != managers.end();
}

void kernel::perform(tuple_events todo) {
  for (auto& x : todo) {
    if (auto* sent = std::get_if<transmit>(&x)) {
      network_.send({sent->destination, sent->port, std::move(sent->content), true,
                     priority::normal, sent->request});
    } else if (auto* flooded = std::get_if<transmit_all>(&x)) {
      static_cast<void>(network_.broadcast(flooded->port, std::move(flooded->octets)));
    } else if (auto* changed = std::get_if<tuple_changed>(&x)) {
      out_.push_back(std::move(*changed));
    } else {
      out_.push_back(std::move(std::get<tuple_deleted>(x)));
    }
  }
}

void kernel::report(request_id request, cause why) {
  if (request != no_request)
    out_.push_back(outcome{request, why == cause::none, why});
}

outputs kernel::set_tuple(std::string_view name, tuple_content content, instant now,
                          request_id request) {
  const auto parsed = key::parse(name);
  auto why = refusal(parsed);
  if (why == cause::none) {
    auto [verdict, todo] = tuples_.set(*parsed, std::move(content), now);
    why = verdict;
    perform(std::move(todo));
  }
  report(request, why);
  return finish(now);
}

outputs kernel::delete_tuple(std::string_view name, instant now, request_id request) {
  const auto parsed = key::parse(name);
  const auto why = refusal(parsed);
  if (why == cause::none)
    perform(tuples_.remove(*parsed, now));
  report(request, why);
  return finish(now);
}

outputs kernel::set_remote_tuple(peer_id owner, std::string_view name, tuple_content content,
                                 request_id request, instant now) {
  if (owner == id())
    return set_tuple(name, std::move(content), now, request);
  return ask(owner, name, std::move(content), request, now);
}

outputs kernel::delete_remote_tuple(peer_id owner, std::string_view name, request_id request,
                                    instant now) {
  if (owner == id())
    return delete_tuple(name, now, request);
  return ask(owner, name, std::nullopt, request, now);
}

outputs kernel::ask(peer_id owner, std::string_view name, std::optional<tuple_content> content,
                    request_id request, instant now) {
  const auto parsed = key::parse(name);
  auto why = refusal(parsed);
  if (why == cause::none) {
    auto [verdict, question] = tuples_.ask_owner(owner, *parsed, std::move(content), request, now);
    why = verdict;
    if (why == cause::none)
      network_.send(
          {owner, question.port, std::move(question.content), true, priority::normal, request});
  }
  if (why != cause::none)
    report(request, why);
  return finish(now);
}

outputs kernel::subscribe(peer_id owner, std::string_view pattern, subscription_id id, instant now,
                          request_id request) {
  const auto parsed = key::parse(pattern);
  auto why = refusal(parsed);
  if (why == cause::none) {
    auto [verdict, todo] = tuples_.subscribe(owner, *parsed, id, now);
    why = verdict;
    perform(std::move(todo));
  }
  report(request, why);
  return finish(now);
}

outputs kernel::unsubscribe(subscription_id id, instant now) {
  perform(tuples_.unsubscribe(id));
  return finish(now);
}

outputs kernel::send_message(peer_id destination, std::uint16_t port, payload octets, bool reliable,
                             priority class_of_service, request_id request, instant now) {
  if (!is_user_port(port)) {
    report(request, cause::bad_port);
  } else if (destination == id()) {
    if (hooked_.test(port))
      out_.push_back(message{port, id(), false, std::move(octets)});
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

outputs kernel::leave(instant now) {
  network_.leave();
  return finish(now);
}

cause kernel::refusal(const result<key>& name) {
  if (network_.has_left())
    return cause::left;
  if (name)
    return cause::none;
  ++refused_;
  return cause::bad_key;
}

peer_id kernel::id() const {
  return config_.network.id;
}

const tuple* kernel::find_tuple(peer_id owner, std::string_view name) const {
  const auto parsed = key::parse(name);
  return parsed ? tuples_.find(owner, *parsed) : nullptr;
}

std::vector<const tuple*> kernel::own_tuples() const {
  return tuples_.find_all(id(), key());
}

std::vector<const tuple*> kernel::find_tuples(peer_id owner, std::string_view pattern) const {
  const auto parsed = key::parse(pattern);
  return parsed ? tuples_.find_all(owner, *parsed) : std::vector<const tuple*>();
}

bool kernel::has_subscriber(std::string_view name) const {
  const auto parsed = key::parse(name);
  return parsed && tuples_.has_subscriber(*parsed);
}

std::vector<const host_record*> kernel::hosts() const {
  return network_.hosts();
}

bool kernel::reachable(peer_id host) const {
  return host == id() || network_.reachable(host);
}

timestamp kernel::network_time(instant now) const {
  return tuples_.network_time(now);
}

kernel_counters kernel::counters() const {
  kernel_counters all{network_.counters(), tuples_.counters(), unhooked_};
  all.tuples.refused += refused_;
  return all;
}

} // namespace rubicon::peis
