#include "bridge/ros2/simulated_ros2.hpp"

#include <deque>
#include <iterator>
#include <variant>

#include "core/overloads.hpp"

namespace rubicon::bridge {

components::outputs simulated_ros2::perform(ros2_outputs todo, instant now) {
  components::outputs out;
  std::deque<ros2_output> waiting(std::make_move_iterator(todo.begin()),
                                  std::make_move_iterator(todo.end()));
  const auto add = [&waiting](ros2_outputs more) {
    waiting.insert(waiting.end(), std::make_move_iterator(more.begin()),
                   std::make_move_iterator(more.end()));
  };
  while (!waiting.empty()) {
    auto next = std::move(waiting.front());
    waiting.pop_front();
    std::visit(overloads{
                   [&](const open_connection&) {
                     add(is_on_ ? core_.on_connected(now) : core_.on_disconnected(now));
                   },
                   [&](const ros2_text& x) {
                     for (const auto& each : server_.on_text(x.text))
                       add(core_.on_text(each, now));
                     add(core_.on_sent(1, now));
                   },
                   [&](components::publish& x) { out.emplace_back(std::move(x)); },
                   [&](components::write& x) { out.emplace_back(std::move(x)); },
               },
               next);
  }
  return out;
}

components::outputs simulated_ros2::deliver(const simulated_rosbridge::texts& all, instant now) {
  ros2_outputs todo;
  for (const auto& each : all)
    for (auto& more : core_.on_text(each, now))
      todo.push_back(std::move(more));
  return perform(std::move(todo), now);
}

components::outputs simulated_ros2::start(instant now) {
  components::outputs out;
  for (auto& each : core_.watched(self_))
    out.emplace_back(std::move(each));
  auto more = perform(core_.start(now), now);
  std::move(more.begin(), more.end(), std::back_inserter(out));
  return out;
}

components::outputs simulated_ros2::on_tuple(const components::news& x, instant now) {
  return perform(core_.on_tuple(x, now), now);
}

components::outputs simulated_ros2::on_written(std::uint64_t token, std::string_view cause,
                                               instant now) {
  return perform(core_.on_written(token, cause, now), now);
}

components::outputs simulated_ros2::on_time(instant now) {
  return perform(core_.on_time(now), now);
}

components::outputs simulated_ros2::publish(const std::string& topic, const std::string& message,
                                            instant now) {
  return deliver(server_.publish(topic, message), now);
}

components::outputs simulated_ros2::call(const std::string& service, const std::string& id,
                                         const std::string& arguments, instant now) {
  return deliver(server_.call(service, id, arguments), now);
}

components::outputs simulated_ros2::stop_server(instant now) {
  is_on_ = false;
  server_.on_disconnected();
  return perform(core_.on_disconnected(now), now);
}

} // namespace rubicon::bridge
