#include "bridge/mqtt/simulated_component.hpp"

#include <utility>
#include <variant>

#include "bridge/table/follow_up.hpp"
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
  auto& broker = site_->broker();
  const auto deliver = [&](const simulated_broker::deliveries& all) {
    mqtt_outputs out;
    for (const auto& each : own_of(all))
      for (auto& more : core_.on_message({each.topic, each.payload, each.retained}, now))
        out.push_back(std::move(more));
    return out;
  };
  return follow_up(
      std::move(todo),
      overloads{
          [&](const subscription& x) { return deliver(broker.subscribe(client_, x.topic)); },
          [&](const unsubscription& x) {
            broker.unsubscribe(client_, x.topic);
            return mqtt_outputs();
          },
          [&](const publication& x) { return deliver(broker.publish(x, true, client_)); },
      });
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
  return joined(std::move(out), connect(now));
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
  return joined(std::move(out), perform(core_.on_time(now), now));
}

void simulated_component::happen(const simulated_event& x, instant now, components::outputs& out) {
  const auto* restart = std::get_if<broker_restart>(&x);
  const auto* other = std::get_if<other_publication>(&x);
  out = joined(std::move(out), restart != nullptr
                                   ? restart_broker(restart->keeps == kept_messages::retained, now)
                                   : publish({other->topic, other->payload}, other->retain, now));
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
