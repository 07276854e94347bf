#include "bridge/mqtt/simulated_component.hpp"

#include <deque>
#include <iterator>
#include <utility>
#include <variant>

#include "core/overloads.hpp"

namespace rubicon::bridge {

components::figures figures_of(const mqtt_bridge& x) {
  components::figures out;
  components::add_figures<bridge::mqtt_counters>(out, x.counters());
  components::add_figures<bridge::object_table_counters>(out, x.table().counters(), "objects ");
  out.emplace_back("queue replaced", static_cast<double>(x.queue().replaced()));
  return out;
}

simulated_component::~simulated_component() {
  if (site_)
    static_cast<void>(site_->broker().lose(client_));
}

simulated_broker::deliveries simulated_component::own_of(simulated_broker::deliveries all) const {
  std::erase_if(all, [this](const auto& each) { return each.client != client_; });
  return all;
}

components::outputs simulated_component::perform(mqtt_outputs todo, instant now) {
  components::outputs out;
  auto& broker = site_->broker();
  std::deque<mqtt_output> waiting(std::make_move_iterator(todo.begin()),
                                  std::make_move_iterator(todo.end()));
  const auto deliver = [&](const simulated_broker::deliveries& all) {
    for (const auto& each : own_of(all))
      for (auto& more : core_.on_message({each.topic, each.payload, each.retained}, now))
        waiting.push_back(std::move(more));
  };
  while (!waiting.empty()) {
    auto next = std::move(waiting.front());
    waiting.pop_front();
    std::visit(overloads{
                   [&](const subscription& x) { deliver(broker.subscribe(client_, x.topic)); },
                   [&](const unsubscription& x) { broker.unsubscribe(client_, x.topic); },
                   [&](const publication& x) { deliver(broker.publish(x, true, client_)); },
                   [&](components::publish& x) { out.emplace_back(std::move(x)); },
                   [&](components::write& x) { out.emplace_back(std::move(x)); },
               },
               next);
  }
  return out;
}

components::outputs simulated_component::connect(instant now) {
  site_->broker().connect(client_, core_.last_will());
  return perform(core_.on_connected(now), now);
}

components::outputs simulated_component::start(instant now) {
  components::outputs out;
  for (auto& key : core_.watched())
    out.emplace_back(components::watch{0, any_peer, std::move(key)});
  site_->catch_up(now);
  client_ = site_->new_client();
  auto more = connect(now);
  std::move(more.begin(), more.end(), std::back_inserter(out));
  return out;
}

components::outputs simulated_component::on_tuple(const components::news& x, instant now) {
  return perform(core_.on_tuple(x, now), now);
}

components::outputs simulated_component::on_written(std::uint64_t token, std::string_view cause,
                                                    instant now) {
  return perform(core_.on_written(token, cause, now), now);
}

components::outputs simulated_component::on_time(instant now) {
  components::outputs out;
  while (const auto event = site_->take(now))
    happen(*event, now, out);
  auto more = perform(core_.on_time(now), now);
  std::move(more.begin(), more.end(), std::back_inserter(out));
  return out;
}

void simulated_component::happen(const simulated_event& x, instant now, components::outputs& out) {
  const auto* restart = std::get_if<broker_restart>(&x);
  const auto* other = std::get_if<other_publication>(&x);
  auto more = restart != nullptr ? restart_broker(restart->keeps == kept_messages::retained, now)
                                 : publish({other->topic, other->payload}, other->retain, now);
  std::move(more.begin(), more.end(), std::back_inserter(out));
}

components::outputs simulated_component::publish(const publication& x, bool retain, instant now) {
  mqtt_outputs todo;
  for (const auto& each : own_of(site_->broker().publish(x, retain)))
    for (auto& more : core_.on_message({each.topic, each.payload, each.retained}, now))
      todo.push_back(std::move(more));
  return perform(std::move(todo), now);
}

components::outputs simulated_component::restart_broker(bool persistent, instant now) {
  site_->broker().restart(persistent);
  core_.on_disconnected();
  return connect(now);
}

components::figures simulated_component::figures() const {
  return figures_of(core_);
}

} // namespace rubicon::bridge
