#include "actors/bridge/ros2_component.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "bridge/ros2/rosbridge_place.hpp"
#include "core/overloads.hpp"

namespace rubicon {

std::variant<io::web_client_settings, std::string> client_settings(const bridge::ros2_settings& x) {
  const auto server = bridge::parse_rosbridge_place(x.server);
  if (!server)
    return x.place + ": " + x.server + ": not HOST:PORT";
  io::web_client_settings out{server->where.host, server->where.port, x.path};
  out.tls = server->tls;
  out.verify = x.verify;
  if (!x.ca_file.empty())
    out.ca_file = (std::filesystem::path(x.folder) / x.ca_file).string();
  if (!out.ca_file.empty() && !std::ifstream(out.ca_file).good())
    return x.place + ": " + out.ca_file + ": cannot be read";
  return out;
}

ros2_component::ros2_component(bridge::ros2_bridge core, peer_id self,
                               io::web_client_settings server)
    : core_(std::move(core)), self_(self), server_(std::move(server)) {}

components::outputs ros2_component::perform(bridge::ros2_outputs todo) {
  components::outputs out;
  for (auto& each : todo)
    std::visit(overloads{
                   [this](const bridge::open_connection&) { client_->connect(); },
                   [this](bridge::ros2_text& x) { client_->send(std::move(x.text)); },
                   [&](components::publish& x) { out.emplace_back(std::move(x)); },
                   [&](components::write& x) { out.emplace_back(std::move(x)); },
               },
               each);
  return out;
}

components::outputs ros2_component::start(instant now) {
  client_ = std::make_unique<io::web_client>(server_, wake_);
  components::outputs out;
  for (auto& each : core_.watched(self_))
    out.emplace_back(std::move(each));
  auto more = perform(core_.start(now));
  std::move(more.begin(), more.end(), std::back_inserter(out));
  return out;
}

components::outputs ros2_component::on_input(instant now) {
  components::outputs out;
  const auto add = [&](bridge::ros2_outputs todo) {
    auto more = perform(std::move(todo));
    std::move(more.begin(), more.end(), std::back_inserter(out));
  };
  for (auto& each : client_->take())
    std::visit(overloads{
                   [&](const io::web_connected&) {
                     is_reported_ = false;
                     out.emplace_back(components::tell{"connected to the rosbridge"});
                     add(core_.on_connected(now));
                   },
                   [&](const io::web_disconnected& x) {
                     if (!std::exchange(is_reported_, true))
                       out.emplace_back(
                           components::tell{"not connected to the rosbridge: " + x.cause});
                     add(core_.on_disconnected(now));
                   },
                   [&](const io::web_message& x) { add(core_.on_text(x.text, now)); },
                   [&](const io::web_sent& x) { add(core_.on_sent(x.count, now)); },
               },
               each);
  return out;
}

components::outputs ros2_component::on_tuple(const components::news& x, instant now) {
  return perform(core_.on_tuple(x, now));
}

components::outputs ros2_component::on_written(std::uint64_t token, std::string_view cause,
                                               instant now) {
  return perform(core_.on_written(token, cause, now));
}

components::outputs ros2_component::on_time(instant now) {
  return perform(core_.on_time(now));
}

components::figures ros2_component::figures() const {
  auto out = bridge::figures_of(core_);
  if (client_)
    components::add_figures<io::web_client_counters>(out, client_->counters(), "client ");
  return out;
}

} // namespace rubicon
