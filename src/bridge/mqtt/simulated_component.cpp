#include "bridge/mqtt/simulated_component.hpp"

#include <deque>
#include <iterator>
#include <utility>
#include <variant>

#include "core/overloads.hpp"

namespace rubicon::bridge {

namespace {

constexpr std::uint32_t own_client = 1;

} // namespace

components::figures figures_of(const mqtt_bridge& x) {
  components::figures out;
  components::add_figures<bridge::mqtt_counters>(out, x.counters());
  components::add_figures<bridge::object_table_counters>(out, x.table().counters(), "objects ");
  out.emplace_back("queue replaced", static_cast<double>(x.queue().replaced()));
  return out;
}

components::outputs simulated_component::perform(mqtt_outputs todo, instant now) {
  components::outputs out;
  std::deque<mqtt_output> waiting(std::make_move_iterator(todo.begin()),
                                  std::make_move_iterator(todo.end()));
  const auto deliver = [&](const simulated_broker::deliveries& all) {
    for (const auto& each : all)
      for (auto& more : core_.on_message({each.topic, each.payload, each.retained}, now))
        waiting.push_back(std::move(more));
  };
  while (!waiting.empty()) {
    auto next = std::move(waiting.front());
    waiting.pop_front();
    std::visit(overloads{
                   [&](const subscription& x) { deliver(broker_.subscribe(own_client, x.topic)); },
                   [&](const unsubscription& x) { broker_.unsubscribe(own_client, x.topic); },
                   [&](const publication& x) { deliver(broker_.publish(x, true)); },
                   [&](components::publish& x) { out.emplace_back(std::move(x)); },
                   [&](components::write& x) { out.emplace_back(std::move(x)); },
               },
               next);
  }
  return out;
}

components::outputs simulated_component::connect(instant now) {
  broker_.connect(own_client, core_.last_will());
  return perform(core_.on_connected(now), now);
}

components::outputs simulated_component::start(instant now) {
  components::outputs out;
  for (auto& key : core_.watched())
    out.emplace_back(components::watch{0, any_peer, std::move(key)});
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
  return perform(core_.on_time(now), now);
}

components::outputs simulated_component::publish(const publication& x, bool retain, instant now) {
  mqtt_outputs todo;
  for (const auto& each : broker_.publish(x, retain))
    for (auto& more : core_.on_message({each.topic, each.payload, each.retained}, now))
      todo.push_back(std::move(more));
  return perform(std::move(todo), now);
}

components::outputs simulated_component::restart_broker(bool persistent, instant now) {
  broker_.restart(persistent);
  core_.on_disconnected();
  return connect(now);
}

components::figures simulated_component::figures() const {
  return figures_of(core_);
}

} // namespace rubicon::bridge
