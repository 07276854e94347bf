#include "bridge/ros2/simulated_ros2.hpp"

#include <iterator>
#include <utility>

#include "bridge/table/follow_up.hpp"
#include "core/overloads.hpp"

namespace rubicon::bridge {

components::outputs simulated_ros2::perform(ros2_outputs todo, instant now) {
  return follow_up(std::move(todo),
                   overloads{[&](const open_connection&) {
                               return is_on_ ? core_.on_connected(now) : core_.on_disconnected(now);
                             },
                             [&](const ros2_text& x) {
                               ros2_outputs out;
                               const auto add = [&out](ros2_outputs more) {
                                 out.insert(out.end(), std::make_move_iterator(more.begin()),
                                            std::make_move_iterator(more.end()));
                               };
                               for (const auto& each : server_.on_text(x.text))
                                 add(core_.on_text(each, now));
                               add(core_.on_sent(1, now));
                               return out;
                             }});
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
  return joined(std::move(out), perform(core_.start(now), now));
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
