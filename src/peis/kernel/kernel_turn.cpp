#include "peis/kernel/kernel_turn.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "peis/wire/package.hpp"

namespace rubicon::peis {

namespace {

constexpr std::string_view id_taken_key = "kernel.id-taken"; ///< who else uses our id

} // namespace

outputs kernel_turn::finish(bool input) {
  auto& network = layers_.network;
  layers_.tuples.set_clock_offset(network.view().clock.offset());
  publish(layers_.statistics.due(network, layers_.tuples, now_));
  while (input && network.serve_next(now_)) {
    while (handle_events()) {
    }
  }
  network.end_turn(now_);
  settle();
  layers_.statistics.follow(layers_.tuples);
  return std::exchange(layers_.out, {});
}

/// Handles events until both layers are quiet, then writes to the links.
void kernel_turn::settle() {
  for (bool again = true; again;) {
    again = handle_events();
    if (!again) {
      layers_.network.flush(now_);
      again = handle_events();
    }
  }
}

/// @returns false if there were none
bool kernel_turn::handle_events() {
  auto taken = layers_.network.take_events();
  for (auto& x : taken)
    std::visit([this](auto& what) { this->handle(what); }, x);
  return !taken.empty();
}

void kernel_turn::handle(host_appeared& x) {
  const auto* record = layers_.network.view().hosts.record_of(x.host);
  layers_.out.emplace_back(x);
  perform(layers_.tuples.on_host_appeared(x.host, record != nullptr && record->marked, now_,
                                          x.incarnation));
}

/// The tuple shows it to those who supervise the network.
void kernel_turn::handle(id_taken& x) {
  publish({{*key::parse(id_taken_key), x.by}});
  layers_.out.emplace_back(std::move(x));
}

void kernel_turn::handle(host_vanished& x) {
  for (const auto request : layers_.quits.take_succeeded(x.host))
    report(request, cause::none);
  perform(layers_.tuples.on_host_vanished(x.host, now_));
  layers_.out.emplace_back(x);
}

void kernel_turn::handle(forgotten_by& x) {
  perform(layers_.tuples.renew(x.host, now_));
}

void kernel_turn::handle(device_noted& x) {
  const auto name = key::parse(x.key);
  if (name && x.value)
    publish({{*name, *x.value}});
  else if (name)
    perform(layers_.tuples.remove(*name, now_));
}

void kernel_turn::handle(delivered& x) {
  if (layers_.quits.on_delivered(x.request, now_))
    return;
  if (x.request.value >= own_ids_first)
    perform(layers_.tuples.on_delivered(x.request, now_));
  else
    report(x.request, cause::none);
}

void kernel_turn::handle(undelivered& x) {
  layers_.quits.on_undelivered(x.request);
  if (x.request.value < own_ids_first)
    report(x.request, x.why);
  layers_.tuples.on_undelivered(x.destination, x.port, x.head.view(), x.request, now_);
}

/// The neighbour that sent a message over a link is charged there for all that it causes.
void kernel_turn::handle(arrived& x) {
  const acting_on its(x.origin);
  static_cast<void>(layers_.tuples.take_work());
  events_made_ = 0;
  const auto link = x.from;
  dispatch(x);
  layers_.network.charge(link, layers_.tuples.take_work() + events_made_, now_);
}

void kernel_turn::dispatch(arrived& x) {
  const bool for_us_only = !x.broadcast;
  switch (x.port) {
  case port::set:
    if (for_us_only)
      on_set(x.source, std::move(x.octets));
    return;
  case port::push:
  case port::append_request:
  case port::append_notice:
    if (for_us_only)
      perform(layers_.tuples.on_message(x.port, x.source, std::move(x.octets), now_));
    return;
  case port::subscribe:
    if (const auto message =
            decode_subscribe(x.octets, layers_.tuples.drafts().clock().network_time(now_)))
      refresh_statistics(message->wanted.name);
    perform(layers_.tuples.on_message(x.port, x.source, std::move(x.octets), now_));
    return;
  case port::unsubscribe:
    perform(layers_.tuples.on_message(x.port, x.source, std::move(x.octets), now_));
    return;
  }
  layers_.ports.deliver({x.port, x.source, x.broadcast, std::move(x.octets)}, layers_.out);
}

void kernel_turn::on_set(peer_id source, const payload& octets) {
  const auto x = layers_.tuples.decode_set(octets, now_);
  if (!x)
    return;
  const bool quit = x->name.folded() == quit_key;
  const bool allowed = !is_reserved(x->name) || (quit && may_stop_us(source));
  perform(layers_.tuples.on_set(source, *x, allowed, now_));
  if (allowed && quit && asks_to_quit(*x))
    layers_.out.emplace_back(quit_requested{source});
  if (allowed && x->name.folded() == debug_key)
    layers_.out.emplace_back(debug_requested{std::string(x->text())});
}

/// Peers of our own host and the managers of the configuration (TUP-22).
bool kernel_turn::may_stop_us(peer_id source) const {
  const auto& managers = layers_.config.managers;
  return layers_.network.view().hosts.shares_host(source) ||
         std::find(managers.begin(), managers.end(), source) != managers.end();
}

void kernel_turn::perform(tuple_events todo) {
  events_made_ += todo.size();
  for (auto& x : todo)
    std::visit([this](auto& what) { this->perform(what); }, x);
}

void kernel_turn::perform(transmit& x) {
  const acting_on its(x.from);
  layers_.network.send(
      {x.destination, x.port, std::move(x.content), true, priority::normal, x.request});
}

void kernel_turn::perform(transmit_all& x) {
  static_cast<void>(layers_.network.broadcast(x.port, std::move(x.octets)));
}

void kernel_turn::perform(tuple_changed& x) {
  if (x.subscription.value >= own_ids_first)
    perform(layers_.indirect.on_meta_tuple(x.subscription, x.content.get(), layers_.tuples, now_));
  else
    layers_.out.emplace_back(std::move(x));
}

void kernel_turn::perform(tuple_deleted& x) {
  if (x.subscription.value >= own_ids_first)
    perform(layers_.indirect.on_meta_tuple(x.subscription, nullptr, layers_.tuples, now_));
  else
    layers_.out.emplace_back(std::move(x));
}

void kernel_turn::ask(std::pair<cause, transmit> question, request_id request) {
  if (question.first == cause::none)
    perform(tuple_events{std::move(question.second)});
  else
    report(request, question.first);
}

void kernel_turn::report(request_id request, cause why) {
  if (request != no_request)
    layers_.out.emplace_back(outcome{request, why == cause::none, why});
}

void kernel_turn::refuse(request_id request, cause why) {
  ++layers_.refused;
  report(request, why);
}

void kernel_turn::publish(const kernel_statistics::texts& values) {
  for (const auto& [name, text] : values) {
    const acting_on its(provenance::begin("value"));
    perform(layers_.tuples.set(name, text_content(text), now_).second);
  }
}

void kernel_turn::refresh_statistics(const key& pattern) {
  publish(layers_.statistics.stale(pattern, layers_.network, layers_.tuples, now_));
}

} // namespace rubicon::peis
